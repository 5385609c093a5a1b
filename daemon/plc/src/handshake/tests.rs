#![allow(clippy::unwrap_used, clippy::panic)]
use super::*;
use crate::registers::{self, WordOrder};
use proptest::prelude::*;
use std::collections::HashSet;

const WRITES: Settings = Settings { writes: true, hold_ns: 0 };
const ENABLED: Control = Control { word: control::ENABLE, load_job_id: 0, load_model_hash: 0 };

fn verdict(epoch: u64, seq: u64, kind: VerdictKind) -> Verdict {
    let mut verdict = Verdict { kind: kind.code(), ..Default::default() };
    verdict.stamp.epoch = epoch;
    verdict.stamp.seq = seq;
    verdict
}

/// A machine that is enabled and ready, at time 0.
fn ready(settings: Settings) -> Handshake {
    let mut machine = Handshake::new(settings, 0);
    machine.write(ENABLED, 0);
    machine.line(Line::Ready, 0);
    while let Some(ask) = machine.next_ask() {
        machine.asked(&ask, true);
    }
    machine
}

fn has(machine: &Handshake, now_ns: u64, bits: u16) -> bool {
    machine.image(now_ns).status & bits == bits
}

fn set(machine: &mut Handshake, bits: u16) {
    machine.write(Control { word: control::ENABLE | bits, ..ENABLED }, 0);
}

fn acknowledge(machine: &mut Handshake) {
    set(machine, control::ACKNOWLEDGE);
    set(machine, 0);
}

#[test]
fn done_waits_for_the_journal() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 1, VerdictKind::IuOk), 0);
    assert!(!has(&machine, 0, status::DONE));
    machine.confirmed(1, 1, 0);
    assert!(has(&machine, 0, status::DONE | status::OK));
}

#[test]
fn a_confirmation_that_comes_before_its_verdict_counts() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 1, 0);
    machine.verdict(&verdict(1, 1, VerdictKind::IuAnomaly), 0);
    assert!(has(&machine, 0, status::DONE | status::NOK));
}

#[test]
fn a_journal_that_is_at_a_new_judge_is_through_with_the_old_one() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(9, 1, VerdictKind::IuOk), 0);
    machine.confirmed(4, 1, 0);
    assert!(!has(&machine, 0, status::DONE), "nothing is known of epoch 4 yet");
    machine.verdict(&verdict(4, 1, VerdictKind::IuOk), 0);
    assert!(has(&machine, 0, status::DONE));
}

#[test]
fn a_result_stays_until_it_is_acknowledged() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 2, 0);
    machine.verdict(&verdict(1, 1, VerdictKind::IuOk), 0);
    machine.verdict(&verdict(1, 2, VerdictKind::IuAnomaly), 0);
    machine.tick(3600 * 1000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 1);
    set(&mut machine, control::ACKNOWLEDGE);
    assert_eq!(machine.image(0).status & (status::DONE | status::OK | status::NOK), 0);
    assert_eq!(machine.image(0).carried_out, control::ACKNOWLEDGE | control::ENABLE);
    set(&mut machine, 0);
    assert!(has(&machine, 0, status::DONE | status::NOK));
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
}

#[test]
fn eight_wait_behind_the_offered_one_and_the_tenth_is_an_overrun() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 99, 0);
    for seq in 1..=9 {
        machine.verdict(&verdict(1, seq, VerdictKind::IuOk), 0);
    }
    assert!(!has(&machine, 0, status::OVERRUN));
    assert_eq!(machine.image(0).queued, 8);
    machine.verdict(&verdict(1, 10, VerdictKind::IuAnomaly), 0);
    assert!(has(&machine, 0, status::OVERRUN));
    for _ in 0..9 {
        acknowledge(&mut machine);
    }
    assert!(!has(&machine, 0, status::DONE));
    machine.verdict(&verdict(1, 11, VerdictKind::IuOk), 0);
    let image = machine.image(0);
    assert_eq!((image.result.unwrap().sequence, image.lost), (11, 1), "the sequence jumps by what was lost");
    set(&mut machine, control::RESET_ERROR);
    assert!(!has(&machine, 0, status::OVERRUN));
}

#[test]
fn losses_on_the_channel_are_an_overrun_and_repeats_are_not_results() {
    let mut machine = ready(WRITES);
    machine.verdict(&verdict(1, 5, VerdictKind::IuOk), 0);
    machine.verdict(&verdict(1, 5, VerdictKind::IuOk), 0);
    assert_eq!((machine.image(0).lost, machine.image(0).queued), (0, 1));
    machine.verdict(&verdict(1, 8, VerdictKind::IuOk), 0);
    assert_eq!(machine.image(0).lost, 2);
    machine.verdict(&verdict(2, 2, VerdictKind::IuOk), 0);
    assert_eq!(machine.image(0).lost, 3, "a new judge numbers from 1");
    assert!(has(&machine, 0, status::OVERRUN));
}

#[test]
fn ready_drops_at_every_fault_and_busy_with_it_and_comes_back_after_reset() {
    for fault in Fault::ALL {
        let mut machine = ready(WRITES);
        machine.verdict(&verdict(1, 1, VerdictKind::IuOk), 0);
        assert!(has(&machine, 0, status::READY | status::BUSY));
        machine.line(Line::Fault { fault, detail: 104 }, 0);
        let image = machine.image(0);
        assert_eq!(image.status & (status::READY | status::BUSY | status::ERROR), status::ERROR);
        assert_eq!((image.error, image.error_detail), (fault as u16, 104));
        set(&mut machine, control::RESET_ERROR);
        assert!(has(&machine, 0, status::ERROR), "it is still wrong");
        machine.line(Line::Ready, 0);
        assert!(!has(&machine, 0, status::READY), "latched");
        set(&mut machine, 0);
        set(&mut machine, control::RESET_ERROR);
        assert!(has(&machine, 0, status::READY));
    }
}

#[test]
fn silence_of_line_loop_or_journal_drops_ready() {
    let mut line = ready(WRITES);
    line.tick(2_000 * MS);
    assert!(has(&line, 2_000 * MS, status::READY));
    line.tick(2_001 * MS);
    assert_eq!(line.image(2_001 * MS).error, Fault::Silence as u16);

    let machine = ready(WRITES);
    assert!(has(&machine, 500 * MS, status::READY | status::ONLINE));
    assert!(!has(&machine, 501 * MS, status::READY));
    assert!(!has(&machine, 501 * MS, status::ONLINE));

    let mut journal = ready(WRITES);
    journal.verdict(&verdict(1, 1, VerdictKind::JobOk), 0);
    journal.line(Line::Ready, 2_001 * MS);
    journal.tick(2_001 * MS);
    assert_eq!(journal.image(2_001 * MS).error, Fault::Journal as u16);
    assert!(!has(&journal, 2_001 * MS, status::DONE));
}

#[test]
fn a_verdict_of_an_unknown_kind_is_not_judged_and_an_error() {
    let mut machine = ready(WRITES);
    machine.confirmed(1, 1, 0);
    let mut foreign = verdict(1, 1, VerdictKind::IuOk);
    foreign.kind = 77;
    machine.verdict(&foreign, 0);
    assert!(has(&machine, 0, status::DONE | status::NOT_JUDGED | status::ERROR));
    assert_eq!(machine.image(0).error, Fault::ForeignVerdict as u16);
}

#[test]
fn commands_are_told_once_when_their_bit_rises_and_answered_until_it_falls() {
    let mut machine = ready(WRITES);
    let load = Control { word: control::ENABLE | control::LOAD_JOB, load_job_id: 7, load_model_hash: 9 };
    machine.write(load, 0);
    machine.write(load, 0);
    let ask = machine.next_ask().unwrap();
    assert_eq!(ask, Ask { kind: CommandKind::LoadJob, job_id: 7, model_hash: 9, argument: 0 });
    assert_eq!(machine.next_ask(), None);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, 0, "not told yet");
    machine.asked(&ask, true);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, control::LOAD_JOB);
    set(&mut machine, 0);
    assert_eq!(machine.image(0).carried_out & control::LOAD_JOB, 0);
}

#[test]
fn start_needs_ready_and_makes_busy_and_load_waits_for_the_end() {
    let mut machine = ready(WRITES);
    set(&mut machine, control::START);
    let ask = machine.next_ask().unwrap();
    machine.asked(&ask, true);
    assert!(has(&machine, 0, status::BUSY));
    set(&mut machine, control::LOAD_JOB);
    assert_eq!(machine.image(0).refused, control::LOAD_JOB);
    let mut end = verdict(1, 1, VerdictKind::JobOk);
    (end.activity, end.iu) = (shm_schemas::NO_INDEX, shm_schemas::NO_INDEX);
    machine.verdict(&end, 0);
    assert!(!has(&machine, 0, status::BUSY));

    let mut lost = ready(WRITES);
    lost.line(Line::Fault { fault: Fault::Camera, detail: 0 }, 0);
    set(&mut lost, control::START);
    assert_eq!((lost.image(0).refused, lost.next_ask()), (control::START, None));
}

#[test]
fn a_command_that_cannot_be_told_is_refused_and_an_error() {
    let mut machine = ready(WRITES);
    set(&mut machine, control::START);
    let ask = machine.next_ask().unwrap();
    machine.asked(&ask, false);
    let image = machine.image(0);
    assert_eq!((image.refused, image.error), (control::START, Fault::Command as u16));
    assert_eq!(image.status & (status::BUSY | status::READY), 0);
}

#[test]
fn with_writes_off_a_result_gives_way_only_to_another_and_only_after_its_time() {
    let mut machine = Handshake::new(Settings { writes: false, hold_ns: 500 * MS }, 0);
    machine.confirmed(1, 9, 0);
    machine.verdict(&verdict(1, 1, VerdictKind::IuOk), 0);
    machine.tick(9_000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 1);
    machine.verdict(&verdict(1, 2, VerdictKind::IuOk), 9_000 * MS);
    machine.verdict(&verdict(1, 3, VerdictKind::IuOk), 9_000 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
    machine.tick(9_499 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 2);
    machine.tick(9_500 * MS);
    assert_eq!(machine.image(0).result.unwrap().sequence, 3);
}

/// What may happen, in any order.
#[derive(Clone, Debug)]
enum Step {
    Verdict {
        skip: u64,
        kind: u8,
        new_epoch: bool,
    },
    JournalCatchesUp {
        behind: usize,
    },
    Line(bool),
    Pass {
        ms: u64,
    },
    /// The PLC's program runs once.
    Scan,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => (prop_oneof![9 => Just(0_u64), 1 => 1..4_u64], 1..=8_u8, prop::bool::weighted(0.05))
            .prop_map(|(skip, kind, new_epoch)| Step::Verdict { skip, kind, new_epoch }),
        3 => (0..3_usize).prop_map(|behind| Step::JournalCatchesUp { behind }),
        1 => any::<bool>().prop_map(Step::Line),
        2 => (0..700_u64).prop_map(|ms| Step::Pass { ms }),
        6 => Just(Step::Scan),
    ]
}

/// The judge, the journal and the clock around the machine, and what has gone through.
struct World {
    machine: Handshake,
    now_ns: u64,
    key: (u64, u64),
    sent: Vec<(u64, u64, u8)>,
    in_journal: HashSet<(u64, u64)>,
    lost: u64,
}

impl World {
    fn new(settings: Settings) -> Self {
        let machine = ready(settings);
        Self { machine, now_ns: 0, key: (100, 0), sent: vec![], in_journal: HashSet::new(), lost: 0 }
    }

    fn run(&mut self, step: &Step) {
        match *step {
            Step::Verdict { skip, kind, new_epoch } => {
                if new_epoch {
                    self.key = (self.key.0 + 1, 0);
                }
                // Before the first verdict there is nothing to lose.
                self.lost += if self.sent.is_empty() { 0 } else { skip };
                self.key.1 += skip + 1;
                let mut verdict = Verdict { kind, model_hash: fingerprint(self.key), ..Default::default() };
                (verdict.stamp.epoch, verdict.stamp.seq) = self.key;
                self.sent.push((self.key.0, self.key.1, kind));
                self.machine.verdict(&verdict, self.now_ns);
            }
            Step::JournalCatchesUp { behind } => {
                let upto = self.sent.len().saturating_sub(behind);
                let Some(&(epoch, seq, _)) = self.sent[..upto].last() else { return };
                self.in_journal.extend(self.sent[..upto].iter().map(|&(epoch, seq, _)| (epoch, seq)));
                self.machine.confirmed(epoch, seq, self.now_ns);
            }
            Step::Line(well) => {
                let line = if well { Line::Ready } else { Line::Fault { fault: Fault::Role, detail: 0 } };
                self.machine.line(line, self.now_ns);
            }
            Step::Pass { ms } => {
                self.now_ns += ms * MS;
                self.machine.tick(self.now_ns);
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
            let right = matches!(verdict.kind, 1 | 3 | 5);
            prop_assert_eq!(outcome == status::OK, right, "ok says a kind that is right, and nothing else");
            let key = (verdict.stamp.epoch, verdict.stamp.seq);
            prop_assert!(self.in_journal.contains(&key), "{:?} is offered before the journal has it", key);
        }
        Ok(())
    }
}

/// Something that goes with the key, far away in the block, so that a mix of two results shows.
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
        // Results change by themselves with writes off, so this client does nothing to keep them still.
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
                prop_assert_eq!(sent.map(|sent| u64::from(sent.2)), Some(number(9, 1)), "kind of another result");
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
            while let Some(ask) = world.machine.next_ask() {
                world.machine.asked(&ask, word % 3 != 0);
            }
            world.check()?;
            let image = world.machine.image(world.now_ns);
            prop_assert_eq!((image.carried_out | image.refused) & !word, 0, "answers clear with their bit");
        }
    }
}
