//! Where messages go.

use std::fmt::Write as _;
use std::fs::File;
use std::io::IsTerminal;
use std::os::fd::AsFd;
use std::os::unix::fs::MetadataExt;
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::format::{FormatEvent, FormatFields, Writer};
use tracing_subscriber::fmt::time::{FormatTime, SystemTime};
use tracing_subscriber::fmt::{FmtContext, layer};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::{SubscriberInitExt, TryInitError};

/// Overrides the configured level: a level, or levels for modules, as in `info,andond::role::judge=trace`.
const VARIABLE: &str = "ANDON_LOG";

/// Which messages are logged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Level {
    /// What stops or endangers the line.
    Error,
    /// Also what somebody should look at.
    Warn,
    /// Also the transitions that a technician cares about.
    #[default]
    Info,
    /// Also each IU.
    Debug,
    /// Also each frame.
    Trace,
}

impl From<Level> for LevelFilter {
    fn from(level: Level) -> Self {
        match level {
            Level::Error => Self::ERROR,
            Level::Warn => Self::WARN,
            Level::Info => Self::INFO,
            Level::Debug => Self::DEBUG,
            Level::Trace => Self::TRACE,
        }
    }
}

/// Starts logging for this process. `role` is `judge` or the name of a tool.
///
/// Under systemd messages go to the journal with the fields `ANDON_CODE`, `ANDON_ROLE`, `ANDON_STATION` and those of the message. Anywhere else they
/// are text on standard error, in colour on a terminal.
///
/// # Errors
/// Logging has been started before.
pub fn start(role: &str, station: &str, level: Level) -> Result<(), TryInitError> {
    let variable = std::env::var(VARIABLE).ok().and_then(|levels| levels.parse::<Targets>().ok());
    let filter = variable.unwrap_or_else(|| Targets::new().with_default(LevelFilter::from(level)));
    let registry = tracing_subscriber::registry().with(filter);
    let journal = if stderr_is_journal() { tracing_journald::layer().ok() } else { None };
    if let Some(journal) = journal {
        let journal = journal
            .with_syslog_identifier(format!("andon-{role}"))
            .with_field_prefix(Some("ANDON".into()))
            .with_custom_fields([("ANDON_ROLE", role), ("ANDON_STATION", station)]);
        return registry.with(journal).try_init();
    }
    let text = layer()
        .event_format(Text { role: role.to_owned() })
        .with_ansi(std::io::stderr().is_terminal())
        // A log that cannot be written, as on a full disk, must not end the role. By default this is printed to where it cannot be written.
        .log_internal_errors(false)
        .with_writer(std::io::stderr);
    registry.with(text).try_init()
}

/// systemd names the stream that it connected to the journal by device and inode: standard error may have been redirected
/// since.
fn stderr_is_journal() -> bool {
    let Ok(stream) = std::env::var("JOURNAL_STREAM") else { return false };
    let stderr = std::io::stderr().as_fd().try_clone_to_owned().map(File::from);
    let Ok(metadata) = stderr.and_then(|stderr| stderr.metadata()) else { return false };
    stream == format!("{}:{}", metadata.dev(), metadata.ino())
}

/// One line of text: time, level, role, message, fields. The message begins with the code.
struct Text {
    role: String,
}

impl<S, N> FormatEvent<S, N> for Text
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        _: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> std::fmt::Result {
        SystemTime.format_time(&mut writer)?;
        let level = *event.metadata().level();
        let colour = match level {
            tracing::Level::ERROR => "\x1b[31m",
            tracing::Level::WARN => "\x1b[33m",
            _ => "\x1b[2m",
        };
        let [colour, plain] = if writer.has_ansi_escapes() { [colour, "\x1b[0m"] } else { [""; 2] };
        let mut fields = Fields::default();
        event.record(&mut fields);
        let Fields { message, rest } = fields;
        writeln!(writer, " {colour}{level:>5}{plain} {:<8} {message}{colour}{rest}{plain}", self.role)
    }
}

#[derive(Default)]
struct Fields {
    message: String,
    rest: String,
}

impl Visit for Fields {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        // Writing to a `String` cannot fail.
        let _ = match field.name() {
            "message" => write!(self.message, "{value:?}"),
            "code" => Ok(()),
            name => write!(self.rest, " {name}={value:?}"),
        };
    }
}
