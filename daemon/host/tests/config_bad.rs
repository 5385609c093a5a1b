//! Every bad configuration in `config_bad/` with its exact messages. `NAME.toml` is read over `base/station.toml` (alone where its name begins with
//! `alone`), and `NAME.expected` holds its messages.

#![allow(clippy::unwrap_used)]

use andon_host::config::{Config, Faults};
use std::path::{Path, PathBuf};

const FOLDER: &str = "tests/config_bad";

/// The faults of these files, with the path of this checkout replaced by `$DIR`.
fn messages(paths: &[PathBuf]) -> String {
    let found = Config::load(paths).unwrap_err().to_string();
    found.replace(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/config_bad"), "$DIR") + "\n"
}

/// The files of `FOLDER` with this extension, in the order of their names.
fn files(extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    paths.sort();
    paths
}

#[test]
fn each_bad_configuration_is_refused_with_its_messages() {
    let base = Path::new(FOLDER).join("base/station.toml");
    let cases = files("toml");
    assert!(cases.len() >= 40, "the table has {} cases", cases.len());
    let mut wrong = String::new();
    for case in cases {
        let alone = case.file_name().unwrap().to_string_lossy().starts_with("alone");
        let both = [base.clone(), case.clone()];
        let found = messages(if alone { &both[1..] } else { &both });
        let expected = case.with_extension("expected");
        if std::env::var_os("ANDON_WRITE_GENERATED").is_some() {
            std::fs::write(&expected, &found).unwrap();
        }
        let expected = std::fs::read_to_string(&expected).unwrap_or_default();
        if found != expected {
            wrong += &format!("{}\nexpected:\n{expected}found:\n{found}\n", case.display());
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn no_expectation_is_without_its_case() {
    for expectation in files("expected") {
        assert!(expectation.with_extension("toml").is_file(), "{}", expectation.display());
    }
}

#[test]
fn the_base_of_all_cases_has_no_fault() {
    let config = Config::load(&[Path::new(FOLDER).join("base/station.toml")]).unwrap();
    assert_eq!(config.root(), Path::new("/run/andon/bench1"));
    assert_eq!(config.journal_path(), Path::new("/var/lib/andon/bench1.sqlite"));
}

#[test]
fn a_file_that_is_not_there_is_a_fault_that_names_it() {
    let found = messages(&["no/such/station.toml".into()]);
    assert_eq!(
        found,
        "no/such/station.toml: cannot be read: No such file or directory (os error 2)\n\
         1 fault in the configuration: nothing is started\n"
    );
}

#[test]
fn no_file_at_all_is_a_station_without_a_name() {
    let Faults(faults) = Config::load(&[] as &[PathBuf]).unwrap_err();
    assert_eq!(faults[0].key.as_deref(), Some("station.name"));
}

#[test]
fn a_fault_in_a_value_that_a_later_file_overrides_is_still_reported() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first.toml", "second.toml"].map(|name| folder.path().join(name));
    std::fs::write(&first, "[camera]\nwidth = 1\n").unwrap();
    std::fs::write(&second, "[camera]\nwidth = 640\n").unwrap();
    let base = Path::new(FOLDER).join("base/station.toml");
    let Faults(faults) = Config::load(&[base, first.clone(), second]).unwrap_err();
    assert_eq!((&faults[0].file, faults[0].line, faults.len()), (&first, Some(2), 1));
}

#[test]
fn a_later_file_overrides_key_by_key_and_objects_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let later = folder.path().join("later.toml");
    let object = "[[objects]]\nid = 7\nname = 'x'\nmarker_side_m = 0.02\ninteraction_points = [[0, 0, 0]]\n";
    std::fs::write(&later, format!("[station]\njobs = 'learned'\n{object}")).unwrap();
    let config = Config::load(&[Path::new(FOLDER).join("base/station.toml"), later]).unwrap();
    assert_eq!(config.station.name, "bench1");
    assert_eq!(config.station.jobs, folder.path().join("learned"));
    assert_eq!(config.shapes().iter().map(|shape| shape.id).collect::<Vec<_>>(), [7]);
}
