//! `steward`: owns every service of the station and removes what the dead leave behind. It moves no data.

use std::time::{Duration, Instant};

use andon_ipc::{Limits, Node, Station, Steward, Stop, TEND_PERIOD, Wake};
use shm_schemas::RoleId;

use super::{Pulse, RoleError};
use crate::config::Config;
use crate::log::{code, log};

/// Runs until it is asked to stop.
pub(super) fn run(station: &Station, config: &Config, stop: &Stop) -> Result<(), RoleError> {
    let mut steward = Steward::create(station, limits(config))?;
    let node = Node::open(station, RoleId::Steward, Duration::ZERO, stop)?;
    let mut pulse = Pulse::new(&node)?;
    loop {
        let began = Instant::now();
        for death in steward.tend()? {
            let who = death.member.map_or("a process without a name".into(), |member| member.to_string());
            log!(
                code::ROLE_DIED,
                "{who} died; what it left behind is {}",
                if death.removed { "removed" } else { "still there" }
            );
        }
        pulse.stepped(began.elapsed());
        pulse.beat(&Wake::Room)?;
        if stop.wait(TEND_PERIOD) {
            return Ok(());
        }
    }
}

/// Room for the frames of the configured camera, three bytes a pixel and two of depth; a film may be larger than that.
fn limits(config: &Config) -> Limits {
    let pixels = config.camera.width as usize * config.camera.height as usize;
    Limits { frame_bytes: Limits::default().frame_bytes.max(5 * pixels) }
}
