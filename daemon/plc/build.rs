//! Names the shared library: a program that links it asks for this name, which changes when `andon.h` does so
//! incompatibly.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libandon_plc.so.0");
}
