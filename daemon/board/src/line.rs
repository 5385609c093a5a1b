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

/// What is the matter with a role of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ill {
    /// It has started again.
    Restarted,
    /// It has not been heard yet.
    Unheard,
    /// A process has gone; it is not known yet which.
    Gone,
    /// It gives no sign of life.
    Silent,
    /// It does not see its bench.
    Blind,
    /// It has not done a step yet.
    Starting,
    /// It is at the end of its recording.
    Ended,
    /// It gets no frames.
    NoFrames,
    /// Its input has fallen silent, or comes too late.
    Waiting,
    /// It cannot work.
    Unable,
    /// It cannot write.
    Unwritten,
    /// It is of another version.
    OtherVersion,
}

impl Ill {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 12] = [
        Self::Restarted,
        Self::Unheard,
        Self::Gone,
        Self::Silent,
        Self::Blind,
        Self::Starting,
        Self::Ended,
        Self::NoFrames,
        Self::Waiting,
        Self::Unable,
        Self::Unwritten,
        Self::OtherVersion,
    ];

    /// The key of the sentence that says so of a role.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Restarted => "ill.Restarted",
            Self::Unheard => "ill.Unheard",
            Self::Gone => "ill.Gone",
            Self::Silent => "ill.Silent",
            Self::Blind => "ill.Blind",
            Self::Starting => "ill.Starting",
            Self::Ended => "ill.Ended",
            Self::NoFrames => "ill.NoFrames",
            Self::Waiting => "ill.Waiting",
            Self::Unable => "ill.Unable",
            Self::Unwritten => "ill.Unwritten",
            Self::OtherVersion => "ill.OtherVersion",
        }
    }
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
