//! Which verdicts have a clip.

use std::collections::HashMap;

use shm_schemas::MessageId;

/// The clips by the verdicts that they show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Clips(HashMap<MessageId, String>);

impl Clips {
    /// The verdicts and the names of their clips.
    pub fn new(clips: impl IntoIterator<Item = (MessageId, String)>) -> Self {
        Self(clips.into_iter().collect())
    }

    pub(crate) fn of(&self, verdict: MessageId) -> Option<&str> {
        self.0.get(&verdict).map(String::as_str)
    }
}
