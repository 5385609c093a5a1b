//! A line that is recorded, and the recordings that it leaves.

use super::{Line, Watcher};
use andon_record::{End, Item, ReadError, RecordingReader, Topic, store};
use rustix::process::Signal;
use std::path::{Path, PathBuf};

impl Line {
    /// Lets the station record in this mode into a folder of its own, which is returned.
    pub fn record(&self, mode: &str) -> PathBuf {
        let path = self.path("recordings");
        let text = format!("[record]\nmode = {mode:?}\npath = {path:?}\n\n[journal]");
        self.reconfigure("[journal]", &text);
        path
    }

    /// Starts every role, the recorder first: what it receives is everything.
    pub fn launch_recorded(&mut self) -> Watcher {
        self.start("steward");
        let watcher = Watcher::join(&self.station);
        self.start("record");
        self.wait_for_log("record", "AND-601", "");
        self.start_all_but(&["steward"]);
        watcher
    }

    /// Stops every role along the data path, the recorder and at last the steward. How those ended that did not end with success.
    pub fn stop_recorded(&mut self) -> Vec<String> {
        let mut failures = self.stop_all_but_steward();
        self.role("record").signal(Signal::TERM);
        let status = self.role("record").wait();
        if !status.success() {
            failures.push(format!("record: {status}: {}", self.log("record")));
        }
        failures.extend(self.stop());
        failures
    }

    /// Its recordings, the oldest first.
    pub fn recordings(&self) -> Vec<PathBuf> {
        let found = store::recordings(&self.path("recordings")).unwrap();
        found.into_iter().map(|recording| recording.path).collect()
    }
}

/// How many detections a recording holds, from its beginning to its end. One that was killed before its first second may have nothing that is whole.
///
/// # Errors
/// What is wrong with it: it does not open, or it ends in the middle, so that nobody has completed it.
pub fn detections_in(recording: &Path) -> Result<usize, String> {
    let mut reader = match RecordingReader::open(recording) {
        Ok(reader) => reader,
        Err(ReadError::Empty { .. } | ReadError::Short { .. } | ReadError::Cut { .. }) => return Ok(0),
        Err(error) => return Err(error.to_string()),
    };
    let of_detections = Topic::of_name("/raw/detections");
    let mut count = 0;
    while let Some(item) = reader.next_item().map_err(|error| error.to_string())? {
        count += usize::from(matches!(item, Item::Entry(entry) if Some(entry.topic) == of_detections));
    }
    match reader.end() {
        End::Complete => Ok(count),
        end => Err(format!("{}: {end:?}", recording.display())),
    }
}
