//! Pictures as files of their own. Only `andond-video` links the library that makes them, for its 394 others.

use std::io::{self, Read as _};
use std::process::Stdio;

use andon_host::video::pipe::{PictureFormat, PipeWriter};

use super::{Helper, VideoError};

/// Makes PNG or JPEG files of pictures of one size.
pub struct StillEncoder {
    // Dropped before the helper: that closes the pipe, and the helper ends by itself.
    pictures: PipeWriter<std::process::ChildStdin>,
    files: std::process::ChildStdout,
    helper: Helper,
}

impl StillEncoder {
    /// Starts an encoder; `ending` is `png` or `jpg`.
    ///
    /// # Errors
    /// That the helper cannot be started.
    pub fn new(ending: &str, format: PictureFormat) -> Result<Self, VideoError> {
        let mut helper = Helper::spawn(&["stills".into(), ending.into()], Stdio::piped(), Stdio::piped())?;
        let (Some(stdin), Some(files)) = (helper.child.stdin.take(), helper.child.stdout.take()) else {
            unreachable!("standard input and output are piped")
        };
        match PipeWriter::new(stdin, format) {
            Ok(pictures) => Ok(Self { pictures, files, helper }),
            Err(_) => Err(VideoError::Camera(helper.final_message())),
        }
    }

    /// The file of one picture: blue, green, red, without padding.
    ///
    /// # Errors
    /// What the helper says.
    pub fn encode(&mut self, picture: &[u8]) -> Result<Vec<u8>, VideoError> {
        self.exchange(picture).map_err(|_| VideoError::Camera(self.helper.final_message()))
    }

    fn exchange(&mut self, picture: &[u8]) -> io::Result<Vec<u8>> {
        self.pictures.write_picture(0, picture)?;
        let mut length = [0; 4];
        self.files.read_exact(&mut length)?;
        let mut file = vec![0; u32::from_le_bytes(length) as usize];
        self.files.read_exact(&mut file)?;
        Ok(file)
    }
}
