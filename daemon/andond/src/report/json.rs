//! JSON lines. The names are an interface: programs outside read them.

use andon_core::input::Side;
use andon_core::verdict::{BrokenOrder, Level, Measure, Measured, Missing, Verdict};
use andon_learn::distribution::Distribution;
use andon_learn::job_file::JobFile;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use shm_schemas::{PartId, verdict_kind};

use super::Names;
use crate::wire::verdict::{level, measure, note, order_fault, outcome, reason};

/// Seconds on the recording's own time.
fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// A distance for JSON: null if it is not finite, because JSON has no NaN.
fn number(value: Option<f32>) -> Option<f64> {
    // Through the shortest decimal, so that 0.1 does not read 0.10000000149.
    value.filter(|value| value.is_finite()).and_then(|value| value.to_string().parse().ok())
}

/// The relation to another activity that was broken.
#[derive(Debug, Serialize)]
struct BrokenLine {
    fault: &'static str,
    activity: u16,
    runs: u16,
}

impl BrokenLine {
    fn new(BrokenOrder { fault, activity, runs }: BrokenOrder) -> Self {
        Self { fault: order_fault(fault).name(), activity, runs }
    }
}

/// A measure that is out of its bounds.
#[derive(Debug, Serialize)]
struct MeasureLine {
    measure: &'static str,
    unit: &'static str,
    value: Option<f64>,
    /// The minimum and the maximum that were shown.
    shown: [Option<f64>; 2],
}

impl MeasureLine {
    fn new(measured: Measured) -> Self {
        Self {
            measure: measure(measured.measure).name(),
            unit: unit(measured.measure),
            value: number(Some(measured.value)),
            shown: [measured.shown_min, measured.shown_max].map(|value| number(Some(value))),
        }
    }
}

const fn unit(measure: Measure) -> &'static str {
    match measure {
        Measure::Duration => "s",
        Measure::Strokes => "strokes",
        Measure::StrokeLength | Measure::Path | Measure::LateralDeviation | Measure::Place => "m",
        Measure::Direction => "degrees",
    }
}

/// Where an IU that is not right lies among the runs that were shown.
#[derive(Debug, Serialize)]
struct DistributionLine {
    /// `Motion` is the DTW distance, which has no unit.
    measure: &'static str,
    unit: &'static str,
    value: Option<f64>,
    /// The number of runs.
    runs: usize,
    /// What they measured, sorted; of many runs some, and nothing where only the range is known.
    shown: Vec<Option<f64>>,
    range: [Option<f64>; 2],
    /// The minimum and the maximum that are right, where there is one; none where that is not known.
    right: Option<[Option<f64>; 2]>,
    /// How much longer than the straight way a path may be, which decides instead of its maximum.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_detour: Option<f64>,
    place: String,
}

impl DistributionLine {
    fn new(of: Distribution) -> Self {
        let some = |value: f32| number(Some(value));
        Self {
            measure: of.measure.map_or("Motion", |of| measure(of).name()),
            unit: of.measure.map_or("", unit),
            value: some(of.value),
            runs: of.runs,
            shown: of.shown.iter().copied().map(some).collect(),
            range: of.range.map(some),
            right: of.right.map(|right| right.map(number)),
            max_detour: number(of.max_detour),
            place: of.place(),
        }
    }
}

/// What was missing for a verdict; what does not say why is left out.
#[derive(Debug, Serialize)]
struct MissingLine {
    #[serde(skip_serializing_if = "Option::is_none")]
    hand: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<u16>,
    /// The name of that object.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    captured_percent: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    needed_percent: Option<u8>,
}

impl MissingLine {
    /// `None` where nothing was missing, or it is not known what.
    fn new(missing: Missing, names: &Names) -> Option<Self> {
        let Missing { hand, object, seconds, captured_percent, needed_percent } = missing;
        (missing != Missing::default()).then(|| Self {
            hand: hand.map(Side::name),
            object,
            name: object.map(|id| names.object(id)),
            seconds: seconds.map(|seconds| (f64::from(seconds) * 1e3).round() / 1e3),
            captured_percent,
            needed_percent,
        })
    }
}

/// One verdict. Its numbers of activities and IUs count from 0, as in CSV and on the registers.
#[derive(Debug)]
pub struct VerdictLine<'v> {
    seq: u64,
    verdict: &'v Verdict,
    part: &'v PartId,
    names: &'v Names,
    job: Option<&'v JobFile>,
}

impl<'v> VerdictLine<'v> {
    /// The line of verdict number `seq` on this part. `job` is the one that it was judged by, where that is known.
    pub const fn new(
        seq: u64,
        verdict: &'v Verdict,
        part: &'v PartId,
        names: &'v Names,
        job: Option<&'v JobFile>,
    ) -> Self {
        Self { seq, verdict, part, names, job }
    }
}

/// Each value is one line here. `value` writes null for none, and `some` leaves the key out.
impl Serialize for VerdictLine<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { seq, verdict, part, names, job } = *self;
        let (level, outcome) = (level(verdict.level), outcome(verdict.outcome));
        let is_of_job = verdict.level == Level::Job;
        let (expected, got) = names.expected_and_got(verdict);
        let step = verdict.nearest.and_then(|step| names.steps().get(usize::from(step)));
        let distribution = job.and_then(|job| Distribution::of_verdict(job, verdict));
        let mut line = Line(serializer.serialize_map(None)?);
        line.value("seq", &seq)?;
        line.value("kind", verdict_kind(level, outcome))?;
        line.value("level", level.name())?;
        line.value("outcome", outcome.name())?;
        line.value("reason", reason(verdict.reason).name())?;
        line.value("hand", &verdict.side.map(Side::name))?;
        line.value("activity", &(!is_of_job).then_some(verdict.activity))?;
        line.value("iu", &verdict.iu)?;
        line.value("context", &(!is_of_job).then_some(verdict.context.0))?;
        line.value("distance", &number(verdict.distance))?;
        line.value("threshold", &number(verdict.threshold))?;
        // How many of a hundred frames of the IU were captured.
        line.some("captured_percent", verdict.captured_percent)?;
        // In how many of a hundred frames of the IU the hand and each object that it acts on were seen.
        line.some("seen_percent", verdict.seen_percent)?;
        // Why it was not judged, in figures.
        line.some("missing", MissingLine::new(verdict.missing, names))?;
        line.value("nearest", &verdict.nearest)?;
        // The name of the step that `nearest` is.
        line.value("step", &step.map(|step| &step.name))?;
        // What was expected, and what came, in words of one kind.
        line.value("expected", &expected)?;
        line.value("got", &got)?;
        line.value("measures", &verdict.measured.map(MeasureLine::new))?;
        line.some("distribution", distribution.map(DistributionLine::new))?;
        line.value("broken", &verdict.broken.map(BrokenLine::new))?;
        line.value("note", &verdict.note.map(|what| note(what).name()))?;
        line.value("early", &verdict.early)?;
        line.value("began_s", &seconds(verdict.began_ns))?;
        line.value("ended_s", &seconds(verdict.ended_ns))?;
        line.value("decided_s", &seconds(verdict.decided_ns))?;
        line.value("part", &(!part.is_none()).then(|| part.text()))?;
        line.0.end()
    }
}

/// The values of a line, as they are written.
struct Line<M>(M);

impl<M: SerializeMap> Line<M> {
    fn value(&mut self, key: &'static str, value: &(impl Serialize + ?Sized)) -> Result<(), M::Error> {
        self.0.serialize_entry(key, value)
    }

    fn some(&mut self, key: &'static str, value: Option<impl Serialize>) -> Result<(), M::Error> {
        value.map_or(Ok(()), |value| self.value(key, &value))
    }
}

/// One event of the segmentation.
#[derive(Debug, Serialize)]
pub struct EventLine {
    /// `eru`, `iu`, `activity` or `job`.
    pub level: &'static str,
    /// `right` or `left`; none for a job.
    pub hand: Option<&'static str>,
    /// `x_c`; of its first IU for an activity; none for a job.
    pub context: Option<[u16; 4]>,
    /// When it began, in seconds.
    pub began_s: f64,
    /// When it ended, in seconds.
    pub ended_s: f64,
    /// For an IU, the share of its frames whose motion was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// For an IU, the share of its frames in which the hand and each object of its context were seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen: Option<f64>,
}

impl EventLine {
    /// The line of an event of one hand.
    pub fn new(level: &'static str, side: Side, context: [u16; 4], began_ns: u64, ended_ns: u64) -> Self {
        Self {
            level,
            hand: Some(side.name()),
            context: Some(context),
            began_s: seconds(began_ns),
            ended_s: seconds(ended_ns),
            measured: None,
            seen: None,
        }
    }

    /// The line of a job.
    pub fn job(began_ns: u64, ended_ns: u64) -> Self {
        Self {
            level: "job",
            hand: None,
            context: None,
            began_s: seconds(began_ns),
            ended_s: seconds(ended_ns),
            measured: None,
            seen: None,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::couple::Context;
    use andon_core::verdict::{Note, OrderFault, Outcome, Reason};

    fn verdict() -> Verdict {
        Verdict {
            level: Level::Iu,
            outcome: Outcome::Anomaly,
            reason: Reason::Motion,
            side: Some(Side::Right),
            nearest: Some(1),
            activity: 0,
            iu: Some(2),
            context: Context([1, 5, 5, 6]),
            distance: Some(1.1),
            threshold: None,
            captured_percent: Some(98),
            seen_percent: Some(90),
            missing: Missing::default(),
            measured: None,
            broken: None,
            note: None,
            early: true,
            began_ns: 1_500_000_000,
            ended_ns: 2_000_000_000,
            decided_ns: 2_100_000_000,
        }
    }

    fn names() -> Names {
        let names = Names::new([(5, "polisher".to_owned()), (6, "brick".to_owned())]);
        names.with_steps(&[("take", &[]), ("polish", &[[1, 5, 0, 0], [1, 5, 5, 6], [1, 5, 5, 6]])])
    }

    #[test]
    fn a_verdict_is_one_object_with_the_names_that_programs_read() {
        let line = serde_json::to_string(&VerdictLine::new(
            7,
            &verdict(),
            &PartId::new(b"A-17").unwrap(),
            &names(),
            None,
        ))
        .unwrap();
        assert_eq!(
            line,
            r#"{"seq":7,"kind":"IuAnomaly","level":"iu","outcome":"anomaly","reason":"Motion","hand":"right","activity":0,"iu":2,"context":[1,5,5,6],"distance":1.1,"threshold":null,"captured_percent":98,"seen_percent":90,"nearest":1,"step":"polish","expected":"polisher at brick","got":"polisher at brick, in a wrong motion","measures":null,"broken":null,"note":null,"early":true,"began_s":1.5,"ended_s":2.0,"decided_s":2.1,"part":"A-17"}"#
        );
    }

    #[test]
    fn a_broken_order_and_a_note_are_told_by_their_words() {
        let broken = BrokenOrder { fault: OrderFault::NotEnded, activity: 2, runs: 6 };
        let verdict = Verdict { broken: Some(broken), note: Some(Note::OtherHand), ..verdict() };
        let line: serde_json::Value =
            serde_json::to_value(VerdictLine::new(1, &verdict, &PartId::NONE, &names(), None)).unwrap();
        assert_eq!(line["broken"], serde_json::json!({"fault": "NotEnded", "activity": 2, "runs": 6}));
        assert_eq!(line["note"], "OtherHand");
    }

    #[test]
    fn a_measure_is_told_with_its_unit_and_what_was_shown() {
        let measured = Measured { measure: Measure::Duration, value: 2.1, shown_min: 4.8, shown_max: 5.4 };
        let verdict = Verdict { measured: Some(measured), ..verdict() };
        let line: serde_json::Value =
            serde_json::to_value(VerdictLine::new(1, &verdict, &PartId::NONE, &names(), None)).unwrap();
        let expected =
            serde_json::json!({"measure": "Duration", "unit": "s", "value": 2.1, "shown": [4.8, 5.4]});
        assert_eq!(line["measures"], expected);
    }

    #[test]
    fn where_an_iu_lies_among_the_runs_is_told_by_all_of_them_and_the_bounds() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");
        let job = JobFile::parse(path, &std::fs::read(path).unwrap()).unwrap();
        let measured = Measured { measure: Measure::Strokes, value: 3.0, shown_min: 6.0, shown_max: 6.0 };
        let verdict = Verdict { nearest: Some(0), iu: Some(1), measured: Some(measured), ..verdict() };
        let line =
            |job| serde_json::to_value(VerdictLine::new(1, &verdict, &PartId::NONE, &names(), job)).unwrap();
        let expected = serde_json::json!({
            "measure": "Strokes", "unit": "strokes", "value": 3.0, "runs": 5, "shown": [], "range": [6.0, 6.0],
            "right": [6.0, 6.5], "place": "less than all 5 shown"
        });
        assert_eq!(line(Some(&job))["distribution"], expected);
        assert!(line(None).get("distribution").is_none());
    }

    #[test]
    fn what_was_missing_is_told_by_its_name_and_figures() {
        let missing = Missing { object: Some(6), seconds: Some(1.4), ..Missing::default() };
        let (outcome, reason) = (Outcome::NotJudged, Reason::ObjectNotSeen);
        let verdict = Verdict { outcome, reason, missing, ..verdict() };
        let line =
            serde_json::to_value(VerdictLine::new(1, &verdict, &PartId::NONE, &names(), None)).unwrap();
        assert_eq!(line["reason"], "ObjectNotSeen");
        assert_eq!(line["missing"], serde_json::json!({"object": 6, "name": "brick", "seconds": 1.4}));
    }

    #[test]
    fn a_job_verdict_has_no_hand_no_place_and_no_context() {
        let job = Verdict { level: Level::Job, outcome: Outcome::Ok, side: None, iu: None, ..verdict() };
        let line: serde_json::Value =
            serde_json::to_value(VerdictLine::new(1, &job, &PartId::NONE, &names(), None)).unwrap();
        for key in ["hand", "activity", "iu", "context", "threshold", "part"] {
            assert!(line[key].is_null(), "{key}");
        }
    }
}
