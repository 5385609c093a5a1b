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
    /// Sees the engineer's pages; teaches jobs and loads them.
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
    /// To see, with a session of such a login also where all who reach the board may read.
    ToEnter(Rank),
    /// To act: a session of such a login, and a form that a page of the board has sent.
    ToAct(Rank),
}

/// Where the pictures and recordings of events are.
pub(crate) const FILM: &str = "/technician/film/";

/// Where the files are that the commands of engineers make.
pub(crate) const MADE: &str = "/engineer/made/";

/// An address that the board answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Page(Page),
    /// What changes on a page.
    Events(Page),
    Picture,
    /// A picture or the recording of an event.
    Film,
    /// The picture of a step.
    Step,
    Style,
    Script,
    Sound,
    Player,
    Upload,
    LogIn,
    LogOut,
    Kiosk,
    Confirm,
    /// A file that a command of an engineer has made.
    Made,
    /// What an engineer orders.
    Order,
}

impl Place {
    /// The place of a request, on a board that shows the picture alone or not. A path is compared, and never becomes a file name.
    pub(crate) fn of(request: &Request, is_look: bool) -> Option<Self> {
        let place = match request.path.as_str() {
            "/events" => Self::Events(Address::of_events(&request.query).page),
            "/picture.svg" => Self::Picture,
            "/board.css" => Self::Style,
            "/board.js" => Self::Script,
            "/sound.js" => Self::Sound,
            "/player.js" => Self::Player,
            "/upload.js" => Self::Upload,
            "/login" => Self::LogIn,
            "/logout" => Self::LogOut,
            "/kiosk" => Self::Kiosk,
            "/confirm" => Self::Confirm,
            "/engineer/order" => Self::Order,
            path if path.starts_with(MADE) => Self::Made,
            path if path.starts_with(FILM) => Self::Film,
            path if path.starts_with("/step/") => Self::Step,
            path => Self::Page(Page::at(path, is_look)?),
        };
        // Where there is the picture alone, nobody logs in.
        let is_of_look =
            matches!(place, Self::Page(_) | Self::Events(_) | Self::Picture | Self::Style | Self::Script);
        (is_of_look || !is_look).then_some(place)
    }

    /// The rank that sees a page.
    pub(crate) const fn reader(page: Page) -> Rank {
        match page {
            Page::Worker => Rank::Worker,
            Page::Technician | Page::Event | Page::Explain | Page::Look => Rank::Technician,
            Page::Engineer | Page::Job => Rank::Engineer,
        }
    }

    /// What is needed to get it.
    pub(crate) const fn get(self) -> Option<Needs> {
        Some(match self {
            Self::Page(page @ (Page::Engineer | Page::Job))
            | Self::Events(page @ (Page::Engineer | Page::Job)) => Needs::ToEnter(Self::reader(page)),
            Self::Page(page) | Self::Events(page) => Needs::ToRead(Self::reader(page)),
            Self::Made => Needs::ToEnter(Rank::Engineer),
            Self::Picture | Self::Film => Needs::ToRead(Rank::Technician),
            Self::Step => Needs::ToRead(Rank::Worker),
            Self::Style
            | Self::Script
            | Self::Sound
            | Self::Player
            | Self::Upload
            | Self::LogIn
            | Self::Kiosk => Needs::Nothing,
            Self::LogOut | Self::Confirm | Self::Order => return None,
        })
    }

    /// What is needed to send a form there.
    pub(crate) const fn post(self) -> Option<Needs> {
        Some(match self {
            Self::LogIn => Needs::Nothing,
            Self::LogOut => Needs::ToAct(Rank::Worker),
            Self::Confirm => Needs::ToAct(Rank::Technician),
            Self::Order => Needs::ToAct(Rank::Engineer),
            Self::Page(_)
            | Self::Events(_)
            | Self::Picture
            | Self::Film
            | Self::Step
            | Self::Style
            | Self::Script
            | Self::Sound
            | Self::Player
            | Self::Upload
            | Self::Made
            | Self::Kiosk => return None,
        })
    }
}
