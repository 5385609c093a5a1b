//! How long somebody waits after wrong passwords: each doubles the time, for the address that they came from and for the name that they were for.
//!
//! Nobody is held: who comes too early is told to come later, and that costs the board nothing. A name waits for a short time at most, so that whoever
//! knows a name cannot keep its owner out for long.

use std::net::IpAddr;

const SECOND_NS: u64 = 1_000_000_000;

/// Wrong passwords without a delay: people mistype.
const FREE: u32 = 3;

/// The longest delay of an address, and of a name.
const OF_ADDRESS_S: u64 = 60;
const OF_NAME_S: u64 = 5;

/// What was wrong is forgotten after so long.
const FORGOTTEN_NS: u64 = 15 * 60 * SECOND_NS;

/// Addresses and names that are kept. The oldest makes way.
const MOST: usize = 1024;

#[derive(Clone, Debug, PartialEq, Eq)]
enum Of {
    Address(IpAddr),
    Name(String),
}

#[derive(Debug)]
struct Failures {
    of: Of,
    count: u32,
    last_ns: u64,
}

impl Failures {
    /// When the next one may come.
    fn free_ns(&self) -> u64 {
        let longest_s = if matches!(self.of, Of::Address(_)) { OF_ADDRESS_S } else { OF_NAME_S };
        let doubled = self.count.checked_sub(FREE).map_or(0, |more| 1_u64 << more.min(10));
        self.last_ns + doubled.min(longest_s) * SECOND_NS
    }
}

/// All of them.
#[derive(Debug, Default)]
pub(super) struct Delays(Vec<Failures>);

fn both(name: &str, peer: IpAddr) -> [Of; 2] {
    // A machine has a whole network of IPv6 addresses.
    let peer = match peer.to_canonical() {
        IpAddr::V6(v6) => IpAddr::V6((u128::from(v6) >> 64 << 64).into()),
        v4 @ IpAddr::V4(_) => v4,
    };
    [Of::Address(peer), Of::Name(name.chars().take(super::MAX_NAME).collect())]
}

impl Delays {
    /// How many seconds this name, or this address, has to wait; `None` where it need not.
    pub(super) fn wait_s(&mut self, name: &str, peer: IpAddr, now_ns: u64) -> Option<u64> {
        self.0.retain(|failures| now_ns.saturating_sub(failures.last_ns) < FORGOTTEN_NS);
        let of = both(name, peer);
        let own = self.0.iter().filter(|failures| of.contains(&failures.of));
        let free_ns = own.map(Failures::free_ns).max()?;
        free_ns.checked_sub(now_ns).filter(|left| *left > 0).map(|left| left.div_ceil(SECOND_NS))
    }

    /// A password was wrong.
    pub(super) fn failed(&mut self, name: &str, peer: IpAddr, now_ns: u64) {
        for of in both(name, peer) {
            match self.0.iter_mut().find(|failures| failures.of == of) {
                Some(failures) => {
                    failures.count = failures.count.saturating_add(1);
                    failures.last_ns = now_ns;
                }
                None => {
                    if self.0.len() >= MOST
                        && let Some(oldest) = (0..self.0.len()).min_by_key(|place| self.0[*place].last_ns)
                    {
                        self.0.swap_remove(oldest);
                    }
                    self.0.push(Failures { of, count: 1, last_ns: now_ns });
                }
            }
        }
    }

    /// A password was right.
    pub(super) fn succeeded(&mut self, name: &str, peer: IpAddr) {
        let of = both(name, peer);
        self.0.retain(|failures| !of.contains(&failures.of));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 1));
    const OTHER: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 2));

    #[test]
    fn each_wrong_password_doubles_the_delay_of_its_address_up_to_a_minute() {
        let mut delays = Delays::default();
        let mut waits = Vec::new();
        let mut now_ns = 0;
        for number in 0..12 {
            waits.push(delays.wait_s("maria", ONE, now_ns).unwrap_or(0));
            now_ns += waits[number] * SECOND_NS;
            delays.failed("maria", ONE, now_ns);
        }
        assert_eq!(waits, [0, 0, 0, 1, 2, 4, 8, 16, 32, 60, 60, 60]);
        // Another name from there waits as long, the same name from elsewhere a little.
        assert_eq!(delays.wait_s("paul", ONE, now_ns), Some(60));
        assert_eq!(delays.wait_s("maria", OTHER, now_ns), Some(OF_NAME_S));
        assert_eq!(delays.wait_s("paul", OTHER, now_ns), None, "nobody else waits");
        assert_eq!(delays.wait_s("maria", ONE, now_ns + FORGOTTEN_NS), None);
    }

    #[test]
    fn a_right_password_ends_the_delay() {
        let mut delays = Delays::default();
        (0..9).for_each(|_| delays.failed("maria", ONE, 0));
        delays.succeeded("maria", ONE);
        assert_eq!(delays.wait_s("maria", ONE, 0), None);
    }

    #[test]
    fn a_machine_with_many_addresses_and_names_takes_no_more_memory() {
        let mut delays = Delays::default();
        for number in 0..5000_u32 {
            delays.failed(&"x".repeat(number as usize), IpAddr::from(number.to_be_bytes()), number.into());
        }
        assert_eq!(delays.0.len(), MOST);
        let [one, other] = [1_u128, 2].map(|low| IpAddr::from(((0xfd00_u128 << 112) | low).to_be_bytes()));
        assert_eq!(both("", one)[0], both("", other)[0], "one network of IPv6 is one address");
    }
}
