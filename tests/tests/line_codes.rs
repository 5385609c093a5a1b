//! The codes of ordinary operation. Each is logged by the role that the index of the codes leads a technician to, when a line does what the code
//! means. The codes of faults are in `line_faults`, those of what cannot be seen in `line_visibility`, and those of inputs that no worker gives in
//! `line_stand_in`.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, Modbus, Settings};
use andon_tests::simulator::Flaw;

/// A line at the worker's own pace that does not end.
fn endless(writes: bool) -> Line {
    Line::new(Settings { at_full_speed: false, repeat: true, writes, ..Settings::default() })
}

#[test]
fn a_line_reports_what_it_watches_what_was_wrong_and_that_it_stops() {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::default() });
    line.launch().until_judged();
    line.wait_for_log("judge", "AND-301", "job.toml");
    assert!(line.log("judge").contains("watching the job 1 ") && line.log("judge").contains(" of hash "));
    line.wait_for_log("judge", "AND-306", "Stop and look at the step");
    line.wait_for_log("judge", "AND-305", "andond history --nok");
    line.wait_for_log("perceive", "AND-102", "at its end");
    line.wait_for_log("journal", "AND-401", "journal.sqlite");
    line.wait_for_log("plc", "AND-501", "");
    line.wait_for_log("encode", "AND-601", "");
    assert_eq!(line.stop(), [""; 0]);
    line.wait_for_log("judge", "AND-602", "");
}

#[test]
fn a_station_without_a_job_a_plc_and_metrics_says_so() {
    let mut line = endless(false);
    line.reconfigure("job = \"job.toml\"\n", "");
    line.reconfigure("enable = true", "enable = false");
    let _watcher = line.launch();
    line.wait_for_log("judge", "AND-311", "Set station.job");
    line.wait_for_log("plc", "AND-511", "");
    line.start("metrics");
    line.wait_for_log("metrics", "AND-618", "");
    line.start("board");
    line.wait_for_log("board", "AND-621", "");
    line.start("executor");
    line.wait_for_log("executor", "AND-628", "");
}

#[test]
fn a_client_that_connects_commands_and_asks_outside_the_register_map_is_reported() {
    let mut line = endless(true);
    let _watcher = line.up();
    let mut plc = Modbus::connect_when_up(line.port);
    line.wait_for_log("plc", "AND-502", "");
    plc.enable();
    line.wait_for_log("judge", "AND-309", "enable: judge from now on");
    assert!(plc.read(60_000, 1).is_err());
    line.wait_for_log("plc", "AND-508", "Check the addresses");
}

#[test]
fn a_client_that_is_not_allowed_is_reported() {
    let mut line = endless(false);
    line.reconfigure("[plc]\n", "[plc]\nbind = \"0.0.0.0\"\nallow = [\"192.0.2.1\"]\n");
    let _watcher = line.launch();
    let _client = Modbus::connect_when_up(line.port);
    line.wait_for_log("plc", "AND-504", "plc.allow");
}

#[test]
fn a_role_that_dies_is_reported_by_the_steward_and_by_its_neighbour_until_it_is_back() {
    let mut line = endless(false);
    let _watcher = line.up();
    line.role("encode").kill();
    line.wait_for_log("steward", "AND-608", "systemd starts it again");
    line.wait_for_log("judge", "AND-610", "andond status");
    line.start("encode");
    line.wait_for_log("judge", "AND-611", "");
}

#[test]
fn a_step_that_is_done_as_nobody_has_shown_it_is_noted() {
    let mut line = Line::new(Settings { flaw: Flaw::WrongHand, ..Settings::default() });
    line.launch().until_judged();
    line.wait_for_log("judge", "AND-313", "if it was, teach the job again with such a run as well");
    line.wait_for_log("judge", "AND-304", "");
}
