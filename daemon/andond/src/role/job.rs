//! When a job begins, for the log: with the first touch, and again with the first touch after it has ended.

use andon_core::couple::Couples;

/// Follows what the hands touch.
#[derive(Default)]
pub(super) struct JobWatch {
    open: bool,
    touching: [bool; 2],
    /// The newest couples began a touch.
    touched: bool,
}

impl JobWatch {
    /// Takes couples before they are judged. Whether a job begins with them.
    pub(super) fn begins(&mut self, couples: &Couples) -> bool {
        let touching = [0, 1].map(|hand: usize| couples.hands[hand].context.is_touch());
        self.touched = touching.iter().zip(self.touching).any(|(now, before)| *now && !before);
        self.touching = touching;
        let begins = self.touched && !self.open;
        self.open |= self.touched;
        begins
    }

    /// The job has ended. Whether the touch that ended it begins the next one.
    pub(super) fn ended(&mut self) -> bool {
        self.open = self.touched;
        self.open
    }

    /// A job has been begun by command, or ended by one.
    pub(super) fn commanded(&mut self, open: bool) {
        (self.open, self.touched) = (open, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::{Context, Couple};
    use andon_core::input::Side;

    fn couples(right: u16, left: u16) -> Couples {
        let hand = |side: Side, object: u16| Couple {
            context: if object == 0 { Context::IDLE } else { Context([side as u16, object, 0, 0]) },
            ..Couple::idle(side, 0)
        };
        Couples { captured_ns: 0, known_ns: 0, hands: [hand(Side::Right, right), hand(Side::Left, left)] }
    }

    #[test]
    fn a_job_begins_with_the_first_touch_and_not_with_the_next() {
        let mut watch = JobWatch::default();
        let begun = [(0, 0), (5, 0), (5, 0), (0, 0), (6, 7)].map(|(r, l)| watch.begins(&couples(r, l)));
        assert_eq!(begun, [false, true, false, false, false]);
    }

    #[test]
    fn after_its_end_a_job_begins_with_a_new_touch_and_not_with_one_that_lasts() {
        let mut watch = JobWatch::default();
        assert!(watch.begins(&couples(5, 0)));
        assert!(!watch.begins(&couples(5, 0)));
        assert!(!watch.ended());
        assert!(!watch.begins(&couples(5, 0)), "the hand has not let go yet");
        assert!(watch.begins(&couples(5, 6)), "the other hand begins");
    }

    #[test]
    fn the_touch_that_ends_a_job_begins_the_next() {
        let mut watch = JobWatch::default();
        assert!(watch.begins(&couples(5, 0)));
        assert!(!watch.begins(&couples(5, 6)));
        assert!(watch.ended());
    }
}
