//! A run: one recording of a whole job, encoded, segmented and judged by the code that runs live.

use crate::digest::sha256_hex;
use crate::job_file::JobFile;
use crate::recording::{self, NamedObject, Recording, TrackError, Truncation, shapes};
use crate::statistics::{median, noise_m};
use andon_core::anomaly::{self, Judge};
use andon_core::config::Method;
use andon_core::couple::{self, Context, Couples, Encoder, Motion};
use andon_core::input::{Frame, Point, Side};
use andon_core::object::ObjectShape;
use andon_core::segment::{Event, HandEvent, JobSegmenter, Measures};
use andon_core::verdict::Verdict;
use std::borrow::Cow;
use std::sync::Arc;

/// The share of an IU whose motion must have been measured for it to be learnt. A reference is the mean of a few. What is missing in one of them
/// weighs there more than in a piece that is judged.
const MIN_MEASURED: f64 = 0.8;

/// One Interaction Unit of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Iu {
    /// The context of the IU.
    pub context: Context,
    /// Its motion after the opening-closing filter, one motion per frame of the grid in which it was measured.
    pub motion: Vec<Motion>,
    /// What was measured of it in metres.
    pub measures: Measures,
    /// When it began, in nanoseconds of source time.
    pub began_ns: u64,
    /// When it ended and the next one began, in nanoseconds of source time.
    pub ended_ns: u64,
    /// Its length in frames of the grid; more than its motion has where not all of it was measured.
    pub frames: u32,
    /// In how many of them the hand waited for the other one.
    pub waited: u32,
    /// Whether so much of it was seen that it can be learnt.
    pub is_well_seen: bool,
}

impl Iu {
    /// Its length in frames of the grid without the time in which the hand waited for the other one; at least one.
    pub(crate) fn worked_frames(&self) -> u32 {
        self.frames.saturating_sub(self.waited).max(1)
    }
}

/// One activity of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Activity {
    /// The hand that carried it out.
    pub side: Side,
    /// Its IUs in the order of time.
    pub ius: Vec<Iu>,
}

impl Activity {
    /// The contexts of its IUs in the order of time.
    pub fn contexts(&self) -> Vec<Context> {
        self.ius.iter().map(|iu| iu.context).collect()
    }

    /// A hand that touches what it moves just before or after, moves nothing and lets go corrects its grip. The judge does not count that either.
    fn forget_grips(&mut self) {
        let moves = |iu: &Iu| iu.measures.path_m > 0.0;
        self.ius = std::mem::take(&mut self.ius)
            .chunk_by(|one, next| one.context == next.context)
            .flat_map(|same| {
                let is_moved = same.iter().any(moves);
                same.iter().filter(move |iu| !is_moved || moves(iu)).cloned()
            })
            .collect();
    }

    /// When its last touch ended, in nanoseconds of source time.
    pub(crate) fn ended_ns(&self) -> u64 {
        self.ius.iter().rfind(|iu| iu.context.is_touch()).map_or(0, |iu| iu.ended_ns)
    }
}

/// One recording of a whole job, encoded and segmented.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The name of the recording, without folders.
    pub name: String,
    /// SHA-256 of the bytes that it was read from, in hexadecimal.
    pub sha256: String,
    /// The objects that may appear in it.
    pub objects: Vec<NamedObject>,
    /// What was seen, frame by frame.
    frames: Arc<[Frame]>,
    /// The constants that it was encoded with.
    method: Method,
    /// The couples that the judge works on, in the order of time.
    couples: Arc<[Couples]>,
    /// The activities in the order in which they began, each with at least one IU.
    pub activities: Vec<Activity>,
}

/// The frames with each hand called what it is, as the encoder takes them. A tracker may call one the other one for some frames. What is learnt from
/// the frames themselves must not take it for another hand.
fn called_what_they_are(
    frames: &[Frame],
    objects: &[NamedObject],
    method: &Method,
) -> Result<Arc<[Frame]>, couple::Unusable> {
    let mut encoder = Encoder::new(*method, &shapes(objects))?;
    let called = |frame: &Frame| {
        let mut frame = frame.clone();
        if encoder.step(&frame, &mut |_| ()).is_ok() && encoder.are_hands_swapped() {
            frame.hands.iter_mut().for_each(|hand| hand.side = hand.side.other());
        }
        frame
    };
    Ok(frames.iter().map(called).collect())
}

/// Why no run was made of a recording.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The track file was refused.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// It was not recorded to its end.
    #[error("{0}")]
    CutShort(Truncation),
    /// The encoder refuses the method or the objects of the run with this name.
    #[error("{0}: the recording cannot be encoded: {1:?}")]
    Unusable(String, couple::Unusable),
    /// The job cannot be judged.
    #[error("the job cannot be judged: {0}")]
    Job(anomaly::Unusable),
}

impl Run {
    /// Reads, encodes and segments a track file. `name` is its name in reports.
    ///
    /// # Errors
    /// The first line that cannot be trusted, or a method or objects that cannot be used.
    pub fn read(name: &str, bytes: &[u8], method: &Method) -> Result<Self, RunError> {
        Self::new(name, &sha256_hex(bytes), &recording::read(name, bytes)?, method)
    }

    /// Encodes and segments a recording. `sha256` is the digest of the bytes that it comes from.
    ///
    /// # Errors
    /// If the method or the objects cannot be used, and if the recording is known to be cut. It does not show how the job ends.
    pub fn new(name: &str, sha256: &str, recording: &Recording, method: &Method) -> Result<Self, RunError> {
        if let Some(cut) = &recording.truncation {
            return Err(RunError::CutShort(cut.clone()));
        }
        let objects = &recording.header.objects;
        let frames = called_what_they_are(&recording.frames, objects, method)
            .map_err(|unusable| RunError::Unusable(name.to_owned(), unusable))?;
        let unencoded = Self {
            name: name.to_owned(),
            sha256: sha256.to_owned(),
            objects: objects.clone(),
            frames,
            method: *method,
            couples: Arc::default(),
            activities: Vec::new(),
        };
        unencoded.encoded()
    }

    /// The same recording, encoded and segmented with other constants.
    ///
    /// # Errors
    /// If the method cannot be used.
    pub fn encoded_with(&self, method: &Method) -> Result<Self, RunError> {
        Self { method: *method, ..self.clone() }.encoded()
    }

    /// The same recording, encoded and segmented with these objects instead of its own.
    ///
    /// # Errors
    /// If the objects cannot be used.
    pub fn encoded_with_objects(&self, objects: &[NamedObject]) -> Result<Self, RunError> {
        Self { objects: objects.to_vec(), ..self.clone() }.encoded()
    }

    fn encoded(self) -> Result<Self, RunError> {
        let couples = self
            .encode(self.frames.iter(), &shapes(&self.objects), &self.method)
            .map_err(|unusable| self.unusable(unusable))?;
        let mut segmenter = JobSegmenter::new(&self.method)
            .map_err(|fault| self.unusable(couple::Unusable::Method(fault)))?;
        let mut collector = Collector::default();
        for couples in &couples {
            segmenter.step(couples, &mut |event| collector.take(event));
        }
        segmenter.finish(&mut |event| collector.take(event));
        let mut activities = collector.activities;
        activities.retain(|activity| !activity.ius.is_empty());
        activities.iter_mut().for_each(Activity::forget_grips);
        Ok(Self { couples: couples.into(), activities, ..self })
    }

    fn encode<'a>(
        &self,
        frames: impl Iterator<Item = &'a Frame>,
        shapes: &[ObjectShape],
        method: &Method,
    ) -> Result<Vec<Couples>, couple::Unusable> {
        let mut encoder = Encoder::new(*method, shapes)?;
        let mut couples = Vec::with_capacity(frames.size_hint().0);
        for frame in frames {
            // A refused frame changes nothing, and the reader lets none through.
            let _ = encoder.step(frame, &mut |made| couples.push(made));
        }
        encoder.flush(&mut |made| couples.push(made));
        Ok(couples)
    }

    /// What was seen, frame by frame.
    pub(crate) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Whether object `id` was seen in any frame.
    pub fn shows(&self, id: u16) -> bool {
        self.frames.iter().any(|frame| frame.objects.iter().any(|object| object.id == id))
    }

    /// Whether a hand was seen in any frame.
    pub fn shows_hands(&self) -> bool {
        self.frames.iter().any(|frame| !frame.hands.is_empty())
    }

    /// Whether this run was recorded frame by frame as the other one was.
    pub(crate) fn shows_the_same(&self, other: &Self) -> bool {
        self.frames == other.frames
    }

    /// Frames per second, from the median time between two of them; 0 if there are fewer than two.
    pub(crate) fn captured_rate_hz(&self) -> f64 {
        let seconds = |pair: &[Frame]| (pair[1].captured_ns - pair[0].captured_ns) as f64 * 1e-9;
        let period_s = median(&self.frames.windows(2).map(seconds).collect::<Vec<_>>());
        if period_s > 0.0 { 1.0 / period_s } else { 0.0 }
    }

    /// How far the two parts of an IU were apart at most, in metres.
    pub(crate) fn reach_m(&self, iu: &Iu) -> f32 {
        let couples = self.couples.iter().flat_map(|couples| couples.hands);
        let shown = couples.filter(|couple| (iu.began_ns..iu.ended_ns).contains(&couple.captured_ns));
        let apart = shown.filter(|couple| couple.context == iu.context).map(|couple| couple.distances[1]);
        apart.fold(0.0, f32::max)
    }

    /// How far apart two positions of an object that lies still seem to be at most, in metres, as a rule. 0 where it is not seen in enough frames.
    pub(crate) fn noise_m(&self, id: u16) -> f32 {
        let place =
            |frame: &Frame| frame.objects.iter().find(|object| object.id == id).map(|object| object.position);
        noise_m(&self.frames.iter().map(place).collect::<Vec<_>>())
    }

    /// How far an activity moves the object that it begins with, in metres: the lesser of how far the object and the hand get. A hand that rests at
    /// an object which the other one moves does not move it.
    pub(crate) fn moved_m(&self, activity: &Activity) -> f32 {
        let of_object = |frame: &Frame| {
            let id = activity.ius.first()?.context.0[1];
            frame.objects.iter().find(|object| object.id == id).map(|object| object.position)
        };
        self.gets_m(activity, &of_object).min(self.hand_moves_m(activity))
    }

    /// How far the hand gets in an activity, in metres.
    pub(crate) fn hand_moves_m(&self, activity: &Activity) -> f32 {
        let of_hand = |frame: &Frame| {
            frame.hands.iter().find(|hand| hand.side == activity.side).map(|hand| hand.middle_knuckle)
        };
        self.gets_m(activity, &of_hand)
    }

    /// How far something gets in the middle half of the time of an activity from where it was at first, in metres.
    fn gets_m(&self, activity: &Activity, place: &dyn Fn(&Frame) -> Option<Point>) -> f32 {
        let (Some(first), Some(last)) = (activity.ius.first(), activity.ius.last()) else { return 0.0 };
        let quarter_ns = (last.ended_ns - first.began_ns) / 4;
        let middle = first.began_ns + quarter_ns..=last.ended_ns - quarter_ns;
        let frames = self.frames.iter().filter(|frame| frame.captured_ns >= first.began_ns);
        let mut seen = frames.filter_map(|frame| Some((frame.captured_ns, place(frame)?)));
        let Some((_, [x, y, z])) = seen.next() else { return 0.0 };
        let later = seen.filter(|(captured_ns, _)| middle.contains(captured_ns));
        later.map(|(_, at)| (at[0] - x).hypot(at[1] - y).hypot(at[2] - z)).fold(0.0, f32::max)
    }

    /// What the judge of a job works on: the couples of this run, encoded with the constants and objects of the job.
    ///
    /// # Errors
    /// If these cannot be used.
    pub fn couples_for(&self, job: &JobFile) -> Result<Cow<'_, [Couples]>, RunError> {
        if self.method == job.method && self.objects == job.objects {
            return Ok(Cow::Borrowed(&self.couples));
        }
        let encoded = self.encode(self.frames.iter(), &job.shapes(), &job.method);
        encoded.map(Cow::Owned).map_err(|unusable| self.unusable(unusable))
    }

    fn unusable(&self, unusable: couple::Unusable) -> RunError {
        RunError::Unusable(self.name.clone(), unusable)
    }

    /// The verdicts that the live judge gives on this run, which is a whole job.
    ///
    /// # Errors
    /// If the job cannot be used.
    pub fn judge(&self, job: &JobFile) -> Result<Vec<Verdict>, RunError> {
        verdicts(&self.couples_for(job)?, job).map_err(RunError::Job)
    }

    /// The verdicts on this run if only one frame in a time of `1 / rate_hz` had been captured. The first one is at each of `phases` times. None
    /// where the job cannot be used.
    pub fn judge_at(&self, rate_hz: f64, phases: u32, job: &JobFile) -> Vec<Vec<Verdict>> {
        let began_ns = self.frames.first().map_or(0, |frame| frame.captured_ns);
        let shapes = job.shapes();
        let at_phase = |phase: u32| {
            let mut newest = None;
            let frames = self.frames.iter().filter(|frame| {
                let periods = (frame.captured_ns - began_ns) as f64 * 1e-9 * rate_hz;
                // Half a frame of the recording keeps the borders clear of the jitter of its times.
                let slot = (periods + (f64::from(phase) + 0.5) / f64::from(phases)) as u64;
                newest.replace(slot) != Some(slot)
            });
            verdicts(&self.encode(frames, &shapes, &job.method).ok()?, job).ok()
        };
        (0..phases).filter_map(at_phase).collect()
    }
}

/// The verdicts of a judge that knows that these couples begin with a job.
///
/// # Errors
/// If the job cannot be judged.
pub fn verdicts(couples: &[Couples], job: &JobFile) -> Result<Vec<Verdict>, anomaly::Unusable> {
    job.with_job(|lent| {
        let mut judge = Judge::<Vec<_>>::with_memory(lent, job.method)?.at_start_of_job();
        let mut verdicts = Vec::new();
        for couples in couples {
            judge.step(couples, &mut |event| verdicts.extend(event.verdict()));
        }
        judge.finish(&mut |event| verdicts.extend(event.verdict()));
        Ok(verdicts)
    })
}

#[derive(Default)]
struct Collector {
    activities: Vec<Activity>,
    /// Index of the open activity of each hand, by [`Side::index`].
    open: [Option<usize>; 2],
    motion: [Vec<Motion>; 2],
}

impl Collector {
    fn take(&mut self, event: Event) {
        let Event::Hand(side, event) = event else { return };
        match event {
            HandEvent::ActivityBegan { .. } => {
                self.open[side.index()] = Some(self.activities.len());
                self.activities.push(Activity { side, ius: Vec::new() });
            }
            HandEvent::IuBegan { .. } => self.motion[side.index()].clear(),
            HandEvent::IuFrame { motion, .. } => self.motion[side.index()].push(motion),
            HandEvent::IuEnded(iu) => {
                let motion = std::mem::take(&mut self.motion[side.index()]);
                let activity = self.open[side.index()].and_then(|open| self.activities.get_mut(open));
                // An IU without a frame cannot be compared.
                if let Some(activity) = activity.filter(|_| !motion.is_empty()) {
                    activity.ius.push(Iu {
                        context: iu.context,
                        motion,
                        measures: iu.measures,
                        began_ns: iu.began_ns,
                        ended_ns: iu.ended_ns,
                        frames: iu.frames,
                        waited: iu.waited,
                        is_well_seen: iu.is_in_sight
                            && MIN_MEASURED * f64::from(iu.frames) <= f64::from(iu.measured),
                    });
                }
            }
            HandEvent::ActivityEnded { .. } => self.open[side.index()] = None,
            HandEvent::IuResumed | HandEvent::IuUnmeasured(_) | HandEvent::Eru { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::recording::{Header, Landmarks};
    use andon_core::input::{Hand, Object, Space};

    /// A hand takes a part, carries it by 20 cm in half a second, holds it there, and brings it back.
    fn carried_and_held_s(held_s: f32) -> Run {
        run_of(&recorded(held_s))
    }

    fn run_of(recording: &Recording) -> Run {
        Run::new("cup", "", recording, &Method::default()).unwrap()
    }

    fn recorded(held_s: f32) -> Recording {
        let back_s = 2.0 + held_s;
        let frame = |index: u16| {
            let t = f32::from(index) / 30.0;
            // The hand comes, takes it after 1.5 s, and leaves half a second after it is back.
            let x = 0.2 * ((2.0 * (t - 1.5)).clamp(0.0, 1.0) - (2.0 * (t - back_s)).clamp(0.0, 1.0));
            let away = (1.0 - 2.0 * t).max(0.0) + (2.0 * (t - back_s - 1.0)).clamp(0.0, 1.0);
            let at = |behind_m: f32| [x, -0.3 * away - behind_m, 0.0];
            let (side, wrist, middle_knuckle) = (Side::Right, at(0.1), at(0.05));
            let hand = Hand { side, score: 1.0, wrist, middle_knuckle, tips: [at(0.0); 3] };
            let part = Object { id: 7, position: [x, 0.0, 0.0], orientation: [1.0, 0.0, 0.0, 0.0] };
            Frame {
                captured_ns: u64::from(index) * 33_333_333,
                hands: [hand].into_iter().collect(),
                objects: [part].into_iter().collect(),
                ..Frame::default()
            }
        };
        let shape = ObjectShape {
            id: 7,
            interaction_points: [[0.0; 3]].into_iter().collect(),
            ..ObjectShape::default()
        };
        let header = Header {
            rate_hz: 30.0,
            space: Space::Plane,
            hands: vec![Side::Right],
            landmarks: Landmarks::Five,
            objects: vec![NamedObject { name: "cup".to_owned(), shape }],
        };
        let frames = (0..(30.0 * (back_s + 2.0)) as u16).map(frame).collect();
        Recording { header, frames, truncation: None }
    }

    #[test]
    fn a_hand_that_is_called_the_other_one_for_some_frames_is_the_same_hand_in_all_that_is_learnt() {
        let mut recording = recorded(1.0);
        let run = run_of(&recording);
        for called_left in [1, 5, 12] {
            let hands = recording.frames[60..60 + called_left].iter_mut().flat_map(|frame| &mut frame.hands);
            hands.for_each(|hand| hand.side = Side::Left);
            assert_eq!(run_of(&recording), run, "{called_left} frames");
        }
    }

    #[test]
    fn what_is_held_elsewhere_for_most_of_the_time_was_moved() {
        for held_s in [0.2, 1.0, 6.0] {
            let run = carried_and_held_s(held_s);
            assert_eq!(run.activities.len(), 1, "{:?}", run.activities);
            let moved_m = run.moved_m(&run.activities[0]);
            assert!((0.15..0.21).contains(&moved_m), "{moved_m} held for {held_s} s");
        }
    }
}
