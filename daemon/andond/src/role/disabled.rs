//! A role that the configuration does not want: there is nothing to do, and the unit is there all the same, and healthy.

use std::time::Instant;

use andon_host::role::{Cycle, Role, Turn};
use andon_ipc::Port;

use super::RoleError;

struct Disabled;

impl Role for Disabled {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        Vec::new()
    }

    fn turn(&mut self, _cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        Ok(Turn::Idle)
    }
}

/// Runs until it is asked to stop.
pub(super) fn run(cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
    cycle.stepped(Instant::now());
    cycle.run(&mut Disabled)
}
