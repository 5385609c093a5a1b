//! What the Modbus server is told.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

use crate::registers::WordOrder;

/// The configuration of the server. The default can be reached from this machine only and cannot be written.
#[derive(Clone, Debug)]
pub struct Config {
    /// Where it listens.
    pub bind: SocketAddr,
    /// Who may connect. All others are refused and counted.
    pub allowed_clients: Vec<IpAddr>,
    /// Whether clients may write the control registers.
    pub writes: bool,
    /// The order of the registers of longer values.
    pub word_order: WordOrder,
    /// Connections at once; one more is closed at once.
    pub connections: usize,
    /// A connection without a whole request for this long is closed.
    pub idle_timeout: Duration,
    /// With writes off, how long a result is offered before the next one takes its place.
    pub hold: Duration,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            // The port of Modbus; one under 1024 needs CAP_NET_BIND_SERVICE.
            bind: SocketAddr::new(Ipv4Addr::LOCALHOST.into(), 502),
            allowed_clients: vec![IpAddr::V4(Ipv4Addr::LOCALHOST)],
            writes: false,
            word_order: WordOrder::Big,
            // A PLC, a second one, a panel, SCADA, and as many again while their old connections time out.
            connections: 8,
            // A PLC polls once a second or faster.
            idle_timeout: Duration::from_secs(30),
            // Five scans of a slow PLC (100 ms).
            hold: Duration::from_millis(500),
        }
    }
}
