//! Opens a `.bag` recording.

use std::fs::File;
use std::path::Path;

use realsense_rust::kind::Rs2StreamKind;
use realsense_rust::stream_profile::StreamProfile;

use super::library::Api;
use super::picture::Optics;
use super::playback::Playback;
use super::player::Player;
use super::{Kind, Source};
use crate::Error;

pub(super) fn open(api: Api, file: &Path, depth: bool) -> Result<Source, Error> {
    let none = |detail: String| Error::NoRecording { file: file.into(), detail };
    // The writer of a pipe would be waited for, and a device has no end.
    if file.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return Err(none("it is a pipe or a device, and a file is needed".to_owned()));
    }
    // The SDK notices a missing file late and reports it in terms of its own.
    File::open(file).map_err(|error| none(error.to_string()))?;
    let bad = |detail: String| Error::recording(file, depth, detail);
    let player = Player::open(api, file).map_err(bad)?;
    let kinds = [("colour", Rs2StreamKind::Color), ("depth", Rs2StreamKind::Depth)];
    let kinds = &kinds[..=usize::from(depth)];
    let (mut sensors, mut streams) = (Vec::new(), Vec::<StreamProfile>::new());
    for sensor in player.sensors().map_err(bad)? {
        let mut played = Vec::new();
        for recorded in sensor.streams().map_err(bad)? {
            let stream = StreamProfile::try_from(recorded).map_err(|error| bad(error.to_string()))?;
            let is_wanted = kinds.iter().any(|(_, kind)| *kind == stream.kind());
            if is_wanted && streams.iter().all(|known| known.kind() != stream.kind()) {
                streams.push(stream);
                played.push(recorded);
            }
        }
        if !played.is_empty() {
            sensor.open(played).map_err(bad)?;
            sensors.push(sensor);
        }
    }
    for (name, kind) in kinds {
        if streams.iter().all(|stream| stream.kind() != *kind) {
            return Err(bad(format!("it has no {name} stream")));
        }
    }
    let optics = Optics::read(&streams)?;
    let colour = streams.iter().find(|stream| stream.kind() == Rs2StreamKind::Color);
    let rate_hz = colour.and_then(|colour| u32::try_from(colour.framerate()).ok()).unwrap_or(0);
    let playback = Playback::start(player, sensors, depth.then_some(rate_hz), file).map_err(bad)?;
    Ok(Source { kind: Kind::Recording(playback), optics, last_number: None })
}
