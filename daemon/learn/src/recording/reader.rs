//! From the bytes of a track file to frames.

use super::convention::{self, Conventions};
use super::line::{FORMAT, FrameLine, HandEntry, HeaderLine, Magic, ObjectEntry, VERSION, all};
use super::{Header, Landmarks, NamedObject, Recording};
use crate::file::{BYTE_ORDER_MARK, NotText, is_utf16};
use andon_core::capacity::{HANDS, INTERACTION_POINTS, OBJECTS};
use andon_core::input::{Frame, Hand, Object, Point, Side, is_on_bench};
use andon_core::object::ObjectShape;
use std::fmt;
use std::io::{BufRead, Read};

/// Maximum length of a line. 32 objects and two whole hands with 17 digits per number are 12 kB, and there may be unknown keys too.
const MAX_LINE_BYTES: usize = 1 << 20;

/// Maximum `t` in seconds: 30 years. A file that begins later has times since 1970, and its first frame is its beginning.
const MAX_TIME_S: f64 = 1e9;

/// A track file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{file}, line {line}: {fault}")]
pub struct TrackError {
    /// The file's name as the caller gave it.
    pub file: String,
    /// The number of the line, from 1.
    pub line: usize,
    /// What is wrong with it, in words.
    pub fault: String,
}

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
            "{}, line {}: the file ends in the middle of this line: it was not written to its end. Nothing is said of what came then; copy \
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
                return Err(TrackError { file: lines.file, line: 1, fault: "the file is empty".to_owned() });
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

    fn frame(&mut self) -> Result<Option<Frame>, String> {
        let Some(is_whole) = self.lines.next_line()? else {
            self.conventions.end()?;
            return match self.before_s {
                Some(_) => Ok(None),
                None => Err("no frame comes after the header, so there is nothing to judge: was the recording stopped at once?".to_owned()),
            };
        };
        let line = match frame_line(&self.lines.buffer) {
            Ok(Ok(line)) => line,
            // A number that is cut off is a syntax error; everything else that is cut off ends too early.
            Ok(Err(error)) if !is_whole && (error.is_eof() || error.is_syntax()) => {
                self.truncation = Some(Truncation { file: self.lines.file.clone(), line: self.lines.line });
                return Ok(None);
            }
            _ if is_header(&self.lines.buffer) => {
                return Err(
                    "another recording begins here: give each of them as a file of its own".to_owned()
                );
            }
            Ok(Err(error)) => return Err(json_words(&error)),
            Err(fault) => return Err(fault),
        };
        self.conventions.time(line.t)?;
        let origin_s = *self.origin_s.get_or_insert(if line.t > MAX_TIME_S { line.t } else { 0.0 });
        if !(0.0..=MAX_TIME_S).contains(&(line.t - origin_s)) {
            return Err(out_of_range("t", line.t, "0 to 1e9 seconds: subtract the first one from all"));
        }
        if let Some(before) = self.before_s.filter(|before| line.t <= *before) {
            return Err(format!("t is {} s after {before} s in the previous frame; t must increase", line.t));
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
    fn next_line(&mut self) -> Result<Option<bool>, String> {
        loop {
            self.buffer.clear();
            self.line += 1;
            let limit = MAX_LINE_BYTES as u64 + 1;
            let count = self.source.by_ref().take(limit).read_until(b'\n', &mut self.buffer);
            let count = count.map_err(|error| format!("the file cannot be read: {error}"))?;
            if count == 0 {
                return Ok(None);
            }
            if count > MAX_LINE_BYTES {
                return Err(format!("the line is longer than {MAX_LINE_BYTES} bytes"));
            }
            if !self.buffer.trim_ascii().is_empty() {
                return Ok(Some(self.buffer.last() == Some(&b'\n')));
            }
        }
    }

    fn error(&self, fault: String) -> TrackError {
        TrackError { file: self.file.clone(), line: self.line, fault }
    }
}

/// A frame, in which NaN is a gap as `null` is.
fn frame_line(line: &[u8]) -> Result<serde_json::Result<FrameLine>, String> {
    let read = serde_json::from_slice(line);
    let gaps = if read.is_err() { convention::without_nan(line)? } else { None };
    Ok(gaps.map_or(read, |line| serde_json::from_slice(&line)))
}

/// What is wrong with a line, which is all that the parser was given: only the column of its place says something.
fn json_words(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at line 1 column ") {
        Some((what, column)) => format!("{what}, at column {column}"),
        None => text,
    }
}

fn out_of_range(key: &str, value: f64, range: &str) -> String {
    format!("{key} is {value}; it must be in {range}")
}

fn twice(what: &str) -> String {
    format!("{what} occurs twice")
}

fn too_many(count: usize, what: &str) -> String {
    format!("there are {count} {what}; at most {OBJECTS} objects and {HANDS} hands can be followed")
}

/// What is wrong with a first line that is no JSON of a header.
fn no_header(line: &[u8], error: &serde_json::Error) -> String {
    let is_meant = line.windows(FORMAT.len()).any(|word| word == FORMAT.as_bytes());
    match convention::other_text(line) {
        Some(other) => other.to_owned(),
        None if is_meant && error.is_syntax() => json_words(error),
        None => "the header is missing; the first line must be {\"format\": \"andon.tracks\", \"version\": 1, ...}".to_owned(),
    }
}

fn is_header(line: &[u8]) -> bool {
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    serde_json::from_slice::<Magic>(line).is_ok_and(|magic| magic.format == FORMAT)
}

/// That the beginning of a file is no text in UTF-8.
fn not_text(line: &[u8]) -> Option<String> {
    if is_utf16(line) {
        return Some(NotText::Utf16.to_string());
    }
    line.contains(&0).then(|| NotText::Binary.to_string())
}

fn header_of(line: &[u8]) -> Result<Header, String> {
    if let Some(fault) = convention::packed(line).map(str::to_owned).or_else(|| not_text(line)) {
        return Err(fault);
    }
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    let magic: Magic = serde_json::from_slice(line).map_err(|error| no_header(line, &error))?;
    if magic.format != FORMAT {
        return Err(format!("the format is {:?}, not {FORMAT:?}", magic.format));
    }
    if magic.version != VERSION {
        return Err(format!(
            "version {} of the track format is unknown; this program reads version {VERSION}",
            magic.version
        ));
    }
    header_of_line(serde_json::from_slice(line).map_err(|error| json_words(&error))?)
}

fn header_of_line(line: HeaderLine) -> Result<Header, String> {
    // No camera is faster than the maximum, and a period is never zero nanoseconds.
    if !(line.rate_hz > 0.0 && line.rate_hz <= 10_000.0) {
        return Err(out_of_range("rate_hz", line.rate_hz, "greater than 0 and at most 10000"));
    }
    let landmarks = match line.landmarks {
        21 => Landmarks::All,
        5 => Landmarks::Five,
        other => return Err(format!("\"landmarks\" is {other}; it must be 21 or 5")),
    };
    let mut hands: Vec<Side> = Vec::new();
    for side in line.hands.iter().map(|name| Side::from(*name)) {
        if hands.contains(&side) {
            return Err(twice(&format!("the {} hand", side.name())));
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

fn objects_of(line: HeaderLine) -> Result<Vec<NamedObject>, String> {
    if line.objects.len() > OBJECTS {
        return Err(too_many(line.objects.len(), "objects"));
    }
    let mut objects: Vec<NamedObject> = Vec::new();
    for object in line.objects {
        let id = object.id;
        if id == 0 {
            return Err("an object has id 0; ids are 1 to 65535".to_owned());
        }
        if objects.iter().any(|known| known.shape.id == id) {
            return Err(twice(&format!("object {id}")));
        }
        let found = object.interaction_points.len();
        let mut interaction_points = heapless::Vec::new();
        for point in object.interaction_points.iter().take(INTERACTION_POINTS + 1) {
            convention::point(id, point)?;
            let point = point_of(point, "an interaction point")?;
            // Too many are refused below.
            let _ = interaction_points.push(point);
        }
        if !(1..=INTERACTION_POINTS).contains(&found) {
            return Err(format!(
                "object {id} has {found} interaction points; it must have 1 to {INTERACTION_POINTS}"
            ));
        }
        let name = if object.name.is_empty() { format!("object {id}") } else { object.name };
        objects.push(NamedObject {
            name,
            shape: ObjectShape { id, interaction_points, ..ObjectShape::default() },
        });
    }
    Ok(objects)
}

fn frame_of(line: &FrameLine, origin_s: f64, header: &Header) -> Result<Frame, String> {
    let captured_ns = ((line.t - origin_s) * 1e9).round() as u64;
    let mut frame = Frame { captured_ns, is_unseen: line.unseen, ..Frame::default() };
    if line.unseen {
        return Ok(frame);
    }
    for entry in &line.hands {
        let Some(hand) = hand_of(entry, header)? else { continue };
        if frame.hands.iter().any(|known| known.side == hand.side) {
            return Err(twice(&format!("the {} hand", hand.side.name())));
        }
        frame.hands.push(hand).map_err(|_| too_many(HANDS + 1, "hands"))?;
    }
    for entry in &line.objects {
        let Some(object) = object_of(entry, header)? else { continue };
        if frame.objects.iter().any(|known| known.id == object.id) {
            return Err(twice(&format!("object {}", object.id)));
        }
        frame.objects.push(object).map_err(|_| too_many(OBJECTS + 1, "objects"))?;
    }
    Ok(frame)
}

/// The hand; `None` where a landmark that the method uses was not seen.
fn hand_of(entry: &HandEntry, header: &Header) -> Result<Option<Hand>, String> {
    let side = Side::from(entry.id);
    if !header.hands.contains(&side) {
        return Err(format!("the {} hand is not in the header", side.name()));
    }
    if !(0.0..=1.0).contains(&entry.score) {
        return Err(out_of_range("score", entry.score, "0 to 1"));
    }
    let Some(landmarks) = &entry.landmarks else { return Ok(None) };
    let expected = header.landmarks.count();
    if landmarks.len() != expected {
        return Err(format!("a hand has {} landmarks; the header promises {expected}", landmarks.len()));
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
fn object_of(entry: &ObjectEntry, header: &Header) -> Result<Option<Object>, String> {
    if !header.objects.iter().any(|known| known.shape.id == entry.id) {
        return Err(format!("object {} is not in the header", entry.id));
    }
    let (Some(position), Some(orientation)) = (all(&entry.p), all(&entry.q)) else { return Ok(None) };
    let position = point_of(&position, "p")?;
    let length = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
    // Rounding to four decimals changes the length by less than 1e-3; a larger deviation means that this is no rotation.
    if !(0.99..=1.01).contains(&length) {
        return Err(format!(
            "q of object {} has length {}; a rotation is a unit quaternion [w, x, y, z]",
            entry.id, length as f32
        ));
    }
    // A quaternion of length 1, as far as `f32` can tell, is kept bit for bit. So a recording replays as it was recorded.
    let length = if (length - 1.0).abs() < f64::from(f32::EPSILON) { 1.0 } else { length };
    Ok(Some(Object { id: entry.id, position, orientation: orientation.map(|part| (part / length) as f32) }))
}

fn point_of(point: &[f64; 3], what: &'static str) -> Result<Point, String> {
    let point = point.map(|value| value as f32);
    if is_on_bench(point) {
        Ok(point)
    } else {
        Err(format!("{what} is infinite or larger than any bench; places are in metres: 100 mm is 0.1"))
    }
}
