//! One run in another order than all others: either the order is free, or the run is not right.

use super::{Doubt, MIN_RUNS};
use crate::run::Run;
use andon_core::couple::Context;
use andon_core::input::Side;

/// The run that does the activities of one hand in another order than all others do, if there is exactly one. The order between two hands is
/// no evidence: hands that work side by side begin now the one, now the other first.
pub(super) fn odd_one(runs: &[&Run]) -> Option<Doubt> {
    if runs.len() < MIN_RUNS {
        return None;
    }
    Side::ALL.into_iter().find_map(|side| {
        let orders: Vec<Vec<Context>> = runs.iter().map(|run| order(run, side)).collect();
        let odd = (0..orders.len()).find(|&odd| is_odd(&orders, odd))?;
        let usual = &orders[usize::from(odd == 0)];
        let at = orders[odd].iter().zip(usual).position(|(had, others)| had != others)?;
        Some(Doubt::OtherOrder {
            run: runs[odd].name.clone(),
            others: runs.len() - 1,
            place: at,
            had: orders[odd][at],
            usual: usual[at],
        })
    })
}

/// Whether all others agree with each other and not with this one.
fn is_odd(orders: &[Vec<Context>], odd: usize) -> bool {
    let mut others = (0..orders.len()).filter(|&index| index != odd).map(|index| &orders[index]);
    let Some(first) = others.next() else { return false };
    *first != orders[odd] && others.all(|other| other == first)
}

/// The first context of each activity of a hand, in the order of time.
fn order(run: &Run, side: Side) -> Vec<Context> {
    let of_side = run.activities.iter().filter(|activity| activity.side == side);
    of_side.filter_map(|activity| activity.ius.first()).map(|iu| iu.context).collect()
}
