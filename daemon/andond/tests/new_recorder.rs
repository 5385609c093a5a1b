//! What a role takes that records: one that writes what the line sees to a track file, which reads back as it was sent.

#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_host::role::{Cycle, CycleError, Ending, Failure, Role, Turn, run_with};
use andon_ipc::{Limits, Node, Port, Reader, Station, Steward, Stop};
use andon_learn::recording::read;
use andond::recorder::{Recorder, Unwritten, header};
use andond::wire;
use rustix::process::{Signal, getpid, kill_process};
use shm_schemas::{Detections, RoleId, flag};
use std::fs::File;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

/// For whatever must happen sooner or later; only a test that fails waits for so long.
const PATIENCE: Duration = Duration::from_secs(60);

/// The example: all that such a role has to write by itself.
struct Keeps {
    detections: Reader<Detections>,
    recorder: Recorder,
    report: Sender<u64>,
}

/// Why it ends.
#[derive(Debug, thiserror::Error)]
enum KeepsError {
    #[error(transparent)]
    Cycle(#[from] CycleError),
    #[error(transparent)]
    Unwritten(#[from] Unwritten),
}

impl Failure for KeepsError {
    fn ending(&self) -> Option<Ending> {
        match self {
            Self::Cycle(error) => error.ending(),
            Self::Unwritten(_) => {
                Some((&andon_host::log::code::DISK_FULL, andon_host::log::Remedy::InMessage, Code::Fault))
            }
        }
    }

    fn is_lasting(&self) -> bool {
        matches!(self, Self::Cycle(error) if error.is_lasting())
    }
}

impl Role for Keeps {
    type Error = KeepsError;
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![&mut self.detections]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, KeepsError> {
        let Some(seen) = cycle.take(&mut self.detections)? else { return Ok(Turn::Idle) };
        self.recorder.write(wire::detections::to_core(&seen))?;
        let _ = self.report.send(self.recorder.frames());
        Ok(Turn::Stepped)
    }

    fn stop(&mut self, _cycle: &mut Cycle<'_>) -> Result<(), KeepsError> {
        Ok(self.recorder.finish()?)
    }
}

#[test]
fn a_role_of_a_few_lines_records_what_the_line_sees() {
    // Under /tmp whatever TMPDIR says: the path must be short.
    let folder = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
    let path = folder.path().join("keeps.toml");
    let text = format!(
        "[station]\nname = \"keeps\"\nroot = {:?}\n[[objects]]\nid = 1\nname = \"cup\"\nmarker_side_m = 0.03\n",
        folder.path()
    );
    std::fs::write(&path, text).unwrap();
    let config = Config::load(&[path]).unwrap();
    let station = Station::under("keeps", &config.root()).unwrap();
    let _steward = Steward::create(&station, Limits { frame_bytes: 4096 }).unwrap();
    let node = Node::open(&station, RoleId::Perceive, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut sent = node.writer::<Detections>().unwrap();

    let out = folder.path().join("run.tracks.jsonl");
    let (report, frames) = channel();
    let role = std::thread::spawn({
        let out = out.clone();
        move || {
            run_with(&config, RoleId::Tool, |node: &Node| {
                let recorder = Recorder::new(File::create(&out).unwrap(), &out, header(&config))?;
                let detections = node.reader().map_err(CycleError::from)?;
                Cycle::new(node)?.run(&mut Keeps { detections, recorder, report })
            })
        }
    });
    // The reader may come up after the first of them: the channel keeps one.
    let until = Instant::now() + PATIENCE;
    let (mut written, mut time) = (0, 0);
    while written < 5 {
        let mut message = sent.loan().unwrap();
        time += 33_333_333;
        message.source_ns = time;
        message.objects_len = 1;
        (message.objects[0].id, message.objects[0].flags) = (1, flag::SEEN);
        message.objects[0].orientation = [1.0, 0.0, 0.0, 0.0];
        sent.send(message).unwrap();
        node.wait(&mut [&mut sent], Duration::from_millis(20)).unwrap();
        written = frames.try_iter().last().unwrap_or(written);
        assert!(Instant::now() < until, "nothing is recorded");
    }
    kill_process(getpid(), Signal::TERM).unwrap();
    assert_eq!(role.join().unwrap(), Code::Stopped);
    let recording = read("run", std::fs::read(&out).unwrap().as_slice()).unwrap();
    assert!(recording.frames.len() >= 5);
    assert!(recording.frames.iter().all(|frame| frame.objects.iter().any(|object| object.id == 1)));
}
