//! One run in another order than all others: either the order is free, or the run is not right.

use super::Doubt;
use crate::run::Run;
use crate::teach::sequence::{Agreement, MIN_RUNS};
use andon_core::couple::Context;
use andon_core::input::Side;

/// The one run that does the common steps of one hand in another order than all others, if there is exactly one. The order between two hands is no
/// evidence: hands that work side by side begin now the one, now the other first.
pub(super) fn odd_one(
    runs: &[&Run],
    agreement: &Agreement,
    words: &dyn Fn(Context) -> String,
) -> Option<Doubt> {
    if runs.len() < MIN_RUNS {
        return None;
    }
    let in_all: Vec<&Vec<Option<usize>>> =
        agreement.steps.iter().filter(|step| step.iter().all(Option::is_some)).collect();
    Side::ALL.into_iter().find_map(|side| {
        let orders: Vec<Vec<Context>> =
            (0..runs.len()).map(|run| order(runs[run], run, &in_all, side)).collect();
        let odd = (0..orders.len()).find(|&odd| is_odd(&orders, odd))?;
        let usual = &orders[usize::from(odd == 0)];
        let at = orders[odd].iter().zip(usual).position(|(had, others)| had != others)?;
        let (run, [had, theirs]) = (&runs[odd].name, [orders[odd][at], usual[at]].map(words));
        Some(Doubt::new(
            format!(
                "{run} has another order than the {} others: its step {} begins with {had}, theirs with {theirs}",
                runs.len() - 1,
                at + 1
            ),
            format!(
                "leave {run} out if it is not correct; if both orders are, say so with --order false or show more runs in that order"
            ),
        ))
    })
}

/// Whether all others agree with each other and not with this one.
fn is_odd(orders: &[Vec<Context>], odd: usize) -> bool {
    let mut others = (0..orders.len()).filter(|&index| index != odd).map(|index| &orders[index]);
    let Some(first) = others.next() else { return false };
    *first != orders[odd] && others.all(|other| other == first)
}

/// The hand and object with which each of these steps of a hand begins in a run, in the order of time.
fn order(run: &Run, number: usize, steps: &[&Vec<Option<usize>>], side: Side) -> Vec<Context> {
    let mut indices: Vec<usize> = steps.iter().filter_map(|step| step[number]).collect();
    indices.sort_unstable();
    let of_side =
        indices.into_iter().map(|index| &run.activities[index]).filter(|activity| activity.side == side);
    let opening = |Context([hand, object, ..]): Context| Context([hand, object, 0, 0]);
    of_side.filter_map(|activity| activity.ius.first()).map(|iu| opening(iu.context)).collect()
}
