//! What a check cannot see: the units of the package write in fewer folders than whoever calls it, and as another user.

use std::path::{Path, PathBuf};

use andon_host::atomic::folder_of;
use andon_host::config::{Config, RecordMode, STATE};

/// Where the units of the package look for their configuration.
pub(in crate::tool) const PACKAGED: &str = "/etc/andon";

/// What is said of a station that the units of the package run; nothing of another one.
pub(in crate::tool) fn unseen(config: &Config, is_root: bool) -> Vec<String> {
    let is_packaged = |file: &PathBuf| std::path::absolute(file).is_ok_and(|file| file.starts_with(PACKAGED));
    if !config.files.iter().any(is_packaged) {
        return Vec::new();
    }
    let outside = written(config).into_iter().filter(|(_, folder)| !is_below(folder, Path::new(STATE)));
    let mut said: Vec<String> = outside
        .map(|(key, folder)| {
            let folder = folder.display();
            format!(
                "{key}: {folder} is not below {STATE}, where alone the package lets its units write. Whether `systemctl edit` gives them more \
                 (ReadWritePaths=) cannot be seen from here"
            )
        })
        .collect();
    if is_root {
        said.push(
            "folders were tried as root: `sudo -u andon andond check` tries them as the user of the units"
                .to_owned(),
        );
    }
    said
}

/// The folders that the roles of a station write in, by the keys that name them.
fn written(config: &Config) -> Vec<(&'static str, PathBuf)> {
    let is_recorded = config.record.mode != RecordMode::Off;
    let is_ordered = config.executor.enable;
    [
        ("journal.path", true, folder_of(&config.journal_path()).to_owned()),
        ("record.path", is_recorded, config.recordings()),
        ("station.jobs", is_ordered, config.station.jobs.clone()),
        ("executor.path", is_ordered, config.executor_path()),
    ]
    .into_iter()
    .filter_map(|(key, is_written, folder)| is_written.then_some((key, folder)))
    .collect()
}

/// Whether a folder lies below another one behind all links, be it there or to be made.
fn is_below(folder: &Path, other: &Path) -> bool {
    let real = |folder: &Path| {
        let behind = |there: &Path| Some(there.canonicalize().ok()?.join(folder.strip_prefix(there).ok()?));
        folder.ancestors().find_map(behind).unwrap_or_else(|| folder.to_owned())
    };
    real(folder).starts_with(real(other))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn of_a_station_of_the_package_it_is_said_what_its_units_may_not_be_able_to_write() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = Config { files: vec!["bench.toml".into()], ..Config::default() };
        config.station.name = "bench1".into();
        config.station.jobs = folder.path().join("jobs");
        config.executor.enable = true;
        assert!(unseen(&config, true).is_empty(), "whoever calls it runs this station");
        config.files = vec!["/etc/andon/andon.toml".into(), "/etc/andon/stations/bench1.toml".into()];
        let said = unseen(&config, false);
        let [jobs] = said.as_slice() else { unreachable!("{said:?}") };
        assert!(jobs.starts_with("station.jobs: ") && jobs.contains("cannot be seen from here"), "{jobs}");
        let as_root = unseen(&config, true);
        assert!(as_root.len() == 2 && as_root[1].contains("sudo -u andon"), "{as_root:?}");
        config.executor.enable = false;
        assert!(unseen(&config, false).is_empty(), "nobody writes there");
    }

    #[test]
    fn a_folder_lies_where_its_links_lead() {
        let folder = tempfile::tempdir().unwrap();
        let [state, link, out] = ["state", "link", "state/out"].map(|name| folder.path().join(name));
        std::fs::create_dir(&state).unwrap();
        std::os::unix::fs::symlink(&state, &link).unwrap();
        std::os::unix::fs::symlink(folder.path(), &out).unwrap();
        assert!(is_below(&link.join("jobs"), &state) && is_below(&state.join("a/b"), &link));
        assert!(!is_below(&out.join("jobs"), &state) && !is_below(folder.path(), &state));
    }
}
