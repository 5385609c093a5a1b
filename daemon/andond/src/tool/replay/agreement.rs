//! How far the verdicts of a replay agree with those that were sent.

use std::ops::Range;

/// What two lists have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Agreement {
    /// How many have come out again, in their order.
    pub(super) equal: usize,
    /// How many at the start are the same.
    pub(super) begin: usize,
    /// How many at the end are the same, of those after the start.
    pub(super) end: usize,
}

/// At most this many verdicts that differ are compared with each other. A recording has some thousands, and where most of them differ nobody needs
/// the exact number.
const COMPARED: usize = 4000;

impl Agreement {
    pub(super) fn of<T: PartialEq>(sent: &[T], judged: &[T]) -> Self {
        let begin = sent.iter().zip(judged).take_while(|(sent, judged)| sent == judged).count();
        let (sent, judged) = (&sent[begin..], &judged[begin..]);
        let last_first = sent.iter().rev().zip(judged.iter().rev());
        let end = last_first.take_while(|(sent, judged)| sent == judged).count();
        let middle = |all: usize| -> Range<usize> { 0..(all - end).min(COMPARED) };
        let between = common(&sent[middle(sent.len())], &judged[middle(judged.len())]);
        Self { equal: begin + between + end, begin, end }
    }
}

/// The length of the longest common subsequence.
fn common<T: PartialEq>(sent: &[T], judged: &[T]) -> usize {
    let mut row = vec![0; judged.len() + 1];
    for sent in sent {
        let mut diagonal = 0;
        for (column, judged) in judged.iter().enumerate() {
            let above = row[column + 1];
            row[column + 1] = if sent == judged { diagonal + 1 } else { above.max(row[column]) };
            diagonal = above;
        }
    }
    row.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_equal_is_counted_in_its_order_with_what_is_so_at_both_ends() {
        for (sent, judged, expected) in [
            ("", "", (0, 0, 0)),
            ("abc", "abc", (3, 3, 0)),
            ("abc", "", (0, 0, 0)),
            ("abcdef", "abXdef", (5, 2, 3)),
            // The start is not known, and from the third on all is as it was.
            ("abcdef", "XYcdef", (4, 0, 4)),
            ("abcdef", "Xcdef", (4, 0, 4)),
            ("abc", "XbY", (1, 0, 0)),
            // The judge was killed before it had sent its last.
            ("ab", "abc", (2, 2, 0)),
            ("aaa", "aa", (2, 2, 0)),
        ] {
            let [sent, judged] = [sent, judged].map(|text| text.chars().collect::<Vec<_>>());
            let Agreement { equal, begin, end } = Agreement::of(&sent, &judged);
            assert_eq!((equal, begin, end), expected, "{sent:?} {judged:?}");
        }
    }

    #[test]
    fn two_long_lists_without_anything_in_common_are_compared_in_no_time() {
        let [sent, judged] = [0, 1_000_000].map(|from| (from..from + 1_000_000).collect::<Vec<u32>>());
        assert_eq!(Agreement::of(&sent, &judged).equal, 0);
    }
}
