//! What of an IU its demonstrations show to matter.
//!
//! The number of strokes is law where five of six runs make as many, but for one reversal at the border. Else they are made by feel, and
//! their number has bounds. Of 80 right jobs of people who stir by feel 39 were accepted while the number was law, and 74 are.

use super::measures::{COUNTED_SHARE, do_agree, likely_reversals};
use andon_core::couple::Context;
use andon_core::segment::Measures;
use std::ops::RangeInclusive;

/// A motion with fewer reversals than this is not a repeated one. Halved and doubled, 1 and 3 of 43 jobs change, and no verdict on 314 jobs of
/// others.
pub(super) const MIN_REPEATED_REVERSALS: u32 = 3;

/// How the motion of an IU is repeated. It is decided once, from the context and from all demonstrations together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strokes {
    /// It is not.
    None,
    /// A certain number of times.
    Counted,
    /// By feel: the demonstrations do not agree in the number.
    ByFeel,
}

impl Strokes {
    pub(super) fn of(context: Context, shown: &[Measures]) -> Self {
        let is_once = |measures: &Measures| measures.reversals < MIN_REPEATED_REVERSALS;
        if !context.is_touch() || shown.iter().any(is_once) {
            Self::None
        } else if do_agree(&likely_reversals(shown).collect::<Vec<_>>(), COUNTED_SHARE) {
            Self::Counted
        } else {
            Self::ByFeel
        }
    }
}

/// Whether a hand comes to take a part away from where it lies. What has been taken has been taken, however quickly.
pub(super) fn is_taking(contexts: &[Context], index: usize) -> bool {
    let is_touch = |index: usize| contexts.get(index).is_some_and(|context| context.is_touch());
    is_touch(index) && !index.checked_sub(1).is_some_and(is_touch) && is_touch(index + 1)
}

/// Whether the hand is on its way with a part.
pub(super) fn is_on_the_way(context: Context) -> bool {
    context.is_touch() && !context.is_pair()
}

/// The IUs of the way to which one of these belongs. They are the one on the way, and the one at the part that it leads to, if it leads to one.
pub(super) fn way_of(contexts: &[Context], index: usize) -> Option<RangeInclusive<usize>> {
    let begin = [Some(index), index.checked_sub(1)]
        .into_iter()
        .flatten()
        .find(|begin| is_on_the_way(contexts[*begin]))?;
    let with = |context: &Context| context.0[..2] == contexts[begin].0[..2];
    let end = begin + usize::from(contexts.get(begin + 1).is_some_and(with));
    (begin..=end).contains(&index).then_some(begin..=end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_takes_what_it_goes_on_with_and_did_not_hold_before_and_then_brings_it_to_another_part() {
        let contexts = [
            [1, 5, 5, 3],
            [1, 5, 0, 0],
            [1, 5, 5, 2],
            [0, 0, 5, 2],
            [1, 5, 5, 2],
            [1, 5, 0, 0],
            [1, 5, 5, 3],
        ]
        .map(Context);
        let taking: Vec<usize> = (0..contexts.len()).filter(|index| is_taking(&contexts, *index)).collect();
        assert_eq!(taking, [0, 4]);
        let ways: Vec<_> = (0..contexts.len()).map(|index| way_of(&contexts, index)).collect();
        let (first, second) = (Some(1..=2), Some(5..=6));
        assert_eq!(ways, [None, first.clone(), first, None, None, second.clone(), second]);
        assert_eq!(way_of(&contexts[..2], 1), Some(1..=1));
    }
}
