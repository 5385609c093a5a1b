//! What speaks against learning from the runs, in words.

use super::outlier::Outlier;

/// What speaks against learning from the runs, and what to do about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// What speaks against them, as a sentence without its full stop.
    pub sentence: String,
    /// What to do about it, as a sentence without its full stop.
    pub remedy: String,
    /// The demonstration that is not like the others, if it is about one.
    pub outlier: Option<Outlier>,
}

impl Doubt {
    pub(super) fn new(sentence: String, remedy: String) -> Self {
        Self { sentence, remedy, outlier: None }
    }

    /// That a demonstration is not like the others; `figures` says in what.
    pub(super) fn of(outlier: Outlier, figures: &str) -> Self {
        let run = &outlier.run;
        Self {
            sentence: format!("{run} is not like the others: {figures}"),
            remedy: format!(
                "look at {run}: leave it out if it is not correct; if it is, show more runs like it"
            ),
            outlier: Some(outlier),
        }
    }
}

/// The names with the verb, in the singular for one of them.
pub(super) fn names(names: &[String], [has, have]: [&str; 2]) -> String {
    format!("{} {}", names.join(", "), if names.len() == 1 { has } else { have })
}
