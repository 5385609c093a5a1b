//! What the newest frames show, and what may have happened unseen.

use super::super::Visibility;
use super::super::contact;
use super::super::geometry::distance;
use super::super::interaction::Interaction;
use super::super::noise::{MAX_DRIFT_M, MOVED_M, has_moved};
use super::super::poses::{HandPose, ObjectPose, Recent, Source};
use super::in_hand::ObjectContact;
use super::{Node, Scene, squared_distance};
use crate::capacity::HANDS;
use crate::input::Point;
use crate::set::ObjectSet;

/// What a seen hand carries may be lost for this many times `blind_ms`, by default two seconds. Nobody puts it down and comes back sooner. With
/// twice 40 of 3,700 drawn streams differ, and 26 with four times.
const CARRIED_BLIND_TIMES: u32 = 3;

/// The places at which an object was seen lately, so seldom that no motion of it is measured. A hand that takes it and puts it down between two glimpses
/// is not seen to act on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Glimpses {
    /// Where it was seen last, and frames since then.
    newest: Option<Point>,
    unseen: u32,
    /// How many times in a row it has been elsewhere, unmeasured each time.
    moves: u8,
}

impl Glimpses {
    /// Takes where the object is seen in the newest frame. Says whether it is carried about unmeasured. For that, it has been elsewhere at two glimpses
    /// in a row, each more than `persist` and at most `blind` frames after the last. What was only exchanged unseen has been elsewhere once.
    fn push(&mut self, seen: Option<Point>, persist: u32, blind: u32) -> bool {
        self.unseen = self.unseen.saturating_add(1);
        let Some(place) = seen else { return false };
        let is_glimpse = persist < self.unseen && self.unseen <= blind;
        let is_elsewhere = self.newest.is_some_and(|lay| has_moved(lay, place));
        let moves = if is_glimpse && is_elsewhere { self.moves.saturating_add(1) } else { 0 };
        *self = Self { newest: Some(place), unseen: 0, moves };
        moves >= 2
    }
}

impl Scene {
    /// An object that was hidden is seen again. Where it is elsewhere than was assumed, all that was assumed of it is forgotten.
    pub(super) fn correct_assumed(&mut self, object: usize, seen: &ObjectPose) {
        let assumed = *self.objects[object].poses.ago(0);
        let max_m = match assumed.source {
            Source::Covered => MOVED_M,
            // It may lie otherwise in the hand than it did.
            Source::Carried => self.method.hand_contact.on_m,
            _ => return,
        };
        if squared_distance(assumed.position, seen.position) <= max_m * max_m {
            return;
        }
        self.objects[object].poses.revise(assumed.unseen, |pose| pose.source = Source::Kept);
        self.touches.iter_mut().for_each(|edges| edges[object].forget(assumed.unseen));
        for other in 0..self.objects.len() {
            self.adjacent[object.min(other)][object.max(other)].forget(assumed.unseen);
        }
    }

    /// Whether an object lies elsewhere than when a hand was last seen, and no hand holds it. None acted on it when it was last seen, or was at it no
    /// longer ago than `blind_ms`.
    pub(super) fn have_moved_unseen(&mut self) -> bool {
        let is_hand_seen = self.hands.iter().any(|hand| hand.ago(0).source == Source::Seen);
        if self.handless_frames >= self.method.persist_frames.into() {
            self.unattended = ObjectSet::first(self.objects.len());
        }
        self.handless_frames = if is_hand_seen { 0 } else { self.handless_frames.saturating_add(1) };
        let mut is_any = false;
        for (index, node) in self.objects.iter_mut().enumerate() {
            let pose = node.poses.ago(0);
            if pose.source != Source::Seen {
                continue;
            }
            let holds = |hand: usize| {
                let is_recent = self.hands[hand].ago(0).unseen <= self.blind_frames;
                self.touches[hand][index].is_near()
                    && (is_recent || self.interactions[hand].held() == Some(index))
            };
            let is_held = (0..HANDS).any(holds);
            let lay = *node.attended.get_or_insert(pose.position);
            let is_elsewhere = has_moved(lay, pose.position);
            let has_moved_unseen = self.unattended.contains(index) && is_elsewhere && !is_held;
            is_any |= has_moved_unseen;
            if is_hand_seen || has_moved_unseen || is_held {
                node.attended = Some(pose.position);
                self.unattended.set(index, false);
            }
        }
        is_any
    }

    /// Whether a hand that is not seen carries an object. It moves in both of the last two windows, and no hand is seen at it. A part that is put in
    /// place while the camera is covered moves in neither. One that is misread is back where it was. Where frames come too seldom to measure what a hand
    /// does, it does not matter whether the hand is seen.
    pub(super) fn are_carried_unseen(&mut self) -> bool {
        let moves_unmeasured = self.move_unmeasured();
        let persist = usize::from(self.method.persist_frames);
        let is_seen_at = |object: usize| {
            let is_seen = |hand: &usize| self.hands[*hand].ago(0).source == Source::Seen;
            (0..HANDS).filter(is_seen).any(|hand| self.is_near_or_leads(hand, object))
        };
        let moves = |object: usize| {
            let seen = |age: usize| self.seen_object(object, age);
            let [now, before, first] = [0, persist, 2 * persist].map(seen);
            let is_farther = |min_m: f32| {
                [now.zip(before), before.zip(first), now.zip(first)]
                    .iter()
                    .all(|pair| pair.is_some_and(|(to, from)| distance(to, from) > min_m))
            };
            is_farther(self.rest_m())
                && is_farther(self.objects[object].drift.bound_m().unwrap_or(MAX_DRIFT_M))
                && is_farther(self.jitter_bound_m(persist, seen))
        };
        // What moves while both hands are seen elsewhere was pushed, or is touched farther away than contacts reach: no hand is unseen.
        let is_any_hidden =
            (0..=2 * persist).any(|age| self.hands.iter().any(|hand| hand.ago(age).source != Source::Seen));
        let is_carried =
            is_any_hidden && (0..self.objects.len()).any(|object| !is_seen_at(object) && moves(object));
        is_carried || moves_unmeasured
    }

    /// Whether an object that no hand is known to hold is carried about, and seen too seldom to measure it.
    fn move_unmeasured(&mut self) -> bool {
        let persist = self.method.persist_frames.into();
        let mut is_any = false;
        for (index, node) in self.objects.iter_mut().enumerate() {
            let pose = node.poses.ago(0);
            let seen = (pose.source == Source::Seen).then_some(pose.position);
            let moves = node.glimpses.push(seen, persist, self.blind_frames);
            is_any |= moves && self.interactions.iter().all(|what| what.held() != Some(index));
        }
        is_any
    }

    /// Whether what lay on the bench when a hand was seen last is hidden, as when something covers the camera. What had been hidden
    /// for longer than `blind_ms` by then, as a part under a lid, lies where a hand has left it.
    pub(super) fn is_bench_hidden(&self) -> bool {
        let mut poses = self.objects.iter().map(|node| node.poses.ago(0));
        let is_any_seen = poses.clone().any(|pose| pose.source == Source::Seen);
        let since = self.handless_frames.saturating_add(self.blind_frames);
        let has_vanished =
            self.handless_frames > 0 && poses.any(|pose| pose.source != Source::Seen && pose.unseen <= since);
        !is_any_seen || has_vanished
    }

    /// Finds for each hand if the newest frame is clear. It shows the hand, all that this is at or may have taken, and what that may touch. Whether it
    /// shows what the hand acts on is known only with the couple.
    pub(super) fn push_clear(&mut self) {
        self.update_taken();
        for (index, hand) in self.hands.iter().enumerate() {
            let hand = hand.ago(0);
            let (interaction, touches) = (self.interactions[index], &self.touches[index]);
            // It takes a while to believe that the hand acts on what it is at.
            let is_at = |j: &usize| interaction.held() == Some(*j) || touches[*j].is_near();
            let mut is_clear = hand.source == Source::Seen;
            let mut hidden_object = 0;
            for (object, node) in self.objects.iter().enumerate() {
                let is_edge_unknown =
                    |j: usize| j != object && !self.adjacent[object.min(j)][object.max(j)].is_known();
                // What a hand is assumed to carry may lie where it was seen last.
                let lay = node.attended.unwrap_or(node.poses.ago(0).position);
                let may_touch = |j: usize| {
                    is_edge_unknown(j) && (self.are_in_reach(j, object, 0) || self.reaches(j, lay, object, 0))
                };
                let is_in_doubt = match node.poses.ago(0).source {
                    Source::Never => false,
                    Source::Seen => {
                        !touches[object].is_known() || interaction.held().is_some_and(is_edge_unknown)
                    }
                    _ => {
                        self.may_be_taken[index].contains(object)
                            || (0..self.objects.len()).filter(is_at).any(may_touch)
                    }
                };
                is_clear &= !is_in_doubt;
                if is_in_doubt && node.poses.ago(0).source != Source::Seen && hidden_object == 0 {
                    hidden_object = node.shape.id;
                }
            }
            self.clear[index] = self.clear[index] << 1 | u32::from(is_clear);
            self.hidden_objects[index].push(hidden_object);
        }
    }

    /// Finds which hands may have taken objects that are hidden. It is each that was at the object or was not seen, and one to which the other may have
    /// given it. What moved when it vanished is in a hand, even if that has not been seen for long.
    fn update_taken(&mut self) {
        let persist = usize::from(self.method.persist_frames);
        // What the hand is seen to act on leaves no room in it. Without this 7 of 72 faults less are found.
        let is_full: [bool; HANDS] = core::array::from_fn(|hand| {
            let is_seen = |object: usize| self.objects[object].poses.ago(0).source == Source::Seen;
            self.hands[hand].ago(0).source == Source::Seen
                && self.interactions[hand].held().is_some_and(is_seen)
        });
        for (object, node) in self.objects.iter().enumerate() {
            let (pose, radius_m) = (node.poses.ago(0), node.shape.radius_m);
            if matches!(pose.source, Source::Seen | Source::Never) {
                self.may_be_taken.iter_mut().for_each(|taken| taken.set(object, false));
                continue;
            }
            let may_have_come = |hand: &Recent<HandPose>, max_unseen: u32| match hand.ago(0).source {
                Source::Never => false,
                Source::Seen => hand.ago(0).is_over(pose.position, radius_m),
                _ => hand.ago(0).unseen <= max_unseen,
            };
            let vanished = node.poses.ago(1);
            let mut before = (persist + 1..=2 * persist).map(|age| node.poses.ago(age));
            let has_moved = vanished.source == Source::Seen
                && self.hands.iter().any(|hand| hand.ago(0).source != Source::Seen)
                && before
                    .find(|pose| pose.source == Source::Seen)
                    .is_some_and(|before| has_moved(vanished.position, before.position));
            let may_be_given =
                has_moved || self.hands.iter().any(|hand| may_have_come(hand, self.blind_frames));
            // What a seen hand carries goes with it, unless another one comes to it that has room.
            let is_carried = self.is_carried(pose);
            for ((taken, hand), is_full) in self.may_be_taken.iter_mut().zip(&self.hands).zip(is_full) {
                let may_have_taken = may_have_come(hand, u32::MAX) && !(is_carried && is_full);
                *taken |= ObjectSet::of(object).when(may_have_taken || may_be_given && !is_carried);
            }
        }
    }

    /// An object that was hidden, lies where it lay, and that the hand was not near meanwhile, was not taken. One that is seen in the
    /// hand was. One that is seen apart from a hand that has let go is not what the hand takes next.
    pub(super) fn push_alternatives(&mut self) {
        for (object, node) in self.objects.iter().enumerate() {
            let [pose, before] = [0, 1].map(|age| *node.poses.ago(age));
            let is_back = pose.source == Source::Seen
                && before.source == Source::Covered
                && !has_moved(pose.position, before.position);
            for (hand, touches) in self.touches.iter().enumerate() {
                let (edge, interaction) = (touches[object], self.interactions[hand]);
                let is_touched =
                    self.may_be_touched[hand].contains(object) || !edge.is_known() || edge.is_near();
                let is_known = pose.source == Source::Seen && edge.is_known();
                let may_be = match interaction {
                    _ if interaction.held() == Some(object) => !is_known || !edge.is_near(),
                    Interaction::Released { .. } if is_known && !edge.is_near() => false,
                    _ => !is_back || is_touched,
                };
                let is_alternative = self.alternatives[hand].contains(object) && may_be;
                self.alternatives[hand].set(object, is_alternative);
                // What it was when it was seen again is decided once and for all.
                let is_seen = pose.source == Source::Seen;
                self.may_be_touched[hand].set(object, if is_seen { is_alternative } else { is_touched });
            }
        }
    }

    /// Finds whether it was seen what the hand acts on, after what it did `before`, and the other objects at which it may be.
    pub(super) fn update_alternatives(&mut self, hand: usize, before: Interaction, age: usize) {
        let [before, held] = [before, self.interactions[hand]].map(Interaction::held);
        let persist = self.method.persist_frames;
        if held.is_none() {
            self.alternatives[hand] = ObjectSet::EMPTY;
            return;
        }
        for (object, node) in self.objects.iter().enumerate() {
            let is_taken = held != before;
            let touch = self.touches[hand][object];
            let is_in_doubt = match node.poses.ago(0).source {
                Source::Never => false,
                Source::Seen if held == Some(object) => !touch.is_known(),
                Source::Seen => !touch.is_apart(age, persist),
                _ => held == Some(object) || self.may_be_taken[hand].contains(object),
            };
            // Where one is first seen at a hand that holds another, the hand may have held that all along.
            let appears = node.poses.ago(age).source == Source::Never
                && node.poses.ago(0).source == Source::Seen
                && held.is_some_and(|held| held != object && touch.is_near());
            let is_new = ObjectSet::of(object).when(is_taken && is_in_doubt || appears);
            self.alternatives[hand] |= is_new;
            self.may_be_touched[hand] |= is_new.when(node.poses.ago(0).source == Source::Seen);
        }
    }

    /// The objects that `o_j` may have touched before it touched `o_l`. They were not seen to be apart from it then, nor since.
    pub(super) fn alternative_neighbours(&self, hand: usize, before: Interaction, age: usize) -> ObjectSet {
        let Some((j, l)) = self.interactions[hand].pair() else { return ObjectSet::EMPTY };
        let persist = self.method.persist_frames;
        let is_same = before.pair() == Some((j, l));
        let may_touch = |other: &usize| {
            let edge = self.adjacent[j.min(*other)][j.max(*other)];
            let was_hidden = || !edge.was_known(age, persist) && self.are_in_reach(j, *other, age);
            !edge.is_apart(age, persist)
                && self.objects[*other].poses.ago(age).source != Source::Never
                && if is_same { self.alternative_neighbours[hand].contains(*other) } else { was_hidden() }
        };
        (0..self.objects.len()).filter(|other| *other != j && *other != l).filter(may_touch).collect()
    }

    /// Whether the hand, or an object that it acted on before, was hidden in most of the `persist_frames` before this one.
    pub(super) fn was_hidden(&self, hand: usize, before: Interaction, age: usize) -> bool {
        let frames = age + 1..=age + usize::from(self.method.persist_frames);
        let is_most = |hidden: usize| 2 * hidden > self.method.persist_frames.into();
        let hand = frames.clone().filter(|age| self.hands[hand].ago(*age).source != Source::Seen);
        let is_object_hidden = |node: &Node| {
            is_most(frames.clone().filter(|age| node.poses.ago(*age).source != Source::Seen).count())
        };
        let mut objects = self.objects.iter().enumerate().filter(|(object, _)| before.involves(*object));
        is_most(hand.count()) || objects.any(|(_, node)| is_object_hidden(node))
    }

    /// Whether an object was first seen about when a hand began to act on it: in the frames in which a contact comes to be known and to be believed.
    /// With one or three times as many as the latter, 19 or 12 of 3,700 drawn streams differ.
    pub(super) fn is_new(&self, object: usize, age: usize) -> bool {
        self.objects[object].known_frames <= 2 * u32::from(self.method.persist_frames) + age as u32
    }

    /// Whether `o_j` and `o_l` may only have been near each other, because they came together unseen.
    pub(super) fn may_not_touch(&self, interaction: Interaction) -> bool {
        interaction
            .pair()
            .is_some_and(|(j, l)| self.object_contacts[j.min(l)][j.max(l)] == ObjectContact::Unknown)
    }

    /// Whether `o_j` seems to have left `o_l`, or without one to have met another object, and it is not seen whether that lasts.
    pub(super) fn may_have_met_or_parted(&self, interaction: Interaction, age: usize) -> bool {
        let Some(j) = interaction.held() else { return false };
        let with = interaction.pair().map(|(_, l)| l);
        let is_of_interest = |l: &usize| *l != j && with.is_none_or(|with| with == *l);
        (0..self.objects.len()).filter(is_of_interest).any(|l| {
            let edge = self.adjacent[j.min(l)][j.max(l)];
            edge.is_believed() == with.is_some() && edge.may_have_changed(age, self.method.persist_frames)
        })
    }

    /// Whether the hand moves away from `o_j`, and not all frames that would show whether it has left were clear. Or it moves along it, and the last was not.
    /// They are those in which that motion is measured: one more than those in which a contact is believed.
    pub(super) fn may_have_left(&self, hand: usize, interaction: Interaction, age: usize) -> bool {
        let Interaction::Acts { j, .. } = interaction else { return false };
        let measured = contact::ahead(age, self.method.persist_frames + 1);
        let hidden = measured & !self.clear[hand];
        let is_end_hidden = hidden >> measured.trailing_zeros() & 1 == 1;
        hidden != 0
            && (self.moves_away(hand, j, age).is_some()
                || is_end_hidden && self.slips_until(hand, j, age).is_some())
    }

    /// Whether fewer than half of the frames in which a change would be believed were clear.
    pub(super) fn is_doubtful(&self, hand: usize, age: usize) -> bool {
        let frames = contact::ahead(age, self.method.persist_frames);
        2 * (self.clear[hand] & frames).count_ones() + 1 < frames.count_ones()
    }

    /// The objects that were out of sight `age` frames before the newest.
    pub(super) fn out_of_sight(&self, age: usize) -> ObjectSet {
        let is_out =
            |index: &usize| self.visibility(self.objects[*index].poses.ago(age).unseen) == Visibility::Unseen;
        (0..self.objects.len()).filter(is_out).collect()
    }

    pub(super) fn visibility(&self, unseen: u32) -> Visibility {
        match unseen {
            0 => Visibility::Seen,
            unseen if unseen <= self.blind_frames => Visibility::Assumed,
            _ => Visibility::Unseen,
        }
    }

    pub(super) fn is_carried(&self, pose: &ObjectPose) -> bool {
        pose.source == Source::Carried && pose.unseen <= CARRIED_BLIND_TIMES * self.blind_frames
    }
}
