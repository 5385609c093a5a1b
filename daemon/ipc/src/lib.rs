//! The only crate that calls iceoryx2: channels, ports, the loop.
