//! Tells what the line's own sight is worth: once in the log, and in the health of `perceive` for as long as it lasts.

use andon_host::config::Config;
use andon_host::log::{Remedy, code, log};
use andon_host::role::Liveness;
use andon_perception::Detections;
use andon_perception::sight::{Expected, Observation, Rates, Spell, Trouble};
use shm_schemas::{FrameHeader, Judging, Sight};

use crate::sight;

/// Follows what `perceive` sees.
pub(super) struct SightWatch {
    expected: Expected,
    sight: andon_perception::sight::SightMonitor,
    /// The pictures per second that the job in force needs.
    needed_hz: Option<f32>,
    newest: Option<Spell>,
    has_looked: bool,
}

impl SightWatch {
    pub(super) fn new(config: &Config) -> Self {
        let rate_hz = config.camera.source.is_live().then_some(config.camera.rate_hz);
        let expected = Expected { rate_hz, ..sight::expected(config) };
        let sight = andon_perception::sight::SightMonitor::new(expected);
        Self { expected, sight, needed_hz: None, newest: None, has_looked: false }
    }

    /// Begins with another source: nothing that was seen before holds.
    pub(super) fn begin(&mut self) {
        self.sight = andon_perception::sight::SightMonitor::new(self.expected);
        self.sight.set_needed_hz(self.needed_hz);
        (self.newest, self.has_looked) = (None, false);
    }

    /// Follows the job in force.
    pub(super) fn watch_for(&mut self, judging: &Judging) {
        self.needed_hz = Some(judging.min_rate_hz).filter(|needed_hz| *needed_hz > 0.0);
        self.sight.set_needed_hz(self.needed_hz);
    }

    /// Takes what was seen in a frame, and says whether it shows the bench. `dropped` are the frames before it that were not processed.
    pub(super) fn look(
        &mut self,
        header: &FrameHeader,
        seen: &Detections,
        dropped: u32,
        liveness: &mut Liveness,
    ) -> bool {
        let spell = self.sight.step(&Observation::new(seen, dropped));
        if spell != self.newest || !self.has_looked {
            // The frame was captured when both clocks showed this.
            let monotonic_ns =
                |at_ns: u64| header.stamp.captured_ns.saturating_sub(header.source_ns.saturating_sub(at_ns));
            match spell {
                Some(Spell { trouble, since_ns }) => {
                    let seen = sight::of_trouble(trouble);
                    liveness.sees(seen, monotonic_ns(since_ns));
                    if let Some(code) = sight::code(seen) {
                        let Rates { processed_hz, expected_hz, needed_hz } = self.sight.rates();
                        let rates = (trouble == Trouble::TooFewFrames)
                            .then(|| sight::rates(processed_hz, Some(expected_hz), needed_hz));
                        code.log_found(
                            &format_args!("{}{}", code.meaning, rates.unwrap_or_default()),
                            Remedy::OfCode,
                        );
                    }
                }
                None => {
                    liveness.sees(Sight::Clear, header.stamp.captured_ns);
                    if let Some(Spell { since_ns, .. }) = self.newest {
                        let lasted_s = header.source_ns.saturating_sub(since_ns) as f64 / 1e9;
                        log!(code::SIGHT_BACK, "after {lasted_s:.1} s");
                    }
                }
            }
            (self.newest, self.has_looked) = (spell, true);
        }
        self.sight.is_seen()
    }
}
