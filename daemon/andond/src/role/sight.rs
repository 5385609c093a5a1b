//! Tells what the line's own sight is worth: once in the log, and in the health of `perceive` for as long as it lasts.

use andon_host::log::{Remedy, code, log};
use andon_host::role::Liveness;
use andon_perception::sight::{Rates, Spell, Trouble};
use shm_schemas::{FrameHeader, Sight};

use crate::perceiving::Perceiving;
use crate::sight;

/// Follows what `perceive` sees of one source.
#[derive(Default)]
pub(super) struct SightWatch {
    newest: Option<Spell>,
    has_looked: bool,
}

impl SightWatch {
    /// Takes what keeps the line from seeing, of which this frame is the newest.
    pub(super) fn tell(
        &mut self,
        header: &FrameHeader,
        spell: Option<Spell>,
        perceiving: &Perceiving,
        liveness: &mut Liveness,
    ) {
        if spell != self.newest || !self.has_looked {
            // The frame was captured when both clocks showed this.
            let monotonic_ns =
                |at_ns: u64| header.stamp.captured_ns.saturating_sub(header.source_ns.saturating_sub(at_ns));
            match spell {
                Some(Spell { trouble, since_ns }) => {
                    let seen = sight::of_trouble(trouble);
                    liveness.sees(seen, monotonic_ns(since_ns));
                    if let Some(code) = sight::code(seen) {
                        let Rates { processed_hz, expected_hz, needed_hz } = perceiving.rates();
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
    }
}
