//! What `andond status` says, as values: for the table and as JSON. The names are an interface: programs outside read them.

use andon_host::log::{Code, code};
use serde::Serialize;
use shm_schemas::{Health, JudgePhase, Judging, RoleId, RoleState, Sight};

use crate::sight;
use crate::tool::known_jobs::KnownJobs;

/// All of it.
#[derive(Serialize)]
pub(super) struct StationLine<'a> {
    pub(super) station: &'a str,
    pub(super) healthy: bool,
    pub(super) configuration: ConfigurationLine,
    /// What the judge says; null where it was not heard.
    pub(super) job: Option<JobLine>,
    pub(super) roles: &'a [RoleLine],
}

/// The configuration that the line has taken.
#[derive(Serialize)]
pub(super) struct ConfigurationLine {
    /// Its hash, 16 hexadecimal digits.
    pub(super) hash: String,
    /// How the files differ from it by now; null where they do not.
    pub(super) changed: Option<String>,
}

/// The job in force, as the judge says it.
#[derive(Serialize)]
pub(super) struct JobLine {
    /// Its number; null where none is loaded.
    pub(super) id: Option<u32>,
    /// Its name; null where none is loaded.
    pub(super) name: Option<String>,
    /// The hash of its file, 16 hexadecimal digits.
    pub(super) hash: Option<String>,
    pub(super) enabled: bool,
    /// A word of [`JudgePhase`].
    pub(super) phase: &'static str,
    /// How many frames per second it needs, Hz; null where no job is loaded, or it does not say.
    pub(super) min_rate_hz: Option<f32>,
    /// The part id of the job that begins next; null where none was given.
    pub(super) next_part: Option<String>,
}

impl JobLine {
    pub(super) fn new(judging: &Judging, known: &KnownJobs) -> Self {
        let Judging { job_id, model_hash, .. } = *judging;
        let has_job = job_id != 0;
        Self {
            id: has_job.then_some(job_id),
            name: has_job.then(|| known.name(job_id, model_hash)),
            hash: has_job.then(|| format!("{model_hash:016x}")),
            enabled: judging.is_enabled != 0,
            phase: JudgePhase::try_from(judging.phase).map_or("?", JudgePhase::name),
            min_rate_hz: Some(judging.min_rate_hz).filter(|rate_hz| *rate_hz > 0.0),
            next_part: (!judging.part.is_none()).then(|| judging.part.text().to_owned()),
        }
    }
}

/// One role. What is unknown of a role that was not heard is null.
#[derive(Serialize)]
pub(super) struct RoleLine {
    pub(super) role: &'static str,
    pub(super) healthy: bool,
    /// A word of [`RoleState`], or `Silent`.
    pub(super) state: &'static str,
    pid: Option<u32>,
    pub(super) rate_hz: Option<f32>,
    pub(super) p50_us: Option<u32>,
    pub(super) p99_us: Option<u32>,
    lateness_us: Option<u32>,
    received: Option<u64>,
    sent: Option<u64>,
    losses: Option<u64>,
    /// Which share of what came to it, it has not lost, since its start, 0 to 1.
    pub(super) kept: Option<f64>,
    /// How much of a core it uses now; more than 1 is more than one core.
    pub(super) core: Option<f64>,
    refused: Option<u64>,
    restarts_seen: Option<u32>,
    /// What the line can see of its bench, a word of [`Sight`]; of the role perceive only.
    sight: Option<&'static str>,
    /// The last code of level WARN or ERROR, as `AND-104`.
    pub(super) last_code: Option<&'static str>,
    /// The hash of the configuration that the role runs with.
    configuration: Option<String>,
    #[serde(skip)]
    pub(super) trouble: Option<Sight>,
    /// CLOCK_MONOTONIC since when that is so.
    #[serde(skip)]
    pub(super) trouble_since_ns: u64,
    #[serde(skip)]
    pub(super) last: Option<&'static Code>,
    #[serde(skip)]
    pub(super) is_configured_otherwise: bool,
}

impl RoleLine {
    pub(super) fn new(role: RoleId, health: Option<&Health>, core: Option<f64>, configuration: u64) -> Self {
        let state = health.and_then(|health| RoleState::try_from(health.state).ok());
        let trouble = health.and_then(sight::trouble_of);
        let is_configured_otherwise = health.is_some_and(|health| health.configuration != configuration);
        let is_at_work = matches!(state, Some(RoleState::Running | RoleState::Finished));
        let number = |of: fn(&Health) -> u64| health.map(of);
        let short = |of: fn(&Health) -> u32| health.map(of);
        let last = health.and_then(|health| code::of_number(health.last_error));
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
            kept: health.and_then(|health| kept(role, health)),
            core,
            refused: number(|health| health.refused),
            restarts_seen: short(|health| health.restarts_seen),
            sight: health.and_then(|health| Sight::try_from(health.sight).ok()).map(Sight::name),
            trouble,
            trouble_since_ns: health.map_or(0, |health| health.sight_since_ns),
            last,
            last_code: last.map(|code| code.name),
        }
    }

    /// Whether it has something to do for each frame.
    pub(super) fn takes_frames(&self) -> bool {
        [RoleId::Capture, RoleId::Perceive, RoleId::Encode, RoleId::Judge]
            .map(RoleId::name)
            .contains(&self.role)
    }
}

/// The share that a role has not lost of what came to it. To `capture` comes what it sends.
fn kept(role: RoleId, health: &Health) -> Option<f64> {
    let came = if role == RoleId::Capture { health.sent } else { health.received };
    let all = came + health.losses;
    (all > 0).then(|| came as f64 / all as f64)
}
