//! The board: pages that show a station, to the worker from three metres and to the technician from near.
//!
//! [`Board`] takes what the channels of the line say, and answers browsers. It knows neither channels nor files nor a clock. The role `board` of `andond`
//! reads those, and calls it. What it shows is made in one place, on the server. A browser without scripts reads the same page as one with scripts,
//! which gets what has changed as server-sent events.
//!
//! # Why a browser can do no harm
//!
//! - Who asks for what is decided in one place, by one table ([`access`]), before anything else is looked at.
//! - GET and HEAD change nothing. A form is taken from a page of the board alone: `Origin` says so, and a token of its session that no other site can
//!   read. What it asks for is a command to the line, which the role sends; the board itself writes nothing.
//! - A session is a random token in a cookie that no script reads and no other site sends. The board keeps its hash.
//! - A path is compared with known ones and never becomes a file name. The name of a recording is text that is compared with the names of those there are.
//! - Of a query only letters, digits, dots, dashes and underscores are read ([`address`]).
//! - What stands on a page is either a constant of this crate or escaped: [`html::Html`] takes nothing else.
//! - A page of another site cannot read it by a trick of its DNS ([`guard`]), cannot load or frame a part of it, and runs no script on it.
#![forbid(unsafe_code)]

mod access;
mod address;
mod answer;
mod audited;
mod board;
mod clips;
mod code;
mod confirm;
mod desk;
mod film;
mod form;
mod guard;
mod html;
mod inbox;
mod job;
mod line;
mod look;
mod order;
mod page;
mod picture;
mod piece;
mod pieces;
#[cfg(test)]
mod sample;
mod shift;
mod told;
mod viewers;
mod watchers;
mod words;

pub use access::{Login, Logins, LoginsError, MAX_NAME, Rank, Tried, Try};
pub use audited::Audited;
pub use board::{Board, Past, Settings};
pub use clips::Clips;
pub use code::Code;
pub use confirm::{Asked, Kept, Was};
pub use desk::{Fetch, Known, KnownJob, MadeFile, Measured, Version};
pub use film::{Ask, Film, NoFilm, Wanted};
pub use inbox::{Inbox, Said};
pub use job::{Job, Step};
pub use line::{Ill, Line, Stop};
pub use look::Finding;
pub use order::{Order, Ordered, Piece};
pub use picture::{Picture, Thing, Visibility, What};
pub use words::{TableError, Tables};
