//! `steward`: owns every service of the station and removes what the dead leave behind. It carries no data.

use std::time::Duration;

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, PATIENCE, Role, Turn};
use andon_host::taken;
use andon_ipc::{Death, Limits, Node, POLL_PERIOD, Port, Station, Steward, Stop};
use shm_schemas::{AuditKind, RoleId};

use super::RoleError;
use super::audit::Auditor;
use super::jobs;

/// Runs until it is asked to stop.
pub(super) fn run(station: &Station, config: &Config, stop: &Stop) -> Result<(), RoleError> {
    // Dropped last: it cleans up when nobody else is in the station, and its own node is somebody.
    let mut steward = Steward::create(station, limits(config))?;
    if let Err(error) = taken::keep(config) {
        log!(code::CONFIGURATION_NOT_KEPT, "{}: {error}", station.root().display());
    }
    // Its own predecessor may still be in the list of the writers: the others wait for that as well.
    let node = Node::open(station, RoleId::Steward, PATIENCE, stop)?
        .with_configuration(config.hash())
        .with_deadline(config.health.deadline(RoleId::Steward));
    let mut role =
        Reaper { steward: &mut steward, config, auditor: Auditor::open(&node)?, unreaped: Vec::new() };
    Cycle::new(&node)?.run(&mut role)
}

struct Reaper<'c> {
    steward: &'c mut Steward,
    config: &'c Config,
    auditor: Auditor,
    /// What is still there is found again at every look, and logged once.
    unreaped: Vec<Death>,
}

impl Role for Reaper<'_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.auditor.port()]
    }

    fn patience(&self) -> Duration {
        POLL_PERIOD
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let deaths = self.steward.poll()?;
        for death in deaths.iter().filter(|death| !self.unreaped.contains(*death)) {
            log_death(death);
            if let Some(member) = &death.member {
                self.auditor.record(cycle, AuditKind::Death, &member.to_string(), "died")?;
            }
        }
        self.unreaped = deaths.into_iter().filter(|death| !death.removed).collect();
        Ok(Turn::Stepped)
    }

    /// A line that is ended in good order begins the next time with the files as they are then.
    fn stop(&mut self, _cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        taken::forget(self.config);
        jobs::forget_choice(self.config);
        Ok(())
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
