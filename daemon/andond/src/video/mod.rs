//! Pictures in and out of processes that link no video library.
//!
//! Only the binary `andond-video` links OpenCV's `videoio` (248 shared libraries, 65 MB): the role `capture` runs in
//! it, and the tools hand it a film to decode, or pictures to make a film of, over a [`pipe`].

pub mod pipe;
pub mod source;

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read as _, Seek as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use pipe::{PictureFormat, PipeReader, PipeWriter};

/// Why a film could not be read or written. Each says what to do.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The helper binary is not beside this one.
    #[error(
        "cannot start {path}: {source}; it is installed beside andond, build it with `cargo build --release -p andond`"
    )]
    Helper {
        /// Where it was looked for.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The helper gave up; it has said why on standard error.
    #[error("{file}: {message}")]
    Film {
        /// The film.
        file: PathBuf,
        /// The helper's own words.
        message: String,
    },
    /// The pipe broke.
    #[error("{file}: the pipe to andond-video broke: {source}")]
    Pipe {
        /// The film.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Where `andond-video` is: beside the running binary.
pub fn helper_path() -> PathBuf {
    let name = "andond-video";
    let own = std::env::current_exe().unwrap_or_default();
    let beside = own.with_file_name(name);
    // A test binary lies in `deps/`, one folder below the binaries.
    let above = own.parent().and_then(Path::parent).map(|folder| folder.join(name));
    if beside.exists() { beside } else { above.filter(|path| path.exists()).unwrap_or(beside) }
}

/// A running `andond-video`. It is stopped when this is dropped.
struct Helper {
    child: Child,
    /// What it writes to standard error: a file, which never fills up as a pipe does that nobody reads meanwhile.
    words: File,
}

impl Helper {
    fn spawn(arguments: &[OsString], stdin: Stdio, stdout: Stdio) -> Result<Self, VideoError> {
        let path = helper_path();
        let start = || -> io::Result<Self> {
            let words = tempfile::tempfile()?;
            let child = Command::new(&path)
                .args(arguments)
                // The decoders' own complaints have no remedy; the helper's last line has.
                .envs([("OPENCV_LOG_LEVEL", "OFF"), ("OPENCV_FFMPEG_LOGLEVEL", "-8")])
                .stdin(stdin)
                .stdout(stdout)
                .stderr(words.try_clone()?)
                .spawn()?;
            Ok(Self { child, words })
        };
        start().map_err(|source| VideoError::Helper { path: path.clone(), source })
    }

    /// What it said before it ended; waits for the end.
    fn last_words(&mut self) -> String {
        let _ = self.child.wait();
        let mut words = String::new();
        // What cannot be read cannot be reported: the words stay short.
        let _ = self.words.rewind().and_then(|()| self.words.read_to_string(&mut words));
        let words = words.trim();
        if words.is_empty() { "andond-video ended without a word".into() } else { words.into() }
    }
}

impl Drop for Helper {
    fn drop(&mut self) {
        // A film that is not read to its end leaves a decoder that waits for us.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A film that is decoded by `andond-video`, one picture at a time.
pub struct Film {
    helper: Helper,
    pictures: PipeReader<std::process::ChildStdout>,
    file: PathBuf,
}

impl Film {
    /// Starts decoding `file`: a film, or a folder of pictures that is played at `rate_hz`.
    pub fn open(file: &Path, rate_hz: f32) -> Result<Self, VideoError> {
        let rate_hz = rate_hz.to_string();
        let mut helper =
            Helper::spawn(&["decode".into(), file.into(), rate_hz.into()], Stdio::null(), Stdio::piped())?;
        // `piped` above: the handle is there.
        let Some(stdout) = helper.child.stdout.take() else { unreachable!("standard output is piped") };
        match PipeReader::new(stdout) {
            Ok(pictures) => Ok(Self { helper, pictures, file: file.into() }),
            Err(_) => Err(VideoError::Film { file: file.into(), message: helper.last_words() }),
        }
    }

    /// Size, format and rate of the pictures.
    pub fn format(&self) -> PictureFormat {
        self.pictures.format()
    }

    /// Goes on to the next picture and tells its time since the first, in nanoseconds; `None` after the last.
    pub fn advance(&mut self) -> Result<Option<u64>, VideoError> {
        self.pictures
            .advance()
            .map_err(|_| VideoError::Film { file: self.file.clone(), message: self.helper.last_words() })
    }

    /// The picture that [`Film::advance`] went on to.
    pub fn picture(&self) -> &[u8] {
        self.pictures.picture()
    }
}

/// A film that is being written by `andond-video`.
pub struct FilmWriter {
    // Before the helper: its end closes the pipe, and the helper ends by itself.
    pictures: Option<PipeWriter<std::process::ChildStdin>>,
    helper: Helper,
    file: PathBuf,
}

impl FilmWriter {
    /// Starts an MP4 of pictures of this format.
    pub fn create(file: &Path, format: PictureFormat) -> Result<Self, VideoError> {
        let mut helper = Helper::spawn(&["encode".into(), file.into()], Stdio::piped(), Stdio::null())?;
        let Some(stdin) = helper.child.stdin.take() else { unreachable!("standard input is piped") };
        match PipeWriter::new(stdin, format) {
            Ok(pictures) => Ok(Self { helper, pictures: Some(pictures), file: file.into() }),
            Err(_) => Err(VideoError::Film { file: file.into(), message: helper.last_words() }),
        }
    }

    /// Adds one picture.
    pub fn write(&mut self, pts_ns: u64, picture: &[u8]) -> Result<(), VideoError> {
        // `pictures` is taken by `finish` alone, which consumes the writer.
        let Some(pictures) = self.pictures.as_mut() else { unreachable!("the film is not finished") };
        pictures
            .write_picture(pts_ns, picture)
            .map_err(|_| VideoError::Film { file: self.file.clone(), message: self.helper.last_words() })
    }

    /// Ends the film and waits until it is on the disk.
    pub fn finish(mut self) -> Result<(), VideoError> {
        // A helper that has failed cannot be told; it says why below.
        let _ = self.pictures.take().map(PipeWriter::finish);
        let status = self
            .helper
            .child
            .wait()
            .map_err(|source| VideoError::Pipe { file: self.file.clone(), source })?;
        if status.success() {
            Ok(())
        } else {
            Err(VideoError::Film { file: self.file, message: self.helper.last_words() })
        }
    }
}
