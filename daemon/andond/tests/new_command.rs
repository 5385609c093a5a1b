//! What a new command takes: one that says in how many frames of a recording a hand is seen.

// A command returns the error of all commands, as those in `tool` do.
#![allow(clippy::unwrap_used, clippy::result_large_err)]

use andon_core::input::{Frame, Hand, Side};
use andon_host::config::Config;
use andon_host::exit::Code;
use andond::recorder::{Recorder, header};
use andond::recording::Recording;
use andond::tool::ToolError;
use clap::Parser;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

/// The example. Its arguments, which are in `cli`:
#[derive(Debug, Parser)]
struct Hands {
    /// Film, folder of pictures or track file
    recording: PathBuf,
}

/// And all that its file in `tool` has to have.
fn run(arguments: &Hands, out: &mut impl Write) -> Result<Code, ToolError> {
    let mut recording = Recording::open(&arguments.recording, &Config::default())?;
    let (mut seen, mut frames) = (0, 0);
    while let Some(frame) = recording.next_frame()? {
        seen += u32::from(!frame.hands.is_empty());
        frames += 1;
    }
    writeln!(out, "a hand is seen in {seen} of {frames} frames").map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}

/// What a command line prints and how it ends, as `main` does it.
fn call(words: &[&str]) -> (String, Code) {
    let Ok(arguments) = Hands::try_parse_from(words) else { return (String::new(), Code::Usage) };
    let mut out = Vec::new();
    let code = run(&arguments, &mut out).unwrap_or_else(|failure| failure.code());
    (String::from_utf8(out).unwrap(), code)
}

#[test]
fn a_command_of_a_few_lines_reads_a_recording_and_ends_with_a_code_of_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.tracks.jsonl");
    let mut recorder =
        Recorder::new(File::create(&path).unwrap(), &path, header(&Config::default())).unwrap();
    for number in 0..4 {
        let mut frame = Frame { captured_ns: number * 33_333_333, ..Frame::default() };
        let [wrist, middle_knuckle, tip] = [-0.17, -0.08, 0.0].map(|y| [0.0, y, 0.0]);
        let hand = Hand { side: Side::Right, score: 1.0, wrist, middle_knuckle, tips: [tip; 3] };
        frame.hands.extend((number > 0).then_some(hand));
        recorder.write(frame).unwrap();
    }
    recorder.finish().unwrap();
    let path = path.to_str().unwrap();
    assert_eq!(call(&["hands", path]), ("a hand is seen in 3 of 4 frames\n".to_owned(), Code::Stopped));
    // Neither arguments that are missing nor a file that is become right by another try.
    assert_eq!(call(&["hands"]).1, Code::Usage);
    assert_eq!(call(&["hands", &format!("{path}.none")]).1, Code::Usage);
}
