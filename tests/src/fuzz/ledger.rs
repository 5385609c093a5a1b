//! Checks that verdicts agree with the couples and with each other.

use andon_core::anomaly::Event;
use andon_core::couple::{Context, Couple, Couples};
use andon_core::input::Side;
use andon_core::verdict::{Level, Missing, Outcome, Reason, Verdict};
use std::collections::BTreeSet;

/// Consecutive frames in which the context of a hand is the same.
#[derive(Clone, Copy)]
struct Stretch {
    context: Context,
    began_ns: u64,
    newest_ns: u64,
    /// The time of the first frame that was out of sight.
    blind_ns: Option<u64>,
}

/// The couples that were observed, and the verdicts on them.
#[derive(Default)]
pub(super) struct Ledger {
    stretches: [Vec<Stretch>; 2],
    verdicts: Vec<Verdict>,
    /// There was a command, and a command cuts an IU in two.
    commanded: bool,
    /// The couples come from no encoder, so that contexts may follow each other that could not otherwise.
    anything: bool,
}

impl Ledger {
    pub(super) fn expect_anything(&mut self) {
        self.anything = true;
    }

    pub(super) fn command(&mut self) {
        self.commanded = true;
    }

    pub(super) fn observe(&mut self, couples: &Couples) {
        assert!(couples.captured_ns <= couples.known_ns);
        for (couple, stretches) in couples.hands.iter().zip(&mut self.stretches) {
            observe_hand(couple, stretches);
        }
    }

    pub(super) fn record(&mut self, event: Event) {
        self.verdicts.extend(event.verdict());
    }

    /// Compares all verdicts with the couples.
    pub(super) fn check(&self) {
        self.verdicts.iter().for_each(check_alone);
        let mut given = BTreeSet::new();
        for verdict in self.verdicts.iter().filter(|verdict| verdict.level != Level::Job) {
            let key = (verdict.side, verdict.began_ns, verdict.iu);
            assert!(given.insert(key) || self.commanded, "given twice: {verdict:?}");
        }
        for side in Side::ALL {
            let of_hand = || self.verdicts.iter().filter(move |verdict| verdict.side == Some(side));
            let ius: Vec<&Verdict> = of_hand().filter(|verdict| verdict.level == Level::Iu).collect();
            let activities: Vec<&Verdict> =
                of_hand().filter(|verdict| verdict.level == Level::Activity).collect();
            ius.iter().for_each(|iu| self.check_iu(iu, &self.stretches[side.index()], &activities));
            if !self.anything {
                activities.iter().for_each(|activity| check_activity(activity, &ius));
            }
        }
    }

    // A check that fails ends the run, like the assertions around it.
    #[allow(clippy::panic)]
    fn check_iu(&self, iu: &Verdict, stretches: &[Stretch], activities: &[&Verdict]) {
        let its = |activity: &&&Verdict| activity.activity == iu.activity && activity.began_ns <= iu.began_ns;
        assert!(activities.iter().any(|activity| its(&activity)), "an IU without an activity: {iu:?}");
        let at = |stretch: &&Stretch| stretch.began_ns <= iu.began_ns && iu.began_ns <= stretch.newest_ns;
        let stretch = stretches.iter().find(at);
        assert!(stretch.is_some(), "an IU that was not seen: {iu:?}");
        let Some(stretch) = stretch else { return };
        assert_eq!(stretch.context, iu.context, "{iu:?}");
        assert!(stretch.began_ns == iu.began_ns || self.commanded, "an IU begins with its context: {iu:?}");
        if iu.outcome == Outcome::Ok && stretch.began_ns == iu.began_ns {
            assert!(stretch.blind_ns.is_none_or(|blind| blind >= iu.ended_ns), "OK, but not seen: {iu:?}");
        }
    }
}

fn observe_hand(couple: &Couple, stretches: &mut Vec<Stretch>) {
    let now_ns = couple.captured_ns;
    let same = stretches.last_mut().filter(|stretch| stretch.context == couple.context);
    let blind_ns = (!couple.is_in_sight()).then_some(now_ns);
    match same {
        Some(stretch) => {
            assert!(stretch.newest_ns < now_ns, "couples come in the order of their times");
            stretch.newest_ns = now_ns;
            stretch.blind_ns = stretch.blind_ns.or(blind_ns);
        }
        None => {
            stretches.push(Stretch {
                context: couple.context,
                began_ns: now_ns,
                newest_ns: now_ns,
                blind_ns,
            });
        }
    }
}

/// Checks what must hold for every verdict.
fn check_alone(verdict: &Verdict) {
    let right = verdict.outcome == Outcome::Ok;
    assert_eq!(
        right,
        verdict.reason == Reason::None,
        "only a verdict that is not OK has a reason: {verdict:?}"
    );
    let wrong = matches!(
        verdict.reason,
        Reason::WrongObject
            | Reason::WrongOrder
            | Reason::Motion
            | Reason::TooShort
            | Reason::TooLong
            | Reason::NotCompleted
    );
    assert_eq!(verdict.outcome == Outcome::Anomaly, wrong, "{verdict:?}");
    let has_missing = verdict.missing != Missing::default();
    assert!(verdict.outcome == Outcome::NotJudged || !has_missing, "{verdict:?}");
    assert!(verdict.began_ns <= verdict.ended_ns, "{verdict:?}");
    assert!(verdict.distance.is_none_or(|distance| distance >= 0.0 && distance.is_finite()), "{verdict:?}");
    assert_eq!(verdict.distance.is_some(), verdict.threshold.is_some(), "{verdict:?}");
    assert!(!right || verdict.measured.is_none(), "what is right is within its bounds: {verdict:?}");
    if verdict.level == Level::Iu && right {
        assert!(verdict.distance <= verdict.threshold, "{verdict:?}");
    }
}

/// Checks that all IUs of an OK activity are OK, and that an activity with an anomalous IU is an anomaly.
fn check_activity(activity: &Verdict, ius: &[&Verdict]) {
    let within = |iu: &&&Verdict| (activity.began_ns..activity.ended_ns).contains(&iu.began_ns);
    let mut ius = ius.iter().filter(within);
    if activity.outcome == Outcome::Ok {
        assert!(ius.all(|iu| iu.outcome == Outcome::Ok), "{activity:?}");
    } else if let Some(wrong) = ius.find(|iu| iu.outcome == Outcome::Anomaly) {
        assert_eq!(activity.outcome, Outcome::Anomaly, "{wrong:?} {activity:?}");
    }
}
