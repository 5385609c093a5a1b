//! Films for the tools: pictures of a film to standard output, and a film from the pictures on standard input.

use std::ffi::OsStr;
use std::io::{BufReader, BufWriter, stdin, stdout};
use std::path::Path;

use andond::video::pipe::{PipeReader, PipeWriter};
use opencv::core::{Mat, Size, Vec3b};
use opencv::videoio::{self, VideoWriter, VideoWriterTrait, VideoWriterTraitConst};

use crate::recording;

/// Writes the pictures of a film to standard output. `rate_hz` is the rate of a folder of pictures.
///
/// # Errors
/// A message for a technician: what is wrong with the film.
pub fn decode(file: &Path, rate_hz: &OsStr) -> Result<(), String> {
    let rate_hz = rate_hz.to_str().and_then(|text| text.parse().ok()).ok_or("the rate must be a number")?;
    let mut source = recording::open(file, rate_hz)?;
    let format = source.format();
    let mut picture = vec![0; format.bytes()];
    // A reader that closes the pipe has seen enough: a broken pipe is a clean end.
    let Ok(mut pipe) = PipeWriter::new(BufWriter::new(stdout().lock()), format) else { return Ok(()) };
    while let Some(pts_ns) = source.next_picture(&mut picture)? {
        if pipe.write_picture(pts_ns, &picture).is_err() {
            return Ok(());
        }
    }
    let _ = pipe.finish();
    Ok(())
}

/// Writes a film of the pictures on standard input.
///
/// # Errors
/// A message for a technician: why the film cannot be written.
pub fn encode(file: &Path) -> Result<(), String> {
    let mut pipe = PipeReader::new(BufReader::new(stdin().lock())).map_err(|error| error.to_string())?;
    let format = pipe.format();
    let size = Size::new(format.width as i32, format.height as i32);
    let message = |error: opencv::Error| error.to_string();
    let codec = VideoWriter::fourcc('a', 'v', 'c', '1').map_err(message)?;
    let mut film =
        VideoWriter::new_with_backend(file, videoio::CAP_FFMPEG, codec, format.rate_hz, size, true)
            .map_err(message)?;
    if !film.is_opened().map_err(message)? {
        return Err("cannot be written: does the folder exist, and does the name end in .mp4?".into());
    }
    while pipe.advance().map_err(|error| error.to_string())?.is_some() {
        let mat = Mat::new_rows_cols_with_bytes::<Vec3b>(size.height, size.width, pipe.picture())
            .map_err(message)?;
        film.write(&mat).map_err(message)?;
    }
    film.release().map_err(message)
}
