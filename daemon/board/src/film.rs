//! The pictures around an event, and what a browser wants of them. A disk has them, so the program that reads it answers later.

use andon_http::{Later, Response};
use shm_schemas::{MessageId, Verdict};

use crate::access::Visitor;
use crate::address::Address;
use crate::answer::{HTML, SVG};
use crate::board::Board;
use crate::page;
use crate::picture::Picture;

/// Browsers that wait at once. A page asks for some pictures ahead.
const MOST: usize = 32;

/// The pictures around an event.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Film {
    /// The name of the clip that has them.
    pub clip: String,
    /// When each was taken, in milliseconds since the one that the event was decided on, in their order; empty where the clip has none.
    pub times_ms: Vec<i64>,
}

impl Film {
    /// The picture that the event was decided on, or the last one before it.
    pub(crate) fn decided(&self) -> usize {
        self.times_ms.partition_point(|time_ms| *time_ms <= 0).saturating_sub(1)
    }
}

/// Why there is no film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFilm {
    /// No clip shows this event: none was recorded, or it was removed.
    NoClip,
    /// There is one, and it cannot be read.
    Unreadable,
}

impl NoFilm {
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::NoClip => "clip.none",
            Self::Unreadable => "clip.unreadable",
        }
    }
}

/// What a browser wants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Which pictures there are: [`crate::Board::film`] answers.
    Film,
    /// The picture with this number: [`crate::Board::frame`] answers.
    Frame(usize),
    /// The recording with this name, if there is one: [`Ask::answer`] answers, with its bytes.
    Recording(String),
}

/// A browser that waits for something of a clip.
#[derive(Debug)]
pub struct Ask {
    /// What it wants.
    pub wanted: Wanted,
    /// The verdict of the event.
    pub event: MessageId,
    /// When that was decided, nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
    address: Address,
    /// Who asks: a page says so at its foot.
    visitor: Visitor,
    later: Later,
}

impl Ask {
    /// Whether the browser has left, or was told that nobody answers.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.later.is_over()
    }

    /// Answers it.
    pub fn answer(self, response: Response) {
        self.later.send(response);
    }
}

/// Those that nobody has taken yet.
#[derive(Debug, Default)]
pub(crate) struct Asks(Vec<Ask>);

impl Asks {
    /// One more, with the promise that it gets now.
    pub(crate) fn add(
        &mut self,
        wanted: Wanted,
        event: &Verdict,
        address: Address,
        visitor: &Visitor,
    ) -> Response {
        self.0.retain(|ask| !ask.is_over());
        if self.0.len() >= MOST {
            return Response::text(503, "as many browsers wait for clips as can be served\n");
        }
        let (response, later) = Response::later();
        let (event, decided_utc_ns) = (event.stamp.id(), event.decided_utc_ns);
        self.0.push(Ask { wanted, event, decided_utc_ns, address, visitor: visitor.clone(), later });
        response
    }
}

impl Board {
    /// What browsers have asked of clips since this was called last. Each waits some seconds for its answer.
    #[must_use]
    pub fn asks(&mut self) -> Vec<Ask> {
        std::mem::take(&mut self.asks.0)
    }

    /// The film of an event, or why there is none, for a browser that has asked for [`Wanted::Film`].
    pub fn film(&self, ask: Ask, film: &Result<Film, NoFilm>) {
        let page = page::whole(self, &ask.address, &ask.visitor, Some(film));
        ask.answer(Response::ok(HTML, page));
    }

    /// A picture of a film, for a browser that has asked for [`Wanted::Frame`].
    pub fn frame(&self, ask: Ask, picture: &Picture) {
        let drawn = page::drawn(self, &ask.address, picture);
        ask.answer(Response::ok(SVG, drawn));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_that_was_decided_on_is_the_last_one_that_is_not_after_it() {
        let decided = |times_ms: &[i64]| Film { times_ms: times_ms.into(), ..Film::default() }.decided();
        assert_eq!([decided(&[-66, -33, 0, 33]), decided(&[-66, -33, 12]), decided(&[40, 80])], [2, 1, 0]);
    }
}
