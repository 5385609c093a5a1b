//! The registers that a PLC reads and writes: one table, and what is made from it.

mod codec;
mod image;
mod map;

pub use codec::{RegisterError, WordOrder, read, write};
pub use image::{Control, Image, ResultBlock, control, status};
pub(crate) use map::measure_scale;
pub use map::{Access, CONTROL_BASE, Get, MAP, MAP_VERSION, Register};
