//! What comes after a new job was written.

use std::fmt::Write as _;

use andon_host::atomic::folder_of;
use andon_host::config::Config;
use andon_learn::job_file::JobFile;

use crate::cli::Teach;
use crate::tool::jobs::is_same;

/// The commands for the job, and where the station would find it if it does not there.
pub(super) fn steps(arguments: &Teach, job: &JobFile, config: &Config) -> String {
    let files = arguments.config.files.iter();
    let station: String = files.map(|file| format!(" -c {}", file.display())).collect();
    let out = &arguments.out;
    let mut text = format!(
        "\nNext:\n  andond replay{station} --job {} RECORDING    judges a recording\n",
        out.display()
    );
    // Track files can do without a station.
    if config.station.name.is_empty() {
        return text;
    }
    let folder = &config.station.jobs;
    let is_its_job = config.station.job.as_ref().is_some_and(|job| is_same(job, out));
    // Writing to a `String` cannot fail.
    let _ = match is_its_job || is_same(folder_of(out), folder) {
        true => writeln!(text, "  andond use {}{station}    loads it into the running line", job.id),
        false => writeln!(
            text,
            "  copy it to {}, where `andond jobs` and `andond use` look, or name it in station.job",
            folder.display()
        ),
    };
    text
}
