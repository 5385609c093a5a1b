//! One piece of work in a recording, which is a run that can be taught: from when to when its frames were captured. A recording may begin in the
//! middle of a piece, end before it does, or have several.

use std::ops::RangeInclusive;
use std::path::Path;

use andon_ipc::Channel;
use andon_record::{Item, RecordingReader, Topic};
use shm_schemas::{Detections, MessageId, Verdict, VerdictLevel, flag};

use super::{BlackboxError, message};

/// How much before a piece and after it belongs to its run: where the parts lay, and that they lie still.
const AROUND_NS: u64 = 1_000_000_000;

/// When the frames of a piece were captured, CLOCK_MONOTONIC in nanoseconds. A film that begins again repeats its own times, and this clock does not.
pub type Piece = RangeInclusive<u64>;

/// The piece that a verdict is on.
///
/// # Errors
/// What of it is not in the recording, and why that cannot be read.
pub fn piece_of(path: &Path, verdict: MessageId) -> Result<Piece, BlackboxError> {
    let seen = Seen::read(path)?;
    let job = seen.job_of(verdict).ok_or(Lack::End);
    job.and_then(|job| seen.piece(job)).map_err(|lack| lack.of(path))
}

/// The one piece of a recording; `None` where nothing was judged, so that all of it is what somebody showed.
///
/// # Errors
/// As [`piece_of`], and that there are several.
pub fn only_piece(path: &Path) -> Result<Option<Piece>, BlackboxError> {
    let seen = Seen::read(path)?;
    if seen.verdicts.is_empty() {
        return Ok(None);
    }
    let (mut whole, mut lack) = (Vec::new(), Lack::End);
    for job in seen.jobs() {
        match seen.piece(job) {
            Ok(piece) => whole.push(piece),
            Err(lacks) => lack = lacks,
        }
    }
    match whole.len() {
        0 => Err(lack.of(path)),
        1 => Ok(whole.pop()),
        count => Err(BlackboxError::SeveralPieces { path: path.into(), count }),
    }
}

/// What of a piece is not in the recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lack {
    Begin,
    End,
}

impl Lack {
    fn of(self, path: &Path) -> BlackboxError {
        let path = path.into();
        match self {
            Self::Begin => BlackboxError::NoBegin { path },
            Self::End => BlackboxError::NoEnd { path },
        }
    }
}

/// A frame, by the time of its source and by the clock of this machine.
#[derive(Clone, Copy, Debug)]
struct Moment {
    source_ns: u64,
    captured_ns: u64,
}

/// What a recording shows of pieces.
#[derive(Default)]
struct Seen {
    verdicts: Vec<Verdict>,
    /// Frames in stretches in which both clocks go on: a source that starts again begins another.
    stretches: Vec<Vec<Moment>>,
}

impl Seen {
    fn read(path: &Path) -> Result<Self, BlackboxError> {
        let mut seen = Self::default();
        let mut reader = RecordingReader::open(path)?;
        while let Some(item) = reader.next_item()? {
            let Item::Entry(entry) = item else { continue };
            let (topic, raw) = (entry.topic, Topic::Raw);
            if let Some(verdict) = message::<Verdict>(topic, raw(Channel::Verdict), &entry.data) {
                seen.verdicts.push(verdict);
            } else if let Some(detections) =
                message::<Detections>(topic, raw(Channel::Detections), &entry.data)
                && detections.flags & flag::END_OF_STREAM == 0
            {
                let Detections { source_ns, stamp, .. } = detections;
                seen.take(Moment { source_ns, captured_ns: stamp.captured_ns });
            }
        }
        Ok(seen)
    }

    fn take(&mut self, moment: Moment) {
        let goes_on = |stretch: &&mut Vec<Moment>| {
            let last = stretch.last();
            last.is_some_and(|last| {
                last.source_ns < moment.source_ns && last.captured_ns < moment.captured_ns
            })
        };
        match self.stretches.last_mut().filter(goes_on) {
            Some(stretch) => stretch.push(moment),
            None => self.stretches.push(vec![moment]),
        }
    }

    /// The verdicts on whole pieces.
    fn jobs(&self) -> impl Iterator<Item = &Verdict> {
        self.verdicts.iter().filter(|verdict| verdict.level == VerdictLevel::Job.code())
    }

    /// The verdict on the piece that this one belongs to.
    fn job_of(&self, id: MessageId) -> Option<&Verdict> {
        let verdict = self.verdicts.iter().find(|verdict| verdict.stamp.id() == id)?;
        let mut later = self.jobs().filter(|job| job.stamp.epoch == id.epoch && job.stamp.seq >= id.seq);
        // What lies outside of it belonged to another one, whose own verdict is not here.
        later.next().filter(|job| (job.began_ns..=job.decided_ns).contains(&verdict.began_ns))
    }

    /// When the frames of this piece were captured.
    fn piece(&self, job: &Verdict) -> Result<Piece, Lack> {
        let is_before = |stretch: &&Vec<Moment>| {
            stretch.first().is_some_and(|first| first.captured_ns <= job.stamp.captured_ns)
        };
        let has_end = |stretch: &&Vec<Moment>| {
            let ends = stretch.first().zip(stretch.last());
            ends.is_some_and(|(first, last)| (first.source_ns..=last.source_ns).contains(&job.ended_ns))
        };
        // The verdict on a film that has begun again is on the time before that.
        let stretch = self.stretches.iter().rev().filter(is_before).find(has_end).ok_or(Lack::End)?;
        if stretch.first().is_none_or(|first| first.source_ns > job.began_ns) {
            return Err(Lack::Begin);
        }
        let before = self.jobs().filter(|other| other.stamp.epoch == job.stamp.epoch);
        let before = before.filter(|other| other.ended_ns <= job.began_ns);
        let floor_ns = before.map(|other| other.ended_ns).max().unwrap_or_default();
        let began_ns = job.began_ns.saturating_sub(AROUND_NS).max(floor_ns);
        let ended_ns = job.ended_ns.saturating_add(AROUND_NS);
        let of_run = stretch.iter().filter(|moment| (began_ns..=ended_ns).contains(&moment.source_ns));
        let captured_ns = |moment: &Moment| moment.captured_ns;
        let mut times = of_run.map(captured_ns);
        let first_ns = times.next().ok_or(Lack::End)?;
        Ok(first_ns..=times.next_back().unwrap_or(first_ns))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SECOND: u64 = 1_000_000_000;

    /// Frames each tenth of a second: of these source times, captured from `captured` on; seconds.
    fn play(seen: &mut Seen, source: std::ops::Range<u64>, captured: u64) {
        for tenth in 0..10 * (source.end - source.start) {
            let at_ns = tenth * SECOND / 10;
            let source_ns = source.start * SECOND + at_ns;
            seen.take(Moment { source_ns, captured_ns: captured * SECOND + at_ns });
        }
    }

    fn verdict(level: VerdictLevel, seq: u64, source: RangeInclusive<u64>, captured: u64) -> Verdict {
        let (began_ns, ended_ns) = (source.start() * SECOND, source.end() * SECOND);
        let mut verdict =
            Verdict { level: level.code(), began_ns, ended_ns, decided_ns: ended_ns, ..Verdict::NONE };
        (verdict.stamp.epoch, verdict.stamp.seq, verdict.stamp.captured_ns) = (7, seq, captured * SECOND);
        verdict
    }

    fn seconds(piece: Result<Piece, Lack>) -> Result<(u64, u64), Lack> {
        piece.map(|piece| (piece.start() / SECOND, piece.end() / SECOND))
    }

    fn job(seen: &Seen, seq: u64) -> Result<(u64, u64), Lack> {
        let job = seen.job_of(MessageId { epoch: 7, seq }).ok_or(Lack::End);
        seconds(job.and_then(|job| seen.piece(job)))
    }

    #[test]
    fn a_film_that_begins_again_repeats_its_times_and_the_piece_is_that_of_the_verdict() {
        let mut seen = Seen::default();
        for (round, captured) in [100, 200, 300].into_iter().enumerate() {
            play(&mut seen, 0..20, captured);
            let seq = 2 * round as u64 + 1;
            seen.verdicts.push(verdict(VerdictLevel::Iu, seq, 6..=7, captured + 7));
            // The last one is said when the film has begun again.
            seen.verdicts.push(verdict(
                VerdictLevel::Job,
                seq + 1,
                5..=15,
                if round == 2 { 400 } else { captured + 16 },
            ));
        }
        play(&mut seen, 0..5, 400);
        assert_eq!(job(&seen, 1), Ok((104, 116)));
        assert_eq!(job(&seen, 3), Ok((204, 216)));
        assert_eq!(job(&seen, 4), Ok((204, 216)));
        assert_eq!(job(&seen, 6), Ok((304, 316)));
    }

    #[test]
    fn a_piece_whose_begin_or_end_is_not_in_the_recording_is_none() {
        let mut seen = Seen::default();
        play(&mut seen, 50..100, 500);
        seen.verdicts.push(verdict(VerdictLevel::Job, 1, 40..=60, 510));
        seen.verdicts.push(verdict(VerdictLevel::Job, 2, 60..=70, 520));
        seen.verdicts.push(verdict(VerdictLevel::Iu, 3, 75..=80, 530));
        assert_eq!(job(&seen, 1), Err(Lack::Begin));
        // Where the piece before it ended, it begins.
        assert_eq!(job(&seen, 2), Ok((510, 521)));
        assert_eq!(job(&seen, 3), Err(Lack::End));
        assert_eq!(job(&seen, 4), Err(Lack::End));
        // The verdict of another piece says nothing of this one.
        seen.verdicts.push(verdict(VerdictLevel::Job, 9, 85..=95, 545));
        assert_eq!(job(&seen, 3), Err(Lack::End));
    }
}
