//! What somebody who sets up a camera is told of its picture.

/// One thing that can be improved, or that is as it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Nothing needs to be done.
    pub is_good: bool,
    /// What it is about, such as the name of a part.
    pub about: String,
    /// What there is, and what to do where that is not good enough.
    pub sentence: String,
}

/// What is looked at, and what is found in it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Look {
    /// What the pictures come from.
    pub(crate) source: String,
    pub(crate) findings: Vec<Finding>,
}
