//! `andond status`: how every role of a running station is doing.

use std::time::{Duration, Instant};

use andon_ipc::{Heartbeat, MonotonicTime, Node, Reader, Wake};
use serde::Serialize;
use shm_schemas::{Health, JudgePhase, Judging, RoleId, RoleState, Sight};

use super::join::join;
use super::{ToolError, running_config};
use crate::cli::Status;
use crate::log::code::{self, CONFIGURATION_CHANGED};
use crate::sight;
use crate::taken::Taken;

/// A role that runs is heard within this time: three beats.
const LISTEN: Duration = Duration::from_millis(3 * Heartbeat::PERIOD.as_millis() as u64);

/// Exit code: some role is not healthy.
const UNHEALTHY: u8 = 1;

/// Runs the command; the exit code says whether every role is healthy.
///
/// # Errors
/// A configuration with faults, or that the station cannot be joined.
pub fn run(arguments: &Status) -> Result<u8, ToolError> {
    let Taken { config, changed } = running_config(&arguments.config)?;
    let roles = config.roles();
    let (newest, judging) = listen(&join(&config)?, &roles)?;
    let job = judging.as_ref().map(JobLine::new);
    let lines: Vec<RoleLine> =
        roles.into_iter().map(|role| RoleLine::new(role, newest_of(&newest, role), config.hash())).collect();
    let healthy = lines.iter().all(|line| line.healthy);
    if arguments.json {
        let station = StationLine {
            station: &config.station.name,
            healthy,
            configuration: ConfigurationLine {
                hash: format!("{:016x}", config.hash()),
                changed: changed.as_ref().map(ToString::to_string),
            },
            job: job.as_ref(),
            roles: &lines,
        };
        println!("{}", serde_json::to_string(&station).map_err(|error| ToolError::Print(error.into()))?);
    } else {
        print(&lines);
        print_job(job.as_ref());
        if let Some(changed) = changed {
            println!("{}: {changed}. {}", CONFIGURATION_CHANGED.name, CONFIGURATION_CHANGED.remedy);
        }
    }
    Ok(if healthy { 0 } else { UNHEALTHY })
}

fn newest_of(newest: &[Health], role: RoleId) -> Option<&Health> {
    newest.iter().find(|health| health.role == role.code())
}

/// The newest health of every role and state of the judge that were sent while this listened; ends early once everyone was
/// heard.
fn listen(node: &Node, roles: &[RoleId]) -> Result<(Vec<Health>, Option<Judging>), ToolError> {
    let mut reader: Reader<Health> = node.reader()?;
    let mut judge: Reader<Judging> = node.reader()?;
    let mut newest: Vec<Health> = Vec::new();
    let mut judging: Option<Judging> = None;
    let (began, began_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
    let all = |newest: &[Health]| roles.iter().all(|role| newest_of(newest, *role).is_some());
    while began.elapsed() < LISTEN && !(all(&newest) && judging.is_some()) {
        if node.wait(&mut [&mut reader, &mut judge], Heartbeat::PERIOD)? == Wake::Stop {
            break;
        }
        while let Some(health) = reader.take()? {
            // The history may hold messages of roles that have ended.
            if health.stamp.sent_ns < began_ns {
                continue;
            }
            newest.retain(|known| known.role != health.role);
            newest.push(*health);
        }
        while let Some(state) = judge.take()? {
            judging = (state.stamp.sent_ns >= began_ns).then_some(*state).or(judging);
        }
    }
    Ok((newest, judging))
}

/// All of it, as JSON. The names are an interface: programs outside read them.
#[derive(Serialize)]
struct StationLine<'a> {
    station: &'a str,
    healthy: bool,
    configuration: ConfigurationLine,
    /// What the judge says; null where it was not heard.
    job: Option<&'a JobLine>,
    roles: &'a [RoleLine],
}

/// The configuration that the line has taken.
#[derive(Serialize)]
struct ConfigurationLine {
    /// Its hash, 16 hexadecimal digits.
    hash: String,
    /// How the files differ from it by now; null where they do not.
    changed: Option<String>,
}

/// The job in force, as the judge says it.
#[derive(Serialize)]
struct JobLine {
    /// Its number; null where none is loaded.
    id: Option<u32>,
    /// The hash of its file, 16 hexadecimal digits.
    hash: Option<String>,
    enabled: bool,
    /// A word of [`JudgePhase`].
    phase: &'static str,
    /// The part id of the job that begins next; null where none was given.
    next_part: Option<String>,
}

impl JobLine {
    fn new(judging: &Judging) -> Self {
        let has_job = judging.job_id != 0;
        Self {
            id: has_job.then_some(judging.job_id),
            hash: has_job.then(|| format!("{:016x}", judging.model_hash)),
            enabled: judging.is_enabled != 0,
            phase: JudgePhase::try_from(judging.phase).map_or("?", JudgePhase::name),
            next_part: (!judging.part.is_none()).then(|| judging.part.text().to_owned()),
        }
    }
}

/// One role. What is unknown of a role that was not heard is null.
#[derive(Serialize)]
struct RoleLine {
    role: &'static str,
    healthy: bool,
    /// A word of [`RoleState`], or `Silent`.
    state: &'static str,
    pid: Option<u32>,
    rate_hz: Option<f32>,
    p50_us: Option<u32>,
    p99_us: Option<u32>,
    lateness_us: Option<u32>,
    received: Option<u64>,
    sent: Option<u64>,
    losses: Option<u64>,
    refused: Option<u64>,
    restarts_seen: Option<u32>,
    /// What the line can see of its bench, a word of [`Sight`]; of the role perceive only.
    sight: Option<&'static str>,
    /// The last code of level WARN or ERROR, as `AND-104`.
    last_code: Option<&'static str>,
    /// The hash of the configuration that the role runs with.
    configuration: Option<String>,
    #[serde(skip)]
    trouble: Option<Sight>,
    #[serde(skip)]
    is_configured_otherwise: bool,
}

impl RoleLine {
    fn new(role: RoleId, health: Option<&Health>, configuration: u64) -> Self {
        let state = health.and_then(|health| RoleState::try_from(health.state).ok());
        let trouble = health.and_then(sight::trouble_of);
        let is_configured_otherwise = health.is_some_and(|health| health.configuration != configuration);
        let is_at_work = matches!(state, Some(RoleState::Running | RoleState::Finished));
        let number = |of: fn(&Health) -> u64| health.map(of);
        let short = |of: fn(&Health) -> u32| health.map(of);
        Self {
            role: role.name(),
            healthy: is_at_work && trouble.is_none() && !is_configured_otherwise,
            configuration: health.map(|health| format!("{:016x}", health.configuration)),
            is_configured_otherwise,
            state: state.map_or("Silent", RoleState::name),
            pid: short(|health| health.pid),
            rate_hz: health.map(|health| health.rate_hz),
            p50_us: short(|health| health.p50_us),
            p99_us: short(|health| health.p99_us),
            lateness_us: short(|health| health.lateness_us),
            received: number(|health| health.received),
            sent: number(|health| health.sent),
            losses: number(|health| health.losses),
            refused: number(|health| health.refused),
            restarts_seen: short(|health| health.restarts_seen),
            sight: health.and_then(|health| Sight::try_from(health.sight).ok()).map(Sight::name),
            trouble,
            last_code: health.and_then(|health| code_name(health.last_error)),
        }
    }
}

fn code_name(number: u32) -> Option<&'static str> {
    code::ALL.iter().find(|code| code.number == number).map(|code| code.name)
}

fn print_job(job: Option<&JobLine>) {
    match job {
        None => println!("job       the judge was not heard"),
        Some(JobLine { id: Some(id), hash: Some(hash), enabled, phase, next_part }) => {
            let watch = if *enabled { "" } else { ", not enabled" };
            println!("job       {id} of hash {hash}: {phase}{watch}");
            if let Some(part) = next_part {
                println!("part      {part} goes with the job that begins next");
            }
        }
        Some(_) => println!("job       none is loaded"),
    }
}

fn print(lines: &[RoleLine]) {
    println!("role      state         rate      p50        p99   received       sent  losses  last code");
    for line in lines {
        let mark = if line.healthy { "" } else { "  <- look here" };
        let state = line.trouble.map_or(line.state, sight::word);
        println!(
            "{:9} {:8} {:7.1} Hz {:5.1} ms {:7.1} ms {:10} {:10} {:7}  {}{mark}",
            line.role,
            state,
            line.rate_hz.unwrap_or_default(),
            f64::from(line.p50_us.unwrap_or_default()) / 1e3,
            f64::from(line.p99_us.unwrap_or_default()) / 1e3,
            line.received.unwrap_or_default(),
            line.sent.unwrap_or_default(),
            line.losses.unwrap_or_default(),
            line.last_code.unwrap_or("-"),
        );
    }
    for line in lines.iter().filter(|line| line.is_configured_otherwise) {
        println!("{} runs with another configuration than the line has taken: restart it", line.role);
    }
    for code in lines.iter().filter_map(|line| line.trouble.and_then(sight::code)) {
        println!("{}: {}. {}", code.name, code.meaning, code.remedy);
    }
}
