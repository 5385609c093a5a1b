//! The section `[board]`: pages for people.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;

use crate::config::keys::Keys;
use crate::config::value::{Text, counted_within, several};

/// `[board]`: pages for worker, technician and engineer.
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// Whether they are served.
    pub enable: bool,
    /// The address that is listened on.
    pub bind: IpAddr,
    /// The port that is listened on.
    pub port: u16,
    /// Names by which browsers may call it, beside its address.
    pub hosts: Vec<String>,
    /// The certificate of TLS, in PEM form.
    pub certificate: Option<PathBuf>,
    /// Its key, in PEM form.
    pub key: Option<PathBuf>,
    /// The file of logins.
    pub logins: Option<PathBuf>,
    /// The language of a page whose address names none.
    pub language: String,
    /// Whether the camera's picture is shown.
    pub picture: bool,
    /// A folder with tables of words.
    pub words: Option<PathBuf>,
}

impl Default for Board {
    fn default() -> Self {
        Self {
            enable: false,
            bind: IpAddr::V4(Ipv4Addr::LOCALHOST),
            // Beside that of the metrics.
            port: 9465,
            hosts: Vec::new(),
            certificate: None,
            key: None,
            logins: None,
            language: "en".to_owned(),
            picture: true,
            words: None,
        }
    }
}

impl Board {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "enable",
            &mut self.enable,
            (),
            "Whether the pages are served: the worker's at http://BIND:PORT/ and the technician's at /technician. Who logs in \
             there may do what the login is for.",
        );
        k.key(
            "bind",
            &mut self.bind,
            (),
            "The address that is listened on. On a loopback address whoever is at this machine may read without a login. Any other \
             address needs board.certificate, board.key and a login, and then nothing is read without one.",
        );
        k.key(
            "port",
            &mut self.port,
            counted_within(1024, 65_535, "one below needs a privilege that this role does not have"),
            "The TCP port. Each station of a PC needs one of its own.",
        );
        k.key(
            "hosts",
            &mut self.hosts,
            several(0, 16, Text::Host),
            "Names under which browsers find this machine, without the port. Any other name is refused, so that no page of \
             another site can read these. An IP address that is bound, and localhost, need not be named.",
        );
        k.optional(
            "certificate",
            &mut self.certificate,
            (),
            r#""/var/lib/andon/bench1.certificate.pem""#,
            "The certificate of TLS, in PEM form, with those that vouch for it behind it. `andond board certificate` makes one \
             that browsers ask about once. With it the addresses begin with https://.",
        );
        k.optional(
            "key",
            &mut self.key,
            (),
            r#""/var/lib/andon/bench1.key.pem""#,
            "The key of board.certificate, in PEM form. Only the user of the station's units may read it.",
        );
        k.optional(
            "logins",
            &mut self.logins,
            (),
            r#""/var/lib/andon/bench1.logins.toml""#,
            "The file of logins, which `andond board login` makes. Without this key it lies beside the database that \
             journal.path has by default, and has the station's name.",
        );
        k.key(
            "language",
            &mut self.language,
            Text::Line,
            "The language of the pages: de, en, es, fr or zh, or one that board.words adds. A page is shown in another one by \
             ?lang=CODE.",
        );
        k.key(
            "picture",
            &mut self.picture,
            (),
            "Whether the technician's page shows what the camera sees. What record.bench and record.masks hide is black there as \
             well.",
        );
        k.optional(
            "words",
            &mut self.words,
            (),
            r#""/etc/andon/words""#,
            "A folder with one file CODE.toml for each language that is added or changed. The guide says what is in it.",
        );
    }
}
