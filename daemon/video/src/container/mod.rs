//! What the container of a film says of it that OpenCV does not tell rightly. It is how many of its pictures are shown, how they are turned, and
//! whether the file is whole.
//!
//! OpenCV counts pictures that an edit list leaves out, and takes the length of the sound for that of the pictures. Up to version 4.6 it turns the
//! films of telephones by the wrong quarter.

mod matroska;
mod mp4;

use std::fs::File;
use std::io::{self, BufReader, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// How the pictures of a film are to be shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Turn {
    /// First exchanged, left for right.
    pub(crate) is_mirrored: bool,
    /// Then turned clockwise by so many quarters.
    pub(crate) quarters: u8,
}

/// What a container says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Container {
    /// How many pictures are shown; `None` where it does not say.
    pub(crate) pictures: Option<u64>,
    /// How they are turned; `None` where this is left to OpenCV.
    pub(crate) turn: Option<Turn>,
    /// The file is shorter than its container says.
    pub(crate) is_cut: bool,
}

/// Reads the container of a film; what is not known of it is `None`.
pub(crate) fn read(path: &Path) -> Container {
    let known = || -> io::Result<Option<Container>> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut film = BufReader::new(file);
        let mut begin = [0; 12];
        film.read_exact(&mut begin)?;
        film.seek(SeekFrom::Start(0))?;
        match begin {
            [0x1a, 0x45, 0xdf, 0xa3, ..] => matroska::read(&mut film, length).map(Some),
            [_, _, _, _, b'f', b't', b'y', b'p', ..]
            | [_, _, _, _, b'm', b'o', b'o', b'v', ..]
            | [_, _, _, _, b'm', b'd', b'a', b't', ..]
            | [_, _, _, _, b'w', b'i', b'd', b'e', ..]
            | [_, _, _, _, b'f', b'r', b'e', b'e', ..] => mp4::read(&mut film, length).map(Some),
            _ => Ok(None),
        }
    };
    // Whether it is a film at all is for the decoder to say.
    known().ok().flatten().unwrap_or_default()
}

/// Whether it is worth to hold the pictures against the count that OpenCV gives. That of an AVI is written, and others are only guessed from the
/// length of whatever is longest.
pub(crate) fn has_a_count(path: &Path) -> bool {
    let mut begin = [0; 4];
    File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok() && begin == *b"RIFF"
}
