//! Either hand may be the first where both meet.
//!
//! One hand takes hold of a part and leaves it where it lies, and the other hand brings another part there. Hands that begin within a few seconds of
//! each other show no order (`relation`). So the part that is brought may be there first. Then the first IU, in which the hand holds its part alone,
//! does not come. Such an activity is right without its first IU, too.

use super::TeachOptions;
use super::relation::is_order_of_hands;
use super::sequence::{Agreement, Sequence};
use crate::job_file::{JobFile, TaughtActivity};
use crate::run::{Iu, Run};
use crate::statistics::median;
use andon_core::capacity::{ACTIVITIES, COMPARISONS};
use andon_core::couple::Context;
use andon_core::segment::MOVED_M;

/// Adds to the nominal activities those that have no first IU where the other hand was the first, as far as there is room.
pub(super) fn add(
    activities: &mut Vec<TaughtActivity>,
    agreement: &Agreement,
    runs: &[Run],
    options: &TeachOptions,
) {
    for (index, sequence) in agreement.sequences.iter().enumerate() {
        if may_be_second(sequence, runs, options) {
            let mut rest = activities[index].clone();
            rest.ius.remove(0);
            if has_room(activities, &rest) {
                activities.push(rest);
            }
        }
    }
}

/// Whether this step of a job is also right without its first IU.
pub(super) fn is_in(job: &JobFile, step: usize) -> bool {
    let of_step = || job.activities.iter().filter(|taught| usize::from(taught.activity) == step);
    of_step().any(|rest| of_step().any(|whole| whole.ius.get(1..) == Some(rest.ius.as_slice())))
}

/// Whether the runs show no order between the hand that begins the sequence and the other one, which brings something to it.
fn may_be_second(sequence: &Sequence, runs: &[Run], options: &TeachOptions) -> bool {
    let [Context([_, held, 0, 0]), Context([_, _, _, brought]), ..] = sequence.contexts[..] else {
        return false;
    };
    let paths: Vec<f64> = sequence.ius[0].measured.iter().map(|measures| measures.path_m.into()).collect();
    let gap_s = |&(run, activity): &(usize, usize)| {
        let (run, activity) = (&runs[run], &runs[run].activities[activity]);
        let [first, second] = *sequence.indices(activity).get(..2)? else { return None };
        let [first, second] = [first, second].map(|iu| &activity.ius[iu]);
        let is_there = |iu: &&Iu| {
            let is_brought = iu.context.0[1..] == [brought, brought, held];
            is_brought && (iu.began_ns..=iu.ended_ns).contains(&second.began_ns)
        };
        let others = run.activities.iter().filter(|other| other.side != activity.side);
        let comes = others.flat_map(|other| &other.ius).find(is_there)?;
        Some((comes.began_ns as f64 - first.began_ns as f64) * 1e-9)
    };
    let gaps: Option<Vec<f64>> = sequence.shown.iter().map(gap_s).collect();
    let is_held_still = !paths.is_empty() && median(&paths) <= f64::from(MOVED_M);
    is_held_still && gaps.is_some_and(|gaps| !is_order_of_hands(&gaps, options))
}

/// Whether one more nominal activity, which is none of these yet, can be judged beside them.
fn has_room(activities: &[TaughtActivity], more: &TaughtActivity) -> bool {
    let has =
        |context: Context| activities.iter().filter(|taught| taught.contexts().contains(&context)).count();
    let is_new = activities.iter().all(|taught| taught.contexts() != more.contexts());
    is_new && activities.len() < ACTIVITIES && more.ius.iter().all(|iu| has(iu.context) < COMPARISONS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::recording::{Header, Landmarks, Recording};
    use crate::run::Activity;
    use crate::teach::sequence::agree;
    use crate::teach::strength::Strengths;
    use andon_core::config::Method;
    use andon_core::input::{Side, Space};
    use andon_core::segment::Measures;

    const PLATE: u16 = 5;
    const CLOTH: u16 = 6;

    /// The right hand takes the plate at this time and has moved it so far. The left hand brings the cloth after 12 s.
    fn run(taken_s: f64, path_m: f32) -> Run {
        let header = Header {
            rate_hz: 30.0,
            space: Space::Plane,
            hands: Side::ALL.to_vec(),
            landmarks: Landmarks::Five,
            objects: Vec::new(),
        };
        let recording = Recording { header, frames: Vec::new(), truncation: None };
        let mut run = Run::new("run", "", &recording, &Method::default()).unwrap();
        let iu = |context, path_m: f32, [began_s, ended_s]: [f64; 2]| Iu {
            context: Context(context),
            measures: Measures { path_m, ..Measures::default() },
            began_ns: (began_s * 1e9) as u64,
            ended_ns: (ended_s * 1e9) as u64,
            frames: 30,
            is_well_seen: true,
            ..Iu::default()
        };
        let held = vec![
            iu([1, PLATE, 0, 0], path_m, [taken_s, 12.0]),
            iu([1, PLATE, PLATE, CLOTH], path_m, [12.0, 13.0]),
        ];
        let brought =
            vec![iu([2, CLOTH, 0, 0], 0.2, [11.0, 12.0]), iu([2, CLOTH, CLOTH, PLATE], 0.2, [12.0, 15.0])];
        run.activities =
            vec![Activity { side: Side::Right, ius: held }, Activity { side: Side::Left, ius: brought }];
        run
    }

    fn may_be_second_in(runs: &[Run]) -> Vec<bool> {
        let sequences = agree(runs, &Strengths::default()).sequences;
        let options = TeachOptions::new("work", "2026-01-01", Method::default());
        sequences.iter().map(|sequence| may_be_second(sequence, runs, &options)).collect()
    }

    #[test]
    fn a_hand_that_holds_a_part_still_may_be_the_second_one_there_unless_the_runs_show_an_order() {
        let taken =
            |first_s: f64, path_m| [0.0, 0.8, 0.5, 1.1, 0.3].map(|later_s| run(first_s + later_s, path_m));
        // Of the two hands it is only the one to which something is brought.
        let soon = may_be_second_in(&taken(10.4, 0.0));
        assert_eq!(soon.iter().filter(|may_be| **may_be).count(), 1);
        assert!(!may_be_second_in(&taken(0.4, 0.0)).contains(&true), "it takes its part long before");
        assert!(!may_be_second_in(&taken(10.4, 0.2)).contains(&true), "both hands bring what they hold");
    }
}
