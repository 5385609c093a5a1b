//! `andond whatif`: what another job would have said of what was recorded, beside what was said.
//!
//! Both are judged again from what was detected, with the commands where they came. So the two columns differ only where the jobs do, even for a clip
//! that begins in the middle of a piece. What several clips show is counted in the oldest of them, which has what came before it.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use jiff::Timestamp;
use shm_schemas::MessageId;

use super::clip::recordings;
use super::since::since_ns;
use super::{ToolError, code_of_verdicts, job, progress, running_config};
use crate::blackbox::again::{Recorded, Step, judge};
use crate::blackbox::{Chain, Plan, chains};
use crate::cli::Whatif;
use crate::compatibility;
use crate::report::Names;

/// Runs the command; the exit code is what the new job says.
///
/// # Errors
/// What is missing or damaged.
pub fn run(arguments: &Whatif) -> Result<u8, ToolError> {
    let since = arguments.since.as_deref();
    let since_utc_ns = since.map(|text| since_ns("--since", text, Timestamp::now())).transpose()?;
    let file = job::load(&arguments.job)?;
    let config = running_config(&arguments.config)?.config;
    let mut found = recordings(&config)?;
    found.retain(|recording| recording.index.ended_utc_ns >= since_utc_ns.unwrap_or(0));
    if found.is_empty() {
        return Err(ToolError::NoRecordings(config.recordings()));
    }
    let paths: Vec<PathBuf> = found.into_iter().map(|recording| recording.path).collect();
    let mut table = Table::default();
    chains(&paths, &mut |chain| table.take(&chain, &arguments.job, &file));
    print!("{}", table.text());
    Ok(table.exit_code())
}

/// Judges recordings by the jobs that were in force, and by another one. What was counted `before` is not counted again.
fn compare(
    paths: &[PathBuf],
    plan: &Plan,
    job: (&Path, &JobFile),
    before: &Frames,
) -> Result<[Counted; 2], ToolError> {
    let (path, file) = job;
    let misfit = |misfit| ToolError::Misfit { path: path.into(), misfit };
    compatibility::station(file, &plan.station.config).map_err(misfit)?;
    let was = Recorded { paths, plan, instead: None, wants_pictures: false, sight: None };
    let would_be = Recorded { instead: Some(file), ..was };
    std::thread::scope(|scope| {
        let old = scope.spawn(|| count(was, before, &|| ()));
        let bar = progress(None, paths.first().map_or(path, PathBuf::as_path));
        let new = count(would_be, before, &|| bar.inc(1));
        bar.finish_and_clear();
        // A thread that panics ends the process.
        let old = old.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        Ok([old?, new?])
    })
}

/// Frames by the numbers of their detections, in each start of the role that sent them.
#[derive(Debug, Default, PartialEq, Eq)]
struct Frames(HashMap<u64, Vec<RangeInclusive<u64>>>);

impl Frames {
    fn add(&mut self, frame: MessageId) {
        let ranges = self.0.entry(frame.epoch).or_default();
        // A number that comes twice is as good as the next one; in a damaged recording it may be any.
        let goes_on = |end: u64| end == frame.seq || frame.seq.checked_sub(1) == Some(end);
        match ranges.last_mut().filter(|range| goes_on(*range.end())) {
            Some(range) => *range = *range.start()..=frame.seq,
            None => ranges.push(frame.seq..=frame.seq),
        }
    }

    fn add_all(&mut self, other: Self) {
        for (epoch, ranges) in other.0 {
            self.0.entry(epoch).or_default().extend(ranges);
        }
    }

    fn has(&self, frame: MessageId) -> bool {
        self.0.get(&frame.epoch).is_some_and(|ranges| ranges.iter().any(|range| range.contains(&frame.seq)))
    }
}

/// What is said of each file.
type ByFile = BTreeMap<PathBuf, Counts>;

/// What is said of recordings that follow each other, and their frames.
#[derive(Debug, Default)]
struct Counted {
    files: ByFile,
    frames: Frames,
}

fn count(recorded: Recorded<'_>, before: &Frames, tick: &dyn Fn()) -> Result<Counted, ToolError> {
    let mut counted = Counted::default();
    let mut names = (0, Names::default());
    judge(recorded, &mut |step: Step<'_>| -> Result<(), ToolError> {
        tick();
        let (job, hash) = step.job;
        if names.0 != hash {
            names = (hash, Names::of_job(job));
        }
        counted.frames.add(step.frame);
        if !step.verdicts.is_empty() && !before.has(step.frame) {
            let of_file = counted.files.entry(step.recording.into()).or_default();
            step.verdicts.iter().for_each(|verdict| of_file.add(verdict, &names.1));
        }
        Ok(())
    })?;
    Ok(counted)
}

/// How many pieces were right, wrong and not judged, and which faults there were.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Counts {
    pieces: [usize; 3],
    faults: BTreeMap<Fault, usize>,
}

/// What was not right with an activity: the number of its step where it has one, whether it is an anomaly, and the words.
type Fault = (Option<u16>, bool, String);

const PIECES: [&str; 3] = ["pieces right", "pieces wrong", "pieces not judged"];

impl Counts {
    fn add(&mut self, verdict: &Verdict, names: &Names) {
        match verdict.level {
            Level::Job => self.pieces[place(verdict.outcome)] += 1,
            Level::Activity if verdict.outcome != Outcome::Ok => {
                let is_anomaly = verdict.outcome == Outcome::Anomaly;
                let fault = names.fault(verdict).unwrap_or_default();
                let words = if is_anomaly { fault } else { format!("{fault}, not judged") };
                *self.faults.entry((verdict.nearest, is_anomaly, words)).or_default() += 1;
            }
            Level::Activity | Level::Iu => (),
        }
    }

    fn add_all(&mut self, other: &Self) {
        self.pieces.iter_mut().zip(other.pieces).for_each(|(count, more)| *count += more);
        for (fault, count) in &other.faults {
            *self.faults.entry(fault.clone()).or_default() += count;
        }
    }

    fn has(&self, is_anomaly: bool) -> bool {
        self.faults.keys().any(|(_, anomaly, _)| *anomaly == is_anomaly)
    }
}

fn place(outcome: Outcome) -> usize {
    match outcome {
        Outcome::Ok => 0,
        Outcome::Anomaly => 1,
        Outcome::NotJudged => 2,
    }
}

/// Every row of two counts, with both numbers.
fn rows<'c>(old: &'c Counts, new: &'c Counts) -> Vec<(&'c str, [usize; 2])> {
    let pieces = (0..).zip(PIECES).map(|(index, what)| (what, [old.pieces[index], new.pieces[index]]));
    let faults: std::collections::BTreeSet<&Fault> = old.faults.keys().chain(new.faults.keys()).collect();
    let number = |counts: &Counts, fault: &Fault| counts.faults.get(fault).copied().unwrap_or_default();
    let faults = faults.into_iter().map(|fault| (fault.2.as_str(), [number(old, fault), number(new, fault)]));
    pieces.chain(faults).collect()
}

/// What was said and what would have been said.
#[derive(Debug, Default)]
struct Table {
    old: Counts,
    new: Counts,
    /// What both were counted of.
    frames: Frames,
    /// Recordings of which the two say something else, and in what.
    differing: Vec<String>,
    /// Why recordings could not be compared.
    left_out: Vec<String>,
}

impl Table {
    /// Adds recordings that follow each other. Those that cannot be judged are left out, which is said.
    fn take(&mut self, chain: &Chain, path: &Path, file: &JobFile) {
        let compared = match &chain.plan {
            Ok(plan) => {
                compare(&chain.paths, plan, (path, file), &self.frames).map_err(|error| error.to_string())
            }
            Err(error) => Err(error.to_string()),
        };
        match compared {
            Ok([old, new]) => {
                self.add(&chain.paths, &old.files, &new.files);
                // The other job judges every frame, also where none was in force.
                self.frames.add_all(new.frames);
            }
            Err(why) => {
                let name = |path: &PathBuf| match path.display().to_string() {
                    name if why.starts_with(&name) => why.clone(),
                    name => format!("{name}: {why}"),
                };
                self.left_out.extend(chain.paths.iter().map(name));
            }
        }
    }

    fn add(&mut self, paths: &[PathBuf], old: &ByFile, new: &ByFile) {
        for path in paths {
            let of = |side: &ByFile| side.get(path).cloned().unwrap_or_default();
            let (old, new) = (of(old), of(new));
            if old != new {
                let differing = rows(&old, &new).into_iter().filter(|(_, [was, is])| was != is);
                let words: Vec<String> =
                    differing.map(|(what, [was, is])| format!("{what} {was} -> {is}")).collect();
                self.differing.push(format!("{}: {}", path.display(), words.join("; ")));
            }
            self.old.add_all(&old);
            self.new.add_all(&new);
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{:52}  {:>7}  {:>7}\n", "", "was", "would be");
        for (what, [old, new]) in rows(&self.old, &self.new) {
            // A string takes everything that is written into it.
            let _ = writeln!(text, "{what:52}  {old:>7}  {new:>7}");
        }
        for line in &self.differing {
            let _ = writeln!(text, "{line}");
        }
        if !self.left_out.is_empty() {
            let _ = writeln!(text, "{} recordings were left out:", self.left_out.len());
        }
        for line in &self.left_out {
            let _ = writeln!(text, "{line}");
        }
        text
    }

    fn exit_code(&self) -> u8 {
        let [right, wrong, not_judged] = self.new.pieces;
        let is_open = not_judged > 0 || self.new.has(false) || right == 0 || !self.left_out.is_empty();
        code_of_verdicts(wrong > 0 || self.new.has(true), is_open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_known_by_their_numbers_in_each_start_of_their_role() {
        let frame = |epoch, seq| MessageId { epoch, seq };
        let (mut all, mut frames) = (Frames::default(), Frames::default());
        for (epoch, seq) in [(1, 5), (1, 6), (1, 6), (1, 7), (1, 9), (2, 1)] {
            frames.add(frame(epoch, seq));
        }
        assert_eq!(frames.0[&1], [5..=7, 9..=9]);
        all.add(frame(1, 8));
        all.add_all(frames);
        assert!((5..=9).all(|seq| all.has(frame(1, seq))) && all.has(frame(2, 1)));
        assert!(!all.has(frame(1, 4)) && !all.has(frame(1, 10)) && !all.has(frame(2, 5)));
    }
}
