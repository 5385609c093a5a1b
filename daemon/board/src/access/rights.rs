//! Who may see and do what. It is one table: what is not in it does not exist.

use andon_http::Request;
use serde::{Deserialize, Serialize};

use crate::address::{Address, Page};

/// What a login is for. Each may do what those before it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rank {
    /// Sees the worker's page.
    Worker,
    /// Sees the technician's page, and says whether a verdict was right.
    Technician,
    /// Teaches.
    Engineer,
}

impl Rank {
    /// All of them, in their order.
    pub const ALL: [Self; 3] = [Self::Worker, Self::Technician, Self::Engineer];

    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Worker => "worker",
            Self::Technician => "technician",
            Self::Engineer => "engineer",
        }
    }
}

/// What a request needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    /// Nothing: it shows nothing of the station.
    Nothing,
    /// To see; where all who reach the board may read, nothing.
    ToRead(Rank),
    /// To act: a session of such a login, and a form that a page of the board has sent.
    ToAct(Rank),
}

/// Where the pictures, stills and recordings of events are.
pub(crate) const FILM: &str = "/technician/film/";

/// An address that the board answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Page(Page),
    /// What changes on a page.
    Events(Page),
    Picture,
    /// A picture, the still or the recording of an event.
    Film,
    Style,
    Script,
    Player,
    LogIn,
    LogOut,
    Kiosk,
    Confirm,
}

impl Place {
    /// The place of a request. A path is compared, and never becomes a file name.
    pub(crate) fn of(request: &Request) -> Option<Self> {
        Some(match request.path.as_str() {
            "/events" => Self::Events(Address::of_events(&request.query).page),
            "/picture.svg" => Self::Picture,
            "/board.css" => Self::Style,
            "/board.js" => Self::Script,
            "/player.js" => Self::Player,
            "/login" => Self::LogIn,
            "/logout" => Self::LogOut,
            "/kiosk" => Self::Kiosk,
            "/confirm" => Self::Confirm,
            path if path.starts_with(FILM) => Self::Film,
            path => Self::Page(Page::at(path)?),
        })
    }

    /// The rank that sees a page.
    pub(crate) const fn reader(page: Page) -> Rank {
        match page {
            Page::Worker => Rank::Worker,
            Page::Technician | Page::Event | Page::Explain => Rank::Technician,
        }
    }

    /// What is needed to get it.
    pub(crate) const fn get(self) -> Option<Needs> {
        Some(match self {
            Self::Page(page) | Self::Events(page) => Needs::ToRead(Self::reader(page)),
            Self::Picture | Self::Film => Needs::ToRead(Rank::Technician),
            Self::Style | Self::Script | Self::Player | Self::LogIn | Self::Kiosk => Needs::Nothing,
            Self::LogOut | Self::Confirm => return None,
        })
    }

    /// What is needed to send a form there.
    pub(crate) const fn post(self) -> Option<Needs> {
        Some(match self {
            Self::LogIn => Needs::Nothing,
            Self::LogOut => Needs::ToAct(Rank::Worker),
            Self::Confirm => Needs::ToAct(Rank::Technician),
            Self::Page(_)
            | Self::Events(_)
            | Self::Picture
            | Self::Film
            | Self::Style
            | Self::Script
            | Self::Player
            | Self::Kiosk => return None,
        })
    }
}
