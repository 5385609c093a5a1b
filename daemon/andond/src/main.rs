//! The Andon daemon.
fn main() {}
