//! The alignment of the IUs of an activity with those of a nominal one: by their contexts, with the fewest edits.

use crate::capacity::ACTIVITY_IUS;
use crate::couple::Context;
use crate::job::NominalIu;

/// The edit distances of the contexts so far to each beginning of a nominal activity. A context that is left out, extra or
/// different is one edit. This is the newest row of the matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alignment {
    edits: [u16; ACTIVITY_IUS + 1],
}

impl Alignment {
    /// Before the first IU.
    pub(super) fn new() -> Self {
        Self { edits: core::array::from_fn(|left_out| left_out as u16) }
    }

    /// Takes the context of the next IU and returns the index of the nominal IU of this context, if an alignment with the fewest
    /// edits pairs the two. Of several indices it is the last one, which aligns the most IUs.
    pub(super) fn step(&mut self, nominal: &[NominalIu<'_>], context: Context) -> Option<usize> {
        let edits = &mut self.edits[..=nominal.len().min(ACTIVITY_IUS)];
        let mut diagonal = edits[0];
        edits[0] = edits[0].saturating_add(1);
        let mut matched: Option<(u16, usize)> = None;
        let mut min = edits[0];
        for (index, iu) in nominal.iter().enumerate().take(ACTIVITY_IUS) {
            let same = iu.context == context;
            let aligned = diagonal.saturating_add(u16::from(!same));
            diagonal = edits[index + 1];
            let shifted = diagonal.min(edits[index]).saturating_add(1);
            edits[index + 1] = aligned.min(shifted);
            min = min.min(edits[index + 1]);
            if same && aligned <= shifted && matched.is_none_or(|(best, _)| aligned <= best) {
                matched = Some((aligned, index));
            }
        }
        matched.filter(|(edits, _)| *edits == min).map(|(_, index)| index)
    }

    /// The fewest edits so far.
    pub(super) fn min_edits(&self, nominal: &[NominalIu<'_>]) -> u16 {
        self.edits[..=nominal.len().min(ACTIVITY_IUS)].iter().copied().min().unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::job::MeasureBounds;
    use std::vec::Vec;

    /// The index with which each IU is aligned. Every letter is a context.
    fn indices(nominal: &str, actual: &str) -> Vec<Option<usize>> {
        let context = |letter: char| Context([1, letter as u16, 0, 0]);
        let any = Bounds { min: 0, max: u32::MAX };
        let ius: Vec<NominalIu<'_>> = nominal
            .chars()
            .map(|letter| NominalIu {
                context: context(letter),
                reference: &[],
                threshold: 0.0,
                frames: any,
                reversals: any,
                measures: MeasureBounds::ANY,
            })
            .collect();
        let mut alignment = Alignment::new();
        actual.chars().map(|letter| alignment.step(&ius, context(letter))).collect()
    }

    #[test]
    fn a_right_sequence_is_aligned_index_by_index() {
        assert_eq!(indices("gpgr", "gpgr"), [Some(0), Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn a_wrong_iu_does_not_make_the_next_one_wrong() {
        assert_eq!(indices("gpgr", "gxgr"), [Some(0), None, Some(2), Some(3)]);
    }

    #[test]
    fn an_extra_iu_does_not_make_the_following_ones_wrong() {
        assert_eq!(indices("abcd", "abxcd"), [Some(0), Some(1), None, Some(2), Some(3)]);
        // A touch in between splits the grasp; the end is found again.
        assert_eq!(indices("gpgr", "gxgpgr"), [Some(0), None, Some(2), Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn a_missing_iu_does_not_make_the_following_ones_wrong() {
        assert_eq!(indices("abcd", "acd"), [Some(0), Some(2), Some(3)]);
        assert_eq!(indices("gpg", "pg"), [Some(1), Some(2)]);
    }

    #[test]
    fn an_unknown_context_is_aligned_with_nothing() {
        assert_eq!(indices("ab", "xyz"), [None, None, None]);
    }
}
