//! The recordings of the paper's two experiments, and of a shop floor.

use super::activity::{Layout, perform_activity};
use super::flaw::Flaw;
use super::job::perform;
use super::movement::Truth;
use super::noise::Noise;
use super::performance::Performance;
use andon_learn::recording::{self, Recording};
use std::io;
use std::path::Path;

/// The activities of the first experiment, in the paper's order.
const ACTIVITIES: [&str; 5] = ["boxing", "measuring", "assembly", "disassembly", "polishing"];

/// One recording of an experiment.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The name of the file without its ending: `p<person>_<what>_r<repetition>`.
    pub name: String,
    /// What was seen.
    pub recording: Recording,
    /// What truly happened.
    pub truth: Truth,
}

/// Experiment 1: 10 people carry out 5 activities with 4 repetitions, and drill once in each of three layouts.
pub fn experiment_1(seed: u64, noise: Noise) -> Vec<Recorded> {
    let mut all = Vec::new();
    for person in 1..=10 {
        let at = |repetition| Performance { seed, person, repetition, noise };
        for activity in ACTIVITIES {
            for repetition in 1..=4 {
                let (recording, truth) = perform_activity(&at(repetition), activity, Layout::Plan);
                all.push(Recorded { name: format!("p{person}_{activity}_r{repetition}"), recording, truth });
            }
        }
        for layout in 0..3 {
            let (recording, truth) = perform_activity(&at(1), "drilling", Layout::Drilling(layout));
            all.push(Recorded { name: format!("p{person}_drilling_C{}_r1", layout + 1), recording, truth });
        }
    }
    all
}

/// Experiment 2: 7 people do the job 3 times correctly, once as `J1` and once as `J2`.
pub fn experiment_2(seed: u64, noise: Noise) -> Vec<Recorded> {
    let mut all = Vec::new();
    for person in 1..=7 {
        for (flaw, repetition) in
            [(Flaw::None, 1), (Flaw::None, 2), (Flaw::None, 3), (Flaw::J1, 1), (Flaw::J2, 1)]
        {
            let (recording, truth) = perform(&Performance { seed, person, repetition, noise }, flaw);
            all.push(Recorded { name: format!("p{person}_{}_r{repetition}", flaw.name()), recording, truth });
        }
    }
    all
}

/// The shop floor: five people show the job correctly once each (`taught`). Then three others do it with every flaw, and with every harmless
/// variation that looks like a flaw.
pub fn floor(seed: u64, noise: Noise) -> Vec<Recorded> {
    let mut all = Vec::new();
    let mut record = |person, what: &str, flaw| {
        let (recording, truth) = perform(&Performance { seed, person, repetition: 1, noise }, flaw);
        all.push(Recorded { name: format!("p{person}_{what}_r1"), recording, truth });
    };
    for person in 1..=5 {
        record(person, "taught", Flaw::None);
    }
    for person in 6..=8 {
        for flaw in Flaw::ALL {
            record(person, flaw.name(), flaw);
        }
    }
    all
}

/// Writes recordings as track files into a folder.
///
/// # Errors
/// If the folder cannot be written.
pub fn save(folder: &Path, recorded: &[Recorded]) -> io::Result<()> {
    save_as(folder, recorded.iter().map(|one| (one.name.as_str(), &one.recording)))
}

/// Writes recordings as track files with these names into a folder.
///
/// # Errors
/// If the folder cannot be written.
pub fn save_as<'a>(
    folder: &Path,
    recordings: impl IntoIterator<Item = (&'a str, &'a Recording)>,
) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    for (name, recording) in recordings {
        let file = std::fs::File::create(folder.join(format!("{name}.tracks.jsonl")))?;
        recording::write(&mut io::BufWriter::new(file), &recording.header, &recording.frames)?;
    }
    Ok(())
}
