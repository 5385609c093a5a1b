//! The handshake under random sequences of what can happen to it.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::tests::{ENABLED, WRITES, ready, set};
use super::*;
use crate::registers::{self, WordOrder};
use proptest::prelude::*;
use shm_schemas::VerdictOutcome;
use std::collections::HashSet;

/// One of the things that happen, in any order.
#[derive(Clone, Debug)]
enum Step {
    Verdict {
        skip: u64,
        level: u8,
        outcome: u8,
        new_epoch: bool,
    },
    JournalCatchesUp {
        behind: usize,
    },
    Line(bool),
    Pass {
        ms: u64,
    },
    /// One cycle of the PLC's program.
    Scan,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => (prop_oneof![9 => Just(0_u64), 1 => 1..4_u64], 1..=4_u8, 1..=4_u8, prop::bool::weighted(0.05))
            .prop_map(|(skip, level, outcome, new_epoch)| Step::Verdict { skip, level, outcome, new_epoch }),
        3 => (0..3_usize).prop_map(|behind| Step::JournalCatchesUp { behind }),
        1 => any::<bool>().prop_map(Step::Line),
        2 => (0..700_u64).prop_map(|ms| Step::Pass { ms }),
        6 => Just(Step::Scan),
    ]
}

/// The judge, the journal and the clock around the machine, with an account of their own.
struct World {
    machine: Handshake,
    line: Line,
    now_ns: u64,
    key: (u64, u64),
    sent: Vec<(u64, u64, u8)>,
    in_journal: HashSet<(u64, u64)>,
    lost: u64,
}

impl World {
    fn new(settings: Settings) -> Self {
        Self {
            machine: ready(settings),
            line: Line::Ready,
            now_ns: 0,
            key: (100, 0),
            sent: vec![],
            in_journal: HashSet::new(),
            lost: 0,
        }
    }

    fn run(&mut self, step: &Step) {
        match *step {
            Step::Verdict { skip, level, outcome, new_epoch } => {
                if new_epoch {
                    self.key = (self.key.0 + 1, 0);
                }
                // Before the first verdict there is nothing to lose.
                self.lost += if self.sent.is_empty() { 0 } else { skip };
                self.key.1 += skip + 1;
                let mut verdict =
                    Verdict { level, outcome, model_hash: fingerprint(self.key), ..Default::default() };
                (verdict.stamp.epoch, verdict.stamp.seq) = self.key;
                self.sent.push((self.key.0, self.key.1, level));
                self.machine.verdict(&verdict, self.now_ns);
            }
            Step::JournalCatchesUp { behind } => {
                let end = self.sent.len().saturating_sub(behind);
                let Some(&(epoch, seq, _)) = self.sent[..end].last() else { return };
                self.in_journal.extend(self.sent[..end].iter().map(|&(epoch, seq, _)| (epoch, seq)));
                self.machine.confirmed(epoch, seq, self.now_ns);
            }
            Step::Line(is_ready) => {
                self.line =
                    if is_ready { Line::Ready } else { Line::Fault { fault: Fault::Role, detail: 0 } };
                self.machine.tick(self.line, self.now_ns);
            }
            Step::Pass { ms } => {
                self.now_ns += ms * MS;
                self.machine.tick(self.line, self.now_ns);
            }
            Step::Scan => {}
        }
    }

    fn check(&self) -> Result<(), TestCaseError> {
        let image = self.machine.image(self.now_ns);
        let outcome = image.status & (status::OK | status::NOK | status::NOT_JUDGED);
        let done = image.status & status::DONE != 0;
        prop_assert_eq!(outcome.count_ones(), u32::from(done), "one outcome with done, none without");
        if done {
            let verdict = image.result.unwrap().verdict;
            let right = verdict.level().is_ok() && verdict.outcome() == Ok(VerdictOutcome::Ok);
            prop_assert_eq!(
                outcome == status::OK,
                right,
                "the bit `ok` is set for what is right, and for nothing else"
            );
            let key = (verdict.stamp.epoch, verdict.stamp.seq);
            prop_assert!(self.in_journal.contains(&key), "{:?} is offered before the journal has it", key);
        }
        Ok(())
    }
}

/// A number that follows from the key and lies far from it in the block, so that a mix of two results is noticed.
fn fingerprint((epoch, seq): (u64, u64)) -> u64 {
    (epoch * 1000 + seq).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn results_come_once_and_in_order_and_none_is_lost_without_overrun(steps in prop::collection::vec(step(), 1..300)) {
        let mut world = World::new(WRITES);
        let mut taken: Vec<(u32, u64, u64)> = vec![];
        for step in &steps {
            world.run(step);
            if let Step::Scan = step {
                let image = world.machine.image(world.now_ns);
                let acknowledging = image.control.word & control::ACKNOWLEDGE != 0;
                let done = image.status & status::DONE != 0;
                if done && !acknowledging {
                    let result = image.result.unwrap();
                    taken.push((result.sequence, result.verdict.stamp.epoch, result.verdict.stamp.seq));
                    set(&mut world.machine, control::ACKNOWLEDGE);
                } else if !done && acknowledging {
                    set(&mut world.machine, 0);
                }
            }
            world.check()?;
        }
        prop_assert!(taken.windows(2).all(|two| two[0].0 < two[1].0));
        let mut rest = world.sent.iter();
        for &(_, epoch, seq) in &taken {
            prop_assert!(rest.any(|sent| (sent.0, sent.1) == (epoch, seq)), "in the order they were sent, each once");
        }
        let image = world.machine.image(world.now_ns);
        let offered = usize::from(image.status & status::DONE != 0 && image.control.word & control::ACKNOWLEDGE == 0);
        let missing = world.sent.len() - taken.len() - offered - usize::from(image.queued);
        prop_assert_eq!(u64::from(image.lost), missing as u64 + world.lost);
        prop_assert_eq!(image.lost > 0, image.status & status::OVERRUN != 0);
        if let Some(&(sequence, ..)) = taken.last() {
            prop_assert!(u64::from(sequence) <= world.sent.len() as u64 + world.lost);
        }
    }

    #[test]
    fn no_client_that_compares_both_sequences_takes_a_torn_result(
        steps in prop::collection::vec(step(), 1..200),
        parts in prop::collection::vec(1..40_u16, 1..6),
    ) {
        // With writes off results change by themselves: nothing that this client does keeps them still.
        let mut world = World::new(Settings { writes: false, hold_ns: 0 });
        let (mut block, mut part) = (Vec::<u16>::new(), 0);
        let order = WordOrder::Big;
        for step in &steps {
            world.run(step);
            world.check()?;
            let from = 11 + block.len() as u16;
            let count = parts[part % parts.len()].min(48 - from);
            part += 1;
            block.extend(registers::read(&world.machine.image(world.now_ns), order, from, count).unwrap());
            if block.len() < 37 {
                continue;
            }
            let number = |at: usize, words: usize| block[at..at + words].iter().fold(0, |n, &word| n << 16 | u64::from(word));
            if number(0, 2) == number(35, 2) && number(0, 2) != 0 {
                let key = (number(27, 4), number(31, 4));
                prop_assert_eq!(number(5, 4), fingerprint(key), "model hash of another result");
                let sent = world.sent.iter().find(|sent| (sent.0, sent.1) == key);
                prop_assert_eq!(sent.map(|sent| u64::from(sent.2)), Some(number(9, 1)), "level of another result");
            }
            block.clear();
        }
    }

    #[test]
    fn whatever_a_client_writes_the_outcome_is_never_ambiguous(
        steps in prop::collection::vec((step(), 0..64_u16), 1..200),
    ) {
        let mut world = World::new(WRITES);
        for (step, word) in &steps {
            world.run(step);
            world.machine.write(Control { word: *word, ..ENABLED }, world.now_ns);
            while let Some(command) = world.machine.next_command() {
                world.machine.command_sent(command.kind, word % 3 != 0);
            }
            world.check()?;
            let image = world.machine.image(world.now_ns);
            prop_assert_eq!((image.carried_out | image.refused) & !word, 0, "answers clear with their bit");
        }
    }
}
