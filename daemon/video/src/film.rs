//! Films for the tools: pictures of a film to standard output, and a film from the pictures on standard input.

use std::ffi::OsStr;
use std::io::{BufReader, BufWriter, Write as _, stdin, stdout};
use std::path::Path;

use andond::video::frame::view;
use andond::video::pipe::{PipeReader, PipeWriter};
use opencv::core::{Mat, Size, Vec3b, Vector};
use opencv::imgcodecs;
use opencv::videoio::{self, VideoWriter, VideoWriterTrait, VideoWriterTraitConst};
use shm_schemas::FrameHeader;

use crate::recording;
use crate::source::Source;

/// Writes the pictures of a film to standard output. `rate_hz` is the rate of a folder of pictures.
///
/// # Errors
/// A message for a technician: what is wrong with the film.
pub fn decode(file: &Path, rate_hz: &OsStr) -> Result<(), String> {
    let rate_hz = rate_hz.to_str().and_then(|text| text.parse().ok()).ok_or("the rate must be a number")?;
    watch(recording::open(file, rate_hz)?.as_mut())
}

/// Writes the pictures of any source to standard output, until its end.
///
/// # Errors
/// A message for a technician: what is wrong with the source.
pub fn watch(source: &mut dyn Source) -> Result<(), String> {
    let format = source.format();
    let mut frame = vec![0; source.frame_bytes()];
    // A reader that closes the pipe has seen enough: a broken pipe is a clean end.
    let Ok(mut pipe) = PipeWriter::new(BufWriter::new(stdout().lock()), format) else { return Ok(()) };
    while let Some(pts_ns) = source.next_picture(&mut frame)? {
        let mut header = FrameHeader::default();
        source.describe(&mut header);
        // Depth lies behind the colour picture.
        let colour = frame
            .get(..header.colour_bytes().unwrap_or(usize::MAX))
            .ok_or("the source sends less than a picture")?;
        let image = view(&header, colour).and_then(|image| image.bgr()).map_err(|error| error.to_string())?;
        if pipe.write_picture(pts_ns, &image).is_err() {
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

/// Writes each picture on standard input to standard output as a file of its own with this ending, after its length in bytes (32 bits, the
/// least significant first).
///
/// # Errors
/// A message for a technician: why the pictures cannot be written.
pub fn stills(ending: &OsStr) -> Result<(), String> {
    let ending = format!(".{}", ending.to_str().unwrap_or_default());
    let mut pipe = PipeReader::new(BufReader::new(stdin().lock())).map_err(|error| error.to_string())?;
    let format = pipe.format();
    let message = |error: opencv::Error| error.to_string();
    let (mut file, mut out) = (Vector::<u8>::new(), stdout().lock());
    while pipe.advance().map_err(|error| error.to_string())?.is_some() {
        let (rows, columns) = (format.height as i32, format.width as i32);
        let mat = Mat::new_rows_cols_with_bytes::<Vec3b>(rows, columns, pipe.picture()).map_err(message)?;
        imgcodecs::imencode_def(&ending, &mat, &mut file).map_err(message)?;
        let length = u32::try_from(file.len()).map_err(|error| error.to_string())?;
        let written = out.write_all(&length.to_le_bytes()).and_then(|()| out.write_all(file.as_slice()));
        if written.and_then(|()| out.flush()).is_err() {
            // A reader that closes the pipe has seen enough.
            return Ok(());
        }
    }
    Ok(())
}
