//! The PLC side of the verdict channel.
