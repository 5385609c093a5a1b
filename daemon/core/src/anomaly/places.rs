//! Where an activity may be in a nominal one, when not all of it was seen.

use super::progress::quickest;
use crate::capacity::ACTIVITY_IUS;
use crate::couple::Context;
use crate::job::NominalIu;

// One bit for each number of IUs that may have come, from none to all.
const _: () = assert!(ACTIVITY_IUS < u64::BITS as usize);

/// The set of the numbers of IUs of a nominal activity that may have come. Empty: what was seen is not part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Places(u64);

impl Places {
    pub(super) const NONE: Self = Self(0);

    /// Before the first IU: at the beginning, or after what may have come in as many frames that were not seen.
    pub(super) fn new(hidden: u32, nominal: &[NominalIu<'_>]) -> Self {
        Self(1).or_later(hidden, nominal)
    }

    /// Those of these places at which the hand is idle before the next IU. These are the beginning, any after it has let go, and any between two IUs
    /// in the same context. What no hand touches stays as it is.
    pub(super) fn after_idle(self, nominal: &[NominalIu<'_>]) -> Self {
        let is_idle = |ius: &usize| match nominal.get(ius.wrapping_sub(1)..=*ius) {
            Some([before, next]) => before.context.is_release() || before.context == next.context,
            _ => true,
        };
        self.iter().filter(is_idle).collect()
    }

    /// Those of these places at which not all IUs have come.
    pub(super) fn before_end(self, nominal: &[NominalIu<'_>]) -> Self {
        Self(self.0 & !(1 << nominal.len()))
    }

    /// The places of both.
    pub(super) fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The places after an IU with this context has begun, where IUs may have come and gone in as many hidden frames before it. With
    /// `allows_insertions` it may be one that is not among the nominal IUs.
    pub(super) fn step(
        self,
        nominal: &[NominalIu<'_>],
        allows_insertions: bool,
        context: Context,
        hidden: u32,
    ) -> Self {
        let before = self.or_later(hidden, nominal);
        let has_context = |index: usize| nominal.get(index).is_some_and(|iu| iu.context == context);
        let next = before.iter().filter(|ius| has_context(*ius)).map(|ius| ius + 1);
        // What was not seen for a while may go on.
        let same = self.iter().filter(|ius| hidden > 0 && has_context(ius.wrapping_sub(1)));
        let inserted = before.iter().filter(|ius| allows_insertions && !has_context(*ius));
        next.chain(same).chain(inserted).collect()
    }

    /// The places after as many hidden frames in an IU with this context, or between two IUs. Another IU with this context may have begun.
    pub(super) fn resume(self, hidden: u32, nominal: &[NominalIu<'_>], context: Context) -> Self {
        let places = self.or_later(hidden, nominal);
        let has_context = |ius: usize| ius > 0 && nominal[ius - 1].context == context;
        let may_be_at = |ius: &usize| {
            let stays = places.contains(*ius) && (context == Context::IDLE || self.contains(*ius));
            let has_begun = has_context(*ius) && (places.contains(*ius) || places.contains(*ius - 1));
            stays || hidden > 0 && has_begun
        };
        (0..=nominal.len()).filter(may_be_at).collect()
    }

    /// These places, and any to which IUs may have led in as many hidden frames. An IU of which more than half is seen is not overlooked.
    /// With a quarter 35 of 3,700 drawn streams differ, and 62 with all of it.
    fn or_later(self, hidden: u32, nominal: &[NominalIu<'_>]) -> Self {
        let mut places = self;
        // For how many frames the IUs that led to the place last at least.
        let mut frames: Option<u32> = None;
        for (index, iu) in nominal.iter().enumerate().filter(|_| hidden > 0) {
            let before = if self.contains(index) { Some(0) } else { frames };
            frames = before
                .map(|before| before.saturating_add(iu.quickest()))
                .filter(|frames| frames / 2 <= hidden);
            places.0 |= u64::from(frames.is_some()) << (index + 1);
        }
        places
    }

    /// Whether all IUs may have come in as many hidden frames, and then those from the first one up to one with this context again. Half of that is not
    /// overlooked: with a quarter 8 of 3,700 drawn streams differ, and 10 with all of it.
    pub(super) fn may_be_again(self, nominal: &[NominalIu<'_>], hidden: u32, context: Context) -> bool {
        let left = self.iter().filter(|ius| *ius > 0).map(|ius| quickest(&nominal[ius..])).min();
        let begins = (0..nominal.len()).filter(|index| nominal[*index].context == context);
        let again = begins.map(|index| quickest(&nominal[..index])).min();
        left.zip(again).is_some_and(|(left, again)| left.saturating_add(again) / 2 <= hidden)
    }

    /// Whether all IUs must have come if the hand is idle, where some may have in as many hidden frames.
    pub(super) fn has_ended_if_idle(self, nominal: &[NominalIu<'_>], hidden: u32) -> bool {
        self.or_later(hidden, nominal).after_idle(nominal).is_certainly(nominal.len())
    }

    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether this number of IUs may have come.
    fn contains(self, ius: usize) -> bool {
        self.0 >> ius & 1 == 1
    }

    /// The numbers of IUs that may have come, in ascending order: the indices of those that may come next.
    pub(super) fn iter(self) -> impl Iterator<Item = usize> + Clone {
        let next = |left: &u64| Some(left & (left - 1));
        let all = core::iter::successors(Some(self.0), next).take(self.0.count_ones() as usize);
        all.map(|left| left.trailing_zeros() as usize)
    }

    /// Whether exactly this number of IUs has come.
    pub(super) fn is_certainly(self, ius: usize) -> bool {
        self.0 == 1 << ius
    }

    /// Exactly this number of IUs has come.
    pub(super) const fn at(ius: usize) -> Self {
        Self(1 << ius)
    }

    /// Whether all IUs have certainly come but for release states, which leave nothing to do.
    pub(super) fn is_at_end(self, nominal: &[NominalIu<'_>]) -> bool {
        let is_over = |ius: usize| nominal[ius..].iter().all(|iu| iu.context.is_release());
        !self.is_empty() && self.iter().all(is_over)
    }

    /// Whether all IUs may have come, if some may have in as many frames that were hidden since the newest began.
    pub(super) fn may_be_complete(self, nominal: &[NominalIu<'_>], hidden: u32) -> bool {
        self.or_later(hidden, nominal).contains(nominal.len())
    }
}

impl FromIterator<usize> for Places {
    fn from_iter<I: IntoIterator<Item = usize>>(ius: I) -> Self {
        Self(ius.into_iter().fold(0, |places, ius| places | 1 << ius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::job::MeasureBounds;
    use proptest::prelude::*;
    use std::string::String;
    use std::vec::Vec;

    const SEEN: u32 = 0;
    const HIDDEN: u32 = u32::MAX;

    fn context(letter: char) -> Context {
        Context([1, letter as u16, 0, 0])
    }

    /// An IU for each letter; `.` is a release state.
    fn nominal(letters: &str) -> Vec<NominalIu<'static>> {
        let any = Bounds { min: 0, max: u32::MAX };
        let iu = |letter| NominalIu {
            context: if letter == '.' { Context([0, 0, 1, 2]) } else { context(letter) },
            reference: &[],
            threshold: 0.0,
            frames: any,
            reversals: any,
            measures: MeasureBounds::ANY,
        };
        letters.chars().map(iu).collect()
    }

    #[test]
    fn what_is_seen_has_one_place_and_what_is_hidden_leaves_each_to_what_may_come_after_it() {
        for (before, ius, places) in [
            (SEEN, &[('g', SEEN), ('p', SEEN), ('g', SEEN)][..], 1 << 3),
            (SEEN, &[('g', SEEN), ('r', SEEN)], 0),
            (SEEN, &[('g', SEEN), ('p', SEEN), ('g', SEEN), ('p', HIDDEN)], 0),
            (SEEN, &[('g', SEEN), ('r', HIDDEN)], 1 << 4),
            (SEEN, &[('g', HIDDEN)], 1 << 1 | 1 << 3),
            (HIDDEN, &[('g', SEEN)], 1 << 1 | 1 << 3),
            (HIDDEN, &[('g', SEEN), ('p', SEEN)], 1 << 2),
            // What was not seen for a while may go on.
            (SEEN, &[('g', SEEN), ('p', SEEN), ('p', HIDDEN)], 1 << 2),
            (SEEN, &[('g', SEEN), ('p', SEEN), ('p', SEEN)], 0),
        ] {
            let nominal = nominal("gpgr");
            let step = |places: Places, (letter, hidden): &(char, u32)| {
                places.step(&nominal, false, context(*letter), *hidden)
            };
            let after = ius.iter().fold(Places::new(before, &nominal), step);
            assert_eq!(after, Places(places), "{before} {ius:?}");
        }
    }

    #[test]
    fn a_hand_that_was_idle_begins_where_it_may_have_let_go_and_has_done_all_unless_it_may_be_in_the_middle()
    {
        for (letters, places) in [("gpgg", 1 | 1 << 3 | 1 << 4), ("g.gg", 1 | 1 << 2 | 1 << 3 | 1 << 4)] {
            let nominal = nominal(letters);
            assert_eq!(Places::new(HIDDEN, &nominal).after_idle(&nominal), Places(places), "{letters}");
        }
        for (letters, hidden, has_ended) in
            [("gpr", HIDDEN, true), ("gpr", SEEN, false), ("g.r", HIDDEN, false)]
        {
            let ended = Places(1 << 2).has_ended_if_idle(&nominal(letters), hidden);
            assert_eq!(ended, has_ended, "{letters} {hidden}");
        }
    }

    #[test]
    fn an_activity_may_be_complete_if_what_is_missing_may_have_been_hidden() {
        for (places, hidden, may_be) in [(1 << 2, SEEN, false), (1 << 2, HIDDEN, true), (0, HIDDEN, false)] {
            assert_eq!(Places(places).may_be_complete(&nominal("gpgr"), hidden), may_be, "{places} {hidden}");
        }
    }

    impl Places {
        fn is_within(self, wider: Self) -> bool {
            self.0 & !wider.0 == 0
        }
    }

    fn taught() -> impl Strategy<Value = Vec<NominalIu<'static>>> {
        prop::collection::vec((0..4u16, 1..60u32), 1..8).prop_map(|ius| {
            let letters: String = ius.iter().map(|(letter, _)| char::from(b'g' + *letter as u8)).collect();
            let all = nominal(&letters).into_iter().zip(ius);
            all.map(|(iu, (_, min))| NominalIu { frames: Bounds { min, ..iu.frames }, ..iu }).collect()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(10_000) })]

        /// Less observed is a superset of places, whatever comes.
        #[test]
        fn whoever_sees_less_loses_no_place(
            nominal in taught(),
            (places, others) in any::<(u64, u64)>(),
            (less, more) in (0..200u32, 0..200u32).prop_map(|(hidden, more)| (hidden, hidden + more)),
            letter in 0..5u16,
            allows_insertions: bool,
        ) {
            let context = if letter == 4 { Context::IDLE } else { context(char::from(b'g' + letter as u8)) };
            let all = (1 << (nominal.len() + 1)) - 1;
            let (narrow, wide) = (Places(places & all), Places((places | others) & all));
            let step = |places: Places, hidden| places.step(&nominal, allows_insertions, context, hidden);
            prop_assert!(step(narrow, less).is_within(step(wide, more)));
            let resume = |places: Places, hidden| places.resume(hidden, &nominal, context);
            prop_assert!(resume(narrow, less).is_within(resume(wide, more)));
            prop_assert!(narrow.or(Places(others & all)).is_within(wide.or(Places(others & all))));
            prop_assert!(narrow.before_end(&nominal).is_within(wide.before_end(&nominal)));
            prop_assert!(narrow.after_idle(&nominal).is_within(wide.after_idle(&nominal)));
            prop_assert!(Places::new(less, &nominal).is_within(Places::new(more, &nominal)));
            prop_assert!(!narrow.may_be_complete(&nominal, less) || wide.may_be_complete(&nominal, more));
        }
    }
}
