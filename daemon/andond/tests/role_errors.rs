//! Every error that ends a role has its code in the log and its exit code. One test, because the newest code belongs to the
//! whole process.

#![allow(clippy::unwrap_used)]

use andon_board::Tables;
use andon_host::exit::Code;
use andon_host::log::last_error;
use andon_host::role::{CycleError, Failure as _};
use andon_ipc::{Channel, Error as Ipc};
use andon_journal::JournalError;
use andon_learn::job_file::JobFile;
use andon_learn::recording::{TrackReader, Truncation};
use andon_perception::bench::CalibrationError;
use andon_perception::{PerceptionError, RuntimeFile};
use andond::compatibility::Misfit;
use andond::perception::SetupError;
use andond::role::RoleError;
use std::io::{Error, ErrorKind};
use std::path::PathBuf;
use std::time::Duration;

fn io() -> Error {
    ErrorKind::Other.into()
}

fn missing(what: RuntimeFile) -> RoleError {
    SetupError::from(PerceptionError::Missing { what, path: PathBuf::new() }).into()
}

fn layout_mismatch() -> Ipc {
    let [ours, theirs, members] = [const { String::new() }; 3];
    Ipc::LayoutMismatch { channel: Channel::Verdict, ours, theirs, members }
}

fn transport() -> Ipc {
    Ipc::Transport { channel: Channel::Verdict, what: "opening it", why: String::new() }
}

#[test]
fn every_error_of_a_role_has_its_code_and_its_exit_code() {
    let station = || "bench1".to_owned();
    let (root, lock) = (PathBuf::new(), PathBuf::new());
    let address = ([127, 0, 0, 1], 502).into();
    let errors: [(RoleError, u32, Code); 27] = [
        (RoleError::Source(String::new()), 108, Code::Fault),
        (TrackReader::new("empty.tracks.jsonl", &b""[..]).err().unwrap().into(), 108, Code::Configuration),
        (
            RoleError::CutShort(Truncation { file: "cut.tracks.jsonl".to_owned(), line: 7 }),
            210,
            Code::Configuration,
        ),
        (missing(RuntimeFile::PalmModel), 205, Code::Configuration),
        (missing(RuntimeFile::LandmarkModel), 205, Code::Configuration),
        (missing(RuntimeFile::OnnxRuntime), 206, Code::Configuration),
        (SetupError::from(CalibrationError::Mirrored).into(), 208, Code::Configuration),
        (JobFile::parse("job.toml", b"").unwrap_err().into(), 302, Code::Configuration),
        (RoleError::UnreadJob { path: PathBuf::new(), source: io() }, 302, Code::Configuration),
        (
            RoleError::UnfitJob { path: PathBuf::new(), misfit: Misfit::Constant("bins") },
            302,
            Code::Configuration,
        ),
        (JournalError::Export(io()).into(), 402, Code::Fault),
        (JournalError::Locked { path: PathBuf::new(), waiting: 0 }.into(), 403, Code::Fault),
        (JournalError::Newer { path: PathBuf::new(), found: 2, known: 1 }.into(), 404, Code::Configuration),
        (JournalError::Removed { path: PathBuf::new() }.into(), 407, Code::Fault),
        (JournalError::PutAside { path: PathBuf::new(), source: io() }.into(), 408, Code::Fault),
        (andon_plc::modbus::ServeError::Bind { address, source: io() }.into(), 506, Code::Fault),
        (Ipc::NoRoom { free_mib: 1, needed_mib: 2 }.into(), 603, Code::Fault),
        (Ipc::StewardRunning { station: station(), lock }.into(), 604, Code::Fault),
        (
            Ipc::NoSteward { station: station(), channel: Channel::Verdict, waited_ms: 1 }.into(),
            605,
            Code::Fault,
        ),
        (Ipc::RootVanished { root }.into(), 606, Code::Fault),
        (layout_mismatch().into(), 607, Code::Fault),
        (CycleError::NoProgress(Duration::ZERO).into(), 612, Code::NoProgress),
        (transport().into(), 613, Code::Fault),
        (RoleError::Start { path: String::new(), source: io() }, 615, Code::Fault),
        (RoleError::Metrics { address, source: io() }, 619, Code::Fault),
        (RoleError::Board { address, source: io() }, 622, Code::Fault),
        (Tables::shipped().must_have("xx").unwrap_err().into(), 623, Code::Configuration),
    ];
    for (error, code, exit) in errors {
        assert_eq!((error.report(), last_error()), (exit, code), "{error}");
    }
    let root = Ipc::RootNotAbsolute { root: PathBuf::new() };
    assert_eq!((RoleError::from(root).report(), last_error()), (Code::Configuration, 801));
}
