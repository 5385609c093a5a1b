//! What a shop floor does to a job, and what the judge must make of it.

/// What goes wrong, or looks as if it did, in the paper's second job: to polish the brick, then to measure it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flaw {
    /// Nothing.
    None,
    /// The paper's `J1`: polishing stops halfway, 3 strokes of 6.
    J1,
    /// The paper's `J2`: the brick is taken, moved a little and put down, but never measured.
    J2,
    /// The brick is rubbed with the meter instead of the polisher.
    WrongObject,
    /// The brick is measured first and polished afterwards.
    WrongOrder,
    /// The polisher is taken and put back without touching the brick.
    StepLeftOut,
    /// The polishing is left out.
    ActivityLeftOut,
    /// The polishing is done twice.
    StepTwice,
    /// Polishing stops after one stroke of six.
    CutShort,
    /// The brick is taken away from the meter instead of being brought to it.
    Reversed,
    /// The strokes go across the brick instead of along it.
    Across,
    /// All strokes are there, at three times the speed.
    Rushed,
    /// The left hand does all of it: a note, no anomaly.
    WrongHand,
    /// A pause of a second and a half while the brick is carried: no anomaly.
    Hesitation,
    /// The whole bench is shifted by 9 cm: no anomaly.
    Shifted,
    /// The whole bench is turned by 30 degrees: no anomaly.
    Turned,
    /// Each part is shifted by 3 cm and turned by 12 degrees: no anomaly.
    PartsMoved,
    /// The hand leaves the picture for two seconds while it polishes: not judged, or an anomaly.
    OffPicture,
    /// Everything takes twice the time: no anomaly.
    HalfSpeed,
}

impl Flaw {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::None,
        Self::J1,
        Self::J2,
        Self::WrongObject,
        Self::WrongOrder,
        Self::StepLeftOut,
        Self::ActivityLeftOut,
        Self::StepTwice,
        Self::CutShort,
        Self::Reversed,
        Self::Across,
        Self::Rushed,
        Self::WrongHand,
        Self::Hesitation,
        Self::Shifted,
        Self::Turned,
        Self::PartsMoved,
        Self::OffPicture,
        Self::HalfSpeed,
    ];

    /// The name of the flaw in the name of a recording.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::J1 => "J1",
            Self::J2 => "J2",
            Self::WrongObject => "wrong_object",
            Self::WrongOrder => "order",
            Self::StepLeftOut => "step_left_out",
            Self::ActivityLeftOut => "activity_left_out",
            Self::StepTwice => "twice",
            Self::CutShort => "cut_short",
            Self::Reversed => "reversed",
            Self::Across => "across",
            Self::Rushed => "rushed",
            Self::WrongHand => "wrong_hand",
            Self::Hesitation => "hesitation",
            Self::Shifted => "shifted",
            Self::Turned => "turned",
            Self::PartsMoved => "parts_moved",
            Self::OffPicture => "off_picture",
            Self::HalfSpeed => "half_speed",
        }
    }

    /// The verdict that the judge must give on a job with this flaw.
    pub const fn expected(self) -> Expected {
        match self {
            Self::None
            | Self::WrongHand
            | Self::Hesitation
            | Self::Shifted
            | Self::Turned
            | Self::PartsMoved
            | Self::HalfSpeed => Expected::Ok,
            Self::OffPicture => Expected::NotOk,
            _ => Expected::Anomaly,
        }
    }
}

/// The verdict that the judge must give on a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Every verdict is OK.
    Ok,
    /// There is an anomaly, and the job is not OK.
    Anomaly,
    /// There may or may not be an anomaly, but not every verdict is OK: a part of the job was not seen.
    NotOk,
}
