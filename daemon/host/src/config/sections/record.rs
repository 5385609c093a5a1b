//! The section `[record]`.

use crate::config::keys::Keys;
use crate::config::value::{several, within, words};
use std::path::PathBuf;

/// What is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Nothing: no picture is stored anywhere.
    Off,
    /// A clip around each verdict that is named in `record.on`.
    Fault,
    /// Everything.
    Always,
}
words!(Mode {
    Mode::Off = "off",
    Mode::Fault = "fault",
    Mode::Always = "always",
});

/// What a clip is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// An anomaly.
    Anomaly,
    /// What could not be judged.
    NotJudged,
    /// A note: something that was not shown before and breaks no law.
    Note,
}
words!(Trigger {
    Trigger::Anomaly = "anomaly",
    Trigger::NotJudged = "not-judged",
    Trigger::Note = "note",
});

/// A polygon in the picture: its corners in pixels, x to the right and y down.
pub(crate) type Polygon = Vec<[u32; 2]>;

/// `[record]`: what is kept to be looked at again.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What is recorded.
    pub mode: Mode,
    /// The folder of the recordings; see [`crate::config::Config::recordings`].
    pub path: Option<PathBuf>,
    /// What a clip is made of.
    pub on: Vec<Trigger>,
    /// How long before a verdict its clip has pictures, s.
    pub before_s: u32,
    /// How long after it, s.
    pub after_s: u32,
    /// Memory for the pictures before a verdict, MB.
    pub memory_mb: u32,
    /// Size at which the next file begins, MB.
    pub file_mb: u32,
    /// Size of all recordings together from which on the oldest are removed, MB.
    pub keep_mb: u32,
    /// Age at which recordings are removed, by what they show, days.
    pub keep_days: u32,
    /// Quality of the pictures as JPEG.
    pub quality: u8,
    /// The size of the pictures that `bench` and `masks` are drawn on, in pixels: width and height.
    pub size: Option<[u32; 2]>,
    /// What may be seen; everything where it is empty.
    pub bench: Polygon,
    /// What may never be seen.
    pub masks: Vec<Polygon>,
}

impl Default for Record {
    fn default() -> Self {
        Self {
            mode: Mode::Off,
            path: None,
            on: vec![Trigger::Anomaly, Trigger::NotJudged, Trigger::Note],
            before_s: 10,
            after_s: 3,
            // 10 s of pictures of 1280 x 720 at 30 Hz are some 45 MB.
            memory_mb: 64,
            file_mb: 256,
            keep_mb: 4096,
            keep_days: 30,
            // Print and skin stay smooth; a higher one costs room and shows the same.
            quality: 80,
            size: None,
            bench: Vec::new(),
            masks: Vec::new(),
        }
    }
}

impl Record {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "mode",
            &mut self.mode,
            (),
            "What is recorded: nothing (off), a clip around each verdict that `on` names (fault), or everything (always). With off no picture is stored anywhere.",
        );
        k.optional(
            "path",
            &mut self.path,
            (),
            r#""/var/lib/andon/bench1.recordings""#,
            "The folder of the recordings. Without it that is /var/lib/andon/NAME.recordings, with the station's name. If it is another one, give it to the unit andon-record@NAME as ReadWritePaths.",
        );
        k.key(
            "on",
            &mut self.on,
            several(1, 3, ()),
            "Which verdicts a clip is made of: anomalies, what could not be judged, and notes on what was not shown before.",
        );
        k.key(
            "before_s",
            &mut self.before_s,
            within(1, 60, "s"),
            "How long before a verdict its clip has pictures. What was detected is kept from the start of the job on.",
        );
        k.key(
            "after_s",
            &mut self.after_s,
            within(0, 60, "s"),
            "How long after a verdict its clip has pictures. What was detected is kept to the end of the job.",
        );
        k.key(
            "memory_mb",
            &mut self.memory_mb,
            within(4, 200, "MB"),
            "Memory for the pictures before a verdict. Where it is too small for before_s, clips begin later. As much again may wait for a slow disk. With 32 MB for all other messages that is all that the role keeps.",
        );
        k.key(
            "file_mb",
            &mut self.file_mb,
            within(4, 4096, "MB"),
            "Size at which a recording ends and the next one begins.",
        );
        k.key(
            "keep_mb",
            &mut self.keep_mb,
            within(10, 10_000_000, "MB"),
            "When all recordings together grow larger, the oldest are removed. They are removed earlier where the journal may need the room.",
        );
        k.key(
            "keep_days",
            &mut self.keep_days,
            within(1, 3650, "days"),
            "Recordings are removed once all that they show is older. How old the file is does not matter.",
        );
        k.key(
            "quality",
            &mut self.quality,
            within(30, 100, "(as JPEG counts it)"),
            "Quality of the recorded pictures. A camera's own JPEG is kept as it is, unless a part of it may not be seen.",
        );
        k.optional(
            "size",
            &mut self.size,
            within(1, 8192, "pixels"),
            "[640, 480]",
            "Width and height of the pictures that `bench` and `masks` are drawn on. Where there are any, a picture of another size is recorded black.",
        );
        k.key(
            "bench",
            &mut self.bench,
            several(0, 32, within(0, 8192, "pixels")),
            "The corners of what may be seen in recorded pictures, x to the right and y down. The rest is black. Without corners all may be seen.",
        );
        k.key(
            "masks",
            &mut self.masks,
            several(0, 16, several(3, 32, within(0, 8192, "pixels"))),
            "Polygons that are black in recorded pictures, as a screen or the way behind the bench.",
        );
    }
}
