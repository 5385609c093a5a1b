//! Feature couples, from the method to shared memory and back.

use andon_core::couple::{Context, Couple, Couples, Motion, Unseen, Visibility, Waiting};
use andon_core::input::{Point, Side};
use andon_core::set::ObjectSet;
use shm_schemas::{Couples as Message, HandCouple};

/// Writes the couples into the loaned message. Its other flags stay as they are.
pub fn write(couples: &Couples, message: &mut Message) {
    message.described_ns = couples.captured_ns;
    message.known_ns = couples.known_ns;
    message.objects = couples.objects;
    message.at_start = couples.at_start.bits();
    message.out_of_sight = couples.out_of_sight.bits();
    message.twice = couples.twice.bits();
    message.unseen = couples.unseen.bits();
    for (couple, place) in couples.hands.iter().zip(message.hands.iter_mut()) {
        *place = HandCouple {
            x_c: couple.context.0,
            distances_m: couple.distances,
            position_m: place_of(couple.position),
            tips_m: place_of(couple.tips),
            drift_m: couple.drift_m,
            x_m: couple.motion.unwrap_or_default().0,
            is_measured: couple.motion.is_some().into(),
            visibility: couple.visibility.map(|visibility| visibility as u8),
            waiting: couple.waiting as u8,
            hidden_object: couple.hidden_object,
            unseen: couple.unseen.bits() as u16,
        };
    }
}

/// Reads the couples from a message.
pub fn read(message: &Message) -> Couples {
    let hand = |side: Side, place: &HandCouple| Couple {
        side,
        captured_ns: message.described_ns,
        motion: (place.is_measured != 0).then_some(Motion(place.x_m)),
        context: Context(place.x_c),
        position: point_of(place.position_m),
        tips: point_of(place.tips_m),
        drift_m: if place.drift_m.is_finite() { place.drift_m } else { 0.0 },
        distances: place.distances_m,
        visibility: place.visibility.map(visibility),
        waiting: waiting(place.waiting),
        unseen: Unseen::from_bits(place.unseen.into()),
        hidden_object: place.hidden_object,
    };
    Couples {
        captured_ns: message.described_ns,
        known_ns: message.known_ns,
        unseen: Unseen::from_bits(message.unseen),
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
            unseen: Unseen::CONTEXT | Unseen::TAKING | Unseen::MOVE,
            waiting: Waiting::Yes,
            hidden_object: 7,
            ..Couple::idle(Side::Right, 9)
        };
        let left = Couple { motion: None, waiting: Waiting::Unknown, ..Couple::idle(Side::Left, 9) };
        let hands = [couple, left];
        let couples = Couples {
            captured_ns: 9,
            known_ns: 11,
            unseen: Unseen::FRAME | Unseen::BENCH,
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
