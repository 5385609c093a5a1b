//! The account with the journal, between the channels and the state machine.

use std::time::{Duration, Instant};

use andon_host::role::{Cycle, Output, Turn};
use andon_ipc::{Error, Node, Port, Reader, Writer};
use andon_plc::modbus::ModbusServer;
use shm_schemas::{AccountKept, AccountUpdate, Journalled, RoleId};

use super::super::RoleError;

/// A journal that has not answered by then is asked again.
const AGAIN: Duration = Duration::from_millis(500);

/// The channels to and from the journal.
pub(super) struct Account {
    updates: Output<Writer<AccountUpdate>>,
    kept: Reader<AccountKept>,
    rows: Reader<Journalled>,
    /// The start of the journal that was heard last.
    journal_epoch: Option<u64>,
    /// When the journal was asked last what it keeps.
    asked: Option<Instant>,
}

impl Account {
    pub(super) fn open(node: &Node) -> Result<Self, Error> {
        Ok(Self {
            updates: Output::beside(node.writer()?),
            kept: node.reader()?,
            rows: node.reader()?,
            journal_epoch: None,
            asked: None,
        })
    }

    pub(super) fn ports(&mut self) -> [&mut dyn Port; 3] {
        [self.updates.port(), &mut self.kept, &mut self.rows]
    }

    /// Tells the state machine what the journal has said: what it keeps, and at most one row.
    pub(super) fn receive(
        &mut self,
        server: &ModbusServer,
        cycle: &mut Cycle<'_>,
    ) -> Result<Turn, RoleError> {
        while let Some(kept) = self.kept.take()? {
            if kept.consumer() != Ok(RoleId::Plc) {
                continue;
            }
            let known = self.journal_epoch.replace(kept.stamp.epoch);
            server.handshake(|handshake, now_ns| {
                if known.is_some_and(|known| known != kept.stamp.epoch) {
                    handshake.journal_restarted();
                }
                handshake.kept(&kept, now_ns);
            });
        }
        let row = loop {
            let Some(row) = cycle.take(&mut self.rows)? else { return Ok(Turn::Idle) };
            if row.consumer() == Ok(RoleId::Plc) {
                break row;
            }
        };
        server.handshake(|handshake, now_ns| handshake.journalled(&row, now_ns));
        Ok(Turn::Stepped)
    }

    /// Sends the journal what it must keep.
    pub(super) fn send(&mut self, server: &ModbusServer, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let Some(update) = server.handshake(|handshake, now_ns| handshake.update(now_ns)) else {
            return self.ask(cycle);
        };
        self.updates.send(cycle, |message| {
            (message.after_row, message.asked) = (update.after_row, update.asked);
            message.consumer = RoleId::Plc.code().into();
            message.account = update.account;
        })?;
        Ok(())
    }

    /// Asks the journal what it keeps, until it has said so.
    fn ask(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        if self.journal_epoch.is_none() && self.asked.is_none_or(|at| at.elapsed() >= AGAIN) {
            self.asked = Some(Instant::now());
            self.updates.send(cycle, |message| message.consumer = RoleId::Plc.code().into())?;
        }
        Ok(())
    }
}
