//! The section `[station]`.

use crate::config::keys::Keys;
use crate::config::value::Text;
use std::path::PathBuf;

/// `[station]`: which bench this is.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Name of the station, after which its services, directories and units are named.
    pub name: String,
    /// Directory that holds the shared memory's files of all stations; see [`crate::config::Config::root`].
    pub root: PathBuf,
    /// The learned job that is judged.
    pub job: Option<PathBuf>,
    /// Directory of the jobs that a PLC can select.
    pub jobs: PathBuf,
}

impl Default for Station {
    fn default() -> Self {
        Self { name: String::new(), root: "/run/andon".into(), job: None, jobs: "/etc/andon/jobs".into() }
    }
}

impl Station {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.required(
            "name",
            &mut self.name,
            Text::Name,
            r#""bench1""#,
            "The station's name, which is the instance of its units as well (andon-judge@bench1).",
        );
        k.key(
            "root",
            &mut self.root,
            (),
            "Directory that holds one directory per station with the files of its services. Do not put it under /tmp: a \
             cleaner that removes it splits the line in silence. With the name it must be shorter than 60 characters.",
        );
        k.optional(
            "job",
            &mut self.job,
            (),
            r#""../jobs/polish-and-measure.toml""#,
            "The learned job that is judged, as `andond teach` wrote it. Without this key a station with a board begins with the job that an \
             engineer loaded last.",
        );
        k.key("jobs", &mut self.jobs, (), "Directory of the learned jobs that a PLC can select.");
    }
}
