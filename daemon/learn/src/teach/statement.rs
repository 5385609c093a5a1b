//! A sentence of the report, with what it depends on.

use crate::distribution::Distribution;
use crate::html::escaped;
use std::fmt;

/// A sentence for people. `Display` prints both.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// The sentence.
    pub text: String,
    /// What it depends on, each with the name of the run where the sentence does not say it.
    pub shown: Vec<(Option<String>, Distribution)>,
}

impl From<String> for Statement {
    fn from(text: String) -> Self {
        Self { text, shown: Vec::new() }
    }
}

impl Statement {
    pub(super) fn of_run(text: String, shown: Option<Distribution>) -> Self {
        Self { text, shown: shown.map(|shown| (None, shown)).into_iter().collect() }
    }

    pub(super) fn html(&self) -> String {
        let strip = |(run, shown): &(Option<String>, Distribution)| {
            shown.html(&run.as_ref().map(|run| format!("{run}, ")).unwrap_or_default())
        };
        escaped(self.text.trim()) + &self.shown.iter().map(strip).collect::<String>()
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.text)?;
        self.shown.iter().try_for_each(|(run, shown)| match run {
            Some(run) => write!(f, "\n    {run}, {shown}"),
            None => write!(f, "\n    {shown}"),
        })
    }
}
