//! A clip, decoded by ffmpeg, frame by frame with its truth.

use crate::Error;
use crate::truth::{TrueFrame, Truth};
use andon_perception::{ImageView, PixelFormat};
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// How the pictures are changed before they are processed.
pub(crate) struct Change {
    /// An ffmpeg filter that changes pixels and moves none.
    pub(crate) filter: Option<String>,
    pub(crate) scale: f64,
    pub(crate) mirror: bool,
    /// Quality of a JPEG that every frame is encoded as first: 2 (best) to 31 (worst).
    pub(crate) jpeg: Option<u8>,
    /// The format that a frame has then.
    pub(crate) pixels: PixelFormat,
}

/// A format by the name that the configuration gives it, for clap.
pub(crate) fn pixel_format(name: &str) -> Result<PixelFormat, String> {
    match name {
        "bgr" => Ok(PixelFormat::Bgr8),
        "yuyv" => Ok(PixelFormat::Yuyv),
        "nv12" => Ok(PixelFormat::Nv12),
        _ => Err("bgr, yuyv or nv12".into()),
    }
}

/// ffmpeg's name of a format, and the bytes of a picture of this size.
pub(crate) fn raw(pixels: PixelFormat, width: usize, height: usize) -> (&'static str, usize) {
    match pixels {
        PixelFormat::Yuyv => ("yuyv422", 2 * width * height),
        PixelFormat::Nv12 => ("nv12", width * height * 3 / 2),
        _ => ("bgr24", 3 * width * height),
    }
}

impl Default for Change {
    /// The clip as it is.
    fn default() -> Self {
        Self { filter: None, scale: 1.0, mirror: false, jpeg: None, pixels: PixelFormat::Bgr8 }
    }
}

pub(crate) struct Clip {
    pub(crate) truth: Truth,
    pixels: PixelFormat,
    shown: usize,
    picture: Vec<u8>,
    pipe: BufReader<ChildStdout>,
    children: Vec<Child>,
}

/// A frame of a clip.
pub(crate) struct Shown<'a> {
    pub(crate) index: usize,
    pub(crate) captured_ns: u64,
    /// Blue, green, red where nothing else was asked for; no padding.
    pub(crate) bytes: &'a [u8],
    pub(crate) image: ImageView<'a>,
    pub(crate) truth: &'a TrueFrame,
}

impl Clip {
    pub(crate) fn open(path: &Path, change: &Change) -> Result<Self, Error> {
        let truth = Truth::beside(path, change)?;
        let mut filters = vec![format!("scale={}:{}:flags=bicubic", truth.width, truth.height)];
        filters.extend(change.filter.clone());
        filters.extend(change.mirror.then(|| "hflip".to_owned()));

        let mut decoder = Command::new("ffmpeg");
        decoder.args(["-v", "error", "-i"]).arg(path).args(["-vf", &filters.join(",")]);
        let mut children = Vec::new();
        if let Some(quality) = change.jpeg {
            decoder.args(["-c:v", "mjpeg", "-q:v", &quality.to_string(), "-f", "matroska", "-"]);
            let (child, pipe) = start(decoder)?;
            children.push(child);
            decoder = Command::new("ffmpeg");
            decoder.args(["-v", "error", "-i", "-"]).stdin(pipe);
        }
        let (name, bytes) = raw(change.pixels, truth.width, truth.height);
        decoder.args(["-f", "rawvideo", "-pix_fmt", name, "-"]);
        let (child, pipe) = start(decoder)?;
        children.push(child);
        let picture = vec![0; bytes];
        Ok(Self { truth, pixels: change.pixels, shown: 0, picture, pipe: BufReader::new(pipe), children })
    }

    /// The next frame; `None` after the last.
    pub(crate) fn next(&mut self) -> Result<Option<Shown<'_>>, Error> {
        match self.pipe.read_exact(&mut self.picture) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
            outcome => outcome?,
        }
        let index = self.shown;
        self.shown += 1;
        let Truth { rate_hz, width, height, frames, .. } = &self.truth;
        Ok(Some(Shown {
            index,
            captured_ns: (index as f64 / rate_hz * 1e9) as u64,
            bytes: &self.picture,
            image: ImageView::new(*width, *height, width * self.pixels.bytes(), self.pixels, &self.picture)?,
            truth: frames.get(index).ok_or("the clip is longer than its truth")?,
        }))
    }
}

impl Drop for Clip {
    fn drop(&mut self) {
        for child in &mut self.children {
            // It may have ended by itself.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn start(mut command: Command) -> Result<(Child, ChildStdout), Error> {
    let child = command.stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| format!("ffmpeg cannot be started: {error}"))?;
    let pipe = child.stdout.take().ok_or("ffmpeg has no output")?;
    Ok((child, pipe))
}
