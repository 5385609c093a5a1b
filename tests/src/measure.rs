//! What the programs that take minutes share: their arguments, percentiles, the report, and the run of their short form.
#![allow(clippy::unwrap_used, clippy::panic)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::str::FromStr;

/// The arguments of this program. Each has a default.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// Without the program's name.
    pub fn of_this_program() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// The argument at this index, from 0, as a number. Panics if it is not a number.
    pub fn number<N: FromStr>(&self, index: usize, default: N) -> N {
        self.0.get(index).map_or(default, |text| {
            text.parse().unwrap_or_else(|_| panic!("argument {}: {text:?} is not a number", index + 1))
        })
    }

    /// The argument at this index, from 0, as a path.
    pub fn path<'a>(&'a self, index: usize, default: &'a str) -> &'a Path {
        Path::new(self.0.get(index).map_or(default, String::as_str))
    }
}

/// The value below which `percent` of the values lie; 0 where there are none. Sorts them.
pub fn percentile(values: &mut [f64], percent: usize) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) * percent / 100).copied().unwrap_or_default()
}

/// Prints the report, writes it to a file, and ends the program as it deserves.
pub fn report(path: &Path, report: &Value, has_passed: bool) -> ExitCode {
    let text = serde_json::to_string_pretty(report).unwrap() + "\n";
    print!("{text}");
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).unwrap();
    }
    fs::write(path, text).unwrap();
    if has_passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Runs such a program with these arguments, the last of which is the path of its report, and reads the report. Panics
/// with the program's output where it fails.
pub fn short_form(program: &str, arguments: &[&str]) -> Value {
    let output = Command::new(program).args(arguments).output().unwrap();
    let [printed, errors] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success(), "{printed}\n{errors}");
    serde_json::from_slice(&fs::read(arguments.last().unwrap()).unwrap()).unwrap()
}
