//! What makes a board safe on a network, as files: the certificate, its key and the logins. The role `board` reads them, and commands make them.

use std::io;
use std::path::{Path, PathBuf};

use andon_board::{Logins, LoginsError};
use andon_host::config::Config;
use andon_http::{Tls, TlsError};
use andon_learn::file;

use crate::mark::{Mark, mark};

/// Why a board may not be reached from a network.
#[derive(Debug, thiserror::Error)]
pub enum UnsafeBoard {
    /// A file cannot be read.
    #[error("{key}: {}: {source}; {remedy}", path.display())]
    Unread {
        /// The key that names it.
        key: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
        /// What to do.
        remedy: &'static str,
    },
    /// The certificate and the key are none, or do not fit.
    #[error(
        "board.certificate and board.key: {} and {}: {source}; `andond board certificate --force` makes new ones",
        certificate.display(), key.display()
    )]
    Tls {
        /// The file of the certificate.
        certificate: PathBuf,
        /// That of the key.
        key: PathBuf,
        /// What is wrong.
        source: TlsError,
    },
    /// The file of logins is none.
    #[error("board.logins: {}: {source}", path.display())]
    Logins {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: LoginsError,
    },
    /// Nobody could log in.
    #[error("board.logins: {}: there is no login in it; make one with `andond board login NAME --role engineer`", .0.display())]
    NoLogin(PathBuf),
}

/// The certificate and the key of a board; `None` where it speaks plain HTTP.
///
/// # Errors
/// That they cannot be used.
pub(crate) fn tls(config: &Config) -> Result<Option<Tls>, UnsafeBoard> {
    let (Some(certificate), Some(key)) = (&config.board.certificate, &config.board.key) else {
        return Ok(None);
    };
    let read = |key, path: &Path| {
        file::read(path).map_err(|source| UnsafeBoard::Unread {
            key,
            path: path.into(),
            source,
            remedy: "`andond board certificate` makes it; the user of the station's units must be able to read it",
        })
    };
    let tls = Tls::new(&read("board.certificate", certificate)?, &read("board.key", key)?);
    let failed = |source| UnsafeBoard::Tls { certificate: certificate.clone(), key: key.clone(), source };
    tls.map(Some).map_err(failed)
}

/// The logins of a board; none where there is no file of them.
///
/// # Errors
/// That the file cannot be read.
pub(crate) fn logins(path: &Path) -> Result<Logins, UnsafeBoard> {
    match file::read_text(path) {
        Ok(text) => Logins::parse(&text).map_err(|source| UnsafeBoard::Logins { path: path.into(), source }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Logins::default()),
        Err(source) => Err(UnsafeBoard::Unread {
            key: "board.logins",
            path: path.into(),
            source,
            remedy: "the user of the station's units must be able to read it",
        }),
    }
}

/// The file of logins, as it was when it was read last.
pub(crate) struct LoginsFile {
    path: PathBuf,
    /// Of what was read; `None` before that.
    mark: Option<Mark>,
    /// The logins in it; none where it cannot be read.
    pub(crate) logins: Logins,
}

impl LoginsFile {
    /// Nobody has read it yet.
    fn new(path: PathBuf) -> Self {
        Self { path, mark: None, logins: Logins::default() }
    }

    /// Reads it if it is another one by now. `None` where it is not.
    pub(crate) fn renew(&mut self) -> Option<Result<(), UnsafeBoard>> {
        let now = mark(&self.path);
        if self.mark.replace(now) == Some(now) {
            return None;
        }
        let (logins, read) = match logins(&self.path) {
            Ok(logins) => (logins, Ok(())),
            Err(error) => (Logins::default(), Err(error)),
        };
        self.logins = logins;
        Some(read)
    }
}

/// What a board needs to listen where its configuration says: on a network only where somebody can log in. On this machine the logins are not read
/// yet.
///
/// # Errors
/// Why it may not.
pub(crate) fn check(config: &Config) -> Result<(Option<Tls>, LoginsFile), UnsafeBoard> {
    let tls = tls(config)?;
    let mut file = LoginsFile::new(config.logins_path());
    if !config.board.bind.is_loopback() {
        file.renew().transpose()?;
        if file.logins.is_empty() {
            return Err(UnsafeBoard::NoLogin(file.path));
        }
    }
    Ok((tls, file))
}
