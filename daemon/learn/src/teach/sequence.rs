//! What the runs have in common: the steps of the job, found from the contexts alone.
//!
//! A *step* is what a hand does with the object that it takes first. It has that hand, that object, and the number of earlier activities of the run
//! with the same two. Where no run has both hands at an object, the hand is the one that most runs use. The other one does the same step. A hand that
//! touches something without moving it is at a step only if all runs have that; otherwise it rests or steadies. Within a step the most common
//! sequence of contexts is nominal, and another sequence that enough runs have is a variant. A run that does a step in another way is left out, and
//! so is one that lacks most of what most runs do.
//!
//! A hand that is seen to let go in the middle makes two steps of one. One sequence of a step may be the beginning of another, and a later
//! step the remainder of that. The later step is then required after the short one (`completes` in the job file). Without this, one half
//! alone was called right in 6 of 15 runs.

use super::TeachError;
use super::contact_regions::SAME_PLACE_M;
use super::kind::Strokes;
use super::strength::{Rule, StepKey, Strengths};
use crate::job_file::{Source, context_words, side_of};
use crate::recording::object_name;
use crate::run::{Activity, Iu, Run};
use crate::statistics::median;
use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::segment::Measures;
use std::collections::{BTreeMap, BTreeSet};

/// What fewer runs than this have in common may be chance: two could share the same slip. With fewer, leaving one out would leave one, which shows
/// neither an order nor a spread. With two, 1 of 70 jobs differs, and 1 right run fewer is accepted. With four, 1 does, and 2 faults fewer are found.
pub(super) const MIN_ALIKE: usize = 3;

/// A variant also needs at least this share of the runs: among many runs, three could share the same slip. If one run in 20 has it, three of 30 do in
/// 19 of 100 jobs, and six in 3 of 1,000. It counts from 16 runs on, which no measured set has.
const MIN_VARIANT_SHARE: f64 = 0.2;

/// Fewer runs than this cannot tell which of them is the odd one, or agree and differ by chance. With three or five, none of 70 jobs of five runs or
/// more differs.
pub(super) const MIN_RUNS: usize = 4;

/// The first point at which a run does not do what the others do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Disagreement {
    /// The run's name.
    pub(super) name: String,
    /// Index of the activity in the run, from 0. If the run lacks a step, the index at which the others have it.
    pub(super) activity: usize,
    /// Index of the IU in the activity, from 0.
    pub(super) iu: usize,
    /// The contexts that the run has there, and the others; `None` where an activity has ended.
    pub(super) had: Option<Context>,
    pub(super) others: Option<Context>,
}

/// A demonstration of an IU of which too little was seen. It is not learnt from: what is missing would become part of the reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Occluded {
    /// The run's name.
    pub run: String,
    /// Index of the activity in the job, from 0.
    pub activity: u16,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context of the IU.
    pub context: Context,
}

/// A sequence of contexts that fulfils a step, and the demonstrations that show it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sequence {
    /// Index of the activity in the job, from 0.
    pub(super) activity: u16,
    pub(super) contexts: Vec<Context>,
    /// The demonstrations have only these in common, and other IUs between them.
    pub(super) allows_insertions: bool,
    /// The hand only rests at the object that it begins with: it has no motion that could be compared.
    pub(super) is_steadied: bool,
    /// The demonstrations: index of the run, and index of the activity in that run.
    pub(super) shown: Vec<(usize, usize)>,
    pub(super) ius: Vec<ShownIu>,
}

/// What its demonstrations show of one IU of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ShownIu {
    pub(super) context: Context,
    pub(super) strokes: Strokes,
    /// The demonstrations from which it can be learnt: index of the run, of the activity in it, and of the IU in that.
    pub(super) shown: Vec<[usize; 3]>,
    pub(super) measured: Vec<Measures>,
    /// How many frames of the grid the hand worked in these.
    pub(super) frames: Vec<u32>,
    /// The demonstrations that are not learnt from.
    pub(super) occluded: Vec<Occluded>,
}

impl ShownIu {
    /// A release state is judged by its context alone, so every demonstration of it will do.
    fn of(sequence: &Sequence, index: usize, runs: &[Run]) -> Self {
        let all = sequence.shown.iter().filter_map(|&(run, activity)| {
            let own = sequence.indices(&runs[run].activities[activity]);
            Some([run, activity, *own.get(index)?])
        });
        let iu = |[run, activity, iu]: [usize; 3]| &runs[run].activities[activity].ius[iu];
        let (shown, hidden): (Vec<_>, Vec<_>) =
            all.partition(|at| iu(*at).is_well_seen || iu(*at).context.is_release());
        let occluded = |at: [usize; 3]| Occluded {
            run: runs[at[0]].name.clone(),
            activity: sequence.activity,
            iu: index,
            context: iu(at).context,
        };
        let measured: Vec<Measures> = shown.iter().map(|at| iu(*at).measures).collect();
        Self {
            context: sequence.contexts[index],
            strokes: Strokes::of(sequence.contexts[index], &measured),
            frames: shown.iter().map(|at| iu(*at).worked_frames()).collect(),
            occluded: hidden.into_iter().map(occluded).collect(),
            shown,
            measured,
        }
    }

    pub(super) fn is_repeated(&self) -> bool {
        self.strokes != Strokes::None
    }

    pub(super) fn is_by_feel(&self) -> bool {
        self.strokes == Strokes::ByFeel
    }

    /// Whether the time at another part is judged: without strokes it shows that what is done there was done. Strokes are counted instead, and people
    /// differ in how quickly they make them.
    pub(super) fn is_timed(&self) -> bool {
        self.context.is_pair() && !self.is_repeated()
    }

    /// The demonstrations from which it can be learnt, each with the index of its run.
    pub(super) fn ius<'a>(&'a self, runs: &'a [Run]) -> impl Iterator<Item = (usize, &'a Iu)> {
        self.shown.iter().map(|&[run, activity, iu]| (run, &runs[run].activities[activity].ius[iu]))
    }
}

/// What the runs have in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Agreement {
    /// The nominal sequences in the order of their activities; the most common sequence of an activity comes first.
    pub(super) sequences: Vec<Sequence>,
    /// The runs that do something else, one entry per run. They are left out.
    pub(super) disagreements: Vec<Disagreement>,
    /// The objects at which a hand rests or steadies in some of the runs that are used.
    pub(super) passive_contacts: Vec<u16>,
    /// The runs that are used, by their indices.
    pub(super) used: Vec<usize>,
    /// For each activity of the job and each run that is used, the index of the activity in the run that is this step.
    pub(super) steps: Vec<Vec<Option<usize>>>,
    /// The step that each activity of the job is.
    pub(super) keys: Vec<StepKey>,
}

impl Agreement {
    /// The runs that are used, of those in which it was found.
    pub(super) fn used_runs<'a>(&self, runs: &'a [Run]) -> Vec<&'a Run> {
        self.used.iter().map(|index| &runs[*index]).collect()
    }

    /// The runs in which it was found, as the job file names them.
    pub(super) fn sources(&self, runs: &[Run]) -> Vec<Source> {
        let source = |(index, run): (usize, &Run)| Source {
            name: run.name.clone(),
            sha256: run.sha256.clone(),
            left_out: !self.used.contains(&index),
        };
        runs.iter().enumerate().map(source).collect()
    }

    /// Why there is nothing that all steps of a run agree on.
    pub(super) fn nothing_agrees(&self, runs: &[Run]) -> TeachError {
        // Where no step is common to most runs, there is nothing that a run could have had instead.
        let mut found = self.disagreements.iter();
        if !found.any(|found| found.others.is_some() || found.had.is_none()) {
            return TeachError::NothingInCommon(runs.len());
        }
        let words = |context| context_words(context, |id| object_name(&runs[0].objects, id));
        let differences = self.disagreements.iter().map(|found| found.sentence(&words)).collect();
        TeachError::NoneAgrees { runs: runs.len(), differences }
    }

    pub(super) fn ius(&self) -> impl Iterator<Item = &ShownIu> {
        self.sequences.iter().flat_map(|sequence| &sequence.ius)
    }
}

impl Sequence {
    /// The indices of its IUs in an activity that shows it: of each the first one in its context after the one before.
    pub(super) fn indices(&self, activity: &Activity) -> Vec<usize> {
        let side = side_of(self.contexts[0].0[0]);
        let mut all = activity.ius.iter().enumerate();
        let next = |context: &Context| {
            all.find(|(_, iu)| iu.context.by_hand(side) == *context).map(|(index, _)| index)
        };
        self.contexts.iter().filter_map(next).collect()
    }
}

/// Finds what the runs have in common. No run may be left out for the sequence of a step where the strengths or two runs say so. Then the step is
/// what all its sequences have in common.
pub(super) fn agree(runs: &[Run], strengths: &Strengths) -> Agreement {
    let steps = Steps::of(runs);
    let (all, mut sequences) = (steps.in_order(), steps.sequences());
    let common_parts = steps.common_parts(&sequences, strengths);
    for (step, contexts) in &common_parts {
        sequences.insert(*step, vec![contexts.clone()]);
    }
    let common: Vec<StepKey> =
        all.iter().filter(|step| 2 * steps.count(step) > runs.len()).copied().collect();
    if common.is_empty() {
        return Agreement::default();
    }
    let found = |run| (run, steps.disagreement(run, &common, &sequences, &common_parts));
    let (disagreeing, kept): (Vec<_>, Vec<_>) =
        (0..runs.len()).map(found).partition(|(_, found)| found.is_some());
    let used: Vec<usize> = kept.into_iter().map(|(run, _)| run).collect();
    let at =
        |step: &StepKey| -> Vec<Option<usize>> { used.iter().map(|run| steps.index(*run, step)).collect() };
    let shown_steps: Vec<&StepKey> = all.iter().filter(|step| at(step).iter().any(Option::is_some)).collect();
    let of_step = |(activity, step): (u16, &&StepKey)| -> Vec<Sequence> {
        let allows_insertions = common_parts.contains_key(*step);
        let shows = |run: &usize, contexts: &[Context]| {
            let index = steps.index(*run, step)?;
            (allows_insertions || steps.contexts(*run, index, step) == contexts).then_some((*run, index))
        };
        let sequence = |contexts: &Vec<Context>| {
            let mut sequence = Sequence {
                activity,
                contexts: contexts.clone(),
                allows_insertions,
                is_steadied: steps.is_steadied(step),
                shown: used.iter().filter_map(|run| shows(run, contexts)).collect(),
                ius: Vec::new(),
            };
            sequence.ius = (0..contexts.len()).map(|index| ShownIu::of(&sequence, index, runs)).collect();
            sequence
        };
        sequences[*step].iter().map(sequence).filter(|sequence| !sequence.shown.is_empty()).collect()
    };
    Agreement {
        sequences: (0u16..).zip(&shown_steps).flat_map(of_step).collect(),
        disagreements: disagreeing.into_iter().filter_map(|(_, found)| found).collect(),
        passive_contacts: steps.passive_contacts(&used).into_iter().collect(),
        steps: shown_steps.iter().map(|step| at(step)).collect(),
        keys: shown_steps.into_iter().copied().collect(),
        used,
    }
}

/// The length in bits of a description of what the runs do. Each different sequence of a step is spelled once, and each run says which of them it
/// has, if it has the step.
pub(super) fn description_bits(runs: &[Run]) -> f64 {
    let steps = Steps::of(runs);
    let counted: Vec<BTreeMap<Vec<Context>, usize>> =
        steps.in_order().iter().map(|step| steps.sequences_of(step)).collect();
    let words: BTreeSet<Context> = counted.iter().flat_map(BTreeMap::keys).flatten().copied().collect();
    // One more word ends a sequence.
    let word_bits = ((words.len() + 1) as f64).log2();
    let of_step = |sequences: &BTreeMap<Vec<Context>, usize>| -> f64 {
        let shown = sequences.values().sum::<usize>();
        let spelled: usize = sequences.keys().map(|contexts| contexts.len() + 1).sum();
        let choices = sequences.values().map(|count| entropy_bits(*count, shown)).sum::<f64>();
        spelled as f64 * word_bits
            + choices
            + entropy_bits(shown, runs.len())
            + entropy_bits(runs.len() - shown, runs.len())
    };
    counted.iter().map(of_step).sum()
}

/// How many bits it takes to say so many times what comes so many times of a number of times.
fn entropy_bits(count: usize, of: usize) -> f64 {
    if count == 0 { 0.0 } else { count as f64 * (of as f64 / count as f64).log2() }
}

type Sequences = BTreeMap<StepKey, Vec<Vec<Context>>>;

/// The step that each activity of each run is; `None` where a hand rests or steadies.
struct Steps<'a> {
    runs: &'a [Run],
    steps: Vec<Vec<Option<StepKey>>>,
}

impl<'a> Steps<'a> {
    fn of(runs: &'a [Run]) -> Self {
        let mut steps = Self::with(runs, |_, _| true);
        let is_kept = |run: &Run, index: usize, step: StepKey| {
            let is_one = steps.sequences_of(&step).len() == 1
                || steps.is_steadied(&step) && steps.common_part(&step).is_some();
            let is_shared = steps.count(&step) == runs.len() && is_one;
            // Only where it decides, because runs are compared for each pair of parts.
            is_shared || is_moved(run, &run.activities[index])
        };
        let kept: Vec<Vec<bool>> = runs
            .iter()
            .zip(&steps.steps)
            .map(|(run, steps)| {
                let steps = steps.iter().enumerate();
                steps.map(|(index, step)| step.is_some_and(|step| is_kept(run, index, step))).collect()
            })
            .collect();
        if kept.iter().flatten().any(|kept| !kept) {
            steps = Self::with(runs, |run, index| kept[run][index]);
        }
        steps
    }

    /// The steps of those activities that `is_kept` keeps.
    fn with(runs: &'a [Run], is_kept: impl Fn(usize, usize) -> bool) -> Self {
        let hands = hands(runs, &is_kept);
        let steps_of = |(number, run): (usize, &Run)| {
            let mut before: BTreeMap<[u16; 2], usize> = BTreeMap::new();
            let step = |(index, activity): (usize, &Activity)| {
                let opening = opening(activity, &hands);
                let count = before.entry(opening).or_default();
                *count += usize::from(is_kept(number, index));
                is_kept(number, index).then(|| StepKey { opening, nth: *count - 1 })
            };
            run.activities.iter().enumerate().map(step).collect()
        };
        Self { runs, steps: runs.iter().enumerate().map(steps_of).collect() }
    }

    /// The objects at which a hand rests or steadies in these runs.
    fn passive_contacts(&self, runs: &[usize]) -> BTreeSet<u16> {
        let of_run = |run: &usize| self.runs[*run].activities.iter().zip(&self.steps[*run]);
        let passive = runs.iter().flat_map(of_run).filter(|(_, step)| step.is_none());
        passive.map(|(activity, _)| object(activity)).collect()
    }

    fn index(&self, run: usize, step: &StepKey) -> Option<usize> {
        self.steps[run].iter().position(|other| other.as_ref() == Some(step))
    }

    fn count(&self, step: &StepKey) -> usize {
        (0..self.runs.len()).filter(|run| self.index(*run, step).is_some()).count()
    }

    /// The contexts of an activity, as the hand of the step would have them.
    fn contexts(&self, run: usize, index: usize, step: &StepKey) -> Vec<Context> {
        let side = side_of(step.opening[0]);
        let contexts = self.runs[run].activities[index].contexts();
        contexts.into_iter().map(|context| context.by_hand(side)).collect()
    }

    /// All steps in the order of their mean index.
    fn in_order(&self) -> Vec<StepKey> {
        let mut indices: BTreeMap<StepKey, Vec<usize>> = BTreeMap::new();
        for (index, step) in self.steps.iter().flat_map(|run| run.iter().flatten().enumerate()) {
            indices.entry(*step).or_default().push(index);
        }
        let mut steps: Vec<(f64, StepKey)> = indices
            .into_iter()
            .map(|(step, indices)| (indices.iter().sum::<usize>() as f64 / indices.len() as f64, step))
            .collect();
        steps.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        steps.into_iter().map(|(_, step)| step).collect()
    }

    /// The sequences of contexts in which the runs do this step, with the number of those that do.
    fn sequences_of(&self, step: &StepKey) -> BTreeMap<Vec<Context>, usize> {
        let mut counts = BTreeMap::new();
        for run in 0..self.runs.len() {
            if let Some(index) = self.index(run, step) {
                *counts.entry(self.contexts(run, index, step)).or_default() += 1;
            }
        }
        counts
    }

    /// For each step its most common sequence, followed by the variants that enough runs have.
    fn sequences(&self) -> Sequences {
        let min_runs = MIN_ALIKE.max((MIN_VARIANT_SHARE * self.runs.len() as f64).ceil() as usize);
        let nominal = |step: StepKey| {
            let mut counts: Vec<(Vec<Context>, usize)> = self.sequences_of(&step).into_iter().collect();
            // Ties go to the longer sequence: a contact that was missed is more common than a contact that never happened.
            counts.sort_by_key(|(contexts, count)| std::cmp::Reverse((*count, contexts.len())));
            let is_allowed =
                |(index, (_, count)): &(usize, (Vec<Context>, usize))| *index == 0 || *count >= min_runs;
            let allowed = counts.into_iter().enumerate().filter(is_allowed);
            (step, allowed.map(|(_, (contexts, _))| contexts).collect())
        };
        self.in_order().into_iter().map(nominal).collect()
    }

    /// For each step of which the runs have only a part in common, that part. One run that does all else as the others may be wrong; two that differ
    /// show that people do.
    fn common_parts(&self, sequences: &Sequences, strengths: &Strengths) -> BTreeMap<StepKey, Vec<Context>> {
        let differs = |run: &usize, step: &StepKey| {
            let index = self.index(*run, step);
            index.is_some_and(|index| !sequences[step].contains(&self.contexts(*run, index, step)))
        };
        let all = self.in_order();
        let differing = (0..self.runs.len()).filter(|run| all.iter().any(|step| differs(run, step))).count();
        // Of two runs, neither shows that the other one is right as well.
        let may_be_wrong = differing == 1 && self.runs.len() >= MIN_RUNS || self.runs.len() < MIN_ALIKE;
        let is_law = |step: &StepKey| {
            let is_shown = may_be_wrong || (0..self.runs.len()).all(|run| !differs(&run, step));
            strengths.is_law(Rule::Sequence(*step)) && is_shown && !self.is_steadied(step)
        };
        let differing_steps = all.into_iter().filter(|step| !is_law(step));
        differing_steps.filter_map(|step| Some((step, self.common_part(&step)?))).collect()
    }

    /// Whether the hand only steadies the object of a step: no run moves it, and as a rule the hand rests there. What comes to it meanwhile is the
    /// work of the other hand.
    fn is_steadied(&self, step: &StepKey) -> bool {
        let all = self.runs.iter().flat_map(|run| run.activities.iter().map(move |activity| (run, activity)));
        let at_it: Vec<_> = all.filter(|(_, activity)| object(activity) == step.opening[1]).collect();
        let moves_m: Vec<f64> =
            at_it.iter().map(|(run, activity)| f64::from(run.hand_moves_m(activity))).collect();
        median(&moves_m) < f64::from(SAME_PLACE_M)
            && !at_it.iter().any(|(run, activity)| is_moved(run, activity))
    }

    /// The contexts that all sequences of a step have in common, in their order, from the first touch on.
    fn common_part(&self, step: &StepKey) -> Option<Vec<Context>> {
        let all = self.sequences_of(step).into_keys();
        let common = all.reduce(|one, other| longest_common_subsequence(&one, &other))?;
        let first = common.iter().position(|context| context.is_touch())?;
        Some(common[first..].to_vec())
    }

    /// The first point at which a run does a step in a way that is nominal in no run. If it lacks most of the common steps, it is the first one that
    /// it lacks.
    fn disagreement(
        &self,
        run: usize,
        common: &[StepKey],
        sequences: &Sequences,
        common_parts: &BTreeMap<StepKey, Vec<Context>>,
    ) -> Option<Disagreement> {
        let name = self.runs[run].name.clone();
        for (activity, step) in self.steps[run].iter().enumerate() {
            let Some(step) = step.filter(|step| !common_parts.contains_key(step)) else { continue };
            let (contexts, allowed) = (self.contexts(run, activity, &step), &sequences[&step]);
            if !allowed.contains(&contexts) {
                let iu = contexts.iter().zip(&allowed[0]).take_while(|(had, other)| had == other).count();
                let (had, others) = (contexts.get(iu).copied(), allowed[0].get(iu).copied());
                return Some(Disagreement { name, activity, iu, had, others });
            }
        }
        let mut lacking = common.iter().enumerate().filter(|(_, step)| self.index(run, step).is_none());
        let (activity, step) = lacking.next()?;
        let had = self.steps[run].get(activity).copied().flatten().map(StepKey::context);
        let is_other_work = 2 * (1 + lacking.count()) > common.len();
        is_other_work.then_some(Disagreement { name, activity, iu: 0, had, others: Some(step.context()) })
    }
}

/// The longest sequence that both have as a part, with others between.
fn longest_common_subsequence(one: &[Context], other: &[Context]) -> Vec<Context> {
    let mut longest: Vec<Vec<Context>> = vec![Vec::new(); other.len() + 1];
    for context in one {
        let before = longest.clone();
        for (index, candidate) in other.iter().enumerate() {
            longest[index + 1] = if candidate == context {
                [before[index].as_slice(), &[*context]].concat()
            } else if longest[index].len() > before[index + 1].len() {
                longest[index].clone()
            } else {
                before[index + 1].clone()
            };
        }
    }
    longest.pop().unwrap_or_default()
}

/// The hand that acts on an object first in an activity, for objects at which no run has both hands. The one that most activities have.
fn hands(runs: &[Run], is_kept: &impl Fn(usize, usize) -> bool) -> BTreeMap<u16, Side> {
    let mut counts: BTreeMap<u16, [usize; 2]> = BTreeMap::new();
    let mut by_both = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let mut of_run: BTreeMap<u16, [usize; 2]> = BTreeMap::new();
        let activities = run.activities.iter().enumerate().filter(|(index, _)| is_kept(number, *index));
        for (_, activity) in activities {
            of_run.entry(object(activity)).or_default()[activity.side.index()] += 1;
        }
        by_both.extend(of_run.iter().filter(|(_, count)| !count.contains(&0)).map(|(id, _)| *id));
        for (id, [right, left]) in of_run {
            let count = counts.entry(id).or_default();
            *count = [count[0] + right, count[1] + left];
        }
    }
    let hand = |[right, left]: [usize; 2]| if left > right { Side::Left } else { Side::Right };
    let of_one = counts.into_iter().filter(|(id, _)| !by_both.contains(id));
    of_one.map(|(id, count)| (id, hand(count))).collect()
}

/// Whether an activity moves the object that it begins with, by more than it seems to move by noise.
fn is_moved(run: &Run, activity: &Activity) -> bool {
    let moved_m = run.moved_m(activity);
    moved_m >= SAME_PLACE_M && moved_m >= run.noise_m(object(activity))
}

/// The object that the activity begins with.
fn object(activity: &Activity) -> u16 {
    activity.ius.first().map_or(0, |iu| iu.context.0[1])
}

/// Hand and first object of an activity: at its beginning the object may be at another one already.
fn opening(activity: &Activity, hands: &BTreeMap<u16, Side>) -> [u16; 2] {
    let id = object(activity);
    let side = hands.get(&id).copied().unwrap_or(activity.side);
    [side as u16, id]
}

#[cfg(test)]
mod tests {
    use super::*;

    impl ShownIu {
        /// One of which nothing but this was measured.
        pub(in crate::teach) fn measuring(context: Context, measured: &[Measures], frames: &[u32]) -> Self {
            let strokes = Strokes::of(context, measured);
            let (measured, frames) = (measured.to_vec(), frames.to_vec());
            Self { context, strokes, shown: Vec::new(), measured, frames, occluded: Vec::new() }
        }
    }

    impl Agreement {
        /// A job of one IU.
        pub(in crate::teach) fn of_iu(iu: &ShownIu) -> Self {
            let sequence =
                Sequence { contexts: vec![iu.context], ius: vec![iu.clone()], ..Sequence::default() };
            Self { sequences: vec![sequence], ..Self::default() }
        }
    }
}
