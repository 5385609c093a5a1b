//! What a camera saw of real clips: a film is processed once and judged often, with and without what may not have been seen.
#![allow(clippy::unwrap_used)]

use andon_core::input::Side;
use andon_core::verdict::{Level, Outcome, Reason};
use andon_learn::job_file::JobFile;
use andon_learn::recording::{Recording, read, write};
use andon_tests::deletion::{jobs, judged, try_deletions, try_two_pieces};
use andon_tests::environment;
use andon_tests::line::andond;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What the perception of the line sees in a clip.
fn seen(clip: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let tracks = folder.path().join("clip.tracks.jsonl");
    let film = format!("tests/footage/{clip}.mp4");
    let mut command = Command::new(andond());
    command.current_dir(root()).args(["tracks", "--config", "config/stations/demo.toml", &film, "--out"]);
    let output = command.arg(&tracks).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    read(clip, &std::fs::read(tracks).unwrap()).unwrap()
}

/// The second clip was not shown to the shipped job. `ANDON_CASES` chooses how many deletions.
#[test]
fn nothing_is_accused_for_what_was_not_seen() {
    let cases = environment::number("ANDON_CASES", 60) / 4;
    let seeds = environment::known_and_drawn(73);
    let path = root().join("config/jobs/polish-and-measure.toml");
    let job = JobFile::parse("the shipped job", &std::fs::read(path).unwrap()).unwrap();
    for clip in ["p1_none_r3", "p2_none_r3"] {
        let whole = seen(clip);
        assert_eq!(jobs(&judged(&job, &whole)), [Outcome::Ok], "{clip}");
        for seed in seeds {
            let tried = try_deletions(&job, &[&whole], seed, cases);
            println!("{clip}: {} accused, {} of {cases} right", tried.accused.len(), tried.right);
            assert!(tried.accused.is_empty(), "seed {seed}, {clip}: {:?}", tried.accused);
            let tried = try_two_pieces(&job, &[&whole], seed, 0..cases);
            assert!(tried.accused.is_empty(), "seed {seed}, {clip}, two pieces: {:?}", tried.accused);
        }
    }
}

/// Below six frames per second no motion can be measured, so it is not known what the hands do.
#[test]
fn a_piece_of_which_too_few_frames_came_is_not_judged_and_says_so() {
    let path = root().join("config/jobs/polish-and-measure.toml");
    let job = JobFile::parse("the shipped job", &std::fs::read(path).unwrap()).unwrap();
    for clip in ["p1_none_r1", "p2_J1_r1"] {
        let whole = seen(clip);
        for every in [3, 4, 6, 8, 10, 15] {
            let frames = whole.frames.iter().step_by(every).cloned().collect();
            let verdicts = judged(&job, &Recording { frames, ..whole.clone() });
            let newest = verdicts.last().unwrap();
            let is_slow = whole.header.rate_hz / (every as f32) < job.min_rate_hz;
            assert!(
                newest.level == Level::Job && newest.outcome != Outcome::Ok || !is_slow,
                "{clip}, 1 of {every}: {newest:?}"
            );
            assert!(!is_slow || newest.reason == Reason::TooFewFrames, "{clip}, 1 of {every}: {newest:?}");
            let is_accused = verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly);
            assert!(!is_accused || clip != "p1_none_r1", "{clip}, 1 of {every}: {verdicts:?}");
        }
    }
}

/// The clip in which the right hand is called the left one in some frames.
fn misnamed(whole: &Recording, from: usize, frames: usize) -> Recording {
    let mut wrong = whole.clone();
    wrong.header.hands = vec![Side::Right, Side::Left];
    let hands = wrong.frames[from..from + frames].iter_mut().flat_map(|frame| &mut frame.hands);
    hands.for_each(|hand| hand.side = Side::Left);
    wrong
}

/// What a replay says, as a running line does: level, outcome and note of each verdict.
fn replayed(recording: &Recording) -> Vec<[String; 3]> {
    let folder = tempfile::tempdir().unwrap();
    let tracks = folder.path().join("clip.tracks.jsonl");
    let mut text = Vec::new();
    write(&mut text, &recording.header, &recording.frames).unwrap();
    std::fs::write(&tracks, text).unwrap();
    let mut command = Command::new(andond());
    command.current_dir(root()).args(["replay", "--json", "--job", "config/jobs/polish-and-measure.toml"]);
    let output = command.args(["--config", "config/stations/demo.toml"]).arg(tracks).output().unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    let word = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let verdict = |line: &str| {
        let verdict: serde_json::Value = serde_json::from_str(line).unwrap();
        ["level", "outcome", "note"].map(|key| word(&verdict[key]))
    };
    lines.lines().map(verdict).collect()
}

/// A name that is wrong for less than `blind_ms` changes nothing. One that lasts is believed, and then it is said that the other hand worked, or not
/// judged. It is right only where what was seen of the parts alone shows that nothing was wrong. A right piece is not accused for it, and one with
/// strokes left out is not right.
#[test]
fn a_hand_that_is_called_the_other_one_is_the_same_hand_until_the_name_has_lasted() {
    for (clip, is_right) in [("p1_none_r1", true), ("p2_J1_r1", false)] {
        let whole = seen(clip);
        let known = replayed(&whole);
        let mut said = 0;
        for frames in [5, 12, 30, 45] {
            for from in (10..whole.frames.len() - frames).step_by(40) {
                let verdicts = replayed(&misnamed(&whole, from, frames));
                let place = format!("{clip}: {frames} frames from {from}: {verdicts:?}");
                if frames < 21 {
                    assert_eq!(verdicts, known, "{place}");
                    continue;
                }
                let has = |outcome: &str| verdicts.iter().any(|verdict| verdict[1] == outcome);
                let is_job_right = verdicts.iter().any(|verdict| verdict[0] == "job" && verdict[1] == "ok");
                assert!(if is_right { !has("anomaly") } else { !is_job_right }, "{place}");
                said += u32::from(has("not_judged") || verdicts.iter().any(|verdict| !verdict[2].is_empty()));
            }
        }
        assert!(said > 0, "{clip}: a name that lasts is nowhere believed");
    }
}
