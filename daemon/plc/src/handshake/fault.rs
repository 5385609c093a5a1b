//! What is wrong with the line, as the PLC sees it.

/// Why `ready` is not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Fault {
    /// The verdict channel cannot be read, or its writer is gone.
    Channel = 1,
    /// No frames come from the camera.
    Camera = 2,
    /// A process of the line is gone.
    Role = 3,
    /// The markers or the hand that the job rests on are out of sight.
    Sight = 4,
    /// The journal has not confirmed a verdict in time.
    Journal = 5,
    /// A command could not be handed to the line.
    Command = 6,
    /// A verdict came whose code this build does not know.
    ForeignVerdict = 7,
    /// Nothing has been heard of the line in time.
    Silence = 8,
}

impl Fault {
    /// Every fault, in the order of the numbers.
    pub const ALL: [Self; 8] = [
        Self::Channel,
        Self::Camera,
        Self::Role,
        Self::Sight,
        Self::Journal,
        Self::Command,
        Self::ForeignVerdict,
        Self::Silence,
    ];

    /// What it means and what to do.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Channel => {
                "the verdict channel cannot be read, or its writer is gone: look at `andond status`, role judge"
            }
            Self::Camera => "no frames come from the camera: check its cable and power",
            Self::Role => "a process of the line is gone: `andond status` names it, systemd starts it again",
            Self::Sight => "the markers or the hand that the job rests on are out of sight: clear the view",
            Self::Journal => {
                "the journal has not confirmed a verdict in time: check the disk and the role journal"
            }
            Self::Command => "a command could not be handed to the line: look at `andond status`, role judge",
            Self::ForeignVerdict => "a verdict came from another build: install one version on the whole PC",
            Self::Silence => "nothing has been heard of the line in time: look at `andond status`",
        }
    }
}

/// How the line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Not all roles are up yet, and nothing is wrong.
    Starting,
    /// Every role of the line runs.
    Ready,
    /// Something is wrong.
    Fault {
        /// What.
        fault: Fault,
        /// The number in the code `AND-n` of the log line that says more; 0 where there is none.
        detail: u32,
    },
}
