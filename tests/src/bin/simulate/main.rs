//! Writes the simulated recordings of the paper's experiments and of a shop floor, and measures the rules on them.
//!
//! ```text
//! simulate 1|2|floor SEED FOLDER           writes track files: experiment 1, experiment 2, or every flaw of the shop floor
//! simulate people SEED FOLDER              writes a folder for each work by feel and each of three persons, the third one seen by boxes
//! simulate measure FIRST LAST              measures experiment 2 with the seeds FIRST to LAST, without files
//! simulate measure-1 FIRST LAST FOLDER     measures experiment 1 with these seeds, and writes a report of each into the folder
//! simulate floor-measure FIRST LAST RUNS   measures the default rules on every flaw, taught by 1 to 5 runs
//! ```

mod measure;

use andon_learn::recording::Recording;
use andon_tests::simulator::{
    ByFeel, Lapse, Noise, Performance, experiment_1, experiment_2, floor, perform_by_feel, save, save_as,
};
use std::path::Path;
use std::process::ExitCode;

type Outcome = Result<(), Box<dyn std::error::Error>>;

const USAGE: &str = "simulate 1|2|floor SEED FOLDER\nsimulate people SEED FOLDER\nsimulate measure FIRST LAST\n\
     simulate measure-1 FIRST LAST FOLDER\nsimulate floor-measure FIRST LAST RUNS";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("simulate: {error}\n{USAGE}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[&str]) -> Outcome {
    let noise = Noise::default();
    match *arguments {
        ["1", seed, folder] => Ok(save(Path::new(folder), &experiment_1(seed.parse()?, noise))?),
        ["2", seed, folder] => Ok(save(Path::new(folder), &experiment_2(seed.parse()?, noise))?),
        ["floor", seed, folder] => Ok(save(Path::new(folder), &floor(seed.parse()?, noise))?),
        ["people", seed, folder] => people(seed.parse()?, Path::new(folder)),
        ["measure", first, last] => measure::experiment_2(first.parse()?..=last.parse()?),
        ["measure-1", first, last, folder] => {
            measure::experiment_1(first.parse()?..=last.parse()?, Path::new(folder))
        }
        ["floor-measure", first, last, runs] => measure::floor(first.parse()?..=last.parse()?, runs.parse()?),
        _ => Err("the arguments do not match any of the forms below".into()),
    }
}

/// A folder for each work by feel and each person. The first two are by motion capture, the third by a camera's boxes.
fn people(seed: u64, folder: &Path) -> Outcome {
    for work in ByFeel::ALL {
        for person in 1..=3 {
            let noise = if person == 3 { Noise::boxes() } else { Noise::motion_capture() };
            let recorded = |repetition, lapse| {
                perform_by_feel(&Performance { seed, person, repetition, noise }, work, lapse)
            };
            let mut runs: Vec<(String, Recording)> = (0..10)
                .map(|repetition| (format!("subject{person}_run{repetition}"), recorded(repetition, None)))
                .collect();
            for lapse in Lapse::ALL {
                let with_lapse = |repetition| {
                    (format!("{}_run{repetition}", lapse.name()), recorded(repetition, Some(lapse)))
                };
                runs.extend((0..5).map(with_lapse));
            }
            let set = folder.join(format!("{}_person{person}", work.name()));
            save_as(&set, runs.iter().map(|(name, recording)| (name.as_str(), recording)))?;
        }
    }
    Ok(())
}
