//! A track file as the recording that `perceive` plays where an outside tracker has seen instead.

use std::fs::File;
use std::io::BufReader;
use std::time::Duration;

use andon_ipc::{Loan, Node};
use andon_learn::recording::SeenTracks;
use shm_schemas::{Detections, RoleId};

use super::RoleError;
use super::cycle::Cycle;
use super::output::Output;
use super::player::{Player, Recording};
use crate::config::Config;
use crate::log::{code, log};
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let output = Output::new(node.writer()?, &[RoleId::Encode]);
    let mut player = Player::new(output, &config.camera, |_: &mut _| Tracks::open(config));
    Cycle::new(node)?.run(&mut player)
}

struct Tracks {
    reader: SeenTracks<BufReader<File>>,
}

impl Tracks {
    fn open(config: &Config) -> Result<Self, RoleError> {
        // The configuration is refused without a path for this source.
        let path = config.camera.path.clone().unwrap_or_default();
        let file =
            File::open(&path).map_err(|error| RoleError::Source(format!("{}: {error}", path.display())))?;
        let (name, blind_ms) = (path.display().to_string(), config.method.blind_ms);
        Ok(Self { reader: SeenTracks::new(&name, BufReader::new(file), blind_ms)? })
    }
}

impl Recording<Loan<Detections>> for Tracks {
    fn message_bytes(&self) -> usize {
        size_of::<Detections>()
    }

    fn interval(&self) -> Duration {
        Duration::from_secs_f32(1.0 / self.reader.header().rate_hz)
    }

    fn next(&mut self, message: &mut Loan<Detections>) -> Result<Option<Duration>, RoleError> {
        let Some(frame) = self.reader.next().transpose()? else {
            if let Some(truncation) = self.reader.truncation() {
                log!(code::TRACK_CUT_SHORT, "{truncation}");
            }
            return Ok(None);
        };
        wire::detections::write_frame(&frame, message);
        Ok(Some(Duration::from_nanos(frame.captured_ns)))
    }
}
