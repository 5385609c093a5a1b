//! Libraries that programs are started with (`LD_PRELOAD`), in place of functions of the C library.
#![allow(clippy::unwrap_used)]

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// Compiles the C source of a library in a folder. Its path is the value for `LD_PRELOAD`.
///
/// # Panics
/// Without a C compiler, or if it warns of something.
pub fn compiled(folder: &Path, source: &str) -> OsString {
    let (file, library) = (folder.join("shim.c"), folder.join("shim.so"));
    std::fs::write(&file, source).unwrap();
    let mut command = Command::new("cc");
    command.args(["-shared", "-fPIC", "-O1", "-Wall", "-Werror", "-pthread", "-o"]);
    command.args([&library, &file]).arg("-ldl");
    assert!(command.status().expect("a C compiler is needed: apt install g++").success());
    library.into()
}
