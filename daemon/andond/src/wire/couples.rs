//! Feature couples, from the method to shared memory and back.

use andon_core::couple::{Context, Couple, Couples, Motion};
use andon_core::input::Side;
use shm_schemas::{Couples as Message, HandCouple, flag};

/// Writes the couples into the loaned message.
pub fn write(couples: &Couples, message: &mut Message) {
    message.described_ns = couples.captured_ns;
    message.known_ns = couples.known_ns;
    for (couple, slot) in couples.hands.iter().zip(message.hands.iter_mut()) {
        *slot = HandCouple {
            x_c: couple.context.0,
            distances_m: couple.distances,
            x_m: couple.motion.0,
            flags: (if couple.sighted { flag::SIGHTED } else { 0 })
                | (if couple.seen { flag::HAND_SEEN } else { 0 }),
        };
    }
}

/// Reads the couples from a message.
pub fn read(message: &Message) -> Couples {
    let hand = |side: Side, couple: &HandCouple| Couple {
        side,
        captured_ns: message.described_ns,
        motion: Motion(couple.x_m),
        context: Context(couple.x_c),
        distances: couple.distances_m,
        sighted: couple.flags & flag::SIGHTED != 0,
        seen: couple.flags & flag::HAND_SEEN != 0,
    };
    Couples {
        captured_ns: message.described_ns,
        known_ns: message.known_ns,
        hands: [hand(Side::Right, &message.hands[0]), hand(Side::Left, &message.hands[1])],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn couples_come_out_of_shared_memory_as_they_went_in() {
        let couple = Couple {
            motion: Motion([1, 2, -3, 4, 5, 6, 7]),
            context: Context([1, 5, 5, 6]),
            distances: [0.01, 0.02],
            sighted: false,
            seen: true,
            ..Couple::idle(Side::Right, 9)
        };
        let couples = Couples { captured_ns: 9, known_ns: 11, hands: [couple, Couple::idle(Side::Left, 9)] };
        let mut message = Message::default();
        write(&couples, &mut message);
        assert_eq!(read(&message), couples);
    }
}
