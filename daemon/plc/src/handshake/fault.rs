//! The state of the station, as the PLC sees it.

/// Why `ready` is not set. The numbers are on the registers: one that is not used any more is never used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Fault {
    /// No frames come from the camera.
    Camera = 2,
    /// A process of the station is gone.
    Role = 3,
    /// The station does not see its bench.
    Sight = 4,
    /// The journal has not confirmed a verdict in time.
    Journal = 5,
    /// The judge does not answer, or does not take back the job that the PLC has loaded.
    Command = 6,
    /// A verdict came with a level or an outcome that this build does not know.
    ForeignVerdict = 7,
}

impl Fault {
    /// Every fault, in the order of its number.
    pub const ALL: [Self; 6] =
        [Self::Camera, Self::Role, Self::Sight, Self::Journal, Self::Command, Self::ForeignVerdict];

    /// The fault of this number.
    pub fn of_number(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| *fault as u16 == number)
    }

    /// What it means, and the remedy.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Camera => "no frames come from the camera: check its cable and its power",
            Self::Role => {
                "a process of the station has ended, hangs or gets no data in time: `andond status` names it, and systemd restarts one that has ended"
            }
            Self::Sight => {
                "the station does not see its bench: the code in the detail says why and what to do"
            }
            Self::Journal => {
                "the journal has not confirmed a verdict in time: check the disk, and `andond status` for the role journal"
            }
            Self::Command => {
                "the judge does not answer, or does not take back the job that was loaded: `andond status`, and the log of the role judge"
            }
            Self::ForeignVerdict => {
                "a verdict came from another version of the program: install one version on the whole PC"
            }
        }
    }
}

/// The state of the station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Not all roles are up yet, and nothing is wrong.
    Starting,
    /// Every role of the line runs.
    Ready,
    /// Something is wrong.
    Fault {
        /// What is wrong.
        fault: Fault,
        /// The number in the code `AND-n` of the log line that says more; 0 where there is none.
        detail: u32,
    },
}
