//! From frames to the text of a track file.

use super::line::{FORMAT, FrameLine, HandEntry, HeaderLine, HeaderObject, Numbers, ObjectEntry, VERSION};
use super::{Header, Landmarks};
use andon_core::input::{Frame, Hand, Object};
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
        let t = (frame.captured_ns as f64 * 1e-3).round() / 1e6;
        line(sink, &frame_line(frame, t, rounded))?;
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
        line(&mut self.sink, &frame_line(frame, frame.captured_ns as f64 / 1e9, |value| value))
    }

    /// Flushes the sink.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
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
                interaction_points: object
                    .shape
                    .interaction_points
                    .iter()
                    .map(|point| point.map(|value| rounded(value.into())))
                    .collect(),
            })
            .collect(),
    }
}

/// A frame at this time in seconds; `number` is how its other numbers are written.
fn frame_line(frame: &Frame, t: f64, number: fn(f64) -> f64) -> FrameLine {
    let object = |object: &Object| ObjectEntry {
        id: object.id,
        p: numbers(&object.position, number),
        q: numbers(&object.orientation, number),
    };
    FrameLine {
        t,
        hands: frame.hands.iter().map(|hand| hand_entry(hand, number)).collect(),
        objects: frame.objects.iter().map(object).collect(),
        unseen: frame.is_unseen,
    }
}

fn hand_entry(hand: &Hand, number: fn(f64) -> f64) -> HandEntry {
    let [index, middle, ring] = &hand.tips;
    let landmarks = [&hand.wrist, index, &hand.middle_knuckle, middle, ring];
    HandEntry {
        id: hand.side.into(),
        score: f64::from(hand.score),
        landmarks: Some(landmarks.map(|point| numbers(point, number)).to_vec()),
    }
}

fn numbers<const N: usize>(values: &[f32; N], number: fn(f64) -> f64) -> Numbers<N> {
    Some(values.map(|value| Some(number(value.into()))))
}

fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
