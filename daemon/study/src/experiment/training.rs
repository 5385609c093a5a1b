//! The training executions of the second experiment, encoded as each variation needs them.

use super::variation::Variation;
use crate::folder::Labelled;
use andon_core::config::Method;
use andon_learn::job_file::JobFile;
use andon_learn::run::Run;
use andon_learn::teach::{Memory, TeachError, TeachOptions, teach_again, with_learned_contacts};

/// The training executions of one round, with the filter and without it. Hands and objects meet as the recordings say and as the executions show it,
/// as far as a variation needs that.
pub(super) struct Encodings {
    all: Vec<Encoding>,
}

struct Encoding {
    is_filtered: bool,
    finds_contact_regions: bool,
    training: Training,
}

impl Encodings {
    /// `raw` are the executions without the filter, where a variation has none.
    ///
    /// # Errors
    /// If where hands and objects meet cannot be learned.
    pub(super) fn new(
        filtered: Training,
        raw: Option<Training>,
        variations: &[Variation],
    ) -> Result<Self, TeachError> {
        let mut all = Vec::new();
        for (is_filtered, training) in [(true, Some(filtered)), (false, raw)] {
            let Some(training) = training else { continue };
            let mut needing = variations.iter().filter(|one| one.is_filtered == is_filtered);
            if needing.any(|one| one.finds_contact_regions) {
                all.push(Encoding {
                    is_filtered,
                    finds_contact_regions: true,
                    training: training.with_learned_contacts()?,
                });
            }
            all.push(Encoding { is_filtered, finds_contact_regions: false, training });
        }
        Ok(Self { all })
    }

    /// The job that these rules teach.
    pub(super) fn teach(&mut self, rules: &Variation) -> Result<JobFile, TeachError> {
        let needed = (rules.is_filtered, rules.finds_contact_regions);
        let index = self.all.iter().position(|one| (one.is_filtered, one.finds_contact_regions) == needed);
        self.all[index.unwrap_or_default()].training.teach(rules)
    }
}

/// The training executions of one round.
pub(super) struct Training {
    method: Method,
    runs: Vec<Run>,
    memory: Memory,
}

impl Training {
    pub(super) fn new(all: &[Labelled], indices: &[usize], method: Method) -> Self {
        let runs = indices.iter().map(|&index| all[index].run.clone()).collect();
        Self { method, runs, memory: Memory::default() }
    }

    /// The same executions where hands and objects meet as these show it.
    fn with_learned_contacts(&self) -> Result<Self, TeachError> {
        let runs = with_learned_contacts(&self.runs, &self.options())?;
        Ok(Self { method: self.method, runs, memory: Memory::default() })
    }

    /// The job that these rules teach, where hands and objects meet as the runs are encoded.
    fn teach(&mut self, rules: &Variation) -> Result<JobFile, TeachError> {
        let Variation { cost, max_slowdown, has_free_ends, rule, bounds, .. } = *rules;
        let options = TeachOptions { cost, max_slowdown, has_free_ends, rule, bounds, ..self.options() };
        teach_again(&self.runs, &options, &mut self.memory)
    }

    fn options(&self) -> TeachOptions {
        TeachOptions {
            // The experiment judges recordings with all their frames, and teaches hundreds of times.
            measure_rate: false,
            examine_runs: false,
            ..TeachOptions::new("experiment 2", "", self.method)
        }
    }
}
