//! What is near and interacts. A hand near an object acts on it once it rests at the object or the object moves with it, until it leaves.
//! It is the in-hand relation of paper III-A.2. The *window* of a frame is this frame and the `persist_frames` after it, in which a change is
//! believed. An object touches another that it comes near or is brought to rest at, unless it passes by.
//!
//! To be near is only the opportunity: nearness alone began an IU 0.7 to 1.1 s before the grasp. A hand that flies over a part is never slower than
//! 0.7 m/s there. One that takes it comes down to 0.02 m/s or carries it. What it holds rests relative to it, in the bench frame or in that of the part.
//!
//! After it has let go, a hand that rests there again makes no new contact until the part moves with it. A tracker with errors of 1 or 2 mm
//! would else see the step begin once more.
//!
//! People hold an object elsewhere than others did. One that moves with one hand alone is in that hand if the finger tips are near enough. That is a
//! hand's width from where the runs hold it, or within reach where no run shows it.

use super::super::geometry::{distance, dot, norm, subtract};
use super::super::poses::Source;
use super::Scene;
use crate::capacity::{HANDS, OBJECTS};
use crate::input::Point;
use core::f32::consts::SQRT_2;

/// Two positions of an object at rest are seldom farther apart than this share of the noise bound. In the plane it is once in seven times. Those of
/// one that passes are. Halved or doubled, none or 1 of 975 runs of people is judged otherwise.
const MAX_REST_SHARE: f32 = 0.4;

/// Whether a hand acts on an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum InHand {
    /// It is not at the object, or only passes it.
    #[default]
    No,
    /// It has let go of the object and has not gone away since. It only lingers until the object moves with it or it comes back from where it was
    /// farthest, in metres.
    Lingers { farthest_m: f32 },
    /// It is at the object, and it has not been seen whether it acts on it.
    Unknown,
    /// It acts on the object.
    Yes,
}

/// Whether two objects touch each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ObjectContact {
    /// They do not, or one only passes the other.
    #[default]
    No,
    /// They do not, and a hand brings one from where no contact reaches. If it comes to rest within the distance where one ends, they do.
    Brought,
    /// They have come near each other unseen, and one moves past the other: whether they touch was not seen.
    Unknown,
    /// They do: they have come to rest within the distance at which a contact ends.
    Rests,
    /// They do: they have come as near as a contact begins.
    Yes,
}

impl ObjectContact {
    /// Whether they touch, or may.
    pub(super) fn touches(self) -> bool {
        matches!(self, Self::Unknown | Self::Rests | Self::Yes)
    }
}

impl Scene {
    /// Finds for the frame `age` frames before the newest which objects each hand acts on. Call it once for each frame, in order.
    pub(super) fn update_in_hand(&mut self, age: usize) {
        for hand in 0..HANDS {
            for object in 0..self.objects.len() {
                let edge = self.touches[hand][object];
                let leads = if edge.is_believed() { Some(false) } else { self.leads(hand, object, age) };
                self.in_hand[hand][object] = self.next_in_hand(hand, object, leads, age);
                let is_held = self.in_hand[hand][object] == InHand::Yes;
                let is_led = self.led[hand].contains(object) || leads == Some(true);
                self.led[hand].set(object, is_held && is_led);
                // A hand that was hidden may have let go since. That the object moves with it says nothing where the other hand may move it.
                let is_shared = matches!(self.in_hand[1 - hand][object], InHand::Yes | InHand::Unknown);
                let may_have_let_go = is_held
                    && match self.shared_unseen[hand].contains(object) {
                        true => is_shared || !self.is_moved_by(hand, object, age),
                        false => is_shared && !edge.was_known(age, self.method.persist_frames),
                    };
                self.shared_unseen[hand].set(object, may_have_let_go);
                if self.in_hand[hand][object] == InHand::Unknown {
                    // The frame does not show what the hand acts on.
                    self.clear[hand] &= !(1 << age);
                }
            }
        }
    }

    /// `leads` is whether the hand leads the object from beyond its contact, as [`leads`](Self::leads) says.
    fn next_in_hand(&self, hand: usize, object: usize, leads: Option<bool>, age: usize) -> InHand {
        let (edge, before) = (self.touches[hand][object], self.in_hand[hand][object]);
        let stays_led = || self.led[hand].contains(object) && self.stays_anywhere(hand, object, age);
        if !edge.is_believed() && (leads == Some(true) || stays_led()) {
            return InHand::Yes;
        }
        if before == InHand::Yes {
            // It moves away, so that it is not at the object any more when a change would be believed.
            let leaves = || {
                let away_m = self.moves_away(hand, object, age);
                away_m.is_some_and(|away_m| away_m > self.hand_contact(object).on_m)
            };
            let is_known = self.relative_positions(hand, object, age).is_some();
            let is_beyond = is_known && !self.is_within_reach(hand, object, age);
            let follows = !is_beyond && self.follows(hand, object, age);
            let stays = (edge.is_believed() || follows) && !leaves();
            return match (stays, edge.is_believed()) {
                (true, _) => InHand::Yes,
                (false, true) => InHand::Lingers { farthest_m: 0.0 },
                // What was not measured may follow it.
                (false, false) if self.relative_path(hand, object, age).is_none() => InHand::Unknown,
                (false, false) => InHand::No,
            };
        }
        if !edge.is_believed() {
            let may_be_held =
                leads.is_none() || before == InHand::Unknown && self.stays_anywhere(hand, object, age);
            return if may_be_held { InHand::Unknown } else { InHand::No };
        }
        if let InHand::Lingers { farthest_m } = before
            && edge.was_known(age, self.method.persist_frames)
        {
            return self.next_lingering(hand, object, age, farthest_m);
        }
        match self.rests(hand, object, age) {
            Some(true) => InHand::Yes,
            // A hand that came to the object unseen may hold it already.
            _ if before == InHand::No && edge.was_known(age, self.method.persist_frames) => InHand::No,
            _ => InHand::Unknown,
        }
    }

    /// Whether the object moves with this hand alone, which acts on nothing else. The other hand acts neither on this nor on what this touches. `None`
    /// where it may be the other hand that moves it.
    fn leads(&self, hand: usize, object: usize, age: usize) -> Option<bool> {
        let other_hand = 1 - hand;
        let is_free = |other: usize| {
            let is_together = || self.adjacent[object.min(other)][object.max(other)].is_believed();
            other == object
                || !self.touches[hand][other].is_believed()
                    && self.in_hand[hand][other] != InHand::Yes
                    && !(self.in_hand[other_hand][other] == InHand::Yes && is_together())
        };
        // Most objects rest, so this comes first.
        let is_moved_along = self.goes_away(object, age)
            && (0..self.objects.len()).all(is_free)
            && self.in_hand[other_hand][object] != InHand::Yes
            && self.is_moved_by(hand, object, age);
        let may_be_other = || {
            self.hands[other_hand].ago(age).source != Source::Never
                && (!self.touches[other_hand][object].was_known(age, self.method.persist_frames)
                    || self.is_moved_by(other_hand, object, age))
        };
        (!is_moved_along || !may_be_other()).then_some(is_moved_along)
    }

    /// Whether the object moves as this hand does, within its reach.
    fn is_moved_by(&self, hand: usize, object: usize, age: usize) -> bool {
        self.is_within_reach(hand, object, age) && self.follows(hand, object, age)
    }

    /// Whether an object has gone farther than a contact is long when a change would be believed: drift does not take it there.
    fn goes_away(&self, object: usize, age: usize) -> bool {
        let moved = self.moved(age, |age| self.seen_object(object, age));
        moved.is_some_and(|(_, path_m)| path_m > self.hand_contact(object).on_m)
    }

    /// Whether a hand that has led an object has not been seen to move along it or away from it.
    fn stays_anywhere(&self, hand: usize, object: usize, age: usize) -> bool {
        self.relative_path(hand, object, age).is_none()
            || self.is_within_reach(hand, object, age) && self.slips_until(hand, object, age).is_none()
    }

    /// Whether the hand is near the object in the newest frame, or leads it from farther away.
    pub(super) fn is_near_or_leads(&self, hand: usize, object: usize) -> bool {
        self.touches[hand][object].is_near() || self.led[hand].contains(object)
    }

    fn is_within_reach(&self, hand: usize, object: usize, age: usize) -> bool {
        self.distance_from_hand(hand, object, age) <= self.objects[object].shape.held_within_m
    }

    /// What errors of some millimetres show of a hand that has opened at a part is no touch.
    fn next_lingering(&self, hand: usize, object: usize, age: usize, farthest_m: f32) -> InHand {
        let distance_m = self.distance_from_hand(hand, object, age);
        let has_returned = farthest_m - distance_m > self.slipped_m();
        let is_moved = self.is_at(hand, object, age) && self.follows(hand, object, age);
        if is_moved || has_returned && self.rests(hand, object, age) == Some(true) {
            InHand::Yes
        } else {
            InHand::Lingers { farthest_m: farthest_m.max(distance_m) }
        }
    }

    /// Finds for the same frame which objects touch. One that is carried past moves farther than the contact is long while that is believed.
    pub(super) fn update_object_contacts(&mut self, age: usize) {
        let is_held: [bool; OBJECTS] =
            core::array::from_fn(|object| self.interactions.iter().any(|what| what.acts_on(object)));
        for i in 0..self.objects.len() {
            for j in i + 1..self.objects.len() {
                self.object_contacts[i][j] = self.next_object_contact([i, j], is_held[i] || is_held[j], age);
            }
        }
    }

    fn next_object_contact(&self, [i, j]: [usize; 2], is_held: bool, age: usize) -> ObjectContact {
        let (edge, before) = (self.adjacent[i][j], self.object_contacts[i][j]);
        // Most pairs lie apart, and nothing of their objects is needed to say so.
        let lie_apart = !edge.is_believed() && !is_held && before != ObjectContact::Rests;
        if lie_apart || !self.objects[i].shape.may_touch(&self.objects[j].shape) {
            return ObjectContact::No;
        }
        let is_near = |age: usize| {
            self.are_in_reach(i, j, age)
                && self.distance_of_objects(i, j, age) <= self.object_contact(i, j).off_m
        };
        if edge.is_believed() {
            if matches!(before, ObjectContact::Rests | ObjectContact::Yes) {
                return ObjectContact::Yes;
            }
            let Some(passes) = self.passes(i, j, age) else { return before };
            return match passes {
                // Where frames are missing, a contact is still believed after the two have parted.
                [false, false] if is_near(age) => ObjectContact::Yes,
                [false, false] => before,
                // Two that came together unseen may touch already, and so may two that may have come to rest unseen.
                [true, true] if edge.was_known(age, self.method.persist_frames) => before,
                _ => ObjectContact::Unknown,
            };
        }
        // Most pairs of which one is carried stay far apart.
        if before == ObjectContact::Brought && !is_near(age) {
            return before;
        }
        let Some((newest, path_m)) = self.path_of_objects(i, j, age) else { return before };
        // Places that are assumed do not show that they rest.
        let rests = || {
            self.shows_rest(age, newest, path_m) && [age, newest].iter().all(|age| self.are_seen(i, j, *age))
        };
        match before {
            ObjectContact::Rests if is_near(age) || is_near(newest) => ObjectContact::Rests,
            ObjectContact::Brought if rests() => ObjectContact::Rests,
            ObjectContact::Brought => ObjectContact::Brought,
            _ if is_held && !is_near(age) => ObjectContact::Brought,
            _ => ObjectContact::No,
        }
    }

    /// Whether one of two objects passes the other, if it stopped where frames of the window are missing, and if it went on at its pace. `None` where
    /// their way was not measured.
    fn passes(&self, i: usize, j: usize, age: usize) -> Option<[bool; 2]> {
        let (newest, path_m) = self.path_of_objects(i, j, age)?;
        let at_pace_m = path_m * f32::from(self.method.persist_frames) / (age - newest) as f32;
        let contact_m = self.object_contact(i, j).on_m;
        Some([path_m, at_pace_m].map(|moved_m| moved_m > contact_m))
    }

    /// The age of the window's last known frame, and how far two objects have moved relative to each other until then, in metres.
    fn path_of_objects(&self, i: usize, j: usize, age: usize) -> Option<(usize, f32)> {
        self.moved(age, |age| {
            let [one, other] = [i, j].map(|object| self.objects[object].poses.ago(age));
            let is_known = one.source.is_known() && other.source.is_known();
            is_known.then(|| subtract(one.position, other.position))
        })
    }

    pub(super) fn are_seen(&self, i: usize, j: usize, age: usize) -> bool {
        [i, j].iter().all(|object| self.objects[*object].poses.ago(age).source == Source::Seen)
    }

    /// Whether the object moves with a hand at it, or the hand rests relative to it up to the end of the window. `None` where that was not measured.
    /// If the hand rests relative to one object, it also rests relative to each at it that rests relative to this one.
    pub(super) fn rests(&self, hand: usize, object: usize, age: usize) -> Option<bool> {
        if !self.is_at(hand, object, age) {
            return Some(false);
        }
        self.relative_positions(hand, object, age)?;
        let rests = self.rests_alone(hand, object, age);
        let rests_with = |other: usize| {
            other != object
                && self.is_at(hand, other, age)
                && self.rests_alone(hand, other, age) == Some(true)
                && self.path_of_objects(object, other, age).is_some_and(|(_, path_m)| path_m <= self.rest_m())
        };
        let is_shown = rests == Some(true) || (0..self.objects.len()).any(rests_with);
        if is_shown { Some(true) } else { rests }
    }

    /// Whether the hand is as near to the object as a contact begins, or leads it.
    fn is_at(&self, hand: usize, object: usize, age: usize) -> bool {
        self.distance_from_hand(hand, object, age) <= self.hand_contact(object).on_m
            || self.leads(hand, object, age) == Some(true)
    }

    /// As [`rests`](Self::rests), as far as these two show it. The tips rest, or the knuckle while the tips take hold or are confused.
    fn rests_alone(&self, hand: usize, object: usize, age: usize) -> Option<bool> {
        if self.follows(hand, object, age) || self.knuckle_rests(hand, object, age) {
            return Some(true);
        }
        let (speed, (_, path_m)) =
            self.relative_speed(hand, object, age).zip(self.relative_path(hand, object, age))?;
        let seems_to_rest = || path_m <= MAX_REST_SHARE * self.noise_displacement_m(hand, object, age);
        Some(speed < self.method.rest_speed_m_s && (path_m <= self.rest_m() || seems_to_rest()))
    }

    /// Whether the middle knuckle is known to rest relative to the object, in the bench frame and up to the end of the window.
    fn knuckle_rests(&self, hand: usize, object: usize, age: usize) -> bool {
        let apart = |age: usize| {
            let (hand, object) = (self.hands[hand].ago(age), self.objects[object].poses.ago(age));
            let is_known = hand.source == Source::Seen && object.source.is_known();
            is_known.then(|| subtract(hand.middle_knuckle, object.position))
        };
        self.kinematics(age, apart).is_some_and(|motion| self.method.is_at_rest(&motion))
            && self.moved(age, apart).is_some_and(|(_, path_m)| path_m <= self.rest_m())
    }

    /// Whether a displacement of `path_m` from one frame to another is rest. A time shorter than most of the window does not show it.
    pub(super) fn shows_rest(&self, age: usize, newest: usize, path_m: f32) -> bool {
        2 * (age - newest) > self.method.persist_frames.into() && path_m <= self.rest_m()
    }

    /// How far something may move while a change is believed and still be at rest, in metres.
    pub(super) fn rest_m(&self) -> f32 {
        self.method.rest_speed_m_s * f32::from(self.method.persist_frames) / self.method.rate_hz
    }

    /// The distance from hand to object at the end of the window, in metres, if the hand moves away and the object stays.
    pub(super) fn moves_away(&self, hand: usize, object: usize, age: usize) -> Option<f32> {
        let distance = self.distance_from_hand(hand, object, self.slips_until(hand, object, age)?);
        (distance > self.distance_from_hand(hand, object, age)).then_some(distance)
    }

    /// The age of the window's last known frame, if the hand moves along the object or away from it and the object stays.
    pub(super) fn slips_until(&self, hand: usize, object: usize, age: usize) -> Option<usize> {
        let (newest, path_m) = self.relative_path(hand, object, age)?;
        // The errors come last, because they take longest.
        let slips = path_m > self.slipped_m()
            && !self.follows(hand, object, age)
            && path_m > self.noise_displacement_m(hand, object, age);
        slips.then_some(newest)
    }

    /// How far a hand that rests at an object seems to move along it at most, by the errors of both, in metres.
    fn noise_displacement_m(&self, hand: usize, object: usize, age: usize) -> f32 {
        let jitter_m = self.jitter_bound_m(age, |age| Some(self.relative_positions(hand, object, age)?[0]));
        // No tracker sees finger tips more exactly than parts.
        jitter_m.max(SQRT_2 * self.drift_m(object))
    }

    /// A hand that has moved this far along an object or away from it, in metres, does not hold it. With a quarter of the contact distance 114 of 3,700
    /// drawn streams differ, and 157 with all.
    fn slipped_m(&self) -> f32 {
        self.method.hand_contact.on_m / 2.0
    }

    /// Whether the object moves with the hand: over half as far as they move apart, and the hand over a quarter of its way. Two hands do not hold a
    /// part stiffly. The first share halved or doubled, 32 or 31 of 3,700 drawn streams differ, and 50 or 52 of the second one.
    fn follows(&self, hand: usize, object: usize, age: usize) -> bool {
        self.relative_path(hand, object, age).is_some_and(|(newest, path_m)| {
            let (hands, poses) = (&self.hands[hand], &self.objects[object].poses);
            let followed = subtract(poses.ago(newest).position, poses.ago(age).position);
            let led = subtract(hands.ago(newest).grip(), hands.ago(age).grip());
            norm(followed) > f32::max(path_m / 2.0, self.rest_m())
                && dot(led, followed) > dot(followed, followed) / 4.0
                && norm(followed) > self.drift_m(object)
                && norm(followed) > self.jitter_bound_m(age, |age| self.seen_object(object, age))
        })
    }

    /// The speed of the finger tips relative to the object, in m/s. It is the less of those in the bench frame and in that of the object.
    fn relative_speed(&self, hand: usize, object: usize, age: usize) -> Option<f32> {
        let speed_in = |frame: usize| {
            let motion =
                self.kinematics(age, |age| Some(self.relative_positions(hand, object, age)?[frame]))?;
            Some(norm(motion.velocity))
        };
        Some(f32::min(speed_in(0)?, speed_in(1)?))
    }

    /// The age of the window's last known frame, and how far the finger tips have moved relative to the object until then, in metres. It is in the bench
    /// frame or that of the object, whichever is less.
    fn relative_path(&self, hand: usize, object: usize, age: usize) -> Option<(usize, f32)> {
        let positions = |age: usize| self.relative_positions(hand, object, age);
        let mut ages = age..=age + usize::from(self.method.persist_frames);
        let (oldest, from) = ages.find_map(|age| Some((age, positions(age)?)))?;
        let (newest, to) = self.newest_known(age, positions)?;
        // What came before this frame does not count.
        let share = (age - newest) as f32 / (oldest - newest) as f32;
        let moved = |frame: usize| share * distance(to[frame], from[frame]);
        Some((newest, f32::min(moved(0), moved(1))))
    }

    /// What is known in the newest frame up to `persist_frames` after this one, after the age of that frame.
    fn newest_known<T>(&self, age: usize, known: impl Fn(usize) -> Option<T>) -> Option<(usize, T)> {
        let newest = age.saturating_sub(self.method.persist_frames.into());
        (newest..age).find_map(|newest| Some((newest, known(newest)?)))
    }

    /// The age of the window's last known frame, and how far a place then is from where it is in this frame, in metres.
    pub(super) fn moved(&self, age: usize, at: impl Fn(usize) -> Option<Point>) -> Option<(usize, f32)> {
        let (from, (newest, to)) = at(age).zip(self.newest_known(age, at))?;
        Some((newest, distance(to, from)))
    }

    /// Where the finger tips are from the object, in metres: in the bench frame and in that of the object.
    fn relative_positions(&self, hand: usize, object: usize, age: usize) -> Option<[Point; 2]> {
        let (hand, object) = (self.hands[hand].ago(age), self.objects[object].poses.ago(age));
        let is_known = hand.source == Source::Seen && object.source.is_known();
        is_known.then(|| [subtract(hand.grip(), object.position), object.own(hand.grip())])
    }
}
