//! How far apart two objects may go before their contact has ended, where people differ more than they do in general. Who makes strokes as long as
//! may be right does not leave the other part. With it for all people, 9 of 90 wrong objects were right (a shop floor's faults, 30 draws).

use super::measures::Rates;
use super::people::People;
use super::sequence::{Agreement, ShownIu, agree};
use super::strength::Strengths;
use super::{TeachError, TeachOptions, encoded_with};
use crate::recording::NamedObject;
use crate::run::{Iu, Run};
use andon_core::config::Contact;
use andon_core::couple::Context;
use andon_core::object::ContactRegion;
use std::collections::BTreeMap;

/// The shares of the missing reach that are tried, each twice as much as the next. One is taken if neither it nor twice as much changes a run, so that
/// the contact ends midway to where the parts lie apart. Else a part that another run puts back somewhat nearer would seem not to leave.
const TRIED_SHARES: [f32; 4] = [2.0, 1.0, 0.5, 0.25];

/// The runs, with contacts that last for strokes of any right length where their people differ more than they do in general. `None` where nothing
/// is widened.
///
/// # Errors
/// If the objects cannot be used.
pub(super) fn widened(
    runs: &[Run],
    agreement: &Agreement,
    options: &TeachOptions,
) -> Result<Option<Vec<Run>>, TeachError> {
    let people = People::of(runs, agreement, options.method.rate_hz);
    if !people.differ_more() {
        return Ok(None);
    }
    let rates = Rates::new(options.bounds.false_alarms, people, agreement);
    let reaches = reaches_m(runs, agreement, &rates);
    let mut is_farther_alike = false;
    for share in TRIED_SHARES {
        let mut objects = runs[0].objects.clone();
        for (pair, reach_m) in &reaches {
            widen(&mut objects, *pair, *reach_m, share, options.method.object_contact);
        }
        if objects == runs[0].objects {
            break;
        }
        let widened = encoded_with(&objects, runs)?;
        let agreed = agree(&widened, &Strengths::default());
        // Where parts lie near each other, they would seem to touch for longer.
        let is_alike = agreed.used == agreement.used && steps(&agreed).eq(steps(agreement));
        if is_alike && is_farther_alike {
            return Ok(Some(widened));
        }
        is_farther_alike = is_alike;
    }
    Ok(None)
}

fn steps(agreement: &Agreement) -> impl Iterator<Item = (u16, &[Context])> {
    agreement.sequences.iter().map(|step| (step.activity, step.contexts.as_slice()))
}

/// How far apart each two parts may go in any of their IUs, in metres.
fn reaches_m(runs: &[Run], agreement: &Agreement, rates: &Rates) -> BTreeMap<[u16; 2], f32> {
    let mut reaches = BTreeMap::new();
    for (iu, reach_m) in agreement.ius().filter_map(|iu| Some((iu, reach_m(runs, iu, rates)?))) {
        let Context([_, _, j, l]) = iu.context;
        let farthest = reaches.entry([j.min(l), j.max(l)]).or_insert(reach_m);
        *farthest = f32::max(*farthest, reach_m);
    }
    reaches
}

/// How far apart the two parts of an IU may go in strokes of any right length, as far as the demonstrations tell. At either end of a stroke that is
/// longer by some way, they are farther apart by no more than half of that. What is twice as long as any that was shown is not the same motion. In
/// metres.
fn reach_m(runs: &[Run], iu: &ShownIu, rates: &Rates) -> Option<f32> {
    let shown_m = iu.measured.iter().filter_map(|measures| measures.stroke_m);
    let longest_m = rates.longest_stroke_m(iu)?.min(2.0 * shown_m.reduce(f32::max)?);
    let of_one =
        |(run, iu): (usize, &Iu)| Some(runs[run].reach_m(iu) + (longest_m - iu.measures.stroke_m?) / 2.0);
    iu.ius(runs).filter_map(of_one).reduce(f32::min)
}

/// Lets the contact of the two parts end no nearer than this, in metres.
fn widen(objects: &mut [NamedObject], [j, l]: [u16; 2], reach_m: f32, share: f32, default: Contact) {
    for (at, with) in [(l, j), (j, l)] {
        let Some(object) = objects.iter_mut().find(|object| object.shape.id == at) else { continue };
        if let Some(met) = object.shape.contact_regions.iter_mut().find(|met| met.with == with) {
            met.contact.off_m += share * (reach_m - met.contact.off_m).max(0.0);
            return;
        }
    }
    if reach_m > default.off_m
        && let Some(object) = objects.iter_mut().find(|object| object.shape.id == l)
    {
        let contact = Contact { off_m: default.off_m + share * (reach_m - default.off_m), ..default };
        // What exceeds the capacity is met as the station says.
        let _ = object.shape.contact_regions.push(ContactRegion {
            with: j,
            points: heapless::Vec::new(),
            contact,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::object::ObjectShape;

    #[test]
    fn a_contact_is_widened_where_it_was_learnt_or_else_at_the_second_part() {
        let object =
            |id| NamedObject { name: String::new(), shape: ObjectShape { id, ..ObjectShape::default() } };
        let (mut objects, default) = (vec![object(5), object(6)], Contact { on_m: 0.03, off_m: 0.045 });
        let off_m = |objects: &[NamedObject]| -> Vec<Vec<f32>> {
            let of = |object: &NamedObject| {
                object.shape.contact_regions.iter().map(|met| met.contact.off_m).collect()
            };
            objects.iter().map(of).collect()
        };
        let polishing = [5, 6];
        widen(&mut objects, polishing, 0.04, 1.0, default);
        assert!(off_m(&objects).iter().all(Vec::is_empty), "it is wide enough");
        widen(&mut objects, polishing, 0.065, 0.5, default);
        assert_eq!(off_m(&objects), [vec![], vec![0.055]]);
        widen(&mut objects, [6, 5], 0.075, 1.0, default);
        assert_eq!(off_m(&objects), [vec![], vec![0.075]]);
        widen(&mut objects, polishing, 0.06, 1.0, default);
        assert_eq!(off_m(&objects), [vec![], vec![0.075]]);
    }
}
