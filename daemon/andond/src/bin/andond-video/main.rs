//! The part of the daemon that links OpenCV's `videoio`: films and cameras in, films out.
//!
//! `andond-video decode FILE` and `andond-video encode FILE` serve the tools over a pipe (see [`andond::video`]);
//! `andond-video capture ...` is the role `capture`, started by `andond run capture`.

mod sources;

use std::io::{BufReader, BufWriter, stdin, stdout};
use std::path::Path;
use std::process::ExitCode;

use andond::video::pipe::{PipeReader, PipeWriter};
use opencv::core::{Mat, Size, Vec3b};
use opencv::videoio::{VideoWriter, VideoWriterTrait, VideoWriterTraitConst};

fn main() -> ExitCode {
    let arguments: Vec<std::ffi::OsString> = std::env::args_os().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [verb, file] if verb == "decode" => decode(Path::new(file)),
        [verb, file] if verb == "encode" => encode(Path::new(file)),
        _ => Err("usage: andond-video decode FILE | encode FILE; people want `andond`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(64)
        }
    }
}

/// Pictures of a film to standard output.
fn decode(file: &Path) -> Result<(), String> {
    let mut source = sources::open(file)?;
    let format = source.format();
    let mut picture = vec![0; format.bytes()];
    // A reader that is gone has seen enough: a broken pipe is a clean end.
    let Ok(mut pipe) = PipeWriter::new(BufWriter::new(stdout().lock()), format) else { return Ok(()) };
    while let Some(pts_ns) = source.next_picture(&mut picture)? {
        if pipe.write_picture(pts_ns, &picture).is_err() {
            return Ok(());
        }
    }
    Ok(())
}

/// A film from the pictures on standard input.
fn encode(file: &Path) -> Result<(), String> {
    let mut pipe = PipeReader::new(BufReader::new(stdin().lock())).map_err(|error| error.to_string())?;
    let format = pipe.format();
    let size = Size::new(format.width as i32, format.height as i32);
    let said = |error: opencv::Error| error.to_string();
    let codec = VideoWriter::fourcc('a', 'v', 'c', '1').map_err(said)?;
    let mut film = VideoWriter::new(file, codec, format.rate_hz, size, true).map_err(said)?;
    if !film.is_opened().map_err(said)? {
        return Err("cannot be written: does the folder exist, and does the name end in .mp4?".into());
    }
    while let Some((_, picture)) = pipe.next_picture().map_err(|error| error.to_string())? {
        let mat = Mat::new_rows_cols_with_bytes::<Vec3b>(size.height, size.width, picture).map_err(said)?;
        film.write(&mat).map_err(said)?;
    }
    film.release().map_err(said)
}
