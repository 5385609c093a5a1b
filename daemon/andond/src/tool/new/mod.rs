//! `andond new`: writes the file of a new station from flags, or from the answers of a person.

mod ask;
mod station;

use std::io::{IsTerminal as _, stdin, stdout};
use std::path::{Path, PathBuf};

use andon_core::capacity::OBJECTS;
use andon_host::atomic;
use andon_host::exit::Code;
use andon_ipc::is_station_name;

use super::{ToolError, cannot_write, new_or_forced};
use crate::cli::metres::Named;
use crate::cli::{Hands, New};
use station::{Camera, Installation, Part, Station};

/// Side of a marker where none is named, in metres: at 800 pixels per metre it has 32 pixels, and `andond look` wants 30.
const SIDE_M: f64 = 0.04;
/// The device of a machine with one camera.
const DEVICE: &str = "/dev/video0";

/// Runs the command.
///
/// # Errors
/// A name that cannot be one, parts that cannot be told apart, and a file that is there or cannot be written.
pub fn run(arguments: &New) -> Result<Code, ToolError> {
    if !is_station_name(&arguments.name) {
        return Err(ToolError::Option {
            option: "NAME",
            given: arguments.name.clone(),
            expected: "a station has a name of 1 to 16 of the characters a-z, 0-9 and '-', as in bench1",
        });
    }
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", arguments.name)));
    new_or_forced(&out, arguments.force)?;
    let asked = arguments.parts.is_empty() && stdin().is_terminal();
    let answers = if asked {
        ask::answers(&mut stdin().lock(), &mut stdout().lock(), arguments).map_err(ToolError::Print)?
    } else {
        ask::Answers::of_flags(arguments)
    };
    let station = Station {
        name: arguments.name.clone(),
        parts: parts(&answers.parts, answers.side_m)?,
        camera: camera(&answers.camera)?,
        hands: answers.hands,
        board: arguments.board,
        language: arguments.language.clone(),
        installation: Installation::of_this_machine(),
    };
    atomic::write(&out, station.text().as_bytes()).map_err(cannot_write(&out))?;
    print!("{}", summary(&station, &out));
    Ok(Code::Stopped)
}

/// The parts with the ids of their markers, from 1 on in the order in which they are named.
fn parts(named: &[Named], side_m: f64) -> Result<Vec<Part>, ToolError> {
    let refused =
        |given: String, expected: &'static str| ToolError::Option { option: "--part", given, expected };
    if named.is_empty() {
        return Err(refused(
            String::new(),
            "a station needs at least one part that carries a marker, as in --part brick --part polisher=0.036",
        ));
    }
    if named.len() > OBJECTS {
        let given = format!("{} parts", named.len());
        return Err(refused(given, "a station has at most 32: mark those that tell the steps apart"));
    }
    for (index, part) in named.iter().enumerate() {
        if named[..index].iter().any(|other| other.name == part.name) {
            let expected = "two parts have this name: give each its own, as in bolt-left and bolt-right";
            return Err(refused(part.name.clone(), expected));
        }
    }
    let numbered = (1..).zip(named);
    Ok(numbered
        .map(|(id, part)| Part { id, name: part.name.clone(), side_m: part.side_m.unwrap_or(side_m) })
        .collect())
}

/// The camera that a word or a path means.
fn camera(source: &str) -> Result<Camera, ToolError> {
    if source == "realsense" {
        return Ok(Camera::Realsense);
    }
    if source.starts_with("/dev/") {
        return Ok(Camera::Device(source.into()));
    }
    let path = Path::new(source).canonicalize().map_err(|_| ToolError::Option {
        option: "--camera",
        given: source.to_owned(),
        expected: "there is no such file; give a device such as /dev/video0, the word realsense, a film, a .bag file or a folder of pictures",
    })?;
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let kind = match ending {
        _ if path.is_dir() => "images",
        "bag" => "bag",
        "jsonl" => "tracks",
        _ => "video",
    };
    Ok(Camera::Recording { kind, path })
}

/// What was written, and what comes next.
fn summary(station: &Station, out: &Path) -> String {
    let file = out.display();
    let jobs = out.with_file_name(station.jobs());
    let jobs = jobs.display();
    let width = station.parts.iter().map(|part| part.name.chars().count()).max().unwrap_or_default();
    let part = |part: &Part| {
        let side_mm = 1000.0 * part.side_m;
        format!("  marker {:>2}  {:width$}  {side_mm:.1} mm\n", part.id, part.name)
    };
    let parts: String = station.parts.iter().map(part).collect();
    let count = match station.parts.len() {
        1 => "one part".to_owned(),
        count => format!("{count} parts"),
    };
    if station.board.is_some() {
        let file = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
        return format!(
            "{}: the station {} with {count}\n{parts}\nNext, by an administrator of this machine, with the name of whoever is to teach it:\n  \
             sudo andond install {} --engineer NAME\n",
            file.display(),
            station.name,
            file.display()
        );
    }
    format!(
        "{file}: the station {} with {count}\n{parts}\nNext:\n  andond markers -c {file}    print the markers, and stick them flat on the parts\n  \
         andond check -c {file}      says what is wrong in the file, and what this machine lacks\n  \
         andond look -c {file}       says whether light, sharpness and sizes are right\n  \
         andond teach run*.mp4 -c {file} --out {jobs}/my-job.toml    learns the job from five films of correct runs\n",
        station.name
    )
}

/// The hands as the station file lists them.
fn hands_listed(hands: Hands) -> &'static str {
    match hands {
        Hands::Right => r#"["right"]"#,
        Hands::Left => r#"["left"]"#,
        Hands::Both => r#"["right", "left"]"#,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn named(names: &[&str]) -> Vec<Named> {
        names.iter().map(|name| Named { name: (*name).into(), side_m: None }).collect()
    }

    #[test]
    fn markers_are_numbered_from_1_and_a_part_may_have_a_side_of_its_own() {
        let mut given = named(&["brick", "polisher"]);
        given[1].side_m = Some(0.036);
        let parts = parts(&given, 0.05).unwrap();
        let listed: Vec<_> = parts.iter().map(|part| (part.id, part.name.as_str(), part.side_m)).collect();
        assert_eq!(listed, [(1, "brick", 0.05), (2, "polisher", 0.036)]);
    }

    #[test]
    fn parts_that_cannot_be_told_apart_and_none_at_all_are_refused() {
        let twice = parts(&named(&["brick", "brick"]), 0.04).unwrap_err().to_string();
        assert_eq!(
            twice,
            "--part \"brick\": two parts have this name: give each its own, as in bolt-left and bolt-right"
        );
        assert!(parts(&[], 0.04).unwrap_err().to_string().contains("as in --part brick"));
        let many: Vec<String> = (0..33).map(|part| format!("part {part}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(parts(&named(&many), 0.04).unwrap_err().to_string().contains("at most 32"));
    }

    #[test]
    fn a_camera_is_known_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, "").unwrap();
            camera(path.to_str().unwrap()).unwrap()
        };
        assert!(matches!(file("run.mp4"), Camera::Recording { kind: "video", .. }));
        assert!(matches!(file("run.bag"), Camera::Recording { kind: "bag", .. }));
        assert!(matches!(file("run.tracks.jsonl"), Camera::Recording { kind: "tracks", .. }));
        let pictures = camera(folder.path().to_str().unwrap()).unwrap();
        assert!(matches!(pictures, Camera::Recording { kind: "images", .. }));
        assert!(matches!(camera("/dev/video2").unwrap(), Camera::Device(device) if device == "/dev/video2"));
        assert!(matches!(camera("realsense").unwrap(), Camera::Realsense));
        assert!(camera("no-such.mp4").unwrap_err().to_string().contains("there is no such file"));
    }
}
