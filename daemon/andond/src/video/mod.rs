//! Films for processes that link no video library.
//!
//! Only the binary `andond-video` of the crate `andon-video` links OpenCV's `videoio`, which loads 248 shared libraries, 65 MB. The role
//! `capture` runs in that binary. The tools start it to decode a film, or to make a film of pictures, over a [`andon_host::video::pipe`].

mod still;

use std::ffi::OsString;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

use andon_host::video::pipe::{PictureFormat, PipeReader, PipeWriter};
use tempfile::TempPath;

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::unwritten::remedy;
pub use still::StillEncoder;

/// Why a film could not be read or written, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The helper binary is not beside this one.
    #[error(
        "cannot start {path}: {source}; it is installed beside andond, build it with `cargo build --release -p andon-video`"
    )]
    Helper {
        /// Where it was looked for.
        path: PathBuf,
        /// The cause that the system gives.
        source: std::io::Error,
    },
    /// The helper failed and wrote the reason to standard error.
    #[error("{file}: {message}")]
    Film {
        /// The film.
        file: PathBuf,
        /// The helper's message.
        message: String,
    },
    /// A film cannot be written.
    #[error("{}: it cannot be written: {source}; {}", file.display(), remedy(source))]
    Write {
        /// The film.
        file: PathBuf,
        /// The cause that the system gives.
        source: std::io::Error,
    },
    /// The camera of a station cannot be opened, or sends no more.
    #[error("{0}")]
    Camera(String),
    /// The pipe broke.
    #[error("{file}: the pipe to andond-video broke: {source}")]
    Pipe {
        /// The film.
        file: PathBuf,
        /// The cause that the system gives.
        source: std::io::Error,
    },
}

/// The path of `andond-video`, which lies beside the running binary.
pub fn helper_path() -> PathBuf {
    let name = "andond-video";
    let own = std::env::current_exe().unwrap_or_default();
    let beside = own.with_file_name(name);
    // The binary of a test is in `deps/`, one folder below the other binaries.
    let above = own.parent().and_then(Path::parent).map(|folder| folder.join(name));
    if beside.exists() { beside } else { above.filter(|path| path.exists()).unwrap_or(beside) }
}

/// A running `andond-video`. It is stopped when this is dropped.
struct Helper {
    child: Child,
    /// Collects standard error, which is read all the time: the helper would wait where nobody reads it.
    stderr: Option<JoinHandle<String>>,
}

impl Helper {
    fn spawn(arguments: &[OsString], stdin: Stdio, stdout: Stdio) -> Result<Self, VideoError> {
        let path = helper_path();
        let mut child = Command::new(&path)
            .args(arguments)
            // The messages of the decoders themselves name no remedy; the last line of the helper does.
            .envs([("OPENCV_LOG_LEVEL", "OFF"), ("OPENCV_FFMPEG_LOGLEVEL", "-8")])
            .stdin(stdin)
            .stdout(stdout)
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|source| VideoError::Helper { path, source })?;
        let stderr = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut message = Vec::new();
                // What cannot be read cannot be reported either.
                let _ = stderr.read_to_end(&mut message);
                String::from_utf8_lossy(&message).into_owned()
            })
        });
        Ok(Self { child, stderr })
    }

    /// Waits for its end and returns what it wrote to standard error.
    fn final_message(&mut self) -> String {
        let status = self.child.wait();
        let message = self.stderr.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        match (message.trim(), status) {
            ("", Ok(status)) => format!("andond-video ended without a message ({status})"),
            ("", Err(_)) => "andond-video ended without a message".into(),
            (message, _) => message.into(),
        }
    }
}

impl Drop for Helper {
    fn drop(&mut self) {
        // A film that is not read to its end leaves a decoder that is still writing.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A film, or what a camera sees, decoded by `andond-video`, one picture at a time.
pub struct Film {
    helper: Helper,
    pictures: PipeReader<std::process::ChildStdout>,
    /// `None` for the camera of a station.
    file: Option<PathBuf>,
}

impl Film {
    /// Starts decoding `file`: a film, or a folder of pictures that is played at `rate_hz`.
    pub fn open(file: &Path, rate_hz: f32) -> Result<Self, VideoError> {
        let rate_hz = rate_hz.to_string();
        Self::start(&["decode".into(), file.into(), rate_hz.into()], Some(file.into()))
    }

    /// Starts reading the camera or the recording that a configuration names.
    pub fn watch(config: &Config) -> Result<Self, VideoError> {
        let files = config.files.iter().flat_map(|file| ["--config".into(), file.into()]);
        let arguments: Vec<OsString> = std::iter::once("watch".into()).chain(files).collect();
        Self::start(&arguments, None)
    }

    fn start(arguments: &[OsString], file: Option<PathBuf>) -> Result<Self, VideoError> {
        let mut helper = Helper::spawn(arguments, Stdio::null(), Stdio::piped())?;
        // The handle exists because standard output is piped above.
        let Some(stdout) = helper.child.stdout.take() else { unreachable!("standard output is piped") };
        match PipeReader::new(stdout) {
            Ok(pictures) => Ok(Self { helper, pictures, file }),
            Err(_) => Err(failed(file, &mut helper)),
        }
    }

    /// Size, format and rate of the pictures.
    pub fn format(&self) -> PictureFormat {
        self.pictures.format()
    }

    /// Advances to the next picture and returns its time since the first in nanoseconds, `None` after the last.
    pub fn advance(&mut self) -> Result<Option<u64>, VideoError> {
        let Self { helper, pictures, file } = self;
        pictures.advance().map_err(|_| failed(file.clone(), helper))
    }

    /// The picture that [`Film::advance`] has reached.
    pub fn picture(&self) -> &[u8] {
        self.pictures.picture()
    }
}

/// Why the helper gave no picture.
fn failed(file: Option<PathBuf>, helper: &mut Helper) -> VideoError {
    let message = helper.final_message();
    match file {
        Some(file) => VideoError::Film { file, message },
        None => VideoError::Camera(message),
    }
}

/// A film that is being written by `andond-video`. It has its name when it is finished: one that is broken off leaves the one before it.
pub struct FilmWriter {
    // Dropped before the helper: that closes the pipe, and the helper ends by itself.
    pictures: Option<PipeWriter<std::process::ChildStdin>>,
    helper: Helper,
    part: TempPath,
    file: PathBuf,
}

impl FilmWriter {
    /// Starts an MP4 of pictures of this format.
    pub fn create(file: &Path, format: PictureFormat) -> Result<Self, VideoError> {
        if file.metadata().is_ok_and(|there| !there.is_file()) {
            let message = "a film is written to a file, and this is none; name one that ends in .mp4".into();
            return Err(VideoError::Film { file: file.into(), message });
        }
        let unwritten = |source| VideoError::Write { file: file.into(), source };
        let part = atomic::beside(file).map_err(unwritten)?.into_temp_path();
        let mut helper =
            Helper::spawn(&["encode".into(), part.as_os_str().into()], Stdio::piped(), Stdio::null())?;
        let Some(stdin) = helper.child.stdin.take() else { unreachable!("standard input is piped") };
        match PipeWriter::new(stdin, format) {
            Ok(pictures) => Ok(Self { helper, pictures: Some(pictures), part, file: file.into() }),
            Err(_) => Err(VideoError::Film { file: file.into(), message: helper.final_message() }),
        }
    }

    /// Adds one picture.
    pub fn write(&mut self, pts_ns: u64, picture: &[u8]) -> Result<(), VideoError> {
        // Only `finish` takes `pictures`, and it consumes the writer.
        let Some(pictures) = self.pictures.as_mut() else { unreachable!("the film is not finished") };
        pictures
            .write_picture(pts_ns, picture)
            .map_err(|_| VideoError::Film { file: self.file.clone(), message: self.helper.final_message() })
    }

    /// Ends the film, waits until it is whole on the disk, and gives it its name.
    pub fn finish(mut self) -> Result<(), VideoError> {
        // A helper that has failed cannot take the end; its message is read below.
        let _ = self.pictures.take().map(PipeWriter::finish);
        let status = self
            .helper
            .child
            .wait()
            .map_err(|source| VideoError::Pipe { file: self.file.clone(), source })?;
        if !status.success() {
            return Err(VideoError::Film { file: self.file, message: self.helper.final_message() });
        }
        atomic::put(self.part, &self.file).map_err(|source| VideoError::Write { file: self.file, source })
    }
}
