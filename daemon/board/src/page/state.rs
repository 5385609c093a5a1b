//! The state of the station in one word.

use crate::board::Board;
use crate::line::{Line, Stop};
use crate::piece::Standing;

/// How long a right piece is shown as such, before the page is quiet again.
const GOOD_NS: u64 = 10_000_000_000;

/// The state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// Not all roles are up yet.
    Starting,
    /// It does not watch.
    Stopped(Stop),
    /// The PLC has not enabled it.
    Off,
    /// No job is loaded.
    NoJob,
    /// It waits for the next piece.
    Ready,
    /// It watches a piece, and nothing is wrong.
    Working,
    /// Something should be looked at.
    Check,
    /// Something could not be judged.
    NotJudged,
    /// Something is wrong.
    Fault,
    /// The piece is right.
    Good,
}

impl State {
    /// The key of its word, and its name in the style.
    pub(super) const fn keys(self) -> (&'static str, &'static str) {
        match self {
            Self::Starting => ("state.Starting", "quiet"),
            Self::Stopped(_) => ("state.Stopped", "stopped"),
            Self::Off => ("state.Off", "quiet"),
            Self::NoJob => ("state.NoJob", "quiet"),
            Self::Ready => ("state.Ready", "quiet"),
            Self::Working => ("state.Working", "quiet"),
            Self::Check => ("state.Check", "check"),
            Self::NotJudged => ("state.NotJudged", "unjudged"),
            Self::Fault => ("state.Fault", "fault"),
            Self::Good => ("state.Good", "good"),
        }
    }

    /// The key of what helps a line that does not watch.
    pub(super) fn help(self) -> Option<String> {
        match self {
            Self::Stopped(stop) => Some(stop.key()),
            Self::NoJob => Some("stop.NoJob".to_owned()),
            _ => None,
        }
    }

    /// Whether the piece has something to tell.
    pub(super) const fn tells(self) -> bool {
        matches!(self, Self::Check | Self::NotJudged | Self::Fault)
    }
}

/// The state of the station now.
pub(crate) fn state(board: &Board) -> State {
    match (board.line, board.judging) {
        (Line::Stopped(stop), _) => State::Stopped(stop),
        (Line::Starting, _) | (_, None) => State::Starting,
        (Line::NoJob, _) => State::NoJob,
        (Line::Ready, Some(_)) if board.has_no_job() => State::NoJob,
        (Line::Ready, Some(judging)) if judging.is_enabled == 0 => State::Off,
        (Line::Ready, Some(_)) => of_piece(board),
    }
}

fn of_piece(board: &Board) -> State {
    match (board.piece.standing(), board.piece.ended_ns()) {
        (Standing::Wrong, _) => State::Fault,
        (Standing::NotJudged, _) => State::NotJudged,
        (Standing::Noted, _) => State::Check,
        (Standing::Right, Some(ended_ns)) if board.now_ns.saturating_sub(ended_ns) < GOOD_NS => State::Good,
        (Standing::Right, _) if board.piece.has_begun() || board.is_running() => State::Working,
        (Standing::Right, _) => State::Ready,
    }
}
