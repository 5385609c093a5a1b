//! The words for what the line cannot see. They are the same in the log, in `andond status`, in `andond tail`, in the journal and for the PLC.

use andon_host::config::Config;
use andon_host::log::{Code, code};
use andon_perception::sight::{Expected, Trouble};
use shm_schemas::{Health, RoleId, Sight};

/// What is expected of a recording at this station.
pub fn expected(config: &Config) -> Expected {
    Expected {
        rate_hz: None,
        hands: !config.perception.hands.is_empty(),
        is_calibrated: config.bench.calibration.is_some(),
    }
}

/// What a trouble is called on the channel `health`.
pub fn of_trouble(trouble: Trouble) -> Sight {
    match trouble {
        Trouble::Frozen => Sight::Frozen,
        Trouble::Black => Sight::Black,
        Trouble::White => Sight::White,
        Trouble::Covered => Sight::Covered,
        Trouble::Blurred => Sight::Blurred,
        Trouble::Noisy => Sight::Noisy,
        Trouble::CameraMoved => Sight::CameraMoved,
        Trouble::TooFewFrames => Sight::TooFewFrames,
        Trouble::NoMarkers => Sight::NoMarkers,
        Trouble::NoHands => Sight::NoHands,
    }
}

/// What the health of a role says of the line's sight, where something is wrong with it.
pub fn trouble_of(health: &Health) -> Option<Sight> {
    let sight = Sight::try_from(health.sight).ok()?;
    (health.role == RoleId::Perceive.code() && sight != Sight::Clear).then_some(sight)
}

/// Finds when the line stops seeing its bench and when it sees it again.
#[derive(Debug, Default)]
pub struct SightChanges {
    trouble: Option<Sight>,
    /// When the newest message was sent, in nanoseconds of the monotonic clock.
    newest_ns: u64,
}

/// What was wrong before, and what is wrong now.
#[derive(Clone, Copy, Debug)]
pub struct SightChange {
    /// `None` where nothing was.
    pub before: Option<Sight>,
    /// `None` where nothing is.
    pub now: Option<Sight>,
}

impl SightChanges {
    /// Takes what a role says of itself.
    pub fn receive(&mut self, health: &Health) -> Option<SightChange> {
        // Messages of two starts of a role are in no order between them.
        let is_old = health.stamp.sent_ns < self.newest_ns;
        if health.role != RoleId::Perceive.code() || health.sight == 0 || is_old {
            return None;
        }
        self.newest_ns = health.stamp.sent_ns;
        let now = trouble_of(health);
        let before = std::mem::replace(&mut self.trouble, now);
        (before != now).then_some(SightChange { before, now })
    }
}

/// The code that the log has for it; its meaning is the sentence that people read. `None` where nothing is wrong.
pub fn code(sight: Sight) -> Option<&'static Code> {
    Some(match sight {
        Sight::Clear => return None,
        Sight::Frozen => &code::PICTURE_FROZEN,
        Sight::Black => &code::PICTURE_BLACK,
        Sight::White => &code::PICTURE_WHITE,
        Sight::Covered => &code::LENS_COVERED,
        Sight::Blurred => &code::PICTURE_BLURRED,
        Sight::Noisy => &code::PICTURE_NOISY,
        Sight::CameraMoved => &code::CAMERA_MOVED,
        Sight::TooFewFrames => &code::TOO_FEW_FRAMES,
        Sight::NoMarkers => &code::MARKERS_FOREIGN,
        Sight::NoHands => &code::HANDS_NOT_FOUND,
    })
}

/// How many pictures per second are processed, how many come, and how many the job needs, as far as that is known. It follows the meaning of the code
/// for too few.
pub fn rates(processed_hz: f32, expected_hz: Option<f32>, needed_hz: Option<f32>) -> String {
    let expected = expected_hz.map(|expected_hz| format!(" of {expected_hz:.1}")).unwrap_or_default();
    let needed = needed_hz.map(|needed_hz| format!(", and the job needs {needed_hz:.1}")).unwrap_or_default();
    format!(": {processed_hz:.1}{expected} per second{needed}")
}

/// The one word for it in `andond status`.
pub fn word(sight: Sight) -> &'static str {
    match sight {
        Sight::Clear => "Clear",
        Sight::TooFewFrames => "SLOW",
        _ => "BLIND",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages of two starts of a role are in no order between them.
    #[test]
    fn what_an_older_start_has_seen_and_is_read_later_changes_nothing() {
        let mut changes = SightChanges::default();
        let mut receive = |sight: Sight, sent_ns: u64| {
            let mut health =
                Health { role: RoleId::Perceive.code(), sight: sight.code(), ..Health::default() };
            health.stamp.sent_ns = sent_ns;
            changes.receive(&health).map(|change| change.now)
        };
        assert_eq!(receive(Sight::Frozen, 10), Some(Some(Sight::Frozen)));
        assert_eq!(receive(Sight::Clear, 30), Some(None));
        assert_eq!(receive(Sight::Frozen, 20), None);
        assert_eq!(receive(Sight::Clear, 40), None);
    }
}
