//! What people call the steps of a job. The names stand in a section at the end of the job file. Its checksum does not cover that, so that a person
//! may change them. The job, its hash and what a PLC knows of it stay the same.

use super::JobFile;
use super::text::{others, quoted, side_of};
use andon_core::couple::Context;
use std::fmt::Write as _;

/// The line that begins the section. No other line of the file is the same: what people name is in quotes.
const HEADER: &str = "[names]\n";

/// The text that the checksum covers: everything before the section.
pub(super) fn before(text: &str) -> &str {
    let Some(at) = text.find(&format!("\n{HEADER}")) else { return text };
    // The empty line before the section is part of it, and may have been removed.
    if text[..at].ends_with('\n') { &text[..at] } else { &text[..=at] }
}

/// Appends the section, if there are names.
pub(super) fn append(text: &mut String, names: &[String]) {
    if names.is_empty() {
        return;
    }
    // Writing to a `String` cannot fail.
    let _ = writeln!(
        text,
        "\n{HEADER}# What people read for each step, in the order of the steps. Change the names as you like: the checksum does not\n\
         # cover this section, and the job stays the same.\nsteps = ["
    );
    for name in names {
        let _ = writeln!(text, "  {},", quoted(name));
    }
    text.push_str("]\n");
}

impl JobFile {
    /// Gives each step the name that a job of the same steps had for it before, or else a proposal.
    pub(crate) fn name_steps(&mut self, before: &[(Vec<Context>, String)]) {
        let name = |number: usize| {
            let contexts = self.step_contexts(number);
            let known = before.iter().find(|(known, _)| *known == contexts);
            known.map_or_else(|| self.proposed_name(number), |(_, name)| name.clone())
        };
        self.step_names = (0..self.steps.len()).map(name).collect();
    }

    /// The names that people have given, each with the contexts of its step.
    pub(crate) fn named_contexts(&self) -> Vec<(Vec<Context>, String)> {
        let names = self.step_names.iter().enumerate();
        names.map(|(number, name)| (self.step_contexts(number), name.clone())).collect()
    }

    /// A name for a step: which part comes to which others, and with which hand where both hands have steps.
    pub(super) fn proposed_name(&self, number: usize) -> String {
        let contexts = self.step_contexts(number);
        let Some(Context([hand, part, _, _])) = contexts.first() else {
            return format!("step {}", number + 1);
        };
        let others = others(&contexts, |id| self.object_name(id));
        let part = self.object_name(*part);
        let words = if others.is_empty() {
            format!("{part} in hand")
        } else {
            format!("{part} at {}", others.join(", "))
        };
        let words = words.replace(char::is_control, " ");
        let hand_of = |taught: &super::TaughtActivity| taught.ius.first().map(|iu| iu.context.0[0]);
        let is_one_handed = self.activities.iter().all(|taught| hand_of(taught) == Some(*hand));
        if is_one_handed { words } else { format!("{} hand: {words}", side_of(*hand).name()) }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::job_file::JobFault;

    fn shipped() -> JobFile {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");
        JobFile::parse(path, &std::fs::read(path).unwrap()).unwrap()
    }

    fn parse(text: &str) -> Result<JobFile, JobFault> {
        JobFile::parse("job.toml", text.as_bytes()).map_err(|error| error.fault)
    }

    #[test]
    fn a_name_is_proposed_for_each_step_and_says_the_hand_only_where_both_have_steps() {
        let mut job = shipped();
        assert_eq!([0, 1].map(|number| job.proposed_name(number)), ["polisher at brick", "brick at meter"]);
        job.activities[1].ius.iter_mut().for_each(|iu| iu.context.0[0] = 2);
        assert_eq!(job.proposed_name(0), "right hand: polisher at brick");
        assert_eq!(job.proposed_name(1), "left hand: brick at meter");
    }

    #[test]
    fn whoever_changes_a_name_has_changed_no_job() {
        let mut job = shipped();
        job.name_steps(&[]);
        let renamed = job.to_toml().replace("\"polisher at brick\"", "\"polish the \\\"old\\\" brick\"");
        for text in [renamed.clone(), renamed.replace("\n\n[names]", "\n[names]")] {
            let read = parse(&text).unwrap();
            assert_eq!(
                [0, 1].map(|number| read.step_name(number)),
                ["polish the \"old\" brick", "brick at meter"]
            );
            assert_eq!(read.model_hash(), job.model_hash());
        }
        let unnamed = JobFile { step_names: Vec::new(), ..job.clone() };
        assert_eq!(unnamed.model_hash(), job.model_hash());
        assert!(matches!(
            parse(&renamed.replacen("once", "onze", 1)),
            Err(JobFault::Checksum { .. } | JobFault::Toml(_))
        ));
    }

    #[test]
    fn a_job_that_is_taught_again_keeps_the_names_of_the_steps_that_it_still_has() {
        let mut job = shipped();
        job.step_names = vec!["polish".to_owned(), "measure".to_owned()];
        let before = job.named_contexts();
        job.activities[1].ius.pop();
        job.name_steps(&before);
        assert_eq!(job.step_names, ["polish", "brick at meter"]);
        assert_eq!([0, 1].map(|number| job.given_name(number)), [Some("polish"), None]);
    }

    #[test]
    fn names_that_are_none_are_refused_with_their_place() {
        let mut job = shipped();
        for (names, key) in [(&["one"][..], "names.steps:"), (&["one", " "], "names.steps[1]:")] {
            job.step_names = names.iter().map(|name| (*name).to_owned()).collect();
            let fault = parse(&job.to_toml()).unwrap_err().to_string();
            assert!(fault.starts_with(key), "{fault}");
        }
    }
}
