//! What the pages say, in the languages of the people who read them.
//!
//! A language is a table in TOML. A customer adds one, or replaces single words of one that is here, by a file `CODE.toml` in a folder of their own. What
//! a table does not have is said as the shipped table of its language says it, or else in English.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use toml::{Table as Toml, Value};

/// The shipped languages: what the pages say, and what the codes of messages mean. English has every key of the first; the codes themselves have the
/// second in English.
const SHIPPED: [(&str, &str, &str); 5] = [
    (ENGLISH, include_str!("words/en.toml"), ""),
    ("de", include_str!("words/de.toml"), include_str!("words/codes/de.toml")),
    ("es", include_str!("words/es.toml"), include_str!("words/codes/es.toml")),
    ("fr", include_str!("words/fr.toml"), include_str!("words/codes/fr.toml")),
    ("zh", include_str!("words/zh.toml"), include_str!("words/codes/zh.toml")),
];

const ENGLISH: &str = "en";

/// Why a table cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The folder or a file of it cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The folder or the file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no TOML.
    #[error("{}: {source}", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<toml::de::Error>,
    },
    /// A key that no page asks for, or that is no text.
    #[error("{}: {key} is no text of the board; /usr/share/doc/andon/words has all of them", path.display())]
    Key {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
    },
    /// A language that has no table.
    #[error("board.language is {language:?}, and there is no such table; there are {known}")]
    Language {
        /// The language.
        language: String,
        /// Those that there are.
        known: String,
    },
}

/// All languages by their codes.
#[derive(Clone, Debug)]
pub struct Tables(BTreeMap<String, Table>);

/// One language: texts by their keys.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table(HashMap<String, String>);

impl Tables {
    /// Those that are part of the program.
    #[must_use]
    pub fn shipped() -> Self {
        let mut tables = BTreeMap::<String, Table>::new();
        for (code, pages, codes) in SHIPPED {
            let mut table = tables.get(ENGLISH).cloned().unwrap_or_default();
            for text in [pages, codes] {
                // A test reads each of them.
                collect("", &text.parse().unwrap_or_default(), &mut |key, text| {
                    table.0.extend(text.map(|text| (key, text.to_owned())));
                });
            }
            tables.insert(code.to_owned(), table);
        }
        Self(tables)
    }

    /// With those of a folder over them.
    ///
    /// # Errors
    /// The first file that cannot be used, and why.
    pub fn with_folder(mut self, folder: &Path) -> Result<Self, TableError> {
        let failed = |source| TableError::Read { path: folder.to_owned(), source };
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                self.add(&path)?;
            }
        }
        Ok(self)
    }

    fn add(&mut self, path: &Path) -> Result<(), TableError> {
        let path_of = || path.to_owned();
        let text =
            std::fs::read_to_string(path).map_err(|source| TableError::Read { path: path_of(), source })?;
        let toml: Toml =
            text.parse().map_err(|source| TableError::Toml { path: path_of(), source: Box::new(source) })?;
        let code = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut table = self.0.get(&code).unwrap_or_else(|| self.english()).clone();
        let mut unknown = None;
        let is_known = |key: &str| self.0.values().any(|table| table.has(key));
        collect("", &toml, &mut |key, text| match text.filter(|_| is_known(&key)) {
            Some(text) => drop(table.0.insert(key, text.to_owned())),
            None => unknown = Some(key),
        });
        self.0.insert(code, table);
        unknown.map_or(Ok(()), |key| Err(TableError::Key { path: path_of(), key }))
    }

    /// Whether there is such a table.
    ///
    /// # Errors
    /// Which tables there are.
    pub fn must_have(&self, language: &str) -> Result<(), TableError> {
        let known = || self.0.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        match self.0.contains_key(language) {
            true => Ok(()),
            false => Err(TableError::Language { language: language.to_owned(), known: known() }),
        }
    }

    pub(crate) fn english(&self) -> &Table {
        // It is the first of those that `shipped` makes, and none is ever taken away.
        &self.0[ENGLISH]
    }

    pub(crate) fn get(&self, code: &str) -> Option<&Table> {
        self.0.get(code)
    }

    /// The codes, and what each language calls itself.
    pub(crate) fn languages(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(code, table)| (code.as_str(), table.say("language")))
    }

    /// Those of them that every board has.
    pub(crate) fn shipped_languages(&self) -> impl Iterator<Item = (&str, &str)> {
        self.languages().filter(|(code, _)| SHIPPED.iter().any(|(shipped, ..)| shipped == code))
    }
}

#[cfg(test)]
impl Tables {
    /// The language in which every text stands in brackets.
    pub(crate) const BRACKETS: &str = "qq";

    /// With that language as well.
    pub(crate) fn in_brackets() -> Self {
        let mut tables = Self::shipped();
        let said =
            tables.english().0.iter().map(|(key, text)| (key.clone(), format!("\u{27e6}{text}\u{27e7}")));
        let said = Table(said.collect());
        tables.0.insert(Self::BRACKETS.to_owned(), said);
        tables
    }
}

impl Table {
    /// The text of a key; the key itself, where a newer line says what this build does not know.
    pub(crate) fn say<'t>(&'t self, key: &'t str) -> &'t str {
        self.0.get(key).map_or(key, String::as_str)
    }

    /// The text of a key, if the language has it.
    pub(crate) fn get(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    /// As [`Table::say`], with these values in their places.
    pub(crate) fn fill(&self, key: &str, values: &[(&str, &str)]) -> String {
        let text = self.say(key).to_owned();
        values.iter().fold(text, |text, (name, value)| text.replace(&format!("{{{name}}}"), value))
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.0.contains_key(key)
    }
}

/// Calls `each` with every key of a table and of the tables in it; a text only where it is one.
fn collect(before: &str, table: &Toml, each: &mut impl FnMut(String, Option<&str>)) {
    for (key, value) in table {
        let key = if before.is_empty() { key.clone() } else { format!("{before}.{key}") };
        match value {
            Value::Table(inner) => collect(&key, inner, each),
            value => each(key, value.as_str()),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::line::Ill;
    use shm_schemas::{
        RoleId, RoleState, Sight, VerdictLevel, VerdictMeasure, VerdictNote, VerdictOutcome, VerdictReason,
    };
    use std::collections::BTreeSet;

    fn keys(text: &str) -> BTreeMap<String, String> {
        let mut keys = BTreeMap::new();
        collect("", &text.parse().unwrap(), &mut |key, text| {
            keys.insert(key, text.unwrap().to_owned());
        });
        keys
    }

    /// The values that a text has places for.
    fn places(text: &str) -> BTreeSet<&str> {
        text.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name).collect()
    }

    #[test]
    fn every_shipped_language_has_every_text_with_the_same_values_in_it() {
        let english = keys(SHIPPED[0].1);
        for (code, text, _) in SHIPPED {
            let table = keys(text);
            assert_eq!(table.keys().collect::<Vec<_>>(), english.keys().collect::<Vec<_>>(), "{code}");
            for (key, text) in table {
                assert!(!text.trim().is_empty(), "{code}: {key}");
                assert_eq!(places(&text), places(&english[&key]), "{code}: {key}");
            }
        }
    }

    /// Between backticks stands what somebody types.
    fn typed(text: &str) -> BTreeSet<&str> {
        text.split('`').skip(1).step_by(2).collect()
    }

    #[test]
    fn every_shipped_language_but_english_has_the_same_codes_with_the_same_to_type_in_them() {
        let german = keys(SHIPPED[1].2);
        assert!(german.contains_key("code.104.do"));
        for (code, _, text) in &SHIPPED[2..] {
            let table = keys(text);
            assert_eq!(table.keys().collect::<Vec<_>>(), german.keys().collect::<Vec<_>>(), "{code}");
            for (key, text) in table {
                assert_eq!(typed(&text), typed(&german[&key]), "{code}: {key}");
            }
        }
    }

    #[test]
    fn every_word_of_a_verdict_and_of_a_role_has_its_text() {
        let measures = VerdictMeasure::ALL.iter().filter(|of| **of != VerdictMeasure::None);
        let mut wanted: Vec<String> = measures
            .flat_map(|of| {
                let name = of.name();
                [format!("fault.{name}.below"), format!("fault.{name}.above"), format!("unit.{name}")]
            })
            .collect();
        let reasons = VerdictReason::ALL.iter().filter(|of| **of != VerdictReason::None);
        wanted.extend(reasons.map(|of| format!("fault.{}", of.name())));
        let notes = VerdictNote::ALL.iter().filter(|of| **of != VerdictNote::None);
        wanted.extend(notes.map(|of| format!("note.{}", of.name())));
        wanted.extend(VerdictLevel::ALL.iter().map(|of| format!("level.{}", of.name())));
        wanted.extend(VerdictOutcome::ALL.iter().map(|of| format!("outcome.{}", of.name())));
        wanted.extend(RoleState::ALL.iter().map(|of| format!("role.{}", of.name())));
        wanted.extend(RoleId::ALL.iter().map(|of| format!("part_of_line.{}", of.name())));
        wanted.extend(Ill::ALL.iter().map(|of| of.key().to_owned()));
        let sights = Sight::ALL.iter().filter(|of| **of != Sight::Clear);
        wanted.extend(sights.map(|of| format!("stop.{}", of.name())));
        let tables = Tables::shipped();
        let english = tables.get(ENGLISH).unwrap();
        for key in wanted {
            assert!(english.has(&key), "{key}");
        }
    }

    fn folder(files: &[(&str, &str)]) -> PathBuf {
        static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("andon-words-{}-{number}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        for (name, text) in files {
            std::fs::write(folder.join(name), text).unwrap();
        }
        folder
    }

    #[test]
    fn a_customer_adds_a_language_and_replaces_a_word() {
        let folder = folder(&[
            ("it.toml", "language = \"Italiano\"\n[state]\nGood = \"BENE\"\n"),
            ("de.toml", "[state]\nGood = \"PASST\"\n[code]\n104.do = \"Herrn Maier rufen\"\n"),
            ("notes.txt", "nothing"),
        ]);
        let tables = Tables::shipped().with_folder(&folder).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        let said = |code: &str, key| tables.get(code).unwrap().say(key).to_owned();
        assert_eq!(said("it", "state.Good"), "BENE");
        assert_eq!(said("it", "state.Fault"), said("en", "state.Fault"));
        assert_eq!(said("de", "state.Good"), "PASST");
        assert_eq!(said("de", "state.Fault"), "FEHLER");
        assert_eq!(said("de", "code.104.do"), "Herrn Maier rufen");
        assert!(tables.languages().any(|language| language == ("it", "Italiano")));
        assert!(tables.must_have("it").is_ok());
        let error = tables.must_have("xx").unwrap_err().to_string();
        assert!(error.ends_with("there are de, en, es, fr, it, zh"), "{error}");
    }

    #[test]
    fn a_table_with_a_fault_is_refused_by_its_name() {
        for (text, expected) in [
            ("[state]\nGodo = \"x\"", "state.Godo is no text"),
            ("[state]\nGood = 7", "state.Good is no text"),
            ("[code]\n999.do = \"x\"", "code.999.do is no text"),
            ("state", "TOML parse error"),
        ] {
            let folder = folder(&[("it.toml", text)]);
            let error = Tables::shipped().with_folder(&folder).unwrap_err().to_string();
            std::fs::remove_dir_all(&folder).unwrap();
            assert!(error.contains("it.toml: ") && error.contains(expected), "{error}");
        }
        assert!(Tables::shipped().with_folder(Path::new("/nowhere")).is_err());
    }
}
