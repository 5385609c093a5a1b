//! `andond board`: the certificate and the logins of a board. They lie outside of the configuration, and nobody but their user may read them.

mod password;
mod secret;

use std::net::IpAddr;

use andon_board::{Logins, Rank};
use andon_host::config::Config;
use andon_host::exit::Code;
use shm_schemas::AuditKind;

use super::{ToolError, audit, load_config_to_learn};
use crate::boards;
use crate::cli::board::{BoardAction, Certificate, Login, Named};

/// Runs the command.
///
/// # Errors
/// What cannot be made, and the journal that does not keep it.
pub fn run(action: &BoardAction) -> Result<Code, ToolError> {
    match action {
        BoardAction::Certificate(arguments) => certificate(arguments)?,
        BoardAction::Login(arguments) => login(arguments)?,
        BoardAction::Kiosk(arguments) => kiosk(arguments)?,
        BoardAction::Remove(arguments) => remove(arguments)?,
        BoardAction::Logins(arguments) => list(&load_config_to_learn(&arguments.config)?)?,
    }
    Ok(Code::Stopped)
}

fn certificate(arguments: &Certificate) -> Result<(), ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    let (Some(certificate), Some(key)) = (&config.board.certificate, &config.board.key) else {
        return Err(ToolError::NoCertificateNamed);
    };
    if let Some(there) = [certificate, key].into_iter().find(|path| path.exists() && !arguments.force) {
        return Err(ToolError::Exists(there.clone()));
    }
    let names = names(&config);
    let [certificate_pem, key_pem] =
        andon_http::self_signed(&names).map_err(|reason| ToolError::CertificateName { reason })?;
    let files =
        [secret::staged(key, key_pem.as_bytes())?, secret::staged(certificate, certificate_pem.as_bytes())?];
    audit::keep(&config, AuditKind::Login, "made a certificate for the board")?;
    files.into_iter().try_for_each(secret::Secret::put)?;
    println!("{} and {}: for {}", certificate.display(), key.display(), names.join(", "));
    println!("a browser asks once whether to trust it; the board takes it at its next start");
    Ok(())
}

/// The names and addresses by which browsers call the board.
fn names(config: &Config) -> Vec<String> {
    let board = &config.board;
    let own = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let mut names = board.hosts.clone();
    names.extend((!board.bind.is_unspecified()).then(|| board.bind.to_string()));
    names.extend([own.trim().to_owned(), "localhost".to_owned(), "127.0.0.1".to_owned()]);
    names.retain(|name| !name.is_empty());
    let mut known = std::collections::HashSet::new();
    names.retain(|name| known.insert(name.to_ascii_lowercase()));
    names
}

fn login(arguments: &Login) -> Result<(), ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    let rank = Rank::from(arguments.rank);
    let mut logins = boards::logins(&config.logins_path())?;
    let password = password::read(&arguments.name)?;
    logins.add(&arguments.name, rank, &password)?;
    let done = format!("login {} may log in to the board as {}", arguments.name, rank.name());
    keep(&config, &logins, &done)
}

fn kiosk(arguments: &Named) -> Result<(), ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    let mut logins = boards::logins(&config.logins_path())?;
    let token = logins.add_kiosk(&arguments.name)?;
    keep(&config, &logins, &format!("kiosk {} may show the worker's page", arguments.name))?;
    println!("open this once on the screen, and in no other browser; it is not shown again:");
    println!("{}/kiosk?token={token}", address(&config));
    Ok(())
}

/// The address by which a browser calls the board.
pub(super) fn address(config: &Config) -> String {
    let board = &config.board;
    let scheme = if board.certificate.is_some() { "https" } else { "http" };
    let host = match (board.hosts.first(), board.bind) {
        (Some(name), _) => name.clone(),
        (None, bind) if bind.is_unspecified() || bind.is_loopback() => "localhost".to_owned(),
        (None, IpAddr::V6(v6)) => format!("[{v6}]"),
        (None, IpAddr::V4(v4)) => v4.to_string(),
    };
    format!("{scheme}://{host}:{}", board.port)
}

fn remove(arguments: &Named) -> Result<(), ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    let path = config.logins_path();
    let mut logins = boards::logins(&path)?;
    if !logins.remove(&arguments.name) {
        return Err(ToolError::NoLogin { name: arguments.name.clone(), path });
    }
    keep(&config, &logins, &format!("{} was removed from the logins of the board", arguments.name))
}

fn list(config: &Config) -> Result<(), ToolError> {
    for (name, rank) in boards::logins(&config.logins_path())?.names() {
        println!("{name:32}  {}", rank.map_or("kiosk", Rank::name));
    }
    Ok(())
}

/// Lets the journal keep who changes the logins, and then changes them: nothing is changed that nobody knows of.
fn keep(config: &Config, logins: &Logins, done: &str) -> Result<(), ToolError> {
    let path = config.logins_path();
    let file = secret::staged(&path, logins.text().as_bytes())?;
    audit::keep(config, AuditKind::Login, done)?;
    file.put()?;
    println!("{done}");
    Ok(())
}
