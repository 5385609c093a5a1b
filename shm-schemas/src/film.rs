//! Channel `film`: a recording that an engineer sends by a page of the board, piece by piece.

use crate::layout::wire;
use crate::stamp::{Stamp, message};
use crate::text::{read_text, write_text};

/// Bytes of a piece at most. As a form of a browser, in letters of six bits each, it has 64 KiB.
pub const PIECE_BYTES: usize = 48 << 10;

/// Bytes of a recording at most: a minute in 4K of a telephone has fewer.
pub const FILM_BYTES: u64 = 512 << 20;

wire! { "andon.FilmPiece", 49_360;
    /// A piece of a recording. One without bytes, of a recording of no size, breaks it off.
    struct FilmPiece {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// The number of the task that the piece is, which no other one has.
        task: u64,
        /// The number that the browser has given this recording.
        film: u64,
        /// How many bytes of the recording come before it.
        at: u64,
        /// Bytes of the whole recording.
        size: u64,
        /// Bytes of this piece.
        length: u32,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 4],
        /// The login that sends it, in UTF-8, with zeros behind it; in pieces, because only short arrays have a default.
        who: [[u8; 16]; 4],
        /// What the recording is to be called, in UTF-8, with zeros behind it.
        name: [[u8; 16]; 4],
        /// The bytes, with zeros behind them.
        bytes: [[[[u8; 16]; 16]; 16]; 12],
    }
}
message!(FilmPiece);

impl FilmPiece {
    /// The login that sends it.
    pub fn who(&self) -> &str {
        read_text(self.who.as_flattened())
    }

    /// What the recording is to be called.
    pub fn name(&self) -> &str {
        read_text(self.name.as_flattened())
    }

    /// The bytes of this piece.
    pub fn bytes(&self) -> &[u8] {
        let all = self.bytes.as_flattened().as_flattened().as_flattened();
        all.get(..self.length as usize).unwrap_or(all)
    }

    /// Says who sends it, and for which recording. False where one of the texts is too long.
    #[must_use]
    pub fn say(&mut self, who: &str, name: &str) -> bool {
        write_text(who, self.who.as_flattened_mut());
        write_text(name, self.name.as_flattened_mut());
        (self.who(), self.name()) == (who, name)
    }

    /// Takes the bytes. False where they are more than a piece has.
    #[must_use]
    pub fn carry(&mut self, bytes: &[u8]) -> bool {
        let all = self.bytes.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        let Some(place) = all.get_mut(..bytes.len()) else { return false };
        place.copy_from_slice(bytes);
        self.length = bytes.len() as u32;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_carries_what_it_was_given_or_says_that_it_is_too_much() {
        let mut piece = FilmPiece::default();
        assert!(piece.say("maria", "run1.mp4") && piece.carry(b"film"));
        assert_eq!((piece.who(), piece.name(), piece.bytes()), ("maria", "run1.mp4", &b"film"[..]));
        let bytes = [7; PIECE_BYTES + 1];
        assert!(piece.carry(bytes.get(1..).unwrap_or_default()) && piece.bytes().len() == PIECE_BYTES);
        assert!(!piece.carry(&bytes) && piece.bytes().len() == PIECE_BYTES);
        // What another build or a broken one says of the length leads nowhere.
        piece.length = u32::MAX;
        assert_eq!(piece.bytes().len(), PIECE_BYTES);
        assert!(!piece.say("maria", core::str::from_utf8(&[b'x'; 65]).unwrap_or_default()));
    }
}
