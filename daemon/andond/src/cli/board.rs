//! What makes the board safe on a network.

use andon_board::Rank;
use andon_host::cli::ConfigArgs;
use clap::{Args, Subcommand, ValueEnum};

/// `andond board`
#[derive(Debug, Args)]
pub struct Board {
    /// What to do
    #[command(subcommand)]
    pub action: BoardAction,
}

/// What `andond board` does.
#[derive(Debug, Subcommand)]
pub enum BoardAction {
    /// Make a certificate that vouches for itself, and its key, in the files that the configuration names
    Certificate(Certificate),
    /// Make a login, or give it another password and rank; the password is asked for, or read from the standard input
    Login(Login),
    /// Make a link that shows the worker's page on a screen without a login
    Kiosk(Named),
    /// Remove a login or a kiosk
    Remove(Named),
    /// List the logins and the kiosks
    Logins(Logins),
}

/// `andond board certificate`
#[derive(Debug, Args)]
pub struct Certificate {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Replace existing files
    #[arg(long)]
    pub force: bool,
}

/// `andond board login`
#[derive(Debug, Args)]
pub struct Login {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Its name
    pub name: String,
    /// What it is for
    #[arg(long = "role", value_enum, value_name = "ROLE")]
    pub rank: LoginRole,
}

/// What a login is for. Each may do what those before it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LoginRole {
    /// Sees the worker's page
    Worker,
    /// Sees the technician's page, and says whether a verdict was right
    Technician,
    /// Teaches
    Engineer,
}

impl From<LoginRole> for Rank {
    fn from(role: LoginRole) -> Self {
        match role {
            LoginRole::Worker => Self::Worker,
            LoginRole::Technician => Self::Technician,
            LoginRole::Engineer => Self::Engineer,
        }
    }
}

/// `andond board kiosk` and `andond board remove`
#[derive(Debug, Args)]
pub struct Named {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
    /// Its name
    pub name: String,
}

/// `andond board logins`
#[derive(Debug, Args)]
pub struct Logins {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub config: ConfigArgs,
}
