//! The PLC side of the verdict channel.
//!
//! - [`registers`]: the register map, one table; `REGISTERS.md` is generated from it.
//! - [`handshake`]: the pure state machine behind the registers.
//! - [`c_abi`]: `libandon_plc` for programs in C on the same machine.
//! - [`modbus`]: the Modbus TCP server of the role `plc`.
#![deny(unsafe_code)]

pub mod c_abi;
mod document;
pub mod handshake;
pub mod modbus;
pub mod registers;

pub use document::document;
