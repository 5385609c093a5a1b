//! `andond history`: queries the journal, also while it is written.

mod csv;
mod plot;
mod summary;
mod table;

use std::io::{BufWriter, Write};

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_journal::{Entry, History, JournalError, Query};
use andon_record::store;
use jiff::Timestamp;

use super::clip::recordings;
use super::known_jobs::KnownJobs;
use super::part::part_id;
use super::since::since_ns;
use super::{ToolError, cannot_write, check_writable, job, running_config};
use crate::cli::History as Arguments;
use crate::clock::Clock;
use csv::WithClips;
use summary::Summary;
use table::Table;

/// The number of the job that somebody means. A number needs no file: the job may be gone.
fn job_number(wanted: &str, config: &Config) -> Result<u32, ToolError> {
    if let Ok(number) = wanted.parse() {
        return Ok(number);
    }
    let meant = job::meant(wanted, config)?;
    match meant.iter().all(|job| job.file.id == meant[0].file.id) {
        true => Ok(meant[0].file.id),
        false => Err(job::several(wanted, &meant)),
    }
}

/// Runs the command.
///
/// # Errors
/// A time that cannot be read, a job that is not known, and a journal that is not there or damaged.
pub fn run(arguments: &Arguments) -> Result<Code, ToolError> {
    let since = arguments.since.as_deref();
    let since_utc_ns = since.map(|text| since_ns("--since", text, Timestamp::now())).transpose()?;
    let part = arguments.part.as_deref().map(|id| part_id("--part", id)).transpose()?;
    let config = running_config(&arguments.config)?.config;
    let known = KnownJobs::of(&config);
    let job_id = arguments.job.as_deref().map(|job| job_number(job, &config)).transpose()?;
    let query = Query { since_utc_ns, job_id, part, nok: arguments.nok };
    arguments.plot.as_deref().map(check_writable).transpose()?;
    let history = History::open(&config.journal_path())?;
    let clock = Clock::new(arguments.utc);
    let mut out = BufWriter::new(anstream::stdout().lock());
    if let Some(question) = &arguments.sql {
        let recordings = recordings(&config).unwrap_or_default();
        let clips = store::by_verdict(&recordings);
        let paths: Vec<_> =
            clips.iter().map(|(id, recording)| (*id, recording.path.to_string_lossy())).collect();
        history.write_sql(question, paths.iter().map(|(id, path)| (*id, path.as_ref())), &mut out)?;
    } else if arguments.csv {
        match arguments.audit {
            true => history.write_audit_csv(since_utc_ns, &mut out)?,
            false => {
                let recordings = recordings(&config).unwrap_or_default();
                let clips = store::by_verdict(&recordings);
                history.write_csv(&query, &mut WithClips::new(&mut out, &clips))?;
            }
        }
    } else if arguments.audit {
        write!(out, "{}", table::audit_header(&clock)).map_err(ToolError::Print)?;
        history.visit_audit(since_utc_ns, |audit| Ok(table::write_audit(&audit, &clock, &mut out)?))?;
    } else if arguments.summary || arguments.plot.is_some() {
        let mut summary = Summary::new(&known);
        history.visit(&query, |entry| {
            summary.add(&entry);
            Ok(())
        })?;
        if arguments.summary {
            write!(out, "{}", summary.text(&clock)).map_err(ToolError::Print)?;
        }
        if let Some(plot) = &arguments.plot {
            atomic::write(plot, plot::draw(&summary, &clock).as_bytes()).map_err(cannot_write(plot))?;
            writeln!(out, "drawn: {}", plot.display()).map_err(ToolError::Print)?;
        }
    } else {
        // Where their folder cannot be read, as by another user, the rows are shown all the same.
        let recordings = recordings(&config).unwrap_or_default();
        let clips = store::by_verdict(&recordings);
        let mut table = Table::new(&known, &clock);
        write!(out, "{}", table.header()).map_err(ToolError::Print)?;
        history.visit_rows(&query, |row, entry: Entry| {
            let has_clip =
                matches!(&entry, Entry::Verdict(verdict) if clips.contains_key(&verdict.stamp.id()));
            Ok::<(), JournalError>(table.write(&entry, has_clip.then_some(row), &mut out)?)
        })?;
    }
    out.flush().map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}
