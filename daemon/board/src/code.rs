//! The codes of the log, as far as people are told of them.

/// A code of the log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Code {
    /// Its number.
    pub number: u32,
    /// The number as it is written, as `AND-104`.
    pub name: &'static str,
    /// How serious it is, as `WARN`.
    pub level: String,
    /// What it belongs to, as `Camera`.
    pub group: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What to do; empty where there is nothing to do.
    pub remedy: &'static str,
}
