//! The configuration of the Modbus server.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

use crate::registers::WordOrder;

/// The configuration of the server. By default only clients on this machine can connect, and they cannot write.
#[derive(Clone, Debug)]
pub struct Config {
    /// The address that it listens on.
    pub bind: SocketAddr,
    /// The clients that may connect. All others are refused and counted.
    pub allowed_clients: Vec<IpAddr>,
    /// Whether the commanders may write the control registers.
    pub writes: bool,
    /// The clients that may write. The others only read.
    pub commanders: Vec<IpAddr>,
    /// The order of the registers of values that need two or four.
    pub word_order: WordOrder,
    /// The number of connections that can be open at the same time; one more is closed immediately.
    pub connections: usize,
    /// A connection without a whole request for this long is closed.
    pub idle_timeout: Duration,
    /// Without writes, how long a result is offered before the next one takes its place.
    pub hold: Duration,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            // The port of Modbus; one under 1024 needs CAP_NET_BIND_SERVICE.
            bind: SocketAddr::new(Ipv4Addr::LOCALHOST.into(), 502),
            allowed_clients: vec![IpAddr::V4(Ipv4Addr::LOCALHOST)],
            writes: false,
            commanders: vec![IpAddr::V4(Ipv4Addr::LOCALHOST)],
            word_order: WordOrder::Big,
            // Two PLCs, a panel and SCADA, and the same number again while their old connections time out.
            connections: 8,
            // A PLC polls once a second or faster.
            idle_timeout: Duration::from_secs(30),
            // Five cycles of a slow PLC (100 ms).
            hold: Duration::from_millis(500),
        }
    }
}
