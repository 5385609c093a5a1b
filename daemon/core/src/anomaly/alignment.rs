//! Where the IUs of an activity lie on a nominal one, by their contexts, with the least edits.

use crate::capacity::ACTIVITY_IUS;
use crate::couple::Context;
use crate::job::NominalIu;

/// The edit distances of the contexts so far to each beginning of a nominal activity: a context that is left out, extra or
/// another one is an edit. One row of the matrix at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alignment {
    edits: [u16; ACTIVITY_IUS + 1],
}

impl Alignment {
    /// Before the first IU.
    pub(super) fn new() -> Self {
        Self { edits: core::array::from_fn(|left_out| left_out as u16) }
    }

    /// Takes the context of the next IU and gives the place of the nominal IU that it is, if a least alignment says so; the last such
    /// place, where more IUs are aligned than before the others.
    pub(super) fn step(&mut self, nominal: &[NominalIu<'_>], context: Context) -> Option<usize> {
        let edits = &mut self.edits[..=nominal.len().min(ACTIVITY_IUS)];
        let mut diagonal = edits[0];
        edits[0] = edits[0].saturating_add(1);
        let mut matched: Option<(u16, usize)> = None;
        let mut least = edits[0];
        for (place, iu) in nominal.iter().enumerate().take(ACTIVITY_IUS) {
            let same = iu.context == context;
            let aligned = diagonal.saturating_add(u16::from(!same));
            diagonal = edits[place + 1];
            let shifted = diagonal.min(edits[place]).saturating_add(1);
            edits[place + 1] = aligned.min(shifted);
            least = least.min(edits[place + 1]);
            if same && aligned <= shifted && matched.is_none_or(|(best, _)| aligned <= best) {
                matched = Some((aligned, place));
            }
        }
        matched.filter(|(edits, _)| *edits == least).map(|(_, place)| place)
    }

    /// Least edits so far.
    pub(super) fn least(&self, nominal: &[NominalIu<'_>]) -> u16 {
        self.edits[..=nominal.len().min(ACTIVITY_IUS)].iter().copied().min().unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Bounds;
    use std::vec::Vec;

    /// The place that each IU is aligned to, where every letter is a context.
    fn places(nominal: &str, seen: &str) -> Vec<Option<usize>> {
        let context = |letter: char| Context([1, letter as u16, 0, 0]);
        let any = Bounds { least: 0, most: u32::MAX };
        let ius: Vec<NominalIu<'_>> = nominal
            .chars()
            .map(|letter| NominalIu {
                context: context(letter),
                reference: &[],
                threshold: 0.0,
                frames: any,
                reversals: any,
            })
            .collect();
        let mut alignment = Alignment::new();
        seen.chars().map(|letter| alignment.step(&ius, context(letter))).collect()
    }

    #[test]
    fn a_right_sequence_is_aligned_place_by_place() {
        assert_eq!(places("gpgr", "gpgr"), [Some(0), Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn a_wrong_iu_does_not_condemn_the_next() {
        assert_eq!(places("gpgr", "gxgr"), [Some(0), None, Some(2), Some(3)]);
    }

    #[test]
    fn an_extra_iu_does_not_condemn_what_follows() {
        assert_eq!(places("abcd", "abxcd"), [Some(0), Some(1), None, Some(2), Some(3)]);
        // A touch in between that splits the grasp: the end is found again.
        assert_eq!(places("gpgr", "gxgpgr"), [Some(0), None, Some(2), Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn a_left_out_iu_does_not_condemn_what_follows() {
        assert_eq!(places("abcd", "acd"), [Some(0), Some(2), Some(3)]);
        assert_eq!(places("gpg", "pg"), [Some(1), Some(2)]);
    }

    #[test]
    fn what_belongs_nowhere_is_aligned_to_nothing() {
        assert_eq!(places("ab", "xyz"), [None, None, None]);
    }
}
