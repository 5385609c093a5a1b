//! The core links into a program that has no allocator, so neither the core nor any of its dependencies can allocate.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

/// A program without the standard library. The compiler refuses it if any of its crates needs an allocator.
const PROGRAM: &str = "#![no_std]
    use andon_core as _;
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! { loop {} }
";

/// Builds the core alone, so that the features of no other crate are mixed in, and compiles `program` with it.
///
/// # Errors
/// The compiler's messages.
fn links(program: &str, folder: &Path) -> Result<(), String> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--locked", "--package", "andon-core", "--lib", "--target-dir"])
        .arg(folder.join("target"))
        .current_dir(root)
        .status();
    assert!(built.unwrap().success(), "the core does not build");
    let debug = folder.join("target/debug");
    std::fs::write(folder.join("program.rs"), program).unwrap();
    let compiled = Command::new("rustc")
        .args(["--edition=2024", "--crate-type=staticlib", "-Cpanic=abort", "program.rs", "--out-dir=."])
        .arg(format!("--extern=andon_core={}", debug.join("libandon_core.rlib").display()))
        .arg(format!("-Ldependency={}", debug.join("deps").display()))
        .current_dir(folder)
        .output()
        .unwrap();
    if compiled.status.success() { Ok(()) } else { Err(String::from_utf8(compiled.stderr).unwrap()) }
}

#[test]
fn core_links_without_an_allocator() {
    // The folder is kept under target/, so that the core is built only once for this test.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("core_no_alloc");
    std::fs::create_dir_all(&folder).unwrap();
    assert_eq!(links(PROGRAM, &folder), Ok(()));
    // The same program with something that allocates is refused, so the check can fail.
    let refused = links(&PROGRAM.replace("use ", "extern crate alloc; use "), &folder).unwrap_err();
    assert!(refused.contains("no global memory allocator"), "{refused}");
}
