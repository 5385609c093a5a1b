//! The handshake under random sequences of what can happen to it.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::tests::{ENABLED, Journal, WRITES, judged, ready, set, watching};
use super::*;
use crate::registers::{self, WordOrder};
use proptest::prelude::*;
use shm_schemas::{MessageId, Verdict, VerdictOutcome};

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
    /// The role is killed and starts again.
    Restart,
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
        1 => Just(Step::Restart),
        6 => Just(Step::Scan),
    ]
}

/// The judge, the journal and the clock around the machine, with an account of their own.
struct World {
    settings: Settings,
    machine: Handshake,
    journal: Journal,
    line: Line,
    now_ns: u64,
    id: MessageId,
    sent: Vec<Verdict>,
    /// How many of them are in the journal.
    written: usize,
    /// Numbers that the judge has left out, up to what is written.
    skipped: Vec<u64>,
}

impl World {
    fn new(settings: Settings) -> Self {
        let (mut machine, mut journal) = (ready(settings), Journal::new(5));
        journal.settle(&mut machine, 0);
        Self {
            settings,
            machine,
            journal,
            line: Line::Ready,
            now_ns: 0,
            id: MessageId { epoch: 100, seq: 0 },
            sent: vec![],
            written: 0,
            skipped: vec![],
        }
    }

    fn run(&mut self, step: &Step) {
        match *step {
            Step::Verdict { skip, level, outcome, new_epoch } => {
                if new_epoch {
                    self.id = MessageId { epoch: self.id.epoch + 1, seq: 0 };
                }
                // Before the first verdict there is nothing to lose.
                self.skipped.push(if self.sent.is_empty() { 0 } else { skip });
                self.id.seq += skip + 1;
                let mut verdict =
                    Verdict { level, outcome, model_hash: fingerprint(self.id), ..Default::default() };
                (verdict.stamp.epoch, verdict.stamp.seq) = (self.id.epoch, self.id.seq);
                self.sent.push(verdict);
                judged(&mut self.machine, &verdict, self.now_ns);
            }
            Step::JournalCatchesUp { behind } => {
                let end = self.sent.len().saturating_sub(behind).max(self.written);
                self.sent[self.written..end].iter().for_each(|verdict| self.journal.write(*verdict));
                self.written = end;
                self.journal.serve(&mut self.machine, self.now_ns);
            }
            Step::Restart => {
                self.machine = ready(self.settings);
                self.machine.tick(self.line, self.now_ns);
                self.journal.settle(&mut self.machine, self.now_ns);
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
            let is_written = self.sent[..self.written].contains(&verdict);
            prop_assert!(is_written, "{:?} is offered before the journal has it", verdict.stamp);
        }
        Ok(())
    }
}

/// A number that follows from the id and lies far from it in the block, so that a mix of two results is noticed.
fn fingerprint(id: MessageId) -> u64 {
    (id.epoch * 1000 + id.seq).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_the_journal_has_comes_once_and_in_order(steps in prop::collection::vec(step(), 1..300)) {
        let mut world = World::new(WRITES);
        // What the PLC's program has taken, by number: a number that it has taken is not taken twice.
        let mut taken: Vec<(u32, u64, u64)> = vec![];
        for step in &steps {
            world.run(step);
            if let Step::Scan = step {
                let image = world.machine.image(world.now_ns);
                let acknowledging = image.control.word & control::ACKNOWLEDGE != 0;
                let done = image.status & status::DONE != 0;
                if done && !acknowledging {
                    let result = image.result.unwrap();
                    let stamp = result.verdict.stamp;
                    let newest = taken.last().map_or(0, |newest| newest.0);
                    prop_assert!(result.sequence >= newest, "an older result is offered");
                    if result.sequence > newest {
                        taken.push((result.sequence, stamp.epoch, stamp.seq));
                    } else {
                        prop_assert_eq!(taken.last(), Some(&(result.sequence, stamp.epoch, stamp.seq)));
                    }
                    set(&mut world.machine, control::ACKNOWLEDGE);
                } else if !done && acknowledging {
                    set(&mut world.machine, 0);
                }
            }
            world.check()?;
        }
        // Let everything arrive that is on its way, and the PLC take it.
        for _ in 0..4 {
            world.run(&Step::JournalCatchesUp { behind: 0 });
            world.run(&Step::Pass { ms: 600 });
        }
        set(&mut world.machine, 0);
        while world.machine.image(world.now_ns).status & status::DONE != 0 {
            let result = world.machine.image(world.now_ns).result.unwrap();
            if taken.last().is_none_or(|newest| result.sequence > newest.0) {
                taken.push((result.sequence, result.verdict.stamp.epoch, result.verdict.stamp.seq));
            }
            set(&mut world.machine, control::ACKNOWLEDGE);
            world.journal.settle(&mut world.machine, world.now_ns);
            set(&mut world.machine, 0);
            world.journal.settle(&mut world.machine, world.now_ns);
        }
        let taken: Vec<_> = taken.iter().map(|&(_, epoch, seq)| (epoch, seq)).collect();
        let sent: Vec<_> = world.sent.iter().map(|sent| (sent.stamp.epoch, sent.stamp.seq)).collect();
        prop_assert_eq!(taken, sent, "in the order they were sent, each once");
        let image = world.machine.image(world.now_ns);
        prop_assert_eq!(u64::from(image.lost), world.skipped.iter().sum::<u64>());
        prop_assert_eq!(image.lost > 0, image.status & status::OVERRUN != 0);
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
                let id = MessageId { epoch: number(27, 4), seq: number(31, 4) };
                prop_assert_eq!(number(5, 4), fingerprint(id), "model hash of another result");
                let sent = world.sent.iter().find(|sent| (sent.stamp.epoch, sent.stamp.seq) == (id.epoch, id.seq));
                prop_assert_eq!(sent.map(|sent| u64::from(sent.level)), Some(number(9, 1)), "level of another result");
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
            if let Some(command) = world.machine.next_command(world.now_ns) {
                let refusal = if word % 3 == 0 { Refusal::Unfit } else { Refusal::None };
                let answer = Judging { command: command.number, refusal: refusal.code(), ..watching() };
                world.machine.judging(&answer, world.now_ns);
            }
            world.check()?;
            let image = world.machine.image(world.now_ns);
            prop_assert_eq!((image.carried_out | image.refused | image.executing) & !word, 0, "answers clear with their bit");
        }
    }
}
