//! Knows when the line could judge. It is told what was done to each role, the role's own signs of life, and what the judge says of itself. It holds
//! against that when the line said that it was ready.

use crate::poller::Answer;
use andon_tests::measure::percentile;
use serde_json::{Value, json};

/// A time in which a role could not work, on the monotonic clock.
#[derive(Clone, Debug)]
struct Unable {
    role: &'static str,
    what: &'static str,
    from_ns: u64,
    /// `None` while it lasts.
    until_ns: Option<u64>,
}

/// What was done to the roles, and when they worked again.
#[derive(Default)]
pub(crate) struct Oracle(Vec<Unable>);

/// How long the line may say that it is ready after a role can work no more. The longest time that a role may be silent, and the longest that the
/// PLC's side may stand still before it says so.
fn may_last_ms(role: &str) -> f64 {
    let silence_ms = if role == "journal" { 3000.0 } else { 1000.0 };
    silence_ms + 500.0
}

impl Oracle {
    /// From now on the role cannot work.
    pub(crate) fn unable(&mut self, role: &'static str, what: &'static str, from_ns: u64) {
        // A process that is killed before it worked has changed nothing.
        if !self.0.iter().any(|unable| unable.role == role && unable.until_ns.is_none()) {
            self.0.push(Unable { role, what, from_ns, until_ns: None });
        }
    }

    /// The role can work again from this time on.
    pub(crate) fn able(&mut self, role: &str, until_ns: u64) {
        let lasting = self.0.iter_mut().filter(|unable| unable.role == role && unable.until_ns.is_none());
        lasting.for_each(|unable| unable.until_ns = Some(until_ns));
    }

    /// The process of this role that was started last said at this time that it works.
    pub(crate) fn works(&mut self, role: &str, said_ns: u64) {
        if self.0.iter().any(|unable| unable.role == role && unable.from_ns < said_ns) {
            self.able(role, said_ns);
        }
    }

    /// What is to be said of the answers. It names those that saw a line ready that could not judge and had had the time to find out.
    pub(crate) fn judge(&self, answers: &[Answer]) -> (Value, Vec<String>) {
        let mut lasted_ms = Vec::new();
        let mut false_ready = Vec::new();
        for unable in &self.0 {
            let until_ns = unable.until_ns.unwrap_or(u64::MAX);
            let first = answers.partition_point(|answer| answer.asked_ns <= unable.from_ns);
            let within = answers.iter().skip(first).take_while(|answer| answer.answered_ns < until_ns);
            let ready =
                within.filter(|answer| answer.is_ready).map(|answer| answer.asked_ns - unable.from_ns).max();
            let ms = ready.unwrap_or_default() as f64 / 1e6;
            lasted_ms.push(ms);
            if ms > may_last_ms(unable.role) {
                false_ready.push(format!("{} after {}: ready for {ms:.0} ms", unable.role, unable.what));
            }
        }
        let seen = json!({
            "times": lasted_ms.len(),
            "ready_for_ms": {
                "p50": percentile(&mut lasted_ms, 50),
                "p99": percentile(&mut lasted_ms, 99),
                "max": percentile(&mut lasted_ms, 100),
            },
        });
        (seen, false_ready)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    /// One answer every 100 ms, which all see the line ready.
    fn always_ready() -> Vec<Answer> {
        let answer =
            |at_ms: u64| Answer { asked_ns: at_ms * MS, answered_ns: at_ms * MS + MS, is_ready: true };
        (0..100).map(|tenth| answer(100 * tenth)).collect()
    }

    #[test]
    fn a_line_that_stays_ready_longer_than_its_roles_may_be_silent_is_found() {
        let mut oracle = Oracle::default();
        oracle.unable("judge", "a kill", 1_000 * MS);
        oracle.works("judge", 4_000 * MS);
        let (_, false_ready) = oracle.judge(&always_ready());
        assert_eq!(false_ready, ["judge after a kill: ready for 2900 ms"]);
    }

    #[test]
    fn a_line_that_is_ready_for_a_moment_longer_or_again_is_right() {
        let mut oracle = Oracle::default();
        oracle.unable("judge", "a kill", 1_000 * MS);
        // A sign of life from before it was killed.
        oracle.works("judge", 900 * MS);
        oracle.works("judge", 2_400 * MS);
        let (_, false_ready) = oracle.judge(&always_ready());
        assert_eq!(false_ready, Vec::<String>::new());
    }
}
