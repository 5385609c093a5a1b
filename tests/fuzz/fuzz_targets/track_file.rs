#![no_main]

#[path = "../../src/fuzz/mod.rs"]
#[allow(dead_code, unused_imports)]
mod entry;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entry::track_file(bytes));
