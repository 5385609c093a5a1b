//! Feature couples, from the method to shared memory and back.

use andon_core::couple::{Context, Couple, Couples, Motion, Visibility, Waiting};
use andon_core::input::{Point, Side};
use andon_core::set::ObjectSet;
use shm_schemas::{Couples as Message, HandCouple, flag};

/// Writes the couples into the loaned message. Its other flags stay as they are.
pub fn write(couples: &Couples, message: &mut Message) {
    message.described_ns = couples.captured_ns;
    message.known_ns = couples.known_ns;
    message.objects = couples.objects;
    message.at_start = couples.at_start.bits();
    message.out_of_sight = couples.out_of_sight.bits();
    message.twice = couples.twice.bits();
    message.flags |= bit(couples.is_captured, flag::CAPTURED)
        | bit(couples.has_moved_unseen, flag::MOVED_UNSEEN)
        | bit(couples.is_carried_unseen, flag::CARRIED_UNSEEN)
        | bit(couples.is_bench_hidden, flag::BENCH_HIDDEN);
    for (couple, place) in couples.hands.iter().zip(message.hands.iter_mut()) {
        *place = HandCouple {
            x_c: couple.context.0,
            distances_m: couple.distances,
            position_m: place_of(couple.position),
            tips_m: place_of(couple.tips),
            drift_m: couple.drift_m,
            x_m: couple.motion.unwrap_or_default().0,
            flags: bit(couple.motion.is_some(), flag::MEASURED)
                | bit(couple.is_clear, flag::CLEAR)
                | bit(couple.is_doubtful, flag::DOUBTFUL)
                | bit(couple.is_object_ambiguous, flag::OBJECT_AMBIGUOUS)
                | bit(couple.is_object_new, flag::OBJECT_NEW)
                | bit(couple.is_object_displaced, flag::OBJECT_DISPLACED),
            visibility: couple.visibility.map(|visibility| visibility as u8),
            waiting: couple.waiting as u8,
            hidden_object: couple.hidden_object,
            padding: 0,
        };
    }
}

/// Reads the couples from a message.
pub fn read(message: &Message) -> Couples {
    let hand = |side: Side, place: &HandCouple| Couple {
        side,
        captured_ns: message.described_ns,
        motion: (place.flags & flag::MEASURED != 0).then_some(Motion(place.x_m)),
        context: Context(place.x_c),
        position: point_of(place.position_m),
        tips: point_of(place.tips_m),
        drift_m: if place.drift_m.is_finite() { place.drift_m } else { 0.0 },
        distances: place.distances_m,
        visibility: place.visibility.map(visibility),
        waiting: waiting(place.waiting),
        is_clear: place.flags & flag::CLEAR != 0,
        is_doubtful: place.flags & flag::DOUBTFUL != 0,
        is_object_ambiguous: place.flags & flag::OBJECT_AMBIGUOUS != 0,
        is_object_new: place.flags & flag::OBJECT_NEW != 0,
        is_object_displaced: place.flags & flag::OBJECT_DISPLACED != 0,
        hidden_object: place.hidden_object,
    };
    Couples {
        captured_ns: message.described_ns,
        known_ns: message.known_ns,
        is_captured: message.flags & flag::CAPTURED != 0,
        has_moved_unseen: message.flags & flag::MOVED_UNSEEN != 0,
        is_carried_unseen: message.flags & flag::CARRIED_UNSEEN != 0,
        is_bench_hidden: message.flags & flag::BENCH_HIDDEN != 0,
        objects: message.objects,
        at_start: ObjectSet::from_bits(message.at_start),
        out_of_sight: ObjectSet::from_bits(message.out_of_sight),
        twice: ObjectSet::from_bits(message.twice),
        hands: [hand(Side::Right, &message.hands[0]), hand(Side::Left, &message.hands[1])],
    }
}

/// A place that is not known is not a number.
fn place_of(point: Option<Point>) -> [f32; 3] {
    point.unwrap_or([f32::NAN; 3])
}

fn point_of(place: [f32; 3]) -> Option<Point> {
    Some(place).filter(|place| place.iter().all(|value| value.is_finite()))
}

/// The bit, if it is to be set.
fn bit<T: Default>(is_set: bool, bit: T) -> T {
    if is_set { bit } else { T::default() }
}

/// Numbers that do not exist are taken for the worst visibility.
fn visibility(number: u8) -> Visibility {
    match number {
        0 => Visibility::Seen,
        1 => Visibility::Assumed,
        _ => Visibility::Unseen,
    }
}

/// Of numbers that do not exist nothing is known.
fn waiting(number: u8) -> Waiting {
    match number {
        0 => Waiting::No,
        2 => Waiting::Yes,
        _ => Waiting::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn couples_come_out_of_shared_memory_as_they_went_in() {
        let couple = Couple {
            motion: Some(Motion([1, 2, -3, 4, 5, 6, 7])),
            context: Context([1, 5, 5, 6]),
            position: Some([0.1, -0.2, 0.3]),
            tips: Some([0.3, 0.1, 0.2]),
            drift_m: 0.017,
            distances: [0.01, 0.02],
            visibility: [Visibility::Seen, Visibility::Assumed, Visibility::Unseen],
            is_clear: true,
            is_doubtful: false,
            is_object_ambiguous: true,
            is_object_new: true,
            is_object_displaced: true,
            waiting: Waiting::Yes,
            hidden_object: 7,
            ..Couple::idle(Side::Right, 9)
        };
        let left = Couple { motion: None, waiting: Waiting::Unknown, ..Couple::idle(Side::Left, 9) };
        let hands = [couple, left];
        let couples = Couples {
            captured_ns: 9,
            known_ns: 11,
            is_captured: true,
            has_moved_unseen: true,
            is_carried_unseen: true,
            is_bench_hidden: true,
            objects: core::array::from_fn(|index| index as u16 + 1),
            at_start: ObjectSet::first(3),
            out_of_sight: ObjectSet::of(5),
            twice: ObjectSet::of(8),
            hands,
        };
        let mut message = Message::default();
        write(&couples, &mut message);
        assert_eq!(read(&message), couples);
    }
}
