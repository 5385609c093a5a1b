//! How long somebody waits after wrong passwords: each doubles the time, for the address that they came from and for the name that they were for.
//!
//! Nobody is held: who comes too early is told to come later, and that costs the board nothing. A name waits for a short time at most. Many machines
//! together can keep it waiting all the same, so it does not wait for them where its login was before: there only what came from that address counts.

use std::net::IpAddr;

const SECOND_NS: u64 = 1_000_000_000;

/// Wrong passwords without a delay: people mistype.
const FREE: u32 = 3;

/// The longest delay of an address, and of a name.
const OF_ADDRESS_S: u64 = 60;
const OF_NAME_S: u64 = 5;

/// What was wrong is forgotten after so long.
const FORGOTTEN_NS: u64 = 15 * 60 * SECOND_NS;

/// So much that was wrong is kept, and so many addresses of logins. The oldest makes way.
const MOST: usize = 1024;

#[derive(Clone, Debug, PartialEq, Eq)]
enum Of {
    Address(IpAddr),
    Name(String),
    /// A name from an address. A right password for another name from there says nothing of it.
    Both(IpAddr, String),
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
pub(super) struct Delays {
    failures: Vec<Failures>,
    /// The address and the name of logins that came in, the newest last. A board that starts again knows none.
    known: Vec<Of>,
}

fn all(name: &str, peer: IpAddr) -> [Of; 3] {
    // A machine has a whole network of IPv6 addresses.
    let peer = match peer.to_canonical() {
        IpAddr::V6(v6) => IpAddr::V6((u128::from(v6) >> 64 << 64).into()),
        v4 @ IpAddr::V4(_) => v4,
    };
    let name: String = name.chars().take(super::MAX_NAME).collect();
    [Of::Address(peer), Of::Name(name.clone()), Of::Both(peer, name)]
}

impl Delays {
    /// How many seconds this name, or this address, has to wait; `None` where it need not.
    pub(super) fn wait_s(&mut self, name: &str, peer: IpAddr, now_ns: u64) -> Option<u64> {
        self.failures.retain(|failures| now_ns.saturating_sub(failures.last_ns) < FORGOTTEN_NS);
        let [address, name, both] = all(name, peer);
        let counts = if self.known.contains(&both) { [address, both] } else { [address, name] };
        let own = self.failures.iter().filter(|failures| counts.contains(&failures.of));
        let free_ns = own.map(Failures::free_ns).max()?;
        free_ns.checked_sub(now_ns).filter(|left| *left > 0).map(|left| left.div_ceil(SECOND_NS))
    }

    /// A password was wrong.
    pub(super) fn failed(&mut self, name: &str, peer: IpAddr, now_ns: u64) {
        for of in all(name, peer) {
            match self.failures.iter_mut().find(|failures| failures.of == of) {
                Some(failures) => {
                    failures.count = failures.count.saturating_add(1);
                    failures.last_ns = now_ns;
                }
                None => {
                    if self.failures.len() >= MOST
                        && let Some(oldest) =
                            (0..self.failures.len()).min_by_key(|place| self.failures[*place].last_ns)
                    {
                        self.failures.swap_remove(oldest);
                    }
                    self.failures.push(Failures { of, count: 1, last_ns: now_ns });
                }
            }
        }
    }

    /// A password was right.
    pub(super) fn succeeded(&mut self, name: &str, peer: IpAddr) {
        let of = all(name, peer);
        self.failures.retain(|failures| !of.contains(&failures.of));
        let [.., both] = of;
        self.known.retain(|known| *known != both);
        if self.known.len() >= MOST {
            self.known.remove(0);
        }
        self.known.push(both);
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
    fn many_machines_together_keep_nobody_out_where_their_login_was_before() {
        let mut delays = Delays::default();
        delays.succeeded("maria", ONE);
        for number in 0..100_u32 {
            delays.failed("maria", IpAddr::from((0x0a01_0000 + number).to_be_bytes()), 0);
        }
        assert_eq!(delays.wait_s("maria", ONE, 0), None);
        assert_eq!(delays.wait_s("maria", OTHER, 0), Some(OF_NAME_S), "it was never there");
        assert_eq!(delays.wait_s("paul", ONE, 0), None);
        // What comes from there counts as before.
        (0..5).for_each(|_| delays.failed("maria", ONE, 0));
        assert_eq!(delays.wait_s("maria", ONE, 0), Some(4));
    }

    #[test]
    fn who_has_a_login_of_their_own_waits_with_the_name_of_another_one_as_before() {
        let mut delays = Delays::default();
        delays.succeeded("maria", ONE);
        for _ in 0..9 {
            delays.failed("maria", ONE, 0);
            delays.succeeded("tom", ONE);
        }
        assert_eq!(delays.wait_s("maria", ONE, 0), Some(OF_NAME_S));
        assert_eq!(delays.wait_s("tom", ONE, 0), None);
    }

    #[test]
    fn a_machine_with_many_addresses_and_names_takes_no_more_memory() {
        let mut delays = Delays::default();
        for number in 0..5000_u32 {
            delays.failed(&"x".repeat(number as usize), IpAddr::from(number.to_be_bytes()), number.into());
        }
        assert_eq!(delays.failures.len(), MOST);
        for number in 0..5000_u32 {
            delays.succeeded("maria", IpAddr::from(number.to_be_bytes()));
        }
        assert_eq!(delays.known.len(), MOST);
        let [one, other] = [1_u128, 2].map(|low| IpAddr::from(((0xfd00_u128 << 112) | low).to_be_bytes()));
        assert_eq!(all("", one)[0], all("", other)[0], "one network of IPv6 is one address");
    }
}
