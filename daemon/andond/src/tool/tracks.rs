//! `andond tracks`: what a film shows, as a track file. The film need not be looked at again for what is done with it later.

use andon_host::atomic;
use andon_host::exit::Code;

use super::{ToolError, cannot_write, each_frame, load_config_to_learn, new_or_forced};
use crate::cli::Tracks;
use crate::recorder::Recorder;
use crate::recording::Recording;

/// Runs the command. The file is there whole or not at all: half a film looks like a whole one.
///
/// # Errors
/// A film that cannot be read, and a file that exists or cannot be written.
pub fn run(arguments: &Tracks) -> Result<Code, ToolError> {
    let Tracks { film, out, .. } = arguments;
    new_or_forced(out, arguments.force)?;
    let config = load_config_to_learn(&arguments.config)?;
    let part = atomic::beside(out).map_err(cannot_write(out))?;
    let mut recording = Recording::open(film, &config)?;
    let mut recorder =
        Recorder::new(part.reopen().map_err(cannot_write(out))?, out, recording.header().clone())?;
    each_frame(&mut recording, film, |frame| Ok(recorder.write(frame).map(drop)?))?;
    recorder.finish()?;
    atomic::put(part.into_temp_path(), out).map_err(cannot_write(out))?;
    println!("written: {}, {} frames", out.display(), recorder.frames());
    Ok(Code::Stopped)
}
