//! Which pairs of parts count. That two parts come near each other means something only where the runs agree that it does. Two that are both at a
//! third one meet by chance, now this one nearer and now that.
//!
//! The pairs are chosen by minimum description length (Rissanen 1978). The sequences of all steps and the pairs that do not count are described
//! together in as few bits as possible. A pair that counts is spelled once in each different sequence that it makes. Each contact of a pair that does
//! not count is told by where in the sequence of its run it begins and ends. So a contact that all runs share is cheaper as a part of the job. One
//! that is now here and now there is cheaper as chance.

use super::sequence::{self, MIN_ALIKE};
use super::{TeachError, encoded_with};
use crate::recording::NamedObject;
use crate::run::Run;
use std::collections::{BTreeMap, BTreeSet};

/// The ids of two objects, the lower one first.
type Pair = [u16; 2];

/// Finds the pairs that do not count, and encodes the runs without them.
///
/// # Errors
/// If the runs cannot be encoded.
pub(super) fn choose(mut runs: Vec<Run>) -> Result<Vec<Run>, TeachError> {
    if runs.len() < MIN_ALIKE {
        return Ok(runs);
    }
    let contacts = contacts(&runs);
    let mut best = description_bits(&runs, &contacts, &BTreeSet::new());
    let mut incidental = BTreeSet::new();
    loop {
        let mut better: Vec<Tried> = Vec::new();
        for pair in contacts.keys().filter(|pair| !incidental.contains(*pair)) {
            let encoded = encoded_with(&without(&runs[0].objects, *pair), &runs)?;
            let tried: BTreeSet<Pair> = incidental.iter().copied().chain([*pair]).collect();
            let bits = description_bits(&encoded, &contacts, &tried);
            if bits < best {
                better.push(Tried { bits, pair: *pair, runs: encoded });
            }
        }
        let Some(chosen) = shortest(better) else { return Ok(runs) };
        (best, runs) = (chosen.bits, chosen.runs);
        incidental.insert(chosen.pair);
    }
}

struct Tried {
    bits: f64,
    pair: Pair,
    runs: Vec<Run>,
}

/// The shortest of these descriptions. Of two parts at a third one, either may seem to be what the other is at. Then descriptions without a pair that
/// shares a part with that of the shortest one are compared. The one decides in which parts move least along what they touch.
fn shortest(tried: Vec<Tried>) -> Option<Tried> {
    let [one, other] = tried.iter().min_by(|one, other| one.bits.total_cmp(&other.bits))?.pair;
    let shares = |tried: &Tried| tried.pair.contains(&one) || tried.pair.contains(&other);
    let rivals = tried.into_iter().filter(shares);
    rivals.min_by(|one, other| paths_m(&one.runs).total_cmp(&paths_m(&other.runs)))
}

/// How far parts move along others that they touch, in metres, in all runs.
fn paths_m(runs: &[Run]) -> f64 {
    let ius = runs.iter().flat_map(|run| &run.activities).flat_map(|activity| &activity.ius);
    ius.filter(|iu| iu.context.is_pair()).map(|iu| f64::from(iu.measures.path_m)).sum()
}

/// The objects, of which these two have no contact.
fn without(objects: &[NamedObject], [one, other]: Pair) -> Vec<NamedObject> {
    let mut objects = objects.to_vec();
    if let Some(object) = objects.iter_mut().find(|object| object.shape.id == one) {
        // There is room for every other object of a bench.
        let _ = object.shape.incidental.push(other);
    }
    objects
}

/// How often two parts are in contact where a hand acts on one of them or has let go of it, for each run.
fn contacts(runs: &[Run]) -> BTreeMap<Pair, Vec<usize>> {
    let mut contacts: BTreeMap<Pair, Vec<usize>> = BTreeMap::new();
    for (number, run) in runs.iter().enumerate() {
        for iu in run.activities.iter().flat_map(|activity| &activity.ius) {
            let [_, _, j, l] = iu.context.0;
            if l != 0 {
                contacts.entry([j.min(l), j.max(l)]).or_insert_with(|| vec![0; runs.len()])[number] += 1;
            }
        }
    }
    contacts
}

/// The length in bits of the shortest description of the runs that is known.
fn description_bits(runs: &[Run], contacts: &BTreeMap<Pair, Vec<usize>>, incidental: &BTreeSet<Pair>) -> f64 {
    // Where in the sequence of a run something happens.
    let place_bits = |run: usize| {
        ((1 + runs[run].activities.iter().map(|activity| activity.ius.len()).sum::<usize>()) as f64).log2()
    };
    let by_chance: f64 = incidental
        .iter()
        .flat_map(|pair| contacts[pair].iter().enumerate())
        .map(|(run, count)| *count as f64 * 2.0 * place_bits(run))
        .sum();
    sequence::description_bits(runs) + by_chance
}
