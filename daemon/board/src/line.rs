//! How the line is.

use shm_schemas::Sight;

/// Whether the line could judge a piece now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// Not all roles are up yet, and nothing is wrong.
    #[default]
    Starting,
    /// All that comes before the judge runs, and the judge has no job.
    NoJob,
    /// It watches.
    Ready,
    /// It does not watch.
    Stopped(Stop),
}

/// Why a line does not watch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// No pictures come.
    Camera,
    /// It does not see its bench.
    Sight(Sight),
    /// Verdicts cannot be kept.
    Journal,
    /// A process is gone, hangs or gets nothing.
    Role,
    /// Its recording is at its end.
    Ended,
}

impl Stop {
    /// The key of the sentence that says so.
    pub(crate) fn key(self) -> String {
        match self {
            Self::Camera => "stop.Camera".to_owned(),
            Self::Journal => "stop.Journal".to_owned(),
            Self::Role => "stop.Role".to_owned(),
            Self::Ended => "stop.Ended".to_owned(),
            Self::Sight(sight) => format!("stop.{}", sight.name()),
        }
    }
}
