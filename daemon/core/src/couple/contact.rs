//! Contacts: edges by distance with hysteresis, believed once they have lasted for `persist_frames`.

use crate::config::Contact;

/// In how many of `persist` frames a change must have been known to be believed: in half of them. By default these are three: one wrong position
/// is no change, and two may come from one shaken frame.
fn min_known(persist: u8) -> u32 {
    u32::from(persist.div_ceil(2))
}

/// The recent history of one edge of the scene graph.
///
/// The newest frame is `persist_frames` ahead of the one whose couple is made. So a change is believed from its true first frame on, and only if it
/// has lasted for `persist_frames`. While one of its ends is not known, an edge stays as it was, and such frames do not confirm a change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Edge {
    /// Bit k: near (with hysteresis) k frames before the newest. 32 frames are more than the longest delay.
    near: u32,
    /// Bit k: both ends were known k frames before the newest.
    known: u32,
    /// Whether it was believed in the frame that [`believe`](Self::believe) last asked for.
    believed: bool,
    /// It has been known to be near or not.
    has_been_known: bool,
}

impl Edge {
    /// Takes the newest distance, in metres, of two ends that are known. Between the two distances an edge is what it was. If it was known in fewer
    /// than half of the `persist` frames before, it is not known there.
    pub(super) fn push(&mut self, distance: f32, contact: &Contact, persist: u8) {
        if (contact.on_m..=contact.off_m).contains(&distance)
            && !is_enough(self.known & window(persist, 0), persist)
        {
            self.push_unknown();
            return;
        }
        let near = if self.is_near() { distance <= contact.off_m } else { distance < contact.on_m };
        self.near = self.near << 1 | u32::from(near);
        self.known = self.known << 1 | 1;
        self.has_been_known = true;
    }

    /// Its ends have rested between the two distances in the newest `persist` frames. Nobody has seen how they came there, or they were near
    /// before: they are near.
    pub(super) fn settle(&mut self, persist: u8) {
        if !self.has_been_known || self.is_near() {
            self.near |= window(persist, 0);
            self.known |= window(persist, 0);
            self.has_been_known = true;
        }
    }

    /// One of the ends is not known in the newest frame.
    pub(super) fn push_unknown(&mut self) {
        self.near = self.near << 1 | self.near & 1;
        self.known <<= 1;
    }

    /// What was assumed in the newest `frames` was wrong.
    pub(super) fn forget(&mut self, frames: u32) {
        self.known &= !window(frames.min(32) as u8, 0);
    }

    /// Whether it is known to be near or not in the newest frame.
    pub(super) fn is_known(self) -> bool {
        self.known & 1 == 1
    }

    /// Whether it is near in the newest frame, believed or not.
    pub(super) fn is_near(self) -> bool {
        self.near & 1 == 1
    }

    /// Moves on to the frame `age` frames before the newest and returns whether there is a contact in it. With fewer than
    /// `persist` frames from there to the newest (at the end of a recording) nothing new is believed.
    pub(super) fn believe(&mut self, age: usize, persist: u8) -> bool {
        if let Some(end) = (age + 1).checked_sub(usize::from(persist)) {
            // Where the last frame of the window is missing, the one after it shows as much.
            let is_end_missing = end > 0 && self.known >> end & 1 == 0;
            let rest = end - usize::from(is_end_missing);
            let [near, known] = [self.near >> rest, self.known >> rest];
            let is_near = near & 1 == 1;
            // What was last seen before the end of the window may have been over before it.
            if is_near != self.believed && known & 1 == 1 {
                // For how many frames up to the newest in the window it has been what it is there.
                let lasted = if is_near { near.trailing_ones() } else { near.trailing_zeros() };
                let seen = (known & window(lasted as u8, 0)).count_ones();
                let is_seen = seen >= min_known(persist);
                self.believed ^= lasted as usize > age - rest && is_seen;
            }
        }
        self.believed
    }

    /// Whether it was known in at least half of the `persist` frames before the frame of this age.
    pub(super) fn was_known(self, age: usize, persist: u8) -> bool {
        is_enough(self.known & window(persist, age + 1), persist)
    }

    /// Whether enough frames of the window [`ahead`] of this age show that the two are apart, and none that they are near.
    pub(super) fn is_apart(self, age: usize, persist: u8) -> bool {
        let frames = ahead(age, persist);
        self.near & frames == 0
            && (self.known & frames).count_ones() >= min_known(persist).min(frames.count_ones())
    }

    /// Whether a change was not believed only because frames are not known. The frame of this age and all known ones of the window [`ahead`] of it
    /// show it. Call it after [`believe`](Self::believe).
    pub(super) fn may_have_changed(self, age: usize, persist: u8) -> bool {
        let frames = ahead(age, persist);
        let (seen, unchanged) = (self.known & frames, if self.believed { self.near } else { !self.near });
        self.known >> age & 1 == 1 && seen != frames && seen & unchanged == 0
    }

    pub(super) fn is_believed(self) -> bool {
        self.believed
    }
}

/// The bits of the frame `age` frames before the newest and of those after it, for `persist` frames or as long as is known.
pub(super) fn ahead(age: usize, persist: u8) -> u32 {
    let frames = (age + 1).min(persist.into());
    window(frames as u8, age + 1 - frames)
}

/// Whether at least one and half of `persist` frames, rounded down, are among these.
fn is_enough(known: u32, persist: u8) -> bool {
    2 * known.count_ones() + 1 >= persist.max(2).into()
}

/// `frames` set bits from bit `from` on.
fn window(frames: u8, from: usize) -> u32 {
    (u32::MAX >> (32 - u32::from(frames.clamp(1, 32)))) << from
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capacity::PERSIST_FRAMES;
    use crate::cases::many_cases;
    use proptest::prelude::*;
    use std::string::String;
    use std::vec;
    use std::vec::Vec;

    const CONTACT: Contact = Contact { on_m: 0.03, off_m: 0.045 };

    /// The answers of the edge for each frame, where couples are made `persist` frames late.
    fn asked<T>(distances: &[f32], persist: u8, ask: impl Fn(&mut Edge, usize, u8) -> T) -> Vec<T> {
        let (mut edge, delay) = (Edge::default(), usize::from(persist));
        let mut answers = Vec::new();
        for (newest, distance) in distances.iter().enumerate() {
            if distance.is_nan() {
                edge.push_unknown();
            } else {
                edge.push(*distance, &CONTACT, persist);
            }
            answers.extend((newest >= delay).then(|| ask(&mut edge, delay, persist)));
        }
        let left = (0..delay.min(distances.len())).rev();
        answers.extend(left.map(|age| ask(&mut edge, age, persist)));
        answers
    }

    /// The frames with this answer, as `x`. Of the distances, `-` is far, `x` near, `=` between the two limits and `?` not known.
    fn answers(distances: &str, persist: u8, ask: impl Fn(&mut Edge, usize, u8) -> bool) -> String {
        let distance = |c| match c {
            '-' => 1.0,
            'x' => 0.01,
            '?' => f32::NAN,
            _ => 0.04,
        };
        let distances: Vec<f32> = distances.chars().map(distance).collect();
        asked(&distances, persist, ask).into_iter().map(|is_so| if is_so { 'x' } else { '-' }).collect()
    }

    #[test]
    fn a_change_is_believed_once_it_has_lasted_from_its_first_frame_on() {
        for (persist, distances, believed) in [
            (5, "---xxxxx-----", "---xxxxx-----"),
            (5, "---xxxx-----", "------------"),
            (3, "xxxxx--xx---xx---", "xxxxxxxxx--------"),
            // Between the two limits a contact stays as it was.
            (2, "====xxx====--===---", "----xxxxxxx--------"),
            // At the end of a recording nothing is believed that has not lasted for long enough.
            (3, "----xx", "------"),
            (3, "---xxx", "---xxx"),
            (3, "xxx---", "xxx---"),
            (3, "xxxx--", "xxxxxx"),
            // While an end is not known, a contact neither begins nor ends.
            (5, "---xxxxx??????????xxxx", "---xxxxxxxxxxxxxxxxxxx"),
            (5, "---xxxxx??????????-----", "---xxxxxxxxxxxxxxx-----"),
            (5, "---??????????xxxxx", "-------------xxxxx"),
            (5, "---x????????----", "----------------"),
            // Behind the gap the contact may have begun or not, until the distance tells.
            (5, "-----??????====xxxxx", "---------------xxxxx"),
            // The last frame of the window is missing: the one after that shows as much, or tells otherwise.
            (5, "-----xxxx?xxx----?----", "-----xxxxxxxx---------"),
            (5, "-----xxxx?------------", "----------------------"),
            // Every second frame is enough; what is seen less often is believed later.
            (5, "-?-?x?x?x?x?-?-?-?-?", "----xxxxxxxx--------"),
            (5, "-??-??x??x??x??x??-??-??-??-", "-------xxxxxxxxxxxx---------"),
        ] {
            assert_eq!(answers(distances, persist, Edge::believe), believed, "{distances} {persist}");
        }
    }

    #[test]
    fn a_change_is_in_doubt_where_nobody_saw_what_came_after_it() {
        for (distances, in_doubt) in [
            ("-----xx?????????-----", "-----xx--------------"),
            ("-----xxxx????????xxxx", "-----xxxx------------"),
            ("xxxxx---?????????xxxx", "-----xxx-------------"),
            // It is believed, or has not lasted.
            ("-----xxxx?xxxx-------", "---------------------"),
            ("-----xx?-------------", "---------------------"),
        ] {
            let may_have_changed = |edge: &mut Edge, age, persist| {
                edge.believe(age, persist);
                edge.may_have_changed(age, persist)
            };
            assert_eq!(answers(distances, 5, may_have_changed), in_doubt, "{distances}");
        }
    }

    /// For each frame, whether a contact is believed, and whether that is certain. For that, the frame and at least half of the window are known, and
    /// they show no change that is not believed.
    fn claims(distances: &[f32], persist: u8) -> Vec<(bool, bool)> {
        asked(distances, persist, |edge, age, persist| {
            let is_believed = edge.believe(age, persist);
            let frames = ahead(age, persist);
            let is_known = edge.known >> age & 1 == 1
                && 2 * (edge.known & frames).count_ones() + 1 >= frames.count_ones();
            (is_believed, is_known && !edge.may_have_changed(age, persist))
        })
    }

    proptest! {
        #![proptest_config(many_cases())]

        /// Whoever sees fewer frames and is certain believes what is believed with all of them, in some frame within the window. The two stay near or
        /// apart for at least as long as the window, with whatever comes between. The last frames of a recording, in which nothing new is believed,
        /// do not count.
        #[test]
        fn whoever_sees_fewer_distances_and_is_certain_agrees_with_who_sees_all(
            (persist, stays) in (1..=PERSIST_FRAMES).prop_flat_map(|persist| {
                let lasts = prop_oneof![0..4usize, 0..30usize];
                let far_or_near = (prop::sample::select(vec![1.0, 0.01]), lasts.clone().prop_map(move |more| persist + more));
                let between = (Just(0.04f32), lasts);
                (Just(persist), prop::collection::vec(prop_oneof![2 => far_or_near, 1 => between], 1..10))
            }),
            gaps in prop::collection::vec((0..200usize, prop_oneof![1..8usize, 1..40usize]), 0..4),
            every in prop_oneof![4 => Just(1usize), 1 => 2..4usize],
        ) {
            let whole: Vec<f32> = stays.iter().flat_map(|(distance, frames)| core::iter::repeat_n(*distance, *frames)).collect();
            let is_hidden = |frame: usize| gaps.iter().any(|(from, frames)| (*from..from + frames).contains(&frame));
            let less: Vec<f32> = (0..).zip(&whole).map(|(frame, distance)| if frame % every > 0 || is_hidden(frame) { f32::NAN } else { *distance }).collect();
            let [whole, less] = [whole, less].map(|distances| claims(&distances, persist as u8));
            for (frame, (is_near, _)) in less.iter().enumerate().filter(|(_, (_, is_certain))| *is_certain) {
                let around = frame.saturating_sub(persist - 1)..(frame + persist).min(whole.len());
                let is_last = frame + persist >= whole.len();
                prop_assert!(is_last || whole[around].iter().any(|(other, _)| other == is_near), "frame {}: {:?} of {:?}", frame, less, whole);
            }
        }
    }
}
