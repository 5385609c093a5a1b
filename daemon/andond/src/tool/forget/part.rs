//! Which recordings show the work on a part. A verdict comes when the work is over, and its recording may have begun in the middle of the work. So
//! recordings before it may show the part as well, and so may one whose verdict was never sent.

use std::path::Path;

use andon_ipc::Channel;
use andon_record::store::Recording;
use andon_record::{Entry, Item, ReadError, RecordingReader, Topic};
use shm_schemas::{JudgePhase, Judging, PartId, Verdict, from_bytes};

/// A moment before a job and after it the part lies on the bench already, and still.
const AROUND_NS: u64 = 2_000_000_000;

/// From when to when, nanoseconds since 1970 UTC.
type Span = (u64, u64);

/// Those that show the part: by a verdict, by its job that was running, or by the time in which that went on.
pub(super) fn showing(recordings: Vec<Recording>, part: &str) -> Vec<Recording> {
    let shown: Vec<Shown> = recordings.iter().map(|recording| Shown::of(recording, part)).collect();
    let jobs: Vec<Span> = shown.iter().flat_map(|shown| shown.jobs.iter().copied()).collect();
    let is_meant = |shown: &Shown| shown.has_part || shown.is_within(&jobs);
    let meant = recordings.into_iter().zip(&shown).filter(|(_, shown)| is_meant(shown));
    meant.map(|(recording, _)| recording).collect()
}

/// What a recording shows of a part.
#[derive(Debug, Default, PartialEq)]
struct Shown {
    /// It says itself that the part was worked on.
    has_part: bool,
    /// When jobs on the part went on, as their verdicts say; it may have been before this recording.
    jobs: Vec<Span>,
    /// From the first picture to the last.
    seen: Option<Span>,
}

impl Shown {
    fn of(recording: &Recording, part: &str) -> Self {
        let mut shown = Self::default();
        // What cannot be read shows what its index says.
        let _ = shown.read(&recording.path, part);
        shown.has_part |= recording.index.verdicts.iter().any(|verdict| verdict.part == part);
        shown
    }

    fn read(&mut self, path: &Path, part: &str) -> Result<(), ReadError> {
        let mut reader = RecordingReader::open(path)?;
        while let Some(item) = reader.next_item()? {
            if let Item::Entry(entry) = item {
                self.take(&entry, part);
            }
        }
        Ok(())
    }

    fn take(&mut self, entry: &Entry, part: &str) {
        let is = |id: &PartId| !id.is_none() && id.text() == part;
        match entry.topic {
            Topic::Picture | Topic::Raw(Channel::Detections) => {
                let (first, last) = self.seen.get_or_insert((entry.sent_ns, entry.sent_ns));
                (*first, *last) = ((*first).min(entry.sent_ns), (*last).max(entry.sent_ns));
            }
            Topic::Raw(Channel::Verdict) => {
                if let Some(verdict) = from_bytes::<Verdict>(&entry.data).filter(|verdict| is(&verdict.part))
                {
                    self.has_part = true;
                    self.jobs.push(span(&verdict));
                }
            }
            Topic::Raw(Channel::Judging) => {
                let is_running = |judging: &Judging| judging.phase == JudgePhase::Running.code();
                let judging = from_bytes::<Judging>(&entry.data).filter(is_running);
                self.has_part |= judging.is_some_and(|judging| is(&judging.part));
            }
            _ => (),
        }
    }

    fn is_within(&self, jobs: &[Span]) -> bool {
        self.seen
            .is_some_and(|(first, last)| jobs.iter().any(|(began, ended)| first <= *ended && *began <= last))
    }
}

/// When the work went on that a verdict is on. A film that is played faster makes it longer than it was.
fn span(verdict: &Verdict) -> Span {
    let decided_ns = verdict.decided_utc_ns;
    let lasted_ns = verdict.decided_ns.saturating_sub(verdict.began_ns);
    (decided_ns.saturating_sub(lasted_ns).saturating_sub(AROUND_NS), decided_ns.saturating_add(AROUND_NS))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_record::RecordingWriter;
    use andon_record::index::Index;
    use shm_schemas::{Layout, bytes_of};
    use std::fs::File;

    const SECOND: u64 = 1_000_000_000;

    fn entry(topic: Topic, second: u64, data: &[u8]) -> Entry {
        Entry { topic, time_ns: second * SECOND, sent_ns: second * SECOND, data: data.into() }
    }

    fn message<T: Layout>(channel: Channel, second: u64, message: &T) -> Entry {
        entry(Topic::Raw(channel), second, bytes_of(message))
    }

    fn part(id: &str) -> PartId {
        PartId::new(id.as_bytes()).unwrap()
    }

    /// A recording with pictures of these seconds and some more.
    fn recording(folder: &Path, seconds: std::ops::Range<u64>, more: &[Entry]) -> Recording {
        let path = folder.join(format!("{:03}.mcap", seconds.start));
        let mut writer = RecordingWriter::new(File::create(&path).unwrap(), 0).unwrap();
        for second in seconds {
            writer.write(&entry(Topic::Picture, second, b"jpeg")).unwrap();
        }
        more.iter().for_each(|entry| writer.write(entry).unwrap());
        writer.finish().unwrap();
        Recording { index: Index::of(&path).unwrap(), path }
    }

    #[test]
    fn a_job_that_went_on_through_several_recordings_is_forgotten_in_all_of_them() {
        let folder = tempfile::tempdir().unwrap();
        // The job went on from second 170 to second 340.
        let verdict = Verdict {
            part: part("SN-7"),
            began_ns: 5 * SECOND,
            decided_ns: 175 * SECOND,
            decided_utc_ns: 340 * SECOND,
            ..Verdict::NONE
        };
        let running = |id: &str, phase: JudgePhase| {
            message(
                Channel::Judging,
                550,
                &Judging { part: part(id), phase: phase.code(), ..Judging::default() },
            )
        };
        let recordings = vec![
            recording(folder.path(), 0..100, &[]),
            recording(folder.path(), 100..200, &[]),
            recording(folder.path(), 200..300, &[]),
            recording(folder.path(), 300..400, &[message(Channel::Verdict, 340, &verdict)]),
            recording(folder.path(), 400..500, &[running("SN-7", JudgePhase::Waiting)]),
            // Its recorder was killed before any verdict.
            recording(folder.path(), 500..600, &[running("SN-7", JudgePhase::Running)]),
            recording(folder.path(), 600..700, &[running("SN-8", JudgePhase::Running)]),
        ];
        let names = |part: &str| -> Vec<String> {
            let found = showing(recordings.clone(), part);
            found
                .iter()
                .map(|recording| recording.path.file_stem().unwrap().to_string_lossy().into())
                .collect()
        };
        assert_eq!(names("SN-7"), ["100", "200", "300", "500"]);
        assert_eq!(names("SN-8"), ["600"]);
        assert!(names("SN-9").is_empty() && names("").is_empty());
    }
}
