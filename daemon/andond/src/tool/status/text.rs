//! The status as people read it: a sentence, the job, a table, and where to look.

use std::io::{self, Write};

use andon_host::log::code::CONFIGURATION_CHANGED;
use andon_ipc::MonotonicTime;
use anstyle::{AnsiColor, Style};
use shm_schemas::{RoleId, Sight};

use super::lines::{JobLine, RoleLine, StationLine};
use crate::clock::Clock;
use crate::sight;

/// A role that keeps less than this share is spoken of, even where it is healthy by now.
const KEPT_WELL: f64 = 0.9;

const RED: Style = Style::new().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Red)));
const GREEN: Style = Style::new().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Green)));

/// Prints all of it.
pub(super) fn print(station: &StationLine<'_>, clock: &Clock) -> io::Result<()> {
    write(station, clock, &mut anstream::stdout().lock())
}

fn write(station: &StationLine<'_>, clock: &Clock, out: &mut impl Write) -> io::Result<()> {
    let name = station.station;
    let roles = station.roles.len();
    let ill: Vec<&str> = station.roles.iter().filter(|line| !line.healthy).map(|line| line.role).collect();
    if ill.is_empty() {
        writeln!(out, "{GREEN}station {name}: all {roles} roles are healthy{GREEN:#}")?;
    } else {
        writeln!(
            out,
            "{RED}station {name}: {} of {roles} roles need help: {}{RED:#}",
            ill.len(),
            ill.join(", ")
        )?;
    }
    writeln!(out, "{}\n", job_words(station.job.as_ref()))?;
    writeln!(out, "role      state     frames/s     kept  of a core   typical       p99  last message")?;
    station.roles.iter().try_for_each(|line| write_role(line, out))?;
    writeln!(
        out,
        "\nkept: the share of what came that it has not lost since its start; of a core: now; typical, p99: the time for one"
    )?;
    for line in station.roles {
        for words in look_here(line, station, clock) {
            writeln!(out, "{RED}look here: {}: {words}{RED:#}", line.role)?;
        }
    }
    for line in station.roles.iter().filter(|line| line.healthy) {
        if let Some(kept) = line.kept.filter(|kept| *kept < KEPT_WELL) {
            let lost = 100.0 * (1.0 - kept);
            writeln!(out, "{} has lost {lost:.0} of 100 since its start, and keeps up now", line.role)?;
        }
    }
    if let Some(changed) = &station.configuration.changed {
        writeln!(out, "{}: {changed}. {}", CONFIGURATION_CHANGED.name, CONFIGURATION_CHANGED.remedy)?;
    }
    Ok(())
}

fn job_words(job: Option<&JobLine>) -> String {
    match job {
        None => "job: the judge was not heard".to_owned(),
        Some(JobLine {
            id: Some(id),
            name: Some(name),
            hash: Some(hash),
            enabled,
            phase,
            min_rate_hz,
            next_part,
        }) => {
            let needed = min_rate_hz
                .map(|rate_hz| format!("; it needs {rate_hz:.1} frames per second"))
                .unwrap_or_default();
            let watch = if *enabled { "" } else { ", not enabled: nothing is judged" };
            let part =
                next_part.as_ref().map(|part| format!("; part {part} goes with the piece that begins next"));
            format!(
                "job {name} (number {id}, hash {hash}): {phase}{watch}{needed}{}",
                part.unwrap_or_default()
            )
        }
        Some(_) => "job: none is loaded, so nothing is judged".to_owned(),
    }
}

fn write_role(line: &RoleLine, out: &mut impl Write) -> io::Result<()> {
    let percent =
        |share: Option<f64>| share.map_or("-".to_owned(), |share| format!("{:.0} %", 100.0 * share));
    let milliseconds = |us: Option<u32>| {
        let us = us.filter(|us| *us > 0 && line.takes_frames());
        us.map_or("-".to_owned(), |us| format!("{:.1} ms", f64::from(us) / 1e3))
    };
    // What plays as fast as it can has no rate that says anything.
    let rate = line.rate_hz.filter(|rate| line.takes_frames() && *rate > 0.0 && *rate < 1000.0);
    let style = if line.healthy { Style::new() } else { RED };
    writeln!(
        out,
        "{style}{:9} {:8} {:>9} {:>8} {:>10} {:>9} {:>9}  {}{style:#}",
        line.role,
        line.trouble.map_or(line.state, sight::word),
        rate.map_or("-".to_owned(), |rate| format!("{rate:.1}")),
        percent(line.kept),
        percent(line.core),
        milliseconds(line.p50_us),
        milliseconds(line.p99_us),
        line.last_code.unwrap_or("-"),
    )
}

/// What is wrong with a role, and what to do.
fn look_here(line: &RoleLine, station: &StationLine<'_>, clock: &Clock) -> Vec<String> {
    let mut words = Vec::new();
    if line.healthy {
        return words;
    }
    if let Some(code) = line.trouble.and_then(sight::code) {
        let since = MonotonicTime::from_nanoseconds(line.trouble_since_ns);
        let since = if line.trouble_since_ns == 0 {
            String::new()
        } else {
            format!(" since {}", clock.time_of(since))
        };
        let lost = line.kept.filter(|kept| *kept < KEPT_WELL);
        let lost =
            lost.map(|kept| format!(" It has kept {:.0} of 100 frames.", 100.0 * kept)).unwrap_or_default();
        let is_slow = line.trouble == Some(Sight::TooFewFrames);
        let rates = if is_slow { rates(station) } else { String::new() };
        words.push(format!("{}{since}, {}{rates}.{lost} {}", code.name, code.meaning, code.remedy));
    }
    if line.is_configured_otherwise {
        words.push("it runs with another configuration than the line has taken: restart it".to_owned());
    }
    if line.state == "Silent" {
        let unit = format!("andon-{}@{}", line.role, station.station);
        words.push(format!(
            "no sign of life. `systemctl status {unit}` says whether it runs, `journalctl -u {unit}` why not"
        ));
    }
    if words.is_empty() {
        words.push(match line.last {
            Some(code) => format!("{}, {}. {}", code.name, code.meaning, code.remedy),
            None => format!("it is {} and has no message yet: wait, or look at its log", line.state),
        });
    }
    words
}

/// How many frames per second come, how many of them are processed, and how many the job needs.
fn rates(station: &StationLine<'_>) -> String {
    let rate_of = |role: RoleId| {
        let line = station.roles.iter().find(|line| line.role == role.name());
        line.and_then(|line| line.rate_hz)
    };
    let needed_hz = station.job.as_ref().and_then(|job| job.min_rate_hz);
    rate_of(RoleId::Perceive)
        .map(|processed_hz| sight::rates(processed_hz, rate_of(RoleId::Capture), needed_hz))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::lines::ConfigurationLine;
    use super::*;
    use shm_schemas::{Health, RoleState};

    fn health(role: RoleId) -> Health {
        Health {
            role: role.code(),
            state: RoleState::Running.code(),
            received: 1000,
            sent: 1000,
            rate_hz: 8205.4,
            p50_us: 14_100,
            p99_us: 20_900,
            ..Health::default()
        }
    }

    fn shown(lines: &[RoleLine]) -> String {
        let job = JobLine {
            id: Some(7),
            name: Some("polish".to_owned()),
            hash: Some("00000000000000ab".to_owned()),
            enabled: true,
            phase: "waiting",
            min_rate_hz: Some(7.5),
            next_part: Some("A-17".to_owned()),
        };
        let station = StationLine {
            station: "bench1",
            healthy: lines.iter().all(|line| line.healthy),
            configuration: ConfigurationLine { hash: String::new(), changed: None },
            job: Some(job),
            roles: lines,
        };
        let mut plain = anstream::StripStream::new(Vec::new());
        write(&station, &Clock::new(true), &mut plain).unwrap();
        String::from_utf8(plain.into_inner()).unwrap()
    }

    #[test]
    fn a_line_that_loses_frames_is_not_called_healthy_and_says_where_to_look() {
        let slow = Health {
            received: 80,
            losses: 920,
            rate_hz: 2.4,
            sight: Sight::TooFewFrames.code(),
            ..health(RoleId::Perceive)
        };
        let camera = Health { rate_hz: 30.0, ..health(RoleId::Capture) };
        let capture = RoleLine::new(RoleId::Capture, Some(&camera), Some(0.04), 0);
        let encode = RoleLine::new(RoleId::Encode, None, None, 0);
        let text = shown(&[capture, RoleLine::new(RoleId::Perceive, Some(&slow), Some(0.97), 0), encode]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "station bench1: 2 of 3 roles need help: perceive, encode",
                "job polish (number 7, hash 00000000000000ab): waiting; it needs 7.5 frames per second; part A-17 \
                 goes with the piece that begins next",
                "",
                "role      state     frames/s     kept  of a core   typical       p99  last message",
                "capture   Running       30.0    100 %        4 %   14.1 ms   20.9 ms  -",
                "perceive  SLOW           2.4      8 %       97 %   14.1 ms   20.9 ms  -",
                "encode    Silent           -        -          -         -         -  -",
                "",
                "kept: the share of what came that it has not lost since its start; of a core: now; typical, p99: the time for one",
                "look here: perceive: AND-218, too few pictures are processed to judge by them: 2.4 of 30.0 per second, and the job needs 7.5. \
                 It has kept 8 of 100 frames. Stop what else runs on the machine, or choose perception.hand_model = \"lite\" or a lower camera.rate_hz. A camera in the dark \
                 gives fewer by itself: light the bench better",
                "look here: encode: no sign of life. `systemctl status andon-encode@bench1` says whether it runs, `journalctl -u \
                 andon-encode@bench1` why not",
            ]
        );
    }

    #[test]
    fn losses_of_the_past_are_told_of_a_healthy_role() {
        let line = RoleLine::new(
            RoleId::Perceive,
            Some(&Health { received: 80, losses: 920, ..health(RoleId::Perceive) }),
            None,
            0,
        );
        let text = shown(&[line]);
        assert!(text.starts_with("station bench1: all 1 roles are healthy\n"), "{text}");
        assert!(text.ends_with("perceive has lost 92 of 100 since its start, and keeps up now\n"), "{text}");
        assert!(!text.contains("8205.4"), "what plays as fast as it can has no rate: {text}");
    }
}
