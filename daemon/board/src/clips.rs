//! Which verdicts have a clip.

use std::collections::HashSet;

use shm_schemas::MessageId;

/// The verdicts that clips show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Clips(HashSet<MessageId>);

impl Clips {
    /// These.
    pub fn new(shown: impl IntoIterator<Item = MessageId>) -> Self {
        Self(shown.into_iter().collect())
    }

    pub(crate) fn show(&self, verdict: MessageId) -> bool {
        self.0.contains(&verdict)
    }
}
