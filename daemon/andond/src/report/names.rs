//! What people call the parts and the steps of a job.

use std::collections::HashMap;

use andon_core::couple::Context;
use andon_learn::job_file::JobFile;
use andon_learn::recording::NamedObject;

/// Names of the objects, by id, and of the steps of the job, by the number of the activity.
#[derive(Clone, Debug, Default)]
pub struct Names {
    objects: HashMap<u16, String>,
    steps: Vec<Step>,
}

/// A step of the job: its name, and the contexts of its IUs as most runs have them.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Its name.
    pub name: String,
    /// The contexts of its IUs.
    pub contexts: Vec<Context>,
}

impl Names {
    /// Names by id; an object without a name is called by its number.
    pub fn new(names: impl IntoIterator<Item = (u16, String)>) -> Self {
        Self { objects: names.into_iter().collect(), steps: Vec::new() }
    }

    /// The names of a job: its objects, and its steps, which are otherwise called by their numbers.
    pub fn of_job(job: &JobFile) -> Self {
        let step = |number: usize| Step { name: job.step_name(number), contexts: job.step_contexts(number) };
        let steps = (0..job.steps.len()).map(step).collect();
        Self { steps, ..Self::of_objects(&job.objects) }
    }

    /// The names in the head of a recording, or in a job file.
    pub fn of_objects(objects: &[NamedObject]) -> Self {
        Self::new(objects.iter().map(|object| (object.shape.id, object.name.clone())))
    }

    /// The same names with these steps.
    #[cfg(test)]
    pub(crate) fn with_steps(self, steps: &[(&str, &[[u16; 4]])]) -> Self {
        let step = |(name, contexts): &(&str, &[[u16; 4]])| Step {
            name: (*name).to_owned(),
            contexts: contexts.iter().copied().map(Context).collect(),
        };
        Self { steps: steps.iter().map(step).collect(), ..self }
    }

    /// The steps of the job, by the number of the activity; none where the job is not known.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The step that an activity of the job is, counted from 1, with its name.
    pub fn step(&self, activity: u16) -> String {
        let name = self.steps.get(usize::from(activity)).map(|step| format!(" ({})", step.name));
        format!("step {}{}", activity + 1, name.unwrap_or_default())
    }

    /// The context of an IU of a step, as most runs have it.
    pub(super) fn nominal(&self, step: u16, iu: Option<u16>) -> Option<Context> {
        self.steps.get(usize::from(step))?.contexts.get(usize::from(iu?)).copied()
    }

    /// The name of object `id`.
    pub fn object(&self, id: u16) -> String {
        self.named(id).map_or_else(|| format!("object {id}"), str::to_owned)
    }

    /// The object in a sentence.
    pub(super) fn the(&self, id: u16) -> String {
        self.named(id).map_or_else(|| format!("object {id}"), |name| format!("the {name}"))
    }

    fn named(&self, id: u16) -> Option<&str> {
        self.objects.get(&id).filter(|name| !name.is_empty()).map(String::as_str)
    }

    /// A context in words: which object is in which hand, or at which other object.
    pub fn context(&self, context: Context) -> String {
        match context.0 {
            [0, 0, 0, 0] => "idle".into(),
            [0, 0, j, l] => format!("{} left at {}", self.object(j), self.object(l)),
            [_, j, _, 0] => format!("{} in hand", self.object(j)),
            [_, j, _, l] => format!("{} at {}", self.object(j), self.object(l)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_without_a_name_is_called_by_its_number() {
        assert_eq!(Names::default().context(Context([0, 0, 6, 3])), "object 6 left at object 3");
        assert_eq!(Names::default().step(2), "step 3");
    }
}
