//! `steward`: owns every service of the station and removes what the dead leave behind. It carries no data.

use std::time::Duration;

use andon_ipc::{Death, Limits, Node, POLL_PERIOD, Port, Station, Steward, Stop};
use shm_schemas::RoleId;

use super::RoleError;
use super::cycle::{Cycle, Role, Turn};
use crate::config::Config;
use crate::log::{code, log};

/// Runs until it is asked to stop.
pub(super) fn run(station: &Station, config: &Config, stop: &Stop) -> Result<(), RoleError> {
    let mut role = Reaper { steward: Steward::create(station, limits(config))?, unreaped: Vec::new() };
    let node = Node::open(station, RoleId::Steward, Duration::ZERO, stop)?
        .with_deadline(config.health.deadline(RoleId::Steward));
    Cycle::new(&node)?.run(&mut role)?;
    Ok(())
}

struct Reaper {
    steward: Steward,
    /// What is still there is found again at every look, and logged once.
    unreaped: Vec<Death>,
}

impl Role for Reaper {
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        Vec::new()
    }

    fn patience(&self) -> Duration {
        POLL_PERIOD
    }

    fn turn(&mut self, _cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let deaths = self.steward.poll()?;
        deaths.iter().filter(|death| !self.unreaped.contains(*death)).for_each(log_death);
        self.unreaped = deaths.into_iter().filter(|death| !death.removed).collect();
        Ok(Turn::Stepped)
    }
}

fn log_death(death: &Death) {
    let member = death.member.as_ref().map_or("a process without a name".into(), ToString::to_string);
    let state = if death.removed { "removed" } else { "still there" };
    log!(code::ROLE_DIED, "{member} died; what it left behind is {state}");
}

/// Room for the frames of the configured camera, three bytes per pixel and two of depth; a film may be larger than that.
fn limits(config: &Config) -> Limits {
    let pixels = config.camera.width as usize * config.camera.height as usize;
    Limits { frame_bytes: Limits::default().frame_bytes.max(5 * pixels) }
}
