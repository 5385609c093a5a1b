//! Films for the tools: pictures of a film to standard output, and a film from the pictures on standard input.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, ErrorKind, Write as _, stdin, stdout};
use std::path::Path;

use andon_host::unwritten::remedy;
use andon_host::video::frame::view;
use andon_host::video::pipe::{PipeReader, PipeWriter};
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
    let mut pipe = match PipeWriter::new(BufWriter::new(stdout().lock()), format) {
        Ok(pipe) => pipe,
        Err(error) => return end_of_reader(error),
    };
    while let Some(pts_ns) = source.next_picture(&mut frame)? {
        let mut header = FrameHeader::default();
        source.describe(&mut header);
        // Depth lies behind the colour picture.
        let colour = frame
            .get(..header.colour_bytes().unwrap_or(usize::MAX))
            .ok_or("the source sends less than a picture")?;
        let image = view(&header, colour).and_then(|image| image.bgr()).map_err(|error| error.to_string())?;
        if let Err(error) = pipe.write_picture(pts_ns, &image) {
            return end_of_reader(error);
        }
    }
    pipe.finish().or_else(end_of_reader)
}

/// A reader that closes the pipe has seen enough: a broken pipe is a clean end, and nothing else is.
fn end_of_reader(error: io::Error) -> Result<(), String> {
    match error.kind() {
        ErrorKind::BrokenPipe => Ok(()),
        _ => Err(format!("standard output cannot be written: {error}; {}", remedy(&error))),
    }
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
    // FFmpeg takes what stands before a colon for a protocol.
    let absolute = std::path::absolute(file).map_err(|error| error.to_string())?;
    let codec = VideoWriter::fourcc('a', 'v', 'c', '1').map_err(message)?;
    let mut film =
        VideoWriter::new_with_backend(absolute, videoio::CAP_FFMPEG, codec, format.rate_hz, size, true)
            .map_err(message)?;
    if !film.is_opened().map_err(message)? {
        return Err(unfinished(file).unwrap_or_else(|| {
            "no film of this kind can be written here: does the name end in .mp4?".to_owned()
        }));
    }
    let mut pictures = 0;
    while pipe.advance().map_err(|error| error.to_string())?.is_some() {
        pictures += 1;
        let mat = Mat::new_rows_cols_with_bytes::<Vec3b>(size.height, size.width, pipe.picture())
            .map_err(message)?;
        film.write(&mat).map_err(message)?;
    }
    film.release().map_err(message)?;
    check_written(file, pictures)
}

/// Checks that a film is whole and on the disk: OpenCV does not say that it could not write.
fn check_written(file: &Path, pictures: u64) -> Result<(), String> {
    if pictures == 0 || recording::count_of(file).is_some_and(|count| count + 1 >= pictures) {
        let synced = File::options().append(true).open(file).and_then(|film| film.sync_all());
        return synced.map_err(|error| unwritten(&error));
    }
    Err(unfinished(file).unwrap_or_else(|| "it was not written to its end; is the disk in order?".into()))
}

/// Why a film came to no end, if the system still says so. Where it has no room, a little more is refused as well.
fn unfinished(file: &Path) -> Option<String> {
    // OpenCV removes a film that it cannot begin.
    let mut film = File::options().append(true).create(true).open(file).ok()?;
    let error = film.write_all(&[0; 1 << 16]).and_then(|()| film.sync_all()).err()?;
    Some(unwritten(&error))
}

fn unwritten(error: &io::Error) -> String {
    format!("it cannot be written: {error}; {}", remedy(error))
}

/// Writes each picture on standard input to standard output as a file of its own with this ending. Before it comes its length in bytes (32 bits, the
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
        if let Err(error) = written.and_then(|()| out.flush()) {
            return end_of_reader(error);
        }
    }
    Ok(())
}
