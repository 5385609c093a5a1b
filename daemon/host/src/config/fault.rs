//! What is wrong with a configuration, in words by which a person can correct it.

use std::fmt;
use std::path::PathBuf;

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1; `None` where something is missing from the whole file.
    pub line: Option<usize>,
    /// The key with its section, as in `camera.rate_hz`; `None` where the file is not TOML.
    pub key: Option<String>,
    /// The value as the file has it, or the default that is in force.
    pub value: Option<String>,
    /// What is wrong, with what is allowed.
    pub problem: String,
    /// The key or the word that was probably meant.
    pub likely: Option<String>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        if let Some(key) = &self.key {
            write!(f, " {key}")?;
            if let Some(value) = &self.value {
                write!(f, " = {value}")?;
            }
            write!(f, ":")?;
        }
        write!(f, " {}", self.problem)?;
        if let Some(likely) = &self.likely {
            write!(f, "; did you mean {likely}?")?;
        }
        Ok(())
    }
}

/// All faults of a configuration, in the order of files and lines. Never empty.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Faults(pub Vec<Fault>);

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for fault in &self.0 {
            writeln!(f, "{fault}")?;
        }
        let faults = if self.0.len() == 1 { "fault" } else { "faults" };
        write!(f, "{} {faults} in the configuration: nothing is started", self.0.len())
    }
}
