//! From frames to the text of a track file.

use super::line::{FORMAT, FrameLine, HandEntry, HeaderLine, HeaderObject, ObjectEntry, SpaceName, VERSION};
use super::{Header, Landmarks};
use andon_core::input::{Frame, Hand, Space};
use std::io::{self, Write};

/// Writes a track file. A frame keeps five landmarks of a hand, so the file promises five whatever the header says.
///
/// Numbers are rounded to a micrometre and a microsecond, under what any tracker measures, to keep files small.
///
/// # Errors
/// When the sink fails.
pub fn write<'a>(
    sink: &mut impl Write,
    header: &Header,
    frames: impl IntoIterator<Item = &'a Frame>,
) -> io::Result<()> {
    line(sink, &header_line(header))?;
    for frame in frames {
        line(sink, &frame_line(frame))?;
    }
    Ok(())
}

fn line(sink: &mut impl Write, value: &impl serde::Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *sink, value)?;
    sink.write_all(b"\n")
}

fn header_line(header: &Header) -> HeaderLine {
    HeaderLine {
        format: FORMAT.to_owned(),
        version: VERSION,
        rate_hz: f64::from(header.rate_hz),
        space: match header.space {
            Space::Plane => SpaceName::Plane,
            Space::Metric => SpaceName::Metric,
        },
        landmarks: Landmarks::Five.count() as u64,
        hands: header.hands.iter().map(|side| (*side).into()).collect(),
        objects: header
            .objects
            .iter()
            .map(|object| HeaderObject {
                id: object.shape.id,
                name: object.name.clone(),
                interaction_points: object.shape.interaction_points.iter().map(rounded).collect(),
            })
            .collect(),
    }
}

fn frame_line(frame: &Frame) -> FrameLine {
    FrameLine {
        t: (frame.captured_ns as f64 * 1e-3).round() / 1e6,
        hands: frame.hands.iter().map(hand_entry).collect(),
        objects: frame
            .objects
            .iter()
            .map(|object| ObjectEntry {
                id: object.id,
                p: rounded(&object.position),
                q: rounded(&object.orientation),
            })
            .collect(),
    }
}

fn hand_entry(hand: &Hand) -> HandEntry {
    let [index, middle, ring] = &hand.tips;
    HandEntry {
        id: hand.side.into(),
        score: f64::from(hand.score),
        landmarks: [&hand.wrist, index, &hand.middle_knuckle, middle, ring].map(rounded).to_vec(),
    }
}

fn rounded<const N: usize>(values: &[f32; N]) -> [f64; N] {
    values.map(|value| (f64::from(value) * 1e6).round() / 1e6)
}
