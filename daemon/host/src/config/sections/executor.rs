//! The section `[executor]`: what an engineer may order on the board.

use std::path::PathBuf;

use crate::config::keys::Keys;

/// `[executor]`: the commands of `andond` that an engineer orders on the board.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Executor {
    /// Whether they are run.
    pub enable: bool,
    /// The folder of what they make; see [`crate::config::Config::executor_path`].
    pub path: Option<PathBuf>,
    /// The folder of recordings to teach from; see [`crate::config::Config::films`].
    pub films: Option<PathBuf>,
}

impl Executor {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "enable",
            &mut self.enable,
            (),
            "Whether whoever has logged in to the board as an engineer may teach and load jobs, draw markers, look and calibrate at \
             http://BIND:PORT/engineer. The units write jobs only below /var/lib/andon: set station.jobs to a folder there.",
        );
        k.optional(
            "path",
            &mut self.path,
            (),
            r#""/var/lib/andon/bench1.executor""#,
            "The folder of what is made for an engineer: reports, markers, pictures, and earlier versions of the jobs. Without this \
             key it lies in /var/lib/andon and has the station's name.",
        );
        k.optional(
            "films",
            &mut self.films,
            (),
            r#""/var/lib/andon/bench1.films""#,
            "The folder of films, track files and recordings that an engineer can teach from. Without this key it is the folder films \
             in executor.path.",
        );
    }
}
