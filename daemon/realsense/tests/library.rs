//! Without librealsense; in a process of its own, because a library is loaded once per process.
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use andon_realsense::settings::{Origin, Settings};
use andon_realsense::{Error, Source};

#[test]
fn a_missing_library_is_told_with_the_command_that_brings_it() {
    let settings = Settings {
        library: PathBuf::from("no/such/folder"),
        origin: Origin::Recording(PathBuf::from("any.bag")),
        depth: true,
    };
    let why = Source::open(&settings).err().unwrap();
    assert!(matches!(why, Error::Library { .. }), "{why:?}");
    assert!(why.to_string().contains("no/such/folder/librealsense2.so.2.56"), "{why}");
    assert!(why.to_string().contains("provision.py"), "{why}");
}
