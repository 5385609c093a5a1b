//! How far the job on the film has come: the state of each step and of its IUs.

use andon_core::couple::Couple;
use andon_core::verdict::{Level, Outcome, Verdict};

use crate::report::{Cause, Names, Teller, has_contact, on_recording};

/// How far a step or an IU is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum State {
    /// It has not come.
    #[default]
    Coming,
    /// A hand is at it.
    Running,
    /// It was judged.
    Judged(Outcome),
}

/// One step of the job.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) name: String,
    pub(super) state: State,
    pub(super) ius: Vec<State>,
}

/// The steps of the job, and what has gone wrong in it.
pub(super) struct Steps {
    names: Names,
    teller: Teller,
    pub(super) steps: Vec<Step>,
    /// The newest fault or what could not be judged. At the end it is what the job is wrong or not judged for, as the lines of text say it.
    pub(super) fault: Option<Cause>,
    /// How the job came out, once it has ended.
    pub(super) job: Option<Verdict>,
}

impl Steps {
    pub(super) fn new(names: Names) -> Self {
        let steps = names.steps().iter().map(|step| Step {
            name: step.name.clone(),
            state: State::Coming,
            ius: vec![State::Coming; step.contexts.len()],
        });
        Self { steps: steps.collect(), names, teller: Teller::default(), fault: None, job: None }
    }

    /// Takes the next verdict. The first one after the end of a job belongs to the next job.
    pub(super) fn judge(&mut self, verdict: &Verdict) {
        if self.job.is_some() {
            *self = Self::new(std::mem::take(&mut self.names));
        }
        let step = verdict.nearest.and_then(|step| self.steps.get_mut(usize::from(step)));
        let judged = State::Judged(verdict.outcome);
        match (verdict.level, step) {
            (Level::Job, _) => self.job = Some(*verdict),
            (Level::Activity, Some(step)) => {
                step.state = judged;
                if verdict.outcome == Outcome::Ok {
                    step.ius.fill(judged);
                }
            }
            (Level::Iu, Some(step)) => {
                let iu = verdict.iu.and_then(|iu| step.ius.get_mut(usize::from(iu)));
                iu.into_iter().for_each(|iu| *iu = judged);
            }
            (_, None) => (),
        }
        let cause = self.teller.cause(verdict, &self.names);
        let is_new = |cause: &Cause| verdict.level == Level::Job || cause.verdict == *verdict;
        self.fault = cause.filter(is_new).or(self.fault.take());
        self.teller.tell(&on_recording(verdict.decided_ns), verdict, &self.names);
    }

    /// Marks where the hands are by their newest couples.
    pub(super) fn run(&mut self, couples: &[Couple]) {
        for step in &mut self.steps {
            step.ius.iter_mut().chain([&mut step.state]).for_each(|state| {
                if *state == State::Running {
                    *state = State::Coming;
                }
            });
        }
        if self.job.is_some() {
            return;
        }
        for couple in couples.iter().filter(|couple| has_contact(couple.context)) {
            let place =
                self.steps.iter().zip(self.names.steps()).enumerate().find_map(|(step, (state, taught))| {
                    let is_open = !matches!(state.state, State::Judged(Outcome::Ok));
                    let mut ius = taught.contexts.iter().zip(&state.ius);
                    let iu = ius.position(|(context, iu)| *context == couple.context && *iu == State::Coming);
                    iu.filter(|_| is_open).map(|iu| (step, iu))
                });
            if let Some((step, iu)) = place {
                self.steps[step].ius[iu] = State::Running;
                if self.steps[step].state == State::Coming {
                    self.steps[step].state = State::Running;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample::{names, wrong};
    use andon_core::couple::Context;
    use andon_core::input::Side;
    use andon_core::verdict::Reason;

    const OK: State = State::Judged(Outcome::Ok);
    const WRONG: State = State::Judged(Outcome::Anomaly);

    fn steps() -> Steps {
        Steps::new(names())
    }

    fn verdict(level: Level, outcome: Outcome, iu: Option<u16>) -> Verdict {
        let reason = if outcome == Outcome::Ok { Reason::None } else { Reason::TooShort };
        Verdict { level, outcome, iu, ..wrong(reason) }
    }

    fn hand(context: [u16; 4]) -> [Couple; 1] {
        [Couple { context: Context(context), ..Couple::idle(Side::Right, 0) }]
    }

    #[test]
    fn a_step_is_running_where_the_hand_is_and_judged_when_it_was_judged() {
        let mut steps = steps();
        steps.run(&hand([1, 5, 0, 0]));
        assert_eq!((steps.steps[0].state, steps.steps[0].ius[0]), (State::Running, State::Running));
        steps.judge(&verdict(Level::Iu, Outcome::Ok, Some(0)));
        steps.run(&hand([1, 5, 5, 6]));
        assert_eq!(steps.steps[0].ius, [OK, State::Running, State::Coming]);
        steps.judge(&verdict(Level::Iu, Outcome::Anomaly, Some(1)));
        steps.judge(&verdict(Level::Activity, Outcome::Anomaly, None));
        steps.run(&hand([0; 4]));
        assert_eq!((steps.steps[0].state, steps.steps[0].ius[1]), (WRONG, WRONG));
        assert_eq!(steps.steps[1].state, State::Coming);
    }

    #[test]
    fn the_newest_fault_is_shown_and_at_the_end_the_one_that_the_job_is_wrong_for() {
        let at = |seconds: u64, verdict: Verdict| Verdict { decided_ns: seconds * 1_000_000_000, ..verdict };
        let first = at(5, verdict(Level::Iu, Outcome::Anomaly, Some(1)));
        let second =
            at(9, Verdict { reason: Reason::Motion, ..verdict(Level::Iu, Outcome::Anomaly, Some(2)) });
        let mut steps = steps();
        steps.judge(&first);
        steps.judge(&second);
        assert_eq!(steps.fault.as_ref().map(|fault| fault.verdict), Some(second));
        steps.judge(&at(12, verdict(Level::Job, Outcome::Anomaly, None)));
        assert_eq!(
            steps.fault.as_ref().map(|fault| fault.verdict),
            Some(first),
            "as `andond replay` says it"
        );
    }

    #[test]
    fn what_follows_from_a_fault_does_not_take_its_place_and_the_next_job_begins_anew() {
        let mut steps = steps();
        steps.judge(&verdict(Level::Iu, Outcome::Anomaly, Some(1)));
        steps.judge(&verdict(Level::Job, Outcome::Anomaly, None));
        assert_eq!(steps.fault.as_ref().map(|fault| fault.verdict.level), Some(Level::Iu));
        steps.judge(&verdict(Level::Iu, Outcome::Ok, Some(0)));
        assert!(steps.fault.is_none() && steps.job.is_none());
        assert_eq!(steps.steps[0].ius, [OK, State::Coming, State::Coming]);
    }
}
