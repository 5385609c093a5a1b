//! `andond record`: writes what a running station sees to a track file, whose replay gives the same verdicts.

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_ipc::{Node, Reader, Wake};
use shm_schemas::{Detections, flag};

use super::join::join;
use super::{ToolError, cannot_write, load_config, new_or_forced};
use crate::cli::Record;
use crate::recorder::{Recorder, header};
use crate::wire;

/// Nothing is due between two frames: this is only how often the wait is repeated.
const WAIT: Duration = Duration::from_secs(10);

/// Runs the command until it is interrupted, or the source is at its end. The file grows meanwhile: what is there when the machine fails is
/// not lost.
///
/// # Errors
/// A file that exists or cannot be written, or a station that cannot be joined. So are lost frames, without which the recording would not give the
/// same verdicts.
pub fn run(arguments: &Record) -> Result<Code, ToolError> {
    let config = load_config(&arguments.config)?;
    let out = arguments.out.as_path();
    new_or_forced(out, arguments.force)?;
    let node = join(&config)?;
    let recorded = record(&node, &config, out);
    if recorded.is_err() && out.metadata().is_ok_and(|file| file.is_file() && file.len() == 0) {
        // Nothing of it came to the disk: an empty file is no recording.
        let _ = std::fs::remove_file(out);
    }
    recorded
}

fn record(node: &Node, config: &Config, out: &Path) -> Result<Code, ToolError> {
    let mut recorder = Recorder::new(File::create(out).map_err(cannot_write(out))?, out, header(config))?;
    let mut detections: Reader<Detections> = node.reader()?;
    eprintln!("recording to {}; stop with Ctrl-C", out.display());
    let mut ended = false;
    while !ended && node.wait(&mut [&mut detections], WAIT)? != Wake::Stop {
        while let Some(message) = detections.take()? {
            ended = message.flags & flag::END_OF_STREAM != 0
                || !recorder.write(wire::detections::to_core(&message))?;
            if ended {
                break;
            }
        }
    }
    recorder.finish()?;
    eprintln!("{} frames", recorder.frames());
    match detections.lost() {
        0 => Ok(Code::Stopped),
        lost => Err(ToolError::Lost(lost)),
    }
}
