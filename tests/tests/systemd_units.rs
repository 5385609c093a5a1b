//! The units are well-formed and locked down, as systemd's own tools judge them.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Maximum exposure of a unit, on systemd's scale from 0 (safe) to 10.
const MAX_EXPOSURE: f32 = 0.9;

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../systemd")
}

/// Runs a tool of systemd.
fn run(tool: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(tool);
    command.args(arguments).env("SYSTEMD_COLORS", "0").env("SYSTEMD_EMOJI", "0").env("SYSTEMD_PAGER", "");
    command
        .output()
        .unwrap_or_else(|error| panic!("{tool}: {error}; run `make test-packages`, or apt install systemd"))
}

/// A copy of the units with their drop-ins. They start a program that is on every machine.
fn installed() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(&shipped(), folder.path());
    folder
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            let text = std::fs::read_to_string(&path).unwrap();
            std::fs::write(target, text.replace("/usr/bin/andond", "/bin/true")).unwrap();
        }
    }
}

/// The paths of the units in `folder` with this ending.
fn units(folder: &Path, ending: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut units: Vec<String> = entries
        .filter(|path| path.is_file())
        .map(|path| path.to_str().unwrap().to_owned())
        .filter(|path| path.ends_with(ending))
        .collect();
    units.sort();
    units
}

#[test]
fn systemd_finds_no_fault_in_the_units() {
    let folder = installed();
    let mut arguments = vec!["verify".to_owned(), "--man=no".to_owned()];
    arguments.extend(units(folder.path(), ".service"));
    arguments.extend(units(folder.path(), ".target"));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let output = run("systemd-analyze", &arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.is_empty(), "{errors}");
}

#[test]
fn no_unit_is_more_exposed_than_0_9() {
    let folder = installed();
    let services = units(folder.path(), ".service");
    assert!(!services.is_empty());
    for service in services {
        let arguments = ["security", "--offline=true", "--no-pager", &service];
        let output = run("systemd-analyze", &arguments);
        let report = String::from_utf8_lossy(&output.stdout);
        let overall = report.lines().find(|line| line.contains("Overall exposure level")).unwrap_or_default();
        println!("{overall}");
        let level =
            overall.rsplit(": ").next().and_then(|level| level.split(' ').next()?.parse::<f32>().ok());
        assert!(
            level.is_some_and(|level| level <= MAX_EXPOSURE),
            "{report}{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn a_station_starts_every_role_that_has_a_unit() {
    let target = std::fs::read_to_string(shipped().join("andon@.target")).unwrap();
    let wanted = |unit: &str| {
        let instance = unit.replace("@.", "@%i.");
        target.lines().any(|line| line.starts_with("Wants=") && line.contains(&instance))
    };
    for path in units(&shipped(), ".service") {
        let unit = Path::new(&path).file_name().unwrap().to_str().unwrap();
        assert!(wanted(unit), "andon@.target does not want {unit}");
    }
}

#[test]
fn each_unit_runs_the_role_that_it_is_named_by() {
    for path in units(&shipped(), ".service") {
        let role = path.rsplit("andon-").next().unwrap().strip_suffix("@.service").unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(&format!("ExecStart=/usr/bin/andond run {role} ")), "{path}");
    }
}

#[test]
fn only_capture_sees_devices_and_only_plc_metrics_and_board_see_the_network() {
    for path in units(&shipped(), ".service") {
        let text = std::fs::read_to_string(&path).unwrap();
        let has = |line: &str| text.lines().any(|found| found == line);
        assert_eq!(has("PrivateDevices=yes"), !path.contains("andon-capture@"), "{path}");
        let sees_network =
            ["plc", "metrics", "board"].iter().any(|role| path.contains(&format!("andon-{role}@")));
        assert_eq!(has("PrivateNetwork=yes"), !sees_network, "{path}");
    }
}

#[test]
fn the_board_may_write_nothing_but_what_all_roles_share() {
    let unit = std::fs::read_to_string(shipped().join("andon-board@.service")).unwrap();
    for setting in ["Directory=", "ReadWritePaths=", "ProtectSystem=", "BindPaths="] {
        assert!(!unit.contains(setting), "{setting}");
    }
}

/// There an engineer's jobs and calibration lie.
#[test]
fn the_executor_may_write_in_the_folder_of_its_state_and_nowhere_else() {
    let unit = std::fs::read_to_string(shipped().join("andon-executor@.service")).unwrap();
    assert!(unit.lines().any(|line| line == "StateDirectory=andon"), "{unit}");
    for setting in ["ReadWritePaths=", "ProtectSystem=", "BindPaths=", "ConfigurationDirectory="] {
        assert!(!unit.contains(setting), "{setting}");
    }
}

#[test]
fn a_role_that_ends_by_itself_is_always_started_again_unless_that_cannot_help() {
    let common = std::fs::read_to_string(shipped().join("andon-@.service.d/10-common.conf")).unwrap();
    for line in ["Restart=always", "RestartPreventExitStatus=64 78", "StartLimitIntervalSec=0"] {
        assert!(common.lines().any(|found| found == line), "{line}");
    }
}

#[test]
fn every_setting_of_processor_and_memory_has_its_reason_before_it() {
    let common = std::fs::read_to_string(shipped().join("andon-@.service.d/10-common.conf")).unwrap();
    let lines: Vec<&str> = common.lines().collect();
    for setting in ["CPUWeight=", "MemoryHigh=", "OOMPolicy=", "OOMScoreAdjust="] {
        let at = lines.iter().position(|line| line.starts_with(setting));
        let at = at.unwrap_or_else(|| panic!("{setting} is not set"));
        assert!(lines[at - 1].starts_with("# "), "{setting} has no reason");
    }
}

/// What was measured stands beside it: a job that is taught from films needs more than a role of the line.
#[test]
fn a_command_of_an_engineer_may_take_more_memory_than_a_role_and_fails_alone() {
    let behind = shipped().join("andon-executor@.service.d/20-behind.conf");
    let text = std::fs::read_to_string(behind).unwrap();
    for line in ["MemoryHigh=1792M", "MemoryMax=2G", "OOMPolicy=continue", "OOMScoreAdjust=500"] {
        assert!(text.lines().any(|found| found == line), "{line}");
    }
}

#[test]
fn sysusers_makes_the_user_that_the_units_run_as() {
    let root = tempfile::tempdir().unwrap();
    std::fs::create_dir(root.path().join("etc")).unwrap();
    let declared = shipped().join("sysusers.d/andon.conf");
    let root_argument = format!("--root={}", root.path().display());
    let output = run("systemd-sysusers", &[&root_argument, declared.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let users = std::fs::read_to_string(root.path().join("etc/passwd")).unwrap();
    let user = users.lines().find(|line| line.starts_with("andon:")).unwrap();
    assert!(user.ends_with(":/var/lib/andon:/usr/sbin/nologin"), "{user}");
}
