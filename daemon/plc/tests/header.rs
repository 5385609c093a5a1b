//! `include/andon.h` and `REGISTERS.md` are what the code says.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

/// Set to write the header instead of comparing it.
const WRITE: &str = "ANDON_WRITE_HEADER";

#[test]
fn the_header_is_what_cbindgen_makes_of_the_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    // The sources by name: cbindgen would otherwise ask cargo for every crate of the workspace.
    let builder = cbindgen::Builder::new()
        .with_config(config)
        .with_src(root.join("src/c_abi/types.rs"))
        .with_src(root.join("src/c_abi/reader.rs"))
        .with_src(root.join("src/c_abi/mod.rs"));
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root.join("include/andon.h");
    if std::env::var_os(WRITE).is_some() {
        fs::write(&path, &made).unwrap();
    }
    let there = fs::read_to_string(&path).unwrap();
    assert!(there == made, "include/andon.h is old: {WRITE}=1 cargo test -p andon-plc --test header");
}

#[test]
fn the_register_document_is_what_the_table_says() {
    let there = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("REGISTERS.md")).unwrap();
    assert!(
        there == andon_plc::registers::document(),
        "REGISTERS.md is old: cargo run -p andon-plc --example registers > daemon/plc/REGISTERS.md"
    );
}
