//! A boundary is a crate: who may depend on whom, read from the manifests as Cargo reads them.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::Value;

/// Every crate of the workspace and the crates of the workspace that it may use.
const MAY_USE: [(&str, &[&str]); 17] = [
    ("andon-core", &[]),
    ("andon-learn", &["andon-core"]),
    ("shm-schemas", &[]),
    ("andon-ipc", &["shm-schemas"]),
    ("andon-http", &[]),
    ("andon-board", &["andon-http", "shm-schemas"]),
    ("andon-journal", &["shm-schemas"]),
    ("andon-perception", &[]),
    ("andon-realsense", &[]),
    ("andon-rate", &[]),
    ("andon-plc", &["andon-ipc", "shm-schemas"]),
    (
        "andon-host",
        &["andon-core", "andon-ipc", "andon-learn", "andon-perception", "andon-plc", "shm-schemas"],
    ),
    ("andon-record", &["andon-host", "andon-ipc", "andon-perception", "shm-schemas"]),
    ("andon-study", &["andon-core", "andon-learn"]),
    (
        "andond",
        &[
            "andon-board",
            "andon-core",
            "andon-host",
            "andon-http",
            "andon-ipc",
            "andon-journal",
            "andon-learn",
            "andon-perception",
            "andon-plc",
            "andon-record",
            "andon-study",
            "shm-schemas",
        ],
    ),
    ("andon-video", &["andon-host", "andon-ipc", "andon-learn", "andon-realsense", "shm-schemas"]),
    (
        "andon-tests",
        &[
            "andon-core",
            "andon-host",
            "andon-ipc",
            "andon-learn",
            "andon-perception",
            "andon-plc",
            "andon-rate",
            "andon-realsense",
            "andon-record",
            "andon-study",
            "shm-schemas",
        ],
    ),
];

/// Libraries that one crate alone may use, besides the tests: the rest of the program does not know them.
const KNOWN_BY_ONE: [(&str, &[&str]); 8] = [
    ("argon2", &["andon-board"]),
    ("hyper", &["andon-http"]),
    ("iceoryx2", &["andon-ipc"]),
    ("mcap", &["andon-record"]),
    ("ort", &["andon-perception"]),
    ("rusqlite", &["andon-journal"]),
    ("rustls", &["andon-http"]),
    ("tokio-modbus", &["andon-plc"]),
];

/// Dependencies of every crate of the workspace that are built into it; what only its tests use is left out.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline", "--manifest-path"])
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    packages
        .iter()
        .map(|package| {
            let used = package["dependencies"].as_array().unwrap().iter();
            let built_in = used.filter(|dependency| dependency["kind"] != "dev");
            let names = built_in.map(|dependency| dependency["name"].as_str().unwrap().to_string());
            (package["name"].as_str().unwrap().to_string(), names.collect())
        })
        .collect()
}

#[test]
fn every_crate_uses_only_those_that_the_design_lets_it_use() {
    let dependencies = dependencies();
    let crates: BTreeSet<&str> = dependencies.keys().map(String::as_str).collect();
    assert_eq!(crates, MAY_USE.iter().map(|(name, _)| *name).collect());
    for (name, allowed) in MAY_USE {
        let ours = dependencies[name].iter().filter(|used| crates.contains(used.as_str()));
        for used in ours {
            assert!(allowed.contains(&used.as_str()), "{name} must not depend on {used}");
        }
    }
}

#[test]
fn a_library_with_a_crate_of_its_own_is_known_by_no_other() {
    for (name, used) in dependencies() {
        for (library, by) in KNOWN_BY_ONE {
            let allowed = by.contains(&name.as_str()) || name == "andon-tests";
            assert!(allowed || !used.contains(library), "{name} must not know {library}");
        }
    }
}

#[test]
fn the_core_needs_no_operating_system() {
    let allowed: BTreeSet<String> = ["heapless", "libm", "thiserror"].map(String::from).into();
    let used = &dependencies()["andon-core"];
    assert!(used.is_subset(&allowed), "{used:?}");
}
