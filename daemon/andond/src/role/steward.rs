//! `steward`: owns every service of the station and removes what the dead leave behind. It moves no data.

use std::time::{Duration, Instant};

use andon_ipc::{Death, Limits, Node, Station, Steward, Stop, TEND_PERIOD};
use shm_schemas::RoleId;

use super::{Pulse, RoleError};
use crate::config::Config;
use crate::log::{code, log};

/// Runs until it is asked to stop.
pub(super) fn run(station: &Station, config: &Config, stop: &Stop) -> Result<(), RoleError> {
    let mut steward = Steward::create(station, limits(config))?;
    let node = Node::open(station, RoleId::Steward, Duration::ZERO, stop)?;
    let mut pulse = Pulse::new(&node)?;
    let mut unburied = Vec::new();
    loop {
        let began = Instant::now();
        let deaths = steward.tend()?;
        deaths.iter().filter(|death| !unburied.contains(*death)).for_each(tell);
        // What is still there is met again at every look.
        unburied = deaths.into_iter().filter(|death| !death.removed).collect();
        pulse.stepped(began.elapsed());
        pulse.beat()?;
        if stop.wait(TEND_PERIOD) {
            return Ok(());
        }
    }
}

fn tell(death: &Death) {
    let who = death.member.as_ref().map_or("a process without a name".into(), ToString::to_string);
    let what = if death.removed { "removed" } else { "still there" };
    log!(code::ROLE_DIED, "{who} died; what it left behind is {what}");
}

/// Room for the frames of the configured camera, three bytes a pixel and two of depth; a film may be larger than that.
fn limits(config: &Config) -> Limits {
    let pixels = config.camera.width as usize * config.camera.height as usize;
    Limits { frame_bytes: Limits::default().frame_bytes.max(5 * pixels) }
}
