//! What a role tells the journal of what people and programs have done.
//!
//! Only the role `plc` knows the clients, only the judge what became of a job, and only the journal may write. So every role sends, and the
//! journal keeps.

use andon_host::role::{Cycle, CycleError, Output};
use andon_ipc::{Error, Node, Port, UtcTime, Writer};
use shm_schemas::{Audit, AuditKind, RoleId};

/// The role's end of the channel `audit`. Its history keeps what is reported while the journal is away.
pub(super) struct Auditor {
    writer: Output<Writer<Audit>>,
    role: RoleId,
}

impl Auditor {
    pub(super) fn open(node: &Node) -> Result<Self, Error> {
        Ok(Self { writer: Output::beside(node.writer()?), role: node.role() })
    }

    pub(super) fn port(&mut self) -> &mut dyn Port {
        self.writer.port()
    }

    /// Tells who has done what just now.
    pub(super) fn record(
        &mut self,
        cycle: &mut Cycle<'_>,
        kind: AuditKind,
        who: &str,
        what: &str,
    ) -> Result<(), CycleError> {
        let role = self.role;
        self.writer.send(cycle, |message| {
            message.utc_ns = UtcTime::now().nanoseconds();
            (message.kind, message.role) = (kind.code(), role.code());
            message.say(who, what);
        })
    }
}
