//! What a test takes from the environment: a test runs in its short form unless it is told otherwise.

/// The number in this variable, or the default.
///
/// # Panics
/// If it is not a number.
pub fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |value| value.parse().expect("a number"))
}
