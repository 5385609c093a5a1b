//! Channel `couple`: the feature couples `X = (x_m, x_c)` of both hands at one instant of the grid (paper III-A.3).

use crate::HANDS;
use crate::layout::wire;
use crate::stamp::{Stamp, message};

wire! { "andon.HandCouple", 60;
    /// The feature couple of one hand.
    struct HandCouple {
        /// `x_c = [ID_h, ID_oj, ID_oj, ID_ol]`.
        x_c: [u16; 4],
        /// Minimum distances from the hand to `o_j` and from `o_j` to `o_l` in metres; infinite without such a contact.
        distances_m: [f32; 2],
        /// Where the hand acts in metres: `o_j` in the frame of `o_l`, or without `o_l` the finger tips on the bench. NaN where it was not seen.
        position_m: [f32; 3],
        /// The finger tips on the bench in metres; NaN where they were neither seen nor assumed, or the hand does not act.
        tips_m: [f32; 3],
        /// How far apart two positions of `o_j`, in the frame of `o_l` if any, may be by drift, in metres. 0 where unknown.
        drift_m: f32,
        /// `x_m = [a_h, θ_hj, φ_hj, jm_hj, θ_jl, φ_jl, jm_jl]`; it means nothing where it was not measured.
        x_m: [i8; 7],
        /// 1 where the motion was measured, else 0.
        is_measured: u8,
        /// The visibility of the hand, of `o_j` and of `o_l`: 0 seen, 1 assumed, 2 unseen.
        visibility: [u8; 3],
        /// Whether the hand waits for the other one: 0 no, 1 not known, 2 yes.
        waiting: u8,
        /// The object because of which the frame does not show what the hand does, as it is hidden; 0 where there is none.
        hidden_object: u16,
        /// What was not seen, one bit for each. 0 is a frame, 1 the context in the frame itself, 2 whether it has changed, and 3 which object the
        /// hand took. 4 is `o_j` or `o_l` up to just before this began. 5 is how one of them came to where this began.
        unseen: u16,
    }
}

wire! { "andon.Couples", 280;
    /// The feature couples of both hands. The stamp names the newest frame that they depend on.
    struct Couples {
        /// The stamp.
        stamp: Stamp,
        /// The instant that the couples describe, in nanoseconds of source time.
        described_ns: u64,
        /// Source time of the newest frame that they depend on: `persist` frames after `described_ns`.
        known_ns: u64,
        /// The hash of the job whose runs show where and how near its objects are met; 0 where there is none.
        model_hash: u64,
        /// CLOCK_MONOTONIC of the first frame since the encoder has begun: what came before it has no part in them.
        began_ns: u64,
        /// Bits of [`crate::flag`]: `END_OF_STREAM` (the couples then mean nothing), `PACED`.
        flags: u32,
        /// What was not seen, one bit for each. 0 is a frame at this instant and 6 who has moved an object that lies elsewhere than before. 7 is the
        /// hand that carries an object which moves. 8 is any object, or one that lay in sight when a hand was seen last, or since.
        unseen: u32,
        /// The ids of the objects that are followed, ascending, then 0; in the sets below there is one bit for each, in this order.
        objects: [u16; 32],
        /// The objects that lie where that job begins.
        at_start: u32,
        /// The objects that have never been seen or not for longer than `blind_ms`.
        out_of_sight: u32,
        /// The objects whose markers the newest frame shows twice.
        twice: u32,
        /// Zero.
        padding: u32,
        /// The right hand, then the left hand.
        hands: [HandCouple; HANDS],
    }
}
message!(Couples);
