//! Verdicts that must agree with the couples and with each other.

use andon_core::couple::{Context, Couple, Couples};
use andon_core::input::Side;
use andon_core::verdict::{Kind, Reason, Verdict};
use std::collections::BTreeSet;

/// Frames in which the context of a hand is the same.
#[derive(Clone, Copy)]
struct Stretch {
    context: Context,
    began_ns: u64,
    newest_ns: u64,
    /// The first frame that was not sighted.
    blind_ns: Option<u64>,
}

/// What was seen and what was said.
#[derive(Default)]
pub(super) struct Ledger {
    stretches: [Vec<Stretch>; 2],
    said: Vec<Verdict>,
    /// Commands cut IUs in two.
    commanded: bool,
    /// The couples come from no encoder: contexts may follow each other that cannot.
    anything: bool,
}

impl Ledger {
    pub(super) fn expect_anything(&mut self) {
        self.anything = true;
    }

    pub(super) fn command(&mut self) {
        self.commanded = true;
    }

    pub(super) fn see(&mut self, couples: &Couples) {
        assert!(couples.captured_ns <= couples.known_ns);
        for (couple, stretches) in couples.hands.iter().zip(&mut self.stretches) {
            see_hand(couple, stretches);
        }
    }

    pub(super) fn say(&mut self, verdict: Verdict) {
        self.said.push(verdict);
    }

    /// Holds all that was said against what was seen.
    pub(super) fn check(&self) {
        self.said.iter().for_each(check_alone);
        let mut given = BTreeSet::new();
        for verdict in self.said.iter().filter(|verdict| verdict.side.is_some()) {
            let key = (verdict.side, verdict.began_ns, verdict.iu);
            assert!(given.insert(key) || self.commanded, "said twice: {verdict:?}");
        }
        for side in Side::ALL {
            let of_hand = || self.said.iter().filter(move |verdict| verdict.side == Some(side));
            let ius: Vec<&Verdict> = of_hand().filter(|verdict| verdict.iu.is_some()).collect();
            let activities: Vec<&Verdict> = of_hand().filter(|verdict| verdict.iu.is_none()).collect();
            ius.iter().for_each(|iu| self.check_iu(iu, &self.stretches[side.place()], &activities));
            if !self.anything {
                activities.iter().for_each(|activity| check_activity(activity, &ius));
            }
        }
    }

    // A check that fails ends the run, as the assertions around it do.
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
        if iu.kind == Kind::IuOk && stretch.began_ns == iu.began_ns {
            assert!(stretch.blind_ns.is_none_or(|blind| blind >= iu.ended_ns), "OK, but not seen: {iu:?}");
        }
    }
}

fn see_hand(couple: &Couple, stretches: &mut Vec<Stretch>) {
    let now_ns = couple.captured_ns;
    let same = stretches.last_mut().filter(|stretch| stretch.context == couple.context);
    let blind_ns = (!couple.sighted).then_some(now_ns);
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

/// What must hold of every verdict.
fn check_alone(verdict: &Verdict) {
    let right = matches!(verdict.kind, Kind::IuOk | Kind::ActivityOk | Kind::JobOk);
    assert_eq!(right, verdict.reason == Reason::None, "a reason for what is not right only: {verdict:?}");
    let unseen = matches!(verdict.reason, Reason::Blind | Reason::Unknown | Reason::Overload);
    assert_eq!(verdict.kind == Kind::NotJudged, unseen, "{verdict:?}");
    assert!(verdict.began_ns <= verdict.ended_ns, "{verdict:?}");
    assert!(verdict.distance.is_none_or(|distance| distance >= 0.0 && distance.is_finite()), "{verdict:?}");
    assert_eq!(verdict.distance.is_some(), verdict.threshold.is_some(), "{verdict:?}");
    if verdict.kind == Kind::IuOk {
        assert!(verdict.distance <= verdict.threshold, "{verdict:?}");
    }
}

/// An activity is right only if all of its IUs are, and the IUs are only if it is.
fn check_activity(activity: &Verdict, ius: &[&Verdict]) {
    let within = |iu: &&&Verdict| (activity.began_ns..activity.ended_ns).contains(&iu.began_ns);
    let mut ius = ius.iter().filter(within);
    if activity.kind == Kind::ActivityOk {
        assert!(ius.all(|iu| iu.kind == Kind::IuOk), "{activity:?}");
    } else if let Some(wrong) = ius.find(|iu| iu.kind == Kind::IuAnomaly) {
        assert_eq!(activity.kind, Kind::ActivityAnomaly, "{wrong:?} {activity:?}");
    }
}
