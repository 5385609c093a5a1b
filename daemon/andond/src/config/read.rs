//! Reads all files at once and collects every fault.

use super::document::Document;
use super::fault::Fault;
use super::keys::Keys;
use super::value::Value;
use std::collections::HashMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// How alike two keys must be (Jaro-Winkler, 0 to 1) before one is offered for the other: a swapped, a missing or
/// a wrong letter is over 0.9, keys that only share their beginning are under 0.8.
const ALIKE: f64 = 0.85;

/// A place in the files: the document's number and the bytes in it.
pub(super) type Place = (usize, Range<usize>);

/// Where a key got its value from.
pub(super) struct Origin {
    /// `None` for a default.
    pub(super) place: Option<Place>,
    /// The value as it is shown.
    pub(super) shown: Option<String>,
    /// What stands there is not allowed: the key still has the value from before.
    pub(super) refused: bool,
}

/// The open section in one document: where it begins, and its keys.
type Part<'d> = (Place, &'d DeTable<'d>);

/// A key that nobody declared.
struct Unknown {
    section: String,
    name: String,
    key_place: Place,
    value_place: Place,
    is_section: bool,
}

/// The visitor that fills the configuration from files; a later file wins.
pub(super) struct Reader<'d> {
    documents: &'d [Document<'d>],
    /// Everything could be read, so that what is not there is missing.
    complete: bool,
    faults: Vec<Fault>,
    origins: HashMap<String, Origin>,
    /// Every key that was declared, as (section, key).
    declared: Vec<(String, &'static str)>,
    unknown: Vec<Unknown>,
    /// The open section: its name, the name of this element in `origins`, its tables.
    section: String,
    element: String,
    parts: Vec<Part<'d>>,
}

impl<'d> Reader<'d> {
    pub(super) fn new(documents: &'d [Document<'d>], complete: bool) -> Self {
        let parts = documents
            .iter()
            .enumerate()
            .map(|(number, document)| ((number, 0..0), &document.table))
            .collect();
        Self {
            documents,
            complete,
            faults: Vec::new(),
            origins: HashMap::new(),
            declared: Vec::new(),
            unknown: Vec::new(),
            section: String::new(),
            element: String::new(),
            parts,
        }
    }

    /// Where each key got its value (`camera.path`, `objects[2].id`), and all faults.
    pub(super) fn finish(mut self) -> (HashMap<String, Origin>, Vec<Fault>) {
        self.leave();
        let unknown = std::mem::take(&mut self.unknown);
        for key in unknown {
            let likely = self.likely_key(&key.section, &key.name);
            let name = joined(&key.section, &key.name);
            let kind = if key.is_section { "section" } else { "key" };
            let mut fault = self.fault(&key.value_place, &name, format!("is not a {kind} that exists"));
            fault.line = Some(self.documents[key.key_place.0].line(key.key_place.1.start));
            fault.likely = likely;
            self.faults.push(fault);
        }
        (self.origins, self.faults)
    }

    fn fault(&self, (number, span): &Place, key: &str, problem: String) -> Fault {
        let document = &self.documents[*number];
        Fault {
            file: document.path.to_owned(),
            line: Some(document.line(span.start)),
            key: Some(key.to_owned()),
            value: document.shown(key, span.clone()),
            problem,
            likely: None,
        }
    }

    /// A key that is like `name`: of the same section, or the very same name in another one.
    fn likely_key(&self, section: &str, name: &str) -> Option<String> {
        let here = self.declared.iter().filter(|(s, _)| s == section).map(|(_, key)| *key);
        most_alike(name, here).map(|key| format!("`{key}`")).or_else(|| {
            let elsewhere = self.declared.iter().find(|(_, key)| *key == name)?;
            Some(format!("`{}`", joined(&elsewhere.0, elsewhere.1)))
        })
    }

    /// Every place of the open section's key, in the order of the files.
    fn found(&mut self, name: &'static str) -> Vec<(Place, &'d DeValue<'d>)> {
        self.declared.push((self.section.clone(), name));
        let of = |((number, _), table): &Part<'d>| {
            let (_, value) = table.iter().find(|(key, _)| key.get_ref() == name)?;
            Some(((*number, value.span()), value.get_ref()))
        };
        self.parts.iter().filter_map(of).collect()
    }

    /// Runs `keys` inside the section `name` with `parts`.
    fn enter(
        &mut self,
        name: &'static str,
        element: String,
        parts: Vec<Part<'d>>,
        keys: impl FnOnce(&mut Self),
    ) {
        let section = std::mem::replace(&mut self.section, name.to_owned());
        let element = std::mem::replace(&mut self.element, element);
        let parts = std::mem::replace(&mut self.parts, parts);
        keys(self);
        self.leave();
        self.section = section;
        self.element = element;
        self.parts = parts;
    }

    /// Notes what the open section has and nobody declared.
    fn leave(&mut self) {
        for ((number, _), table) in &self.parts {
            for (key, value) in table.iter() {
                let declared = |(s, name): &(String, &str)| *s == self.section && name == key.get_ref();
                if !self.declared.iter().any(declared) {
                    self.unknown.push(Unknown {
                        section: self.section.clone(),
                        name: key.get_ref().to_string(),
                        key_place: (*number, key.span()),
                        value_place: (*number, value.span()),
                        is_section: value.get_ref().is_table(),
                    });
                }
            }
        }
    }

    /// Reads `name` from every file, so that faults in overridden values are found too. The last one counts.
    fn read<T: Value>(&mut self, name: &'static str, limit: &T::Limit, mut take: impl FnMut(T)) -> bool {
        let found = self.found(name);
        let present = !found.is_empty();
        for (place, raw) in found {
            // The parser puts an empty value where it could not find one, which it has reported.
            if place.1.is_empty() {
                continue;
            }
            let value = T::read(raw, limit, self.documents[place.0].folder);
            let refused = value.is_none();
            match value {
                Some(value) => take(value),
                None => {
                    let problem = format!("must be {}", T::allowed(limit));
                    let mut fault = self.fault(&place, &joined(&self.section, name), problem);
                    fault.likely = raw
                        .as_str()
                        .and_then(|word| most_alike(word, T::words().iter().copied()))
                        .map(|word| format!("{word:?}"));
                    self.faults.push(fault);
                }
            }
            let shown = self.documents[place.0].shown(name, place.1.clone());
            self.origins.insert(joined(&self.element, name), Origin { place: Some(place), shown, refused });
        }
        present
    }
}

impl Keys for Reader<'_> {
    fn section(&mut self, name: &'static str, _: &'static str, keys: impl FnOnce(&mut Self)) {
        let mut parts = Vec::new();
        for (place, raw) in self.found(name) {
            match raw.as_table() {
                Some(table) => parts.push((place, table)),
                None => {
                    let fault = self.fault(&place, name, format!("must be a section, written [{name}]"));
                    self.faults.push(fault);
                }
            }
        }
        self.enter(name, name.to_owned(), parts, keys);
    }

    fn list<T: Default>(
        &mut self,
        name: &'static str,
        _: &'static str,
        items: &mut Vec<T>,
        keys: impl Fn(&mut T, &mut Self),
    ) {
        for (place, raw) in self.found(name) {
            let tables = raw.as_array().and_then(|array| {
                array
                    .iter()
                    .map(|raw| Some((raw.span(), raw.get_ref().as_table()?)))
                    .collect::<Option<Vec<_>>>()
            });
            let Some(tables) = tables else {
                let problem = format!("must be sections, each written [[{name}]]");
                let fault = self.fault(&place, name, problem);
                self.faults.push(fault);
                continue;
            };
            items.clear();
            for (index, (span, table)) in tables.into_iter().enumerate() {
                let mut item = T::default();
                let part = vec![((place.0, span), table)];
                self.enter(name, format!("{name}[{index}]"), part, |reader| keys(&mut item, reader));
                items.push(item);
            }
            self.origins.insert(name.to_owned(), Origin { place: Some(place), shown: None, refused: false });
        }
    }

    fn key<T: Value>(&mut self, name: &'static str, value: &mut T, limit: T::Limit, _: &'static str) {
        let default = value.write();
        if !self.read(name, &limit, |read| *value = read) {
            let shown = Some(format!("{default} (default)"));
            self.origins.insert(joined(&self.element, name), Origin { place: None, shown, refused: false });
        }
    }

    fn required<T: Value>(
        &mut self,
        name: &'static str,
        value: &mut T,
        limit: T::Limit,
        _: &'static str,
        _: &'static str,
    ) {
        if self.read(name, &limit, |read| *value = read) || !self.complete {
            return;
        }
        // It is missing from the section that comes last, or from the last file where no file has the section.
        let (number, at) = match self.parts.last() {
            Some(((number, span), _)) => (*number, Some(span.start)),
            None => (self.documents.len().saturating_sub(1), None),
        };
        let document = self.documents.get(number);
        let fault = Fault {
            file: document.map_or("(no file given)".into(), |document| document.path.to_owned()),
            line: document.zip(at).map(|(document, at)| document.line(at)),
            key: Some(joined(&self.section, name)),
            value: None,
            problem: format!("is missing; must be {}", T::allowed(&limit)),
            likely: None,
        };
        self.faults.push(fault);
    }

    fn optional<T: Value>(
        &mut self,
        name: &'static str,
        value: &mut Option<T>,
        limit: T::Limit,
        _: &'static str,
        _: &'static str,
    ) {
        self.read(name, &limit, |read| *value = Some(read));
    }
}

fn joined(section: &str, key: &str) -> String {
    if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
}

fn most_alike<'w>(word: &str, words: impl Iterator<Item = &'w str>) -> Option<&'w str> {
    words
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, candidate)| candidate)
}
