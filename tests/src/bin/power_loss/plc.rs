//! A PLC that acknowledges every result and remembers all that it was told.

use andon_tests::line::{Modbus, control, status};
use std::collections::BTreeMap;

/// What the PLC remembers through every loss of the line's power.
#[derive(Default)]
pub(crate) struct Plc {
    client: Option<Modbus>,
    /// Epoch and `seq` of the verdict that it was offered under each number.
    results: BTreeMap<u32, (u64, u64)>,
    /// The newest number whose acknowledgement the line has answered.
    acknowledged: u32,
    /// The number of the line's newest start, and whether it was told in this one.
    boot: u32,
    is_told: bool,
    is_acknowledging: bool,
    /// Results that were lost to it.
    lost: u64,
}

impl Plc {
    pub(crate) fn power_is_back(&mut self) {
        (self.client, self.is_told, self.is_acknowledging) = (None, false, false);
    }

    /// Whether the line has told the number of this start: it knows then what the journal keeps.
    pub(crate) fn is_told(&self) -> bool {
        self.is_told
    }

    /// The number of results whose acknowledgement was answered.
    pub(crate) fn acknowledged(&self) -> usize {
        self.acknowledged as usize
    }

    /// Every verdict that was ever offered.
    pub(crate) fn offered(&self) -> impl Iterator<Item = (u64, u64)> {
        self.results.values().copied()
    }

    /// One cycle: reads, and writes what follows from it. Returns what must not be. A line that does not answer is not a fault.
    pub(crate) fn look(&mut self, port: u16) -> Vec<String> {
        self.client = self.client.take().or_else(|| Modbus::connect(port).ok());
        let Some(mut client) = self.client.take() else { return Vec::new() };
        let Ok(registers) = client.read(0, 52) else { return Vec::new() };
        let (faults, word) = self.take(&Registers(&registers));
        if client.control(word).is_ok() {
            self.client = Some(client);
        }
        faults
    }

    fn take(&mut self, registers: &Registers<'_>) -> (Vec<String>, u16) {
        let mut faults = Vec::new();
        let boot = registers.number(48, 2) as u32;
        if boot != 0 && !std::mem::replace(&mut self.is_told, true) {
            if boot <= self.boot {
                faults.push(format!("start {boot} of the line after start {}", self.boot));
            }
            self.boot = boot;
        }
        let lost = registers.number(9, 2);
        if lost != std::mem::replace(&mut self.lost, lost) {
            faults.push(format!("{lost} results are lost"));
        }
        let answers = registers.0[1] | registers.0[2];
        if self.is_acknowledging && answers & control::ACKNOWLEDGE != 0 {
            if registers.0[1] & control::ACKNOWLEDGE != 0 {
                self.acknowledged = registers.number(11, 2) as u32;
            }
            self.is_acknowledging = false;
        } else if !self.is_acknowledging
            && registers.0[0] & status::DONE != 0
            && answers & control::ACKNOWLEDGE == 0
        {
            faults.extend(
                self.offer(
                    registers.number(11, 2) as u32,
                    (registers.number(38, 4), registers.number(42, 4)),
                ),
            );
            self.is_acknowledging = true;
        }
        (faults, control::ENABLE | if self.is_acknowledging { control::ACKNOWLEDGE } else { 0 })
    }

    fn offer(&mut self, sequence: u32, verdict: (u64, u64)) -> Option<String> {
        let newest = self.results.keys().next_back().copied().unwrap_or(0);
        let known = self.results.get(&sequence).copied();
        let wrong = match known {
            _ if sequence <= self.acknowledged => "it was acknowledged",
            Some(known) if known != verdict => "this number was another verdict's",
            None if sequence != newest + 1 => "this number is not the next",
            None if self.results.values().any(|offered| *offered == verdict) => {
                "this verdict had another number"
            }
            _ => {
                self.results.insert(sequence, verdict);
                return None;
            }
        };
        Some(format!("result {sequence}, {verdict:?}, is offered: {wrong}"))
    }
}

/// The registers from 0 on, for the word order "big".
struct Registers<'r>(&'r [u16]);

impl Registers<'_> {
    fn number(&self, address: usize, count: usize) -> u64 {
        self.0[address..address + count].iter().fold(0, |number, word| number << 16 | u64::from(*word))
    }
}
