//! What a camera saw of real clips: a film is processed once and judged often, with and without what may not have been seen.
#![allow(clippy::unwrap_used)]

use andon_core::verdict::Outcome;
use andon_learn::job_file::JobFile;
use andon_learn::recording::{Recording, read};
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

/// The second clip was not shown to the shipped job. `ANDON_SEED` and `ANDON_CASES` choose other deletions.
#[test]
fn nothing_is_accused_for_what_was_not_seen() {
    let (seed, cases) = (environment::number("ANDON_SEED", 73), environment::number("ANDON_CASES", 60));
    let path = root().join("config/jobs/polish-and-measure.toml");
    let job = JobFile::parse("the shipped job", &std::fs::read(path).unwrap()).unwrap();
    for clip in ["p1_none_r3", "p2_none_r3"] {
        let whole = seen(clip);
        assert_eq!(jobs(&judged(&job, &whole)), [Outcome::Ok], "{clip}");
        let tried = try_deletions(&job, &[&whole], seed, cases / 2);
        println!("{clip}: {} accused, {} of {} right", tried.accused.len(), tried.right, cases / 2);
        assert!(tried.accused.is_empty(), "{clip}: {:?}", tried.accused);
        let tried = try_two_pieces(&job, &[&whole], seed, cases / 2);
        assert!(tried.accused.is_empty(), "{clip}, two pieces: {:?}", tried.accused);
    }
}
