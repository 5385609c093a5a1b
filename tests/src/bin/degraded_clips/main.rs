//! Judges the shipped clips as a worse camera or a slower machine would show them. They have fewer frames per second or noise, or are in the dark,
//! strongly compressed, or turned. A correct clip must never be accused, and a faulty one never be called right; that it cannot be judged is not a
//! fault.
//!
//! `ffmpeg` changes the clips, and `andond replay` beside this program judges them with the shipped job. Prints a row per clip and change;
//! ends with 1 if a correct clip was accused or a faulty one called right.

use andon_tests::workers;
use clap::Parser;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;

type Error = Box<dyn std::error::Error + Send + Sync>;

#[derive(Parser)]
struct Arguments {
    /// Clips; their names say who shows what: `p<person>_<what>_r<repetition>.mp4`.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// Only changes with these names.
    #[arg(long = "change", value_name = "NAME")]
    changes: Vec<String>,
    /// The job to judge with.
    #[arg(long, default_value = "config/jobs/polish-and-measure.toml")]
    job: PathBuf,
    /// The station whose objects are on the bench.
    #[arg(long, default_value = "config/stations/demo.toml")]
    station: PathBuf,
}

/// What is done to a clip.
struct Change {
    name: &'static str,
    /// An ffmpeg filter.
    filter: &'static str,
    /// The quality of H.264: 0 loses nothing, 51 is the worst.
    crf: u8,
}

const fn change(name: &'static str, filter: &'static str) -> Change {
    Change { name, filter, crf: 0 }
}

const CHANGES: [Change; 21] = [
    change("30/s", "null"),
    change("15/s", "fps=15"),
    change("10/s", "fps=10"),
    change("7.5/s", "fps=7.5"),
    change("5/s", "fps=5"),
    change("3/s", "fps=3"),
    change("noise 10", "noise=alls=10:allf=t"),
    change("noise 20", "noise=alls=20:allf=t"),
    change("noise 20, smoothed", "noise=alls=20:allf=t,gblur=1.2"),
    change("darker", "eq=brightness=-0.25"),
    change("gamma 0.4", "eq=gamma=0.4"),
    change("soft lens", "gblur=1.2"),
    change("soft lens, 15/s", "gblur=1.2,fps=15"),
    change("noise 10, 15/s", "noise=alls=10:allf=t,fps=15"),
    change("upside down", "hflip,vflip"),
    change("tilted", "perspective=16:8:624:8:0:480:640:480:sense=destination"),
    change("1280x720", "scale=960:720,pad=1280:720:160:0"),
    Change { name: "crf 32", filter: "null", crf: 32 },
    Change { name: "crf 36", filter: "null", crf: 36 },
    Change { name: "crf 40", filter: "null", crf: 40 },
    Change { name: "crf 44", filter: "null", crf: 44 },
];

/// What was said of a job, or should be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Said {
    Right,
    Anomaly,
    NotJudged,
}

impl Said {
    const fn word(self) -> &'static str {
        match self {
            Self::Right => "ok",
            Self::Anomaly => "anomaly",
            Self::NotJudged => "not judged",
        }
    }
}

/// What came of one clip with one change.
struct Row {
    clip: String,
    change: &'static str,
    expected: Said,
    said: Said,
    /// An IU, an activity or a job is an anomaly.
    is_accused: bool,
}

impl Row {
    fn is_wrong(&self) -> bool {
        match self.expected {
            Said::Right => self.is_accused,
            _ => self.said == Said::Right,
        }
    }

    /// What is not judged is neither right nor wrong.
    fn word(&self) -> &'static str {
        match self.said {
            _ if self.is_wrong() => "WRONG",
            Said::NotJudged => "not judged",
            _ => "right",
        }
    }
}

fn main() -> Result<ExitCode, Error> {
    let arguments = Arguments::parse();
    let wanted = |change: &&Change| {
        arguments.changes.is_empty() || arguments.changes.iter().any(|name| name == change.name)
    };
    let todo: Vec<(&Change, &PathBuf)> = CHANGES
        .iter()
        .filter(wanted)
        .flat_map(|change| arguments.clips.iter().map(move |clip| (change, clip)))
        .collect();
    let rows = Mutex::new(Vec::new());
    workers::for_each(&todo, |(change, clip)| -> Result<(), Error> {
        let row = judge(&arguments, change, clip)?;
        println!(
            "{:24} {:20} {:10} {:10} {}",
            row.clip,
            row.change,
            row.expected.word(),
            row.said.word(),
            row.word()
        );
        rows.lock().map_err(|_| "a worker has panicked")?.push(row);
        Ok(())
    })?;
    let rows = rows.into_inner()?;
    print_totals(&rows);
    Ok(ExitCode::from(u8::from(rows.iter().any(Row::is_wrong))))
}

/// A row per change: how the correct and the faulty clips came out.
fn print_totals(rows: &[Row]) {
    println!("\n{:20} correct: ok, not judged, accused; faulty: anomaly, not judged, called right", "change");
    for change in &CHANGES {
        let of = |is_correct: bool, said: Said| {
            let is_one = |row: &&Row| {
                row.change == change.name && (row.expected == Said::Right) == is_correct && row.said == said
            };
            rows.iter().filter(is_one).count()
        };
        if rows.iter().any(|row| row.change == change.name) {
            let accused = rows
                .iter()
                .filter(|row| row.change == change.name && row.expected == Said::Right && row.is_accused);
            println!(
                "{:20} {:11} {:11} {:8} {:16} {:11} {:13}",
                change.name,
                of(true, Said::Right),
                of(true, Said::NotJudged),
                accused.count(),
                of(false, Said::Anomaly),
                of(false, Said::NotJudged),
                of(false, Said::Right)
            );
        }
    }
    println!("{} wrong", rows.iter().filter(|row| row.is_wrong()).count());
}

fn judge(arguments: &Arguments, change: &Change, clip: &Path) -> Result<Row, Error> {
    let name = clip.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = tempfile::tempdir()?;
    let film = folder.path().join("clip.mp4");
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-v", "error", "-i"]).arg(clip).args(["-vf", change.filter, "-pix_fmt", "yuv420p"]);
    // What is not compressed is written fast.
    let preset = if change.crf == 0 { "ultrafast" } else { "medium" };
    ffmpeg.args(["-preset", preset, "-crf", &change.crf.to_string()]).arg(&film);
    let status = ffmpeg.status().map_err(|error| format!("ffmpeg cannot be started: {error}"))?;
    if !status.success() {
        return Err(format!("ffmpeg cannot change {} by {}", clip.display(), change.filter).into());
    }
    let output = Command::new(andon_tests::line::andond())
        .args(["replay", "--json", "--job"])
        .arg(&arguments.job)
        .arg("--config")
        .arg(&arguments.station)
        .arg(&film)
        .stderr(Stdio::piped())
        .output()?;
    let text = String::from_utf8(output.stdout)?;
    let mut said = None;
    let mut is_accused = false;
    for line in text.lines() {
        let verdict: serde_json::Value = serde_json::from_str(line)?;
        let outcome = match verdict["outcome"].as_str() {
            Some("ok") => Said::Right,
            Some("anomaly") => Said::Anomaly,
            _ => Said::NotJudged,
        };
        is_accused |= outcome == Said::Anomaly;
        if verdict["level"] == "job" {
            said = Some(worse(said, outcome));
        }
    }
    if said.is_none() && !output.stderr.is_empty() {
        eprintln!("{name}, {}: {}", change.name, String::from_utf8_lossy(&output.stderr).trim());
    }
    let expected = if name.contains("_none_") { Said::Right } else { Said::Anomaly };
    Ok(Row { clip: name, change: change.name, expected, said: said.unwrap_or(Said::NotJudged), is_accused })
}

/// Of several jobs that a clip seems to show, the one with the worst verdict counts.
fn worse(one: Option<Said>, other: Said) -> Said {
    match (one, other) {
        (Some(Said::Anomaly), _) | (_, Said::Anomaly) => Said::Anomaly,
        (Some(Said::NotJudged), _) | (_, Said::NotJudged) => Said::NotJudged,
        _ => Said::Right,
    }
}
