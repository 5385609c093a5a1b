//! What the board says of the codes, against the codes themselves.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::Path;

use andon_host::log::code;
use toml::Table;

const LANGUAGES: [&str; 4] = ["de", "es", "fr", "zh"];

fn table(language: &str) -> Table {
    let file = format!("../board/src/words/codes/{language}.toml");
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap().parse().unwrap()
}

/// What is the same in every language: what somebody types, keys, files and larger numbers.
fn fixed(text: &str) -> BTreeSet<&str> {
    let typed = text.split('`').skip(1).step_by(2);
    let is_fixed = |word: &&str| {
        let is_key =
            word.contains(['_', '/']) || word.split_once('.').is_some_and(|(_, key)| !key.is_empty());
        is_key || word.len() > 2 && word.bytes().all(|byte| byte.is_ascii_digit())
    };
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || "_./".contains(letter);
    let words = text.split('`').step_by(2).flat_map(move |rest| rest.split(move |letter| !is_part(letter)));
    typed.chain(words.map(|word| word.trim_end_matches('.')).filter(is_fixed)).collect()
}

#[test]
fn every_code_is_told_in_every_language_with_the_same_commands_keys_and_numbers() {
    for language in LANGUAGES {
        let table = table(language);
        let codes = table["code"].as_table().unwrap();
        let known: Vec<String> = code::ALL.iter().map(|code| code.number.to_string()).collect();
        assert_eq!(codes.keys().collect::<BTreeSet<_>>(), known.iter().collect(), "{language}");
        for code in code::ALL {
            let told = codes[&code.number.to_string()].as_table().unwrap();
            let remedy = told.get("do").map_or("", |remedy| remedy.as_str().unwrap());
            for (english, text) in [(code.meaning, told["means"].as_str().unwrap()), (code.remedy, remedy)] {
                assert_eq!(english.is_empty(), text.is_empty(), "{language}: {}", code.name);
                assert_eq!(fixed(text), fixed(english), "{language}: {}: {text}", code.name);
            }
            let group = table["group"].as_table().unwrap().get(&(code.number / 100).to_string());
            assert!(group.is_some(), "{language}: {}", code::group(code.number));
        }
    }
}
