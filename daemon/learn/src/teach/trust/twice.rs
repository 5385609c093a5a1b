//! The same recording given more than once: it shows no more than once, and makes the spread look smaller than it is.
//!
//! A film that was encoded again, turned, made larger or shifted in time is the same run. So is a track file with noise on it. Two runs are the same
//! where the hands do the same to a few millimetres all the time. One is first moved as a whole in time and on the bench.
//!
//! Eight copies of each of 16 runs were made, with noise: later, with every third frame, turned, without hands now and then. Of the 128 copies 105
//! are found, and none of 32 other runs is taken for one. With half or twice a constant the latter never differs.

use super::{Doubt, names};
use crate::run::Run;
use andon_core::input::{Frame, Point, Side};

/// The hands of two recordings of one run are no farther apart than this in nine of ten instants, in metres. The shipped films encoded again, turned,
/// enlarged, and with little data, are 1.5 to 3.7 mm apart. Of two different runs of one person the nearest are 4 cm apart.
const MAX_APART_M: f64 = 0.008;
const MIN_NEAR_SHARE: f64 = 0.9;

/// At least this share of the instants with a hand must be in both. With half of it 126 of 128 copies are found, with 0.9 it is 92.
const MIN_COMMON: f64 = 0.8;

/// At least so many instants are compared, and the hands get about by so much, in metres. A hand that rests is alike in all runs. With 10 instants
/// all is found that is with 20, and with 40 one copy of 128 fewer. Another spread changes nothing.
const MIN_INSTANTS: usize = 20;
const MIN_SPREAD_M: f64 = 0.03;

/// So often the hands are compared: often enough for what people do with them. Halved, as many copies are found, and doubled one of 128 fewer.
const STEP_NS: i64 = 200_000_000;

/// One recording may begin so much before the other one. Halved, 12 of 128 copies fewer are found, those that begin 1.9 s later; doubled, as many.
const MAX_SHIFT_NS: i64 = 2_000_000_000;
/// First the shift is found to this step, within which a hand at 1 m/s moves by 5 cm, and then exactly. Half the time between two pictures makes a
/// centimetre of it. Halved or doubled, the first one finds as many copies, and the second one 2 of 128 more or 1 fewer.
const COARSE_NS: i64 = 100_000_000;
const FINE_NS: i64 = 5_000_000;

/// A hand is between two frames where these are no farther apart. Halved, as many copies are found, and doubled 9 of 128 more, those that lack hands
/// for 0.3 s at a time.
const MAX_GAP_NS: u64 = 250_000_000;

/// Takes out the runs that show what an earlier one shows, and says so.
pub(in crate::teach) fn without_copies(runs: &mut Vec<Run>) -> Option<Doubt> {
    let tracks: Vec<Tracks<'_>> = runs.iter().map(Tracks::of).collect();
    let is_copy = |index: usize| {
        (0..index).any(|earlier| {
            runs[earlier].shows_the_same(&runs[index]) || tracks[earlier].are_of_one_run(&tracks[index])
        })
    };
    let mut are_copies = (0..runs.len()).map(is_copy).collect::<Vec<bool>>().into_iter();
    let copies =
        runs.extract_if(.., |_| are_copies.next() == Some(true)).map(|run| run.name).collect::<Vec<_>>();
    let different = match runs.len() {
        1 => "one different run remains".to_owned(),
        count => format!("{count} different runs remain"),
    };
    (!copies.is_empty()).then(|| {
        Doubt::new(
            format!("{} an earlier run: only {different}", names(&copies, ["repeats", "repeat"])),
            "give each recording once, and record more runs: 5 should be enough".to_owned(),
        )
    })
}

/// Where each hand is, frame by frame.
struct Tracks<'a>([Vec<(u64, &'a Point)>; 2]);

impl<'a> Tracks<'a> {
    fn of(run: &'a Run) -> Self {
        let at = |side: Side, frame: &'a Frame| {
            let hand = frame.hands.iter().find(|hand| hand.side == side)?;
            Some((frame.captured_ns, &hand.middle_knuckle))
        };
        Self(Side::ALL.map(|side| run.frames().iter().filter_map(|frame| at(side, frame)).collect()))
    }

    /// Whether both show one run.
    fn are_of_one_run(&self, other: &Self) -> bool {
        let best = |shifts: &mut dyn Iterator<Item = i64>| {
            let apart = shifts.filter_map(|shift| Some((self.apart_m(other, shift)?, shift)));
            apart.min_by(|one, other| one.0.total_cmp(&other.0))
        };
        let steps = MAX_SHIFT_NS / COARSE_NS;
        let Some((_, near)) = best(&mut (-steps..=steps).map(|step| step * COARSE_NS)) else { return false };
        let steps = COARSE_NS / FINE_NS;
        let exact = best(&mut (-steps..=steps).map(|step| near + step * FINE_NS));
        exact.is_some_and(|(apart_m, _)| apart_m <= MAX_APART_M)
    }

    /// How far the hands are apart in nine of ten instants. The other recording is later by so much, and is moved onto this one. `None` where too
    /// little is in both.
    fn apart_m(&self, other: &Self, shift_ns: i64) -> Option<f64> {
        let (mut pairs, mut instants) = (Vec::new(), 0);
        for (own, others) in self.0.iter().zip(&other.0) {
            let (Some((first, _)), Some((last, _))) = (own.first(), own.last()) else { continue };
            let mut now = *first as i64;
            while now <= *last as i64 {
                if let Some(here) = at(own, now) {
                    instants += 1;
                    pairs.extend(at(others, now + shift_ns).map(|there| [here, there]));
                }
                now += STEP_NS;
            }
        }
        let is_enough = pairs.len() >= MIN_INSTANTS && pairs.len() as f64 >= MIN_COMMON * f64::from(instants);
        is_enough.then(|| apart_m(&pairs)).flatten()
    }
}

/// Where a hand is at a time, between the frames around it; `None` where it is not seen.
fn at(track: &[(u64, &Point)], now_ns: i64) -> Option<[f64; 3]> {
    let now_ns = u64::try_from(now_ns).ok()?;
    let next = track.partition_point(|(at, _)| *at < now_ns);
    let (after, there) = track.get(next)?;
    if *after == now_ns {
        return Some(there.map(f64::from));
    }
    let (before, here) = track.get(next.checked_sub(1)?)?;
    if after - before > MAX_GAP_NS {
        return None;
    }
    let share = (now_ns - before) as f64 / (after - before) as f64;
    Some([0, 1, 2].map(|axis| f64::from(here[axis]) * (1.0 - share) + f64::from(there[axis]) * share))
}

/// The distance that nine of ten pairs keep to. All second points are turned about the bench's normal and moved so that they come as near to the
/// first ones as they can. `None` where the hand hardly moves.
fn apart_m(pairs: &[[[f64; 3]; 2]]) -> Option<f64> {
    let count = pairs.len() as f64;
    let middle =
        |which: usize| [0, 1, 2].map(|axis| pairs.iter().map(|pair| pair[which][axis]).sum::<f64>() / count);
    let middles = [middle(0), middle(1)];
    let from_middle =
        |pair: &[[f64; 3]; 2], which: usize| [0, 1, 2].map(|axis| pair[which][axis] - middles[which][axis]);
    let (mut sine, mut cosine, mut spread) = (0.0, 0.0, 0.0);
    for pair in pairs {
        let ([x, y, z], [u, v, _]) = (from_middle(pair, 0), from_middle(pair, 1));
        sine += u * y - v * x;
        cosine += u * x + v * y;
        spread += x * x + y * y + z * z;
    }
    if (spread / count).sqrt() < MIN_SPREAD_M {
        return None;
    }
    let (sine, cosine) = sine.atan2(cosine).sin_cos();
    let mut apart: Vec<f64> = pairs
        .iter()
        .map(|pair| {
            let ([x, y, z], [u, v, w]) = (from_middle(pair, 0), from_middle(pair, 1));
            let [u, v] = [u * cosine - v * sine, u * sine + v * cosine];
            ((x - u).powi(2) + (y - v).powi(2) + (z - w).powi(2)).sqrt()
        })
        .collect();
    let index = ((apart.len() - 1) as f64 * MIN_NEAR_SHARE) as usize;
    Some(*apart.select_nth_unstable_by(index, f64::total_cmp).1)
}
