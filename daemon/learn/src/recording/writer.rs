//! From frames to the text of a track file.

use super::line::{FORMAT, FrameLine, HandEntry, HeaderLine, HeaderObject, ObjectEntry, VERSION, seen};
use super::{Header, Landmarks};
use andon_core::input::{Frame, Hand};
use std::io::{self, Write};

/// Writes a track file. A frame holds five landmarks per hand, so the file promises five landmarks whatever the header says.
///
/// To keep files small, numbers are rounded to a micrometre and a microsecond, which is finer than any tracker measures.
///
/// # Errors
/// If the sink fails.
pub fn write<'a>(
    sink: &mut impl Write,
    header: &Header,
    frames: impl IntoIterator<Item = &'a Frame>,
) -> io::Result<()> {
    line(sink, &header_line(header))?;
    for frame in frames {
        line(sink, &frame_line(frame, &Numbers::Rounded))?;
    }
    Ok(())
}

/// Writes a track file frame by frame, with every bit of its numbers. Each frame is read back as it was written, as long as its time is less than a
/// month.
#[derive(Debug)]
pub struct TrackWriter<W> {
    sink: W,
}

impl<W: Write> TrackWriter<W> {
    /// Writes the header; see [`write()`].
    ///
    /// # Errors
    /// If the sink fails.
    pub fn new(mut sink: W, header: &Header) -> io::Result<Self> {
        line(&mut sink, &header_line(header))?;
        Ok(Self { sink })
    }

    /// Writes a frame. Its time must be later than the one before it.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn frame(&mut self, frame: &Frame) -> io::Result<()> {
        line(&mut self.sink, &frame_line(frame, &Numbers::Exact))
    }

    /// Flushes the sink.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

enum Numbers {
    Rounded,
    Exact,
}

impl Numbers {
    fn time_s(&self, ns: u64) -> f64 {
        match self {
            Self::Rounded => (ns as f64 * 1e-3).round() / 1e6,
            Self::Exact => ns as f64 / 1e9,
        }
    }

    fn of<const N: usize>(&self, values: &[f32; N]) -> [f64; N] {
        match self {
            Self::Rounded => rounded(values),
            Self::Exact => values.map(f64::from),
        }
    }
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
        space: header.space,
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

fn frame_line(frame: &Frame, numbers: &Numbers) -> FrameLine {
    FrameLine {
        t: numbers.time_s(frame.captured_ns),
        hands: frame.hands.iter().map(|hand| hand_entry(hand, numbers)).collect(),
        objects: frame
            .objects
            .iter()
            .map(|object| ObjectEntry {
                id: object.id,
                p: seen(numbers.of(&object.position)),
                q: seen(numbers.of(&object.orientation)),
            })
            .collect(),
        unseen: frame.is_unseen,
    }
}

fn hand_entry(hand: &Hand, numbers: &Numbers) -> HandEntry {
    let [index, middle, ring] = &hand.tips;
    HandEntry {
        id: hand.side.into(),
        score: f64::from(hand.score),
        landmarks: Some(
            [&hand.wrist, index, &hand.middle_knuckle, middle, ring]
                .map(|point| seen(numbers.of(point)))
                .to_vec(),
        ),
    }
}

fn rounded<const N: usize>(values: &[f32; N]) -> [f64; N] {
    values.map(|value| (f64::from(value) * 1e6).round() / 1e6)
}
