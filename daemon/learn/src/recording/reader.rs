//! From the bytes of a track file to frames.

use super::convention::{self, Conventions};
use super::error::{TrackError, TrackFault};
use super::line::{FORMAT, FrameLine, HandEntry, HeaderLine, Magic, ObjectEntry, VERSION, all};
use super::{Header, Landmarks, NamedObject, Recording};
use crate::file::{BYTE_ORDER_MARK, NotText, is_utf16};
use andon_core::capacity::{HANDS, OBJECTS};
use andon_core::input::{Frame, Hand, Object, Point, Side};
use andon_core::object::ObjectShape;
use std::fmt;
use std::io::{BufRead, Read};

/// Maximum length of a line. 32 objects and two whole hands with 17 digits per number are 12 kB, and there may be unknown keys too.
const MAX_LINE_BYTES: usize = 1 << 20;

/// Maximum coordinate in metres: no bench is wider than a kilometre, and the square of this is far from overflow.
const MAX_COORDINATE_M: f64 = 1000.0;

/// Maximum `t` in seconds: 30 years. A file that begins later has times since 1970, and its first frame is its beginning.
const MAX_TIME_S: f64 = 1e9;

/// The file ends in the middle of a line; it was read up to its last whole line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// The file's name as the caller gave it.
    pub file: String,
    /// The number of the incomplete line, from 1.
    pub line: usize,
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, line {}: the file ends in the middle of this line, so it was not written to its end, and nothing is said of what came then; copy \
             it again, or remove this line if no more is missing",
            self.file, self.line
        )
    }
}

/// Reads a whole track file. `file` is its name in error messages.
///
/// # Errors
/// The first line that cannot be trusted.
pub fn read(file: &str, bytes: &[u8]) -> Result<Recording, TrackError> {
    let mut reader = TrackReader::new(file, bytes)?;
    let frames = reader.by_ref().collect::<Result<Vec<_>, _>>()?;
    Ok(Recording { header: reader.header, frames, truncation: reader.truncation })
}

/// Reads a track file frame by frame, and needs the memory of one line.
#[derive(Debug)]
pub struct TrackReader<R> {
    lines: Lines<R>,
    header: Header,
    /// `t` of the beginning: 0, or that of the first frame where times are since 1970.
    origin_s: Option<f64>,
    before_s: Option<f64>,
    conventions: Conventions,
    truncation: Option<Truncation>,
    ended: bool,
}

impl<R: BufRead> TrackReader<R> {
    /// Reads the header. `file` is the file's name in error messages.
    ///
    /// # Errors
    /// A missing header, an unknown format or version, a number out of range.
    pub fn new(file: &str, source: R) -> Result<Self, TrackError> {
        let mut lines = Lines { source, file: file.to_owned(), line: 0, buffer: Vec::new() };
        let header = match lines.next_line() {
            Ok(Some(_)) => header_of(&lines.buffer).map_err(|fault| lines.error(fault))?,
            Ok(None) => {
                return Err(TrackError { file: file.to_owned(), line: 1, fault: TrackFault::Empty });
            }
            Err(fault) => return Err(lines.error(not_text(&lines.buffer).unwrap_or(fault))),
        };
        let conventions = Conventions::new(f64::from(header.rate_hz), header.space);
        Ok(Self {
            lines,
            header,
            origin_s: None,
            before_s: None,
            conventions,
            truncation: None,
            ended: false,
        })
    }

    /// The first line.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Where the file was cut off; `None` until its end was reached, and if it is whole.
    pub fn truncation(&self) -> Option<&Truncation> {
        self.truncation.as_ref()
    }

    fn frame(&mut self) -> Result<Option<Frame>, TrackFault> {
        let Some(is_whole) = self.lines.next_line()? else {
            self.conventions.end()?;
            return if self.before_s.is_some() { Ok(None) } else { Err(TrackFault::NoFrames) };
        };
        let line = match frame_line(&self.lines.buffer) {
            Ok(line) => line,
            // A number that is cut off is a syntax error; everything else that is cut off ends too early.
            Err(TrackFault::Json(error)) if !is_whole && (error.is_eof() || error.is_syntax()) => {
                self.truncation = Some(Truncation { file: self.lines.file.clone(), line: self.lines.line });
                return Ok(None);
            }
            Err(_) if is_header(&self.lines.buffer) => return Err(TrackFault::SecondHeader),
            Err(fault) => return Err(fault),
        };
        self.conventions.time(line.t)?;
        let origin_s = *self.origin_s.get_or_insert(if line.t > MAX_TIME_S { line.t } else { 0.0 });
        if !(0.0..=MAX_TIME_S).contains(&(line.t - origin_s)) {
            let range = "0 to 1e9 seconds: subtract the first one from all";
            return Err(TrackFault::Range("t", line.t, range));
        }
        if let Some(before) = self.before_s.filter(|before| line.t <= *before) {
            return Err(TrackFault::Time(line.t, before));
        }
        self.before_s = Some(line.t);
        let frame = frame_of(&line, origin_s, &self.header)?;
        self.conventions.frame(&frame.hands, &frame.objects)?;
        Ok(Some(frame))
    }
}

impl<R: BufRead> Iterator for TrackReader<R> {
    type Item = Result<Frame, TrackError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let frame = self.frame().map_err(|fault| self.lines.error(fault)).transpose();
        self.ended = !matches!(frame, Some(Ok(_)));
        frame
    }
}

/// Reads lines of bounded length, and counts them.
#[derive(Debug)]
struct Lines<R> {
    source: R,
    file: String,
    line: usize,
    buffer: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    /// Fills the buffer with the next line that is not blank. Returns whether it is whole, that is ended by `\n`; `None` at the end.
    fn next_line(&mut self) -> Result<Option<bool>, TrackFault> {
        loop {
            self.buffer.clear();
            self.line += 1;
            let limit = MAX_LINE_BYTES as u64 + 1;
            let count = self.source.by_ref().take(limit).read_until(b'\n', &mut self.buffer)?;
            if count == 0 {
                return Ok(None);
            }
            if count > MAX_LINE_BYTES {
                return Err(TrackFault::LongLine(MAX_LINE_BYTES));
            }
            if !self.buffer.trim_ascii().is_empty() {
                return Ok(Some(self.buffer.last() == Some(&b'\n')));
            }
        }
    }

    fn error(&self, fault: TrackFault) -> TrackError {
        TrackError { file: self.file.clone(), line: self.line, fault }
    }
}

/// A frame, in which NaN is a gap as `null` is.
fn frame_line(line: &[u8]) -> Result<FrameLine, TrackFault> {
    serde_json::from_slice(line).or_else(|error| match convention::without_nan(line)? {
        Some(line) => Ok(serde_json::from_slice(&line)?),
        None => Err(error.into()),
    })
}

/// What is wrong with a first line that is no JSON of a header.
fn no_header(line: &[u8], error: serde_json::Error) -> TrackFault {
    let is_meant = line.windows(FORMAT.len()).any(|word| word == FORMAT.as_bytes());
    match convention::other_text(line) {
        Some(other) => TrackFault::OtherText(other),
        None if is_meant && error.is_syntax() => error.into(),
        None => TrackFault::NoHeader,
    }
}

fn is_header(line: &[u8]) -> bool {
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    serde_json::from_slice::<Magic>(line).is_ok_and(|magic| magic.format == FORMAT)
}

/// That the beginning of a file is no text in UTF-8.
fn not_text(line: &[u8]) -> Option<TrackFault> {
    if is_utf16(line) {
        return Some(NotText::Utf16.into());
    }
    line.contains(&0).then_some(TrackFault::NotText(NotText::Binary))
}

fn header_of(line: &[u8]) -> Result<Header, TrackFault> {
    if let Some(fault) = convention::packed(line).map(TrackFault::OtherText).or_else(|| not_text(line)) {
        return Err(fault);
    }
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    let magic: Magic = serde_json::from_slice(line).map_err(|error| no_header(line, error))?;
    if magic.format != FORMAT {
        return Err(TrackFault::Format(magic.format));
    }
    if magic.version != VERSION {
        return Err(TrackFault::Version(magic.version));
    }
    header_of_line(serde_json::from_slice(line)?)
}

fn header_of_line(line: HeaderLine) -> Result<Header, TrackFault> {
    // No camera is faster than the maximum, and a period is never zero nanoseconds.
    if !(line.rate_hz > 0.0 && line.rate_hz <= 10_000.0) {
        return Err(TrackFault::Range("rate_hz", line.rate_hz, "greater than 0 and at most 10000"));
    }
    let landmarks = match line.landmarks {
        21 => Landmarks::All,
        5 => Landmarks::Five,
        other => return Err(TrackFault::LandmarkCount(other)),
    };
    let mut hands: Vec<Side> = Vec::new();
    for side in line.hands.iter().map(|name| Side::from(*name)) {
        if hands.contains(&side) {
            return Err(TrackFault::Twice(format!("the {} hand", side.name())));
        }
        hands.push(side);
    }
    Ok(Header {
        rate_hz: line.rate_hz as f32,
        space: line.space,
        hands,
        landmarks,
        objects: objects_of(line)?,
    })
}

fn objects_of(line: HeaderLine) -> Result<Vec<NamedObject>, TrackFault> {
    if line.objects.len() > OBJECTS {
        return Err(TrackFault::Full("objects", line.objects.len()));
    }
    let mut objects: Vec<NamedObject> = Vec::new();
    for object in line.objects {
        let id = object.id;
        if id == 0 {
            return Err(TrackFault::ZeroId);
        }
        if objects.iter().any(|known| known.shape.id == id) {
            return Err(TrackFault::Twice(format!("object {id}")));
        }
        let found = object.interaction_points.len();
        let mut interaction_points = heapless::Vec::new();
        for point in &object.interaction_points {
            convention::point(id, point)?;
            interaction_points
                .push(point_of(point, "an interaction point")?)
                .map_err(|_| TrackFault::InteractionPoints(id, found))?;
        }
        if interaction_points.is_empty() {
            return Err(TrackFault::InteractionPoints(id, found));
        }
        let name = if object.name.is_empty() { format!("object {id}") } else { object.name };
        objects.push(NamedObject {
            name,
            shape: ObjectShape { id, interaction_points, ..ObjectShape::default() },
        });
    }
    Ok(objects)
}

fn frame_of(line: &FrameLine, origin_s: f64, header: &Header) -> Result<Frame, TrackFault> {
    let captured_ns = ((line.t - origin_s) * 1e9).round() as u64;
    let mut frame = Frame { captured_ns, is_unseen: line.unseen, ..Frame::default() };
    if line.unseen {
        return Ok(frame);
    }
    for entry in &line.hands {
        let Some(hand) = hand_of(entry, header)? else { continue };
        if frame.hands.iter().any(|known| known.side == hand.side) {
            return Err(TrackFault::Twice(format!("the {} hand", hand.side.name())));
        }
        frame.hands.push(hand).map_err(|_| TrackFault::Full("hands", HANDS + 1))?;
    }
    for entry in &line.objects {
        let Some(object) = object_of(entry, header)? else { continue };
        if frame.objects.iter().any(|known| known.id == object.id) {
            return Err(TrackFault::Twice(format!("object {}", object.id)));
        }
        frame.objects.push(object).map_err(|_| TrackFault::Full("objects", OBJECTS + 1))?;
    }
    Ok(frame)
}

/// The hand; `None` where a landmark that the method uses was not seen.
fn hand_of(entry: &HandEntry, header: &Header) -> Result<Option<Hand>, TrackFault> {
    let side = Side::from(entry.id);
    if !header.hands.contains(&side) {
        return Err(TrackFault::UnknownHand(side.name()));
    }
    if !(0.0..=1.0).contains(&entry.score) {
        return Err(TrackFault::Range("score", entry.score, "0 to 1"));
    }
    let Some(landmarks) = &entry.landmarks else { return Ok(None) };
    let expected = header.landmarks.count();
    if landmarks.len() != expected {
        return Err(TrackFault::Landmarks(landmarks.len(), expected));
    }
    // All landmarks are checked, including those that the method does not use: a tracker that writes nonsense is not trusted.
    for point in landmarks.iter().filter_map(all) {
        point_of(&point, "a landmark")?;
    }
    let used = header.landmarks.indices().map(|index| all(&landmarks[index]));
    let [Some(wrist), Some(middle_knuckle), Some(index), Some(middle), Some(ring)] =
        used.map(|point| point.map(|point| point.map(|value| value as f32)))
    else {
        return Ok(None);
    };
    Ok(Some(Hand { side, score: entry.score as f32, wrist, middle_knuckle, tips: [index, middle, ring] }))
}

/// The object; `None` where it was not seen.
fn object_of(entry: &ObjectEntry, header: &Header) -> Result<Option<Object>, TrackFault> {
    if !header.objects.iter().any(|known| known.shape.id == entry.id) {
        return Err(TrackFault::UnknownObject(entry.id));
    }
    let (Some(position), Some(orientation)) = (all(&entry.p), all(&entry.q)) else { return Ok(None) };
    let position = point_of(&position, "p")?;
    let length = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
    // Rounding to four decimals changes the length by less than 1e-3; a larger deviation means that this is no rotation.
    if !(0.99..=1.01).contains(&length) {
        return Err(TrackFault::Quaternion(entry.id, length as f32));
    }
    // A quaternion of length 1, as far as `f32` can tell, is kept bit for bit, so that a recording replays as it was recorded.
    let length = if (length - 1.0).abs() < f64::from(f32::EPSILON) { 1.0 } else { length };
    Ok(Some(Object { id: entry.id, position, orientation: orientation.map(|part| (part / length) as f32) }))
}

fn point_of(point: &[f64; 3], what: &'static str) -> Result<Point, TrackFault> {
    if point.iter().all(|value| value.abs() <= MAX_COORDINATE_M) {
        Ok(point.map(|value| value as f32))
    } else {
        Err(TrackFault::NotFinite(what))
    }
}
