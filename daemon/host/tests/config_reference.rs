//! The annotated reference and the station files that are shipped.

#![allow(clippy::unwrap_used)]

use andon_host::config::{Config, reference};
use andon_host::log::index;
use std::path::{Path, PathBuf};

fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Holds a file that is generated against its generator, or writes it where `ANDON_WRITE_GENERATED` is set.
fn is_up_to_date(path: &str, text: &str) {
    let path = shipped(path);
    if std::env::var_os("ANDON_WRITE_GENERATED").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap();
    assert!(found == text, "{} is stale: run this test with ANDON_WRITE_GENERATED=1", path.display());
}

#[test]
fn the_shipped_reference_is_the_one_that_the_program_prints() {
    is_up_to_date("config/andon.toml", &reference());
}

#[test]
fn the_index_of_codes_lists_the_codes_of_the_program() {
    is_up_to_date("daemon/andond/CODES.md", &index());
}

#[test]
fn the_reference_changes_no_default() {
    let demo = shipped("config/stations/demo.toml");
    let alone = Config::load(&[&demo]).unwrap();
    let over_reference = Config::load(&[&shipped("config/andon.toml"), &demo]).unwrap();
    assert_eq!(alone.hash(), over_reference.hash());
    assert_eq!(alone, Config { files: alone.files.clone(), ..over_reference });
}

#[test]
fn the_reference_read_without_its_comment_marks_has_no_unknown_key_and_no_refused_value() {
    // `#key = value` is an example, `# text` an explanation.
    let with_examples: String = reference()
        .lines()
        .map(|line| match line.strip_prefix('#') {
            Some(example) if !example.starts_with(' ') => format!("{example}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all.toml"), with_examples).unwrap();
    let config = Config::load_to_learn(&[folder.path().join("all.toml")]).unwrap();
    assert_eq!(config.objects.len(), 1);
    assert_eq!(config.camera.serial.as_deref(), Some("035422071234"));
}

#[test]
fn the_demo_station_has_the_objects_of_the_footage() {
    let config = Config::load(&[shipped("config/stations/demo.toml")]).unwrap();
    let shapes: Vec<(u16, usize)> =
        config.shapes().iter().map(|shape| (shape.id, shape.interaction_points.len())).collect();
    assert_eq!(shapes, [(5, 3), (6, 5), (3, 4)]);
}

#[test]
fn the_film_station_has_the_objects_of_the_demo_station() {
    let objects = |path| {
        let text = std::fs::read_to_string(shipped(path)).unwrap();
        text.parse::<toml::Table>().unwrap()["objects"].clone()
    };
    assert_eq!(objects("config/stations/film.toml"), objects("config/stations/demo.toml"));
}
