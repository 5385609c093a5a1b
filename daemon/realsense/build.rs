//! Writes one trampoline for each function of librealsense's C interface.
//!
//! `realsense-sys` declares the functions and expects a linker to find them. Each trampoline has the name of a function and jumps through a
//! slot that `sdk::library` fills when it has loaded the library.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::{env, fs};

const FUNCTIONS: &str = "src/sdk/functions.txt";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={FUNCTIONS}");
    if env::var_os("CARGO_FEATURE_REALSENSE").is_none() {
        return Ok(());
    }
    let arch = env::var("CARGO_CFG_TARGET_ARCH")?;
    if arch != "x86_64" {
        return Err(format!("feature `realsense`: there is no trampoline for {arch}, only for x86_64").into());
    }
    let listing = fs::read_to_string(FUNCTIONS)?;
    let names: Vec<&str> = listing.lines().map(str::trim).filter(|name| !name.is_empty()).collect();
    let mut code = String::from("core::arch::global_asm!(r#\"\n.text\n");
    for (index, name) in names.iter().enumerate() {
        let offset = index * 8;
        writeln!(code, ".globl {name}\n.type {name},@function")?;
        writeln!(code, "{name}: jmp *(andon_rs2_slots+{offset})(%rip)\n.size {name},.-{name}")?;
    }
    code.push_str("\"#, options(att_syntax));\n");
    writeln!(code, "/// The functions, in the order of their slots.")?;
    writeln!(code, "static NAMES: [&str; {}] = {names:?};", names.len())?;
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("trampolines.rs"), code)?;
    Ok(())
}
