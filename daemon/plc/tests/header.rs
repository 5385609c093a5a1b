//! `include/andon.h` and `REGISTERS.md` are what the code says.
#![allow(clippy::unwrap_used)]

use andon_plc::c_abi::VERDICT_SOURCE;
use andon_plc::registers::{MAP, control, status};
use shm_schemas::{
    HandCode, OrderFault, VerdictLevel, VerdictMeasure, VerdictNote, VerdictOutcome, VerdictReason,
};
use std::fs;
use std::path::Path;

/// Set to write the header instead of comparing it.
const WRITE: &str = "ANDON_WRITE_HEADER";

/// An enum of the wire as C sees it: the name, what it is, and its words with number and meaning.
fn c_enum(name: &str, title: &str, words: impl Iterator<Item = (&'static str, u8, &'static str)>) -> String {
    let constants = words.map(|(word, number, meaning)| {
        // In logs and JSON it is an empty text.
        let word = if word.is_empty() { "none" } else { word };
        let constant = screaming(&format!("{name}_{word}"));
        format!("  /**\n   * {meaning}\n   */\n  {constant} = {number},\n")
    });
    format!("/**\n * {title}\n */\nenum {name} {{\n{}}};", constants.collect::<String>())
}

/// `WrongObject` and `wrong_object` as `WRONG_OBJECT`.
fn screaming(name: &str) -> String {
    let mut constant = String::new();
    let mut is_after_small = false;
    for letter in name.chars() {
        if letter.is_uppercase() && is_after_small {
            constant.push('_');
        }
        is_after_small = letter.is_lowercase();
        constant.push(letter.to_ascii_uppercase());
    }
    constant
}

/// The enums of a verdict, from the wire's own tables.
fn enums() -> String {
    macro_rules! words {
        ($kind:ty) => {
            <$kind>::ALL.iter().map(|word| (word.name(), word.code(), word.meaning()))
        };
    }
    [
        c_enum("AndonLevel", "What is judged.", words!(VerdictLevel)),
        c_enum("AndonOutcome", "How it came out.", words!(VerdictOutcome)),
        c_enum("AndonReason", "The rule that decided.", words!(VerdictReason)),
        c_enum("AndonNote", "What was not shown before.", words!(VerdictNote)),
        c_enum("AndonOrderFault", "How the order of the job was broken.", words!(OrderFault)),
        c_enum("AndonMeasure", "Which measure is out of its bounds, and its unit.", words!(VerdictMeasure)),
        c_enum("AndonHand", "Which hand.", words!(HandCode)),
    ]
    .join("\n\n")
}

/// The struct that a macro makes of a verdict's fields, with the names that C has for the lists of the wire.
fn verdict() -> String {
    let names = [
        ("A [`Verdict", "An [`Andon"),
        ("A [`HandCode", "An [`AndonHand"),
        ("[`OrderFault", "[`AndonOrderFault"),
        ("[`NO_INDEX", "[`ANDON_NO_INDEX"),
        ("[`", ""),
        ("`]", ""),
    ];
    names.into_iter().fold(VERDICT_SOURCE.to_owned(), |source, (of_wire, of_c)| source.replace(of_wire, of_c))
}

#[test]
fn the_header_is_what_cbindgen_makes_of_the_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    config.after_includes = Some(format!("\n{}", enums()));
    let of_verdict = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verdict.rs");
    fs::write(&of_verdict, verdict()).unwrap();
    // The sources by name: cbindgen would otherwise ask cargo for every crate of the workspace.
    let builder = cbindgen::Builder::new()
        .with_config(config)
        .with_src(of_verdict)
        .with_src(root.join("src/c_abi/types.rs"))
        .with_src(root.join("src/c_abi/reader.rs"))
        .with_src(root.join("src/c_abi/mod.rs"));
    let mut generated = Vec::new();
    builder.generate().unwrap().write(&mut generated);
    let generated = String::from_utf8(generated).unwrap();
    let path = root.join("include/andon.h");
    if std::env::var_os(WRITE).is_some() {
        fs::write(&path, &generated).unwrap();
    }
    let shipped = fs::read_to_string(&path).unwrap();
    assert!(shipped == generated, "include/andon.h is old: {WRITE}=1 cargo test -p andon-plc --test header");
}

#[test]
fn the_register_document_is_what_the_table_says() {
    let shipped = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("REGISTERS.md")).unwrap();
    assert!(
        shipped == andon_plc::document(),
        "REGISTERS.md is old: cargo run -p andon-plc --example registers > daemon/plc/REGISTERS.md"
    );
}

/// A constant of the program for a controller: its name and its value.
fn constant(line: &str) -> Option<(&str, u32)> {
    let (name, rest) = line.trim().split_once(" : ")?;
    let value = rest.split_once(":= ")?.1.trim_end_matches(';');
    let hexadecimal = |digits: &str| u32::from_str_radix(digits, 16);
    let value = value.strip_prefix("16#").map_or_else(|| value.parse(), hexadecimal);
    Some((name, value.ok()?))
}

/// Whoever copies the program reads names. Those of registers, bits and levels are the names of the tables.
#[test]
fn the_constants_of_the_program_are_those_of_the_tables() {
    let program = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("andon.st")).unwrap();
    let (constants, _) = program.split_once("VAR CONSTANT").unwrap().1.split_once("END_VAR").unwrap();
    let constants: Vec<(&str, u32)> = constants.lines().filter_map(constant).collect();
    assert!(constants.len() > 20, "{constants:?}");
    for (name, value) in constants {
        let (kind, word) = name.split_once('_').unwrap();
        let word = word.to_lowercase();
        let bit =
            |bits: &[(u16, &str, &str)]| bits.iter().find(|(_, name, _)| *name == word).map(|bit| bit.0);
        let of_table = match kind {
            "R" => MAP.iter().find(|register| register.name == word).map(|register| register.address),
            "IS" => bit(&status::BITS),
            "DO" => bit(&control::BITS),
            _ => VerdictLevel::ALL.iter().find(|level| level.name() == word).map(|level| level.code().into()),
        };
        assert_eq!(of_table.map(u32::from), Some(value), "{name}");
    }
}
