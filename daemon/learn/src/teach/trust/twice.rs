//! The same recording given more than once: it shows no more than once, and makes the spread look smaller than it is.

use super::Doubt;
use crate::run::Run;
use std::borrow::Cow;

/// The runs without those that show what an earlier one shows, and the names of these.
pub(in crate::teach) fn without_copies(runs: &[Run]) -> (Cow<'_, [Run]>, Option<Doubt>) {
    let is_copy = |index: &usize| runs[..*index].iter().any(|earlier| earlier.shows_the_same(&runs[*index]));
    let copies: Vec<usize> = (0..runs.len()).filter(is_copy).collect();
    if copies.is_empty() {
        return (Cow::Borrowed(runs), None);
    }
    let kept = (0..runs.len()).filter(|index| !copies.contains(index));
    let names = copies.iter().map(|&index| runs[index].name.clone()).collect();
    let doubt = Doubt::Twice { copies: names, runs: runs.len() - copies.len() };
    (kept.map(|index| runs[index].clone()).collect(), Some(doubt))
}
