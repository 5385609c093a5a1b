//! The rows of the journal, read from the CSV that `andond history` prints.

/// One row.
#[derive(Clone, Debug)]
enum Row {
    Verdict { epoch: u64, seq: u64 },
    Gap { restart: bool, epoch: u64, first: u64, last: Option<u64> },
}

/// The journal's rows, in the order of writing.
#[derive(Clone, Debug)]
pub struct Journalled(Vec<Row>);

impl Journalled {
    pub(super) fn read(csv: &str) -> Self {
        let mut lines = csv.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let index_of = |name: &str| header.iter().position(|column| *column == name).unwrap();
        let [entry, reason, epoch, seq, last] = ["entry", "reason", "epoch", "seq", "last_seq"].map(index_of);
        let row = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            if fields[entry] == "not_watching" {
                return None;
            }
            let (epoch, seq) = (fields[epoch].parse().unwrap(), fields[seq].parse().unwrap());
            Some(match fields[entry] {
                "verdict" => Row::Verdict { epoch, seq },
                _ => Row::Gap {
                    restart: fields[reason] == "restart",
                    epoch,
                    first: seq,
                    last: fields[last].parse().ok(),
                },
            })
        };
        Self(lines.filter_map(row).collect())
    }

    /// Epoch and `seq` of every verdict, in the order of the rows.
    pub fn verdicts(&self) -> Vec<(u64, u64)> {
        let verdict = |row: &Row| match row {
            Row::Verdict { epoch, seq } => Some((*epoch, *seq)),
            Row::Gap { .. } => None,
        };
        self.0.iter().filter_map(verdict).collect()
    }

    /// The number of gaps that are recorded.
    pub fn gaps(&self) -> usize {
        self.0.len() - self.verdicts().len()
    }

    /// Those verdicts of `sent` that have no row and that no gap stands for.
    pub fn unexplained(&self, sent: &[(u64, u64)]) -> Vec<(u64, u64)> {
        let written: std::collections::HashSet<_> = self.verdicts().into_iter().collect();
        sent.iter()
            .filter(|verdict| !written.contains(verdict) && !self.has_gap_for(**verdict))
            .copied()
            .collect()
    }

    fn has_gap_for(&self, (epoch, seq): (u64, u64)) -> bool {
        self.0.iter().enumerate().any(|(index, row)| {
            let Row::Gap { restart, epoch: of, first, last } = row else { return false };
            if *restart {
                // It stands for the rest of one judge's verdicts, and for those of every judge before the one that comes next.
                let until = self.0[index..].iter().find_map(|row| match row {
                    Row::Verdict { epoch, .. } => Some(*epoch),
                    Row::Gap { .. } => None,
                });
                epoch == *of && seq >= *first || epoch > *of && until.is_some_and(|until| epoch < until)
            } else {
                epoch == *of && (*first..=last.unwrap_or(u64::MAX)).contains(&seq)
            }
        })
    }
}
