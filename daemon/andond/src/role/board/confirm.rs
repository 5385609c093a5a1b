//! Lets the journal keep what people say of verdicts on the board, as `andond confirm` does: by a message on the channel `audit`, of which the journal
//! alone writes. The board answers once it is on disk.

use std::path::{Path, PathBuf};
use std::thread::{Builder, JoinHandle, sleep};
use std::time::{Duration, Instant};

use andon_board::{Asked, Board, Kept, Was};
use andon_host::role::Cycle;
use andon_ipc::{Port, Reader, UtcTime};
use andon_journal::{History, JournalError};
use shm_schemas::{Audit, AuditKind, MessageId};

use super::super::audit::Auditor;
use crate::confirmed::{self, Confirmed};
use crate::role::RoleError;

/// A journal that runs writes within one turn.
const PATIENCE: Duration = Duration::from_secs(5);

/// How often it looks whether it is on disk.
const LOOK: Duration = Duration::from_millis(30);

/// What is looked for in the journal at once. What is more waits for the next turn.
const AT_ONCE: usize = 4;

/// All that somebody has asked for and not been answered.
pub(super) struct Confirmer {
    path: PathBuf,
    auditor: Auditor,
    said: Reader<Audit>,
    /// Those that nobody has looked for yet.
    waiting: Vec<Asked>,
    open: Vec<(Asked, Stage)>,
}

/// How far it is.
enum Stage {
    /// Its verdict is looked for.
    Find(JoinHandle<Result<Found, JournalError>>),
    /// The journal has been told.
    Keep(JoinHandle<bool>),
}

/// What the journal has of a verdict.
enum Found {
    Nothing,
    /// What is to be said of it, and the journal to see it in.
    Row(Confirmed, History),
    /// The same was said last.
    Said,
}

impl Confirmer {
    pub(super) fn new(path: PathBuf, auditor: Auditor, said: Reader<Audit>) -> Self {
        Self { path, auditor, said, waiting: Vec::new(), open: Vec::new() }
    }

    pub(super) fn ports(&mut self) -> [&mut dyn Port; 2] {
        [self.auditor.port(), &mut self.said]
    }

    /// Goes on with each as far as it comes without waiting.
    pub(super) fn turn(&mut self, cycle: &mut Cycle<'_>, board: &mut Board) -> Result<(), RoleError> {
        self.hear(board)?;
        self.waiting.extend(board.take_asked());
        while self.open.len() < AT_ONCE && !self.waiting.is_empty() {
            let asked = self.waiting.remove(0);
            let (path, verdict, was) = (self.path.clone(), asked.verdict, asked.was);
            match Builder::new().name("find".into()).spawn(move || find(&path, verdict, was)) {
                Ok(finding) => self.open.push((asked, Stage::Find(finding))),
                Err(_) => board.answer_asked(asked, Kept::Unkept),
            }
        }
        for (asked, stage) in std::mem::take(&mut self.open) {
            match stage {
                Stage::Find(finding) if finding.is_finished() => {
                    let found = finding.join().ok().and_then(Result::ok);
                    self.found(cycle, board, asked, found)?;
                }
                Stage::Keep(keeping) if keeping.is_finished() => {
                    let is_kept = keeping.join().unwrap_or_default();
                    board.answer_asked(asked, if is_kept { Kept::Kept } else { Kept::Unkept });
                }
                stage => self.open.push((asked, stage)),
            }
        }
        Ok(())
    }

    /// What was said here, and what was said by `andond confirm`.
    fn hear(&mut self, board: &mut Board) -> Result<(), RoleError> {
        while let Some(audit) = self.said.take()? {
            let kind = AuditKind::try_from(audit.kind).map_or("", AuditKind::name);
            if let Some(said) = Confirmed::read(kind, audit.what()) {
                board.confirmed(said.id, said.was, audit.who());
            }
        }
        Ok(())
    }

    fn found(
        &mut self,
        cycle: &mut Cycle<'_>,
        board: &mut Board,
        asked: Asked,
        found: Option<Found>,
    ) -> Result<(), RoleError> {
        match found {
            Some(Found::Row(confirmed, history)) => {
                let since_utc_ns = UtcTime::now().nanoseconds();
                let who = format!("login {}", asked.login);
                self.auditor.record(cycle, AuditKind::Confirmation, &who, &confirmed.text())?;
                let path = self.path.clone();
                let keep = move || is_kept(history, &path, since_utc_ns, &who, confirmed);
                match Builder::new().name("keep".into()).spawn(keep) {
                    Ok(keeping) => self.open.push((asked, Stage::Keep(keeping))),
                    Err(_) => board.answer_asked(asked, Kept::Unkept),
                }
            }
            Some(Found::Said) => board.answer_asked(asked, Kept::Kept),
            Some(Found::Nothing) => board.answer_asked(asked, Kept::Gone),
            None => board.answer_asked(asked, Kept::Unkept),
        }
        Ok(())
    }
}

fn find(path: &Path, verdict: MessageId, was: Was) -> Result<Found, JournalError> {
    let history = History::open_read_only(path)?;
    let Some(row) = history.row(verdict)? else { return Ok(Found::Nothing) };
    let said = confirmed::since(&history, None)?;
    let last = said.get(&verdict).map(|(confirmed, _)| confirmed.was);
    Ok(match last {
        Some(last) if last == was => Found::Said,
        _ => Found::Row(Confirmed { row, id: verdict, was }, history),
    })
}

/// Waits until the journal has it on disk.
fn is_kept(history: History, path: &Path, since_utc_ns: u64, who: &str, confirmed: Confirmed) -> bool {
    let (began, mut history) = (Instant::now(), Some(history));
    while began.elapsed() < PATIENCE {
        match history.as_ref().map(|history| confirmed::since(history, Some(since_utc_ns))) {
            Some(Ok(mut said)) => {
                if said.remove(&confirmed.id).is_some_and(|(known, by)| known == confirmed && by == who) {
                    return true;
                }
            }
            // A journal that has begun again has another log.
            _ => history = History::open_read_only(path).ok(),
        }
        sleep(LOOK);
    }
    false
}
