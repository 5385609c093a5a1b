//! The PLC side of the verdict channel.
//!
//! - [`registers`]: the register map, one table; `REGISTERS.md` is made from it.
//! - [`handshake`]: the pure state machine behind the registers.
//! - [`modbus`]: the Modbus TCP server of `andond run plc`, driven by it.
#![deny(unsafe_code)]

pub mod handshake;
pub mod modbus;
pub mod registers;
