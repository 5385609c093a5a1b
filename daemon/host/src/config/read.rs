//! Reads all files at once and collects every fault.

use super::document::Document;
use super::fault::Fault;
use super::keys::Keys;
use super::value::Value;
use std::collections::HashMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// How alike two keys must be (Jaro-Winkler, 0 to 1) before one is suggested for the other. With one letter swapped, missing
/// or wrong they are over 0.9; keys that only share their beginning are under 0.8.
const ALIKE: f64 = 0.85;

/// A location in the files: the index of the document, and the bytes in it.
pub(super) type Location = (usize, Range<usize>);

/// Where the value of a key comes from.
pub(super) struct Origin {
    /// `None` for a default.
    pub(super) location: Option<Location>,
    /// The value as it is shown.
    pub(super) shown: Option<String>,
    /// The value is not allowed: the key still has the one from before.
    pub(super) refused: bool,
}

/// The open section in one document: where it begins, and its keys.
type Part<'d> = (Location, &'d DeTable<'d>);

/// A key that nobody declared.
struct Unknown {
    section: String,
    name: String,
    key_location: Location,
    value_location: Location,
    is_section: bool,
}

/// The visitor that fills the configuration from files; a later file wins.
pub(super) struct Reader<'d> {
    documents: &'d [Document<'d>],
    /// Every file could be read, so that a key that was not found is missing.
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

    /// The origin of each key (`camera.path`, `objects[2].id`), and all faults.
    pub(super) fn finish(mut self) -> (HashMap<String, Origin>, Vec<Fault>) {
        self.leave();
        let unknown = std::mem::take(&mut self.unknown);
        for key in unknown {
            let likely = self.likely_key(&key.section, &key.name);
            let name = joined(&key.section, &key.name);
            let kind = if key.is_section { "section" } else { "key" };
            let mut fault = self.fault(&key.value_location, &name, format!("is not a {kind} that exists"));
            fault.line = Some(self.documents[key.key_location.0].line(key.key_location.1.start));
            fault.likely = likely;
            self.faults.push(fault);
        }
        (self.origins, self.faults)
    }

    fn fault(&self, (number, span): &Location, key: &str, problem: String) -> Fault {
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

    /// A key that resembles `name`: one of the same section, or the same name in another section.
    fn likely_key(&self, section: &str, name: &str) -> Option<String> {
        let here = self.declared.iter().filter(|(s, _)| s == section).map(|(_, key)| *key);
        most_alike(name, here).map(|key| format!("`{key}`")).or_else(|| {
            let elsewhere = self.declared.iter().find(|(_, key)| *key == name)?;
            Some(format!("`{}`", joined(&elsewhere.0, elsewhere.1)))
        })
    }

    /// Every occurrence of a key of the open section, in the order of the files.
    fn found(&mut self, name: &'static str) -> Vec<(Location, &'d DeValue<'d>)> {
        // Each element of a list declares the same keys again.
        if !self.declared.iter().any(|(section, known)| *section == self.section && *known == name) {
            self.declared.push((self.section.clone(), name));
        }
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

    /// Keeps the keys of the open section that nobody declared.
    fn leave(&mut self) {
        for ((number, _), table) in &self.parts {
            for (key, value) in table.iter() {
                let declared = |(s, name): &(String, &str)| *s == self.section && name == key.get_ref();
                if !self.declared.iter().any(declared) {
                    self.unknown.push(Unknown {
                        section: self.section.clone(),
                        name: key.get_ref().to_string(),
                        key_location: (*number, key.span()),
                        value_location: (*number, value.span()),
                        is_section: value.get_ref().is_table(),
                    });
                }
            }
        }
    }

    /// Reads `name` from every file, so that faults in overridden values are found as well. The last value counts.
    fn read<T: Value>(&mut self, name: &'static str, limit: &T::Limit, mut take: impl FnMut(T)) -> bool {
        let found = self.found(name);
        let present = !found.is_empty();
        for (location, raw) in found {
            // The parser puts an empty value where it found none, which it has reported.
            if location.1.is_empty() {
                continue;
            }
            let value = T::read(raw, limit, self.documents[location.0].folder);
            let refused = value.is_none();
            match value {
                Some(value) => take(value),
                None => {
                    let problem = format!("must be {}", T::allowed(limit));
                    let mut fault = self.fault(&location, &joined(&self.section, name), problem);
                    fault.likely = raw
                        .as_str()
                        .and_then(|word| most_alike(word, T::words().into_iter()))
                        .map(|word| format!("{word:?}"))
                        .or_else(|| T::meant(raw, limit));
                    self.faults.push(fault);
                }
            }
            let shown = self.documents[location.0].shown(name, location.1.clone());
            self.origins
                .insert(joined(&self.element, name), Origin { location: Some(location), shown, refused });
        }
        present
    }
}

impl Keys for Reader<'_> {
    fn section(&mut self, name: &'static str, _: &'static str, keys: impl FnOnce(&mut Self)) {
        let mut parts = Vec::new();
        for (location, raw) in self.found(name) {
            match raw.as_table() {
                Some(table) => parts.push((location, table)),
                None => {
                    let fault = self.fault(&location, name, format!("must be a section, written [{name}]"));
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
        for (location, raw) in self.found(name) {
            let tables = raw.as_array().and_then(|array| {
                array
                    .iter()
                    .map(|raw| Some((raw.span(), raw.get_ref().as_table()?)))
                    .collect::<Option<Vec<_>>>()
            });
            let Some(tables) = tables else {
                let problem = format!("must be sections, each written [[{name}]]");
                let fault = self.fault(&location, name, problem);
                self.faults.push(fault);
                continue;
            };
            items.clear();
            // What an earlier file said of its list is of no item of this one.
            self.origins.retain(|key, _| !key.starts_with(&format!("{name}[")));
            for (index, (span, table)) in tables.into_iter().enumerate() {
                let mut item = T::default();
                let at = (location.0, span.clone());
                self.origins.insert(
                    format!("{name}[{index}]"),
                    Origin { location: Some(at), shown: None, refused: false },
                );
                let part = vec![((location.0, span), table)];
                self.enter(name, format!("{name}[{index}]"), part, |reader| keys(&mut item, reader));
                items.push(item);
            }
            self.origins
                .insert(name.to_owned(), Origin { location: Some(location), shown: None, refused: false });
        }
    }

    fn key<T: Value>(&mut self, name: &'static str, value: &mut T, limit: T::Limit, _: &'static str) {
        let default = value.write();
        if !self.read(name, &limit, |read| *value = read) {
            let shown = Some(format!("{default} (default)"));
            self.origins
                .insert(joined(&self.element, name), Origin { location: None, shown, refused: false });
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
