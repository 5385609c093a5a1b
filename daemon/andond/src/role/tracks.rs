//! A track file as the recording that `perceive` plays where an outside tracker has seen instead.

use std::fs::File;
use std::io::BufReader;
use std::time::Duration;

use andon_host::config::Config;
use andon_host::role::{Cycle, Output, Player, Recording};
use andon_ipc::{Loan, Node};
use andon_learn::file;
use andon_learn::recording::SeenTracks;
use shm_schemas::{Detections, RoleId};

use super::RoleError;
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let output = Output::new(node.writer()?, &[RoleId::Encode]);
    let mut player = Player::new(output, &config.camera, |_: &mut _| Tracks::open(config));
    Cycle::new(node)?.run(&mut player)
}

struct Tracks {
    reader: SeenTracks<BufReader<File>>,
    /// The time of the first frame, which other trackers do not begin with zero.
    first_ns: Option<u64>,
}

impl Tracks {
    fn open(config: &Config) -> Result<Self, RoleError> {
        // The configuration is refused without a path for this source.
        let path = config.camera.path.clone().unwrap_or_default();
        let file =
            file::open(&path).map_err(|error| RoleError::Source(format!("{}: {error}", path.display())))?;
        let (name, blind_ms) = (path.display().to_string(), config.method.blind_ms);
        Ok(Self { reader: SeenTracks::new(&name, BufReader::new(file), blind_ms)?, first_ns: None })
    }
}

impl Recording<Loan<Detections>> for Tracks {
    type Error = RoleError;

    fn message_bytes(&self) -> usize {
        size_of::<Detections>()
    }

    fn interval(&self) -> Duration {
        Duration::from_secs_f32(1.0 / self.reader.header().rate_hz)
    }

    fn next(&mut self, message: &mut Loan<Detections>) -> Result<Option<Duration>, RoleError> {
        let Some(frame) = self.reader.next().transpose()? else {
            // That it is at its end is not known where it is cut: nothing may be said of the end then.
            return self.reader.truncation().map_or(Ok(None), |cut| Err(RoleError::CutShort(cut.clone())));
        };
        wire::detections::write_frame(&frame, message);
        let first_ns = *self.first_ns.get_or_insert(frame.captured_ns);
        Ok(Some(Duration::from_nanos(frame.captured_ns - first_ns)))
    }
}
