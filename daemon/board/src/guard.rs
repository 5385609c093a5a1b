//! By which names a browser may call the board.
//!
//! A page of another site may lead its own name to this machine (DNS rebinding). The browser then takes the board for a part of that site, and lets it
//! read everything. The header Host has that name, so only known names are answered.

use std::net::IpAddr;

use andon_http::Request;

/// The names that are answered, in small letters.
#[derive(Debug)]
pub(crate) struct Guard {
    names: Vec<String>,
}

impl Guard {
    /// Answers to the loopback address, to the address that the board listens on, and to these names.
    pub(crate) fn new(bind: IpAddr, port: u16, hosts: &[String]) -> Self {
        let mut hosts: Vec<String> = hosts.iter().map(|host| host.to_ascii_lowercase()).collect();
        hosts.extend(["localhost", "127.0.0.1", "[::1]"].map(str::to_owned));
        if !bind.is_unspecified() {
            hosts.push(if bind.is_ipv6() { format!("[{bind}]") } else { bind.to_string() });
        }
        let names = hosts.iter().map(|host| format!("{host}:{port}")).collect();
        Self { names }
    }

    pub(crate) fn knows(&self, request: &Request) -> bool {
        let host = request.host.as_ref().map(|host| host.to_ascii_lowercase());
        host.is_some_and(|host| self.names.contains(&host))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knows(guard: &Guard, host: Option<&str>) -> bool {
        guard.knows(&Request { host: host.map(str::to_owned), ..Request::default() })
    }

    #[test]
    fn only_known_names_with_the_own_port_are_answered() {
        let guard = Guard::new([10, 0, 0, 7].into(), 9465, &["Bench1.Plant.example".to_owned()]);
        for host in
            ["localhost:9465", "127.0.0.1:9465", "[::1]:9465", "10.0.0.7:9465", "bench1.plant.EXAMPLE:9465"]
        {
            assert!(knows(&guard, Some(host)), "{host}");
        }
        for host in [
            "evil.example:9465",
            "localhost",
            "localhost:80",
            "10.0.0.8:9465",
            "",
            "bench1.plant.example:9465:1",
        ] {
            assert!(!knows(&guard, Some(host)), "{host}");
        }
        assert!(!knows(&guard, None));
    }

    #[test]
    fn every_address_is_no_name() {
        let guard = Guard::new([0, 0, 0, 0].into(), 9465, &[]);
        assert!(!knows(&guard, Some("0.0.0.0:9465")) && knows(&guard, Some("localhost:9465")));
    }
}
