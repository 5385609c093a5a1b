//! Follows hands from frame to frame.

use super::empty_bench::EmptyBench;
use super::landmarker::Landmarker;
use super::models::{LandmarkModel, Landmarks, PalmModel};
use super::palm::Palms;
use super::region::Region;
use super::side::Evidence;
use crate::config::HandsConfig;
use crate::detections::{HANDS, LANDMARKS, Side, Timings};
use crate::error::PerceptionError;
use crate::image::ImageView;
use crate::workers::Workers;
use heapless::Vec;
use std::time::Instant;

/// Two regions that overlap more than this hold the same hand (MediaPipe's `min_similarity_threshold`).
const SAME_HAND: f32 = 0.5;
/// A lost hand keeps its side if it is found again within this time, in nanoseconds, where its region overlaps the old one.
const REMEMBERED_NS: u64 = 1_000_000_000;
/// Minimum overlap of the old region and the new one: a hand at 1 m/s has left its region within `REMEMBERED_NS`.
const REMEMBERED_OVERLAP: f32 = 0.1;
/// Maximum shift of a hand's region from one frame to the next, as a share of its side. 2 m/s at 30 fps, for a region of 0.3 m, are 0.22.
const MAX_SHIFT: f32 = 0.5;
/// Maximum factor by which its side changes from one frame to the next: an opening fist changes by 1.3.
const MAX_GROWTH: f32 = 1.6;
/// A hand of a frame; fields as in [`HandDetection`](crate::detections::HandDetection).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) side: Side,
    pub(crate) score: f32,
    pub(crate) landmarks_px: [[f32; 2]; LANDMARKS],
    pub(crate) shape_m: [[f32; 3]; LANDMARKS],
}

#[derive(Clone, Copy, Debug)]
struct Track {
    /// Where the hand is expected in the next frame.
    region: Region,
    evidence: Evidence,
    seen: Landmarks,
}

/// A hand that is out of sight.
#[derive(Clone, Copy, Debug)]
struct Lost {
    region: Region,
    evidence: Evidence,
    since_ns: u64,
}

/// Follows up to two hands.
pub(crate) struct Tracker<P, L> {
    palms: P,
    /// The first hand that is followed, and the second one where there are two to look with.
    landmarkers: Vec<Landmarker<L>, HANDS>,
    config: HandsConfig,
    tracks: Vec<Track, HANDS>,
    lost: Vec<Lost, HANDS>,
    previous_ns: Option<u64>,
    frames_since_search: u32,
    empty_bench: EmptyBench,
    /// Whether a search has begun beside the followed hands. The next frame takes what it has found, and waits for it where it must. The same frames
    /// give the same hands however fast the machine is.
    is_searching: bool,
}

impl<P: PalmModel, L: LandmarkModel> Tracker<P, L> {
    /// `landmarks` is one model for each hand that is looked at side by side with another; there is at least one.
    pub(crate) fn new(palms: P, landmarks: Vec<L, HANDS>, config: HandsConfig) -> Self {
        let landmarkers =
            landmarks.into_iter().map(|model| Landmarker::new(model, config.min_hand_score)).collect();
        Self {
            palms,
            landmarkers,
            config,
            tracks: Vec::new(),
            lost: Vec::new(),
            previous_ns: None,
            frames_since_search: 0,
            empty_bench: EmptyBench::default(),
            is_searching: false,
        }
    }

    /// The wanted hands of one frame. Frames come in order of their time.
    ///
    /// # Errors
    /// [`PerceptionError::Inference`].
    pub(crate) fn step(
        &mut self,
        image: &ImageView<'_>,
        captured_ns: u64,
        workers: &Workers,
        timings: &mut Timings,
    ) -> Result<Vec<Found, HANDS>, PerceptionError> {
        let after_gap = self.previous_ns.is_some_and(|previous| {
            captured_ns.saturating_sub(previous) > u64::from(self.config.gap_ms) * 1_000_000
        });
        self.previous_ns = Some(captured_ns);
        self.lost.retain(|lost| captured_ns.saturating_sub(lost.since_ns) <= REMEMBERED_NS);

        let followed = self.tracks.len();
        self.frames_since_search += 1;
        if after_gap {
            self.search_after_gap(image, captured_ns, timings)?;
        } else {
            self.follow(image, captured_ns, workers)?;
            self.search_where_one_is_missing(image, followed, timings)?;
        }
        if !self.tracks.is_empty() {
            self.empty_bench.has_hand();
        }
        timings.landmarks_ns += self.landmarkers.iter_mut().map(Landmarker::spent_ns).sum::<u64>();
        match self.tracks.as_mut_slice() {
            [first, second] => first.evidence.settle_pair(&mut second.evidence),
            tracks => tracks.iter_mut().for_each(|track| track.evidence.settle()),
        }
        self.drop_unwanted();
        Ok(self.found())
    }

    /// Number of hands that are followed, of whatever side.
    pub(crate) fn followed(&self) -> usize {
        self.tracks.len()
    }

    /// Searches the whole picture first, because the old regions say little after a gap, and looks into these afterwards.
    fn search_after_gap(
        &mut self,
        image: &ImageView<'_>,
        captured_ns: u64,
        timings: &mut Timings,
    ) -> Result<(), PerceptionError> {
        let old = std::mem::take(&mut self.tracks);
        for track in &old {
            self.remember(track, captured_ns);
        }
        self.search(image, timings)?;
        for track in old {
            self.look(image, track.region)?;
        }
        Ok(())
    }

    /// Looks for every followed hand where it is expected; a hand that is not there is lost.
    fn follow(
        &mut self,
        image: &ImageView<'_>,
        captured_ns: u64,
        workers: &Workers,
    ) -> Result<(), PerceptionError> {
        let tracks = std::mem::take(&mut self.tracks);
        let follow = |landmarker: &mut Landmarker<L>, track: &Track| {
            landmarker.follow(image, track.region, track.evidence)
        };
        let mut seen: Vec<Landmarks, HANDS> = Vec::new();
        match (tracks.as_slice(), self.landmarkers.as_mut_slice()) {
            ([one, other], [landmarker, other_landmarker]) => {
                let (one, other) =
                    workers.join(|| follow(landmarker, one), || follow(other_landmarker, other));
                seen.extend([one?, other?]);
            }
            (tracks, [landmarker, ..]) => {
                for track in tracks {
                    seen.extend([follow(landmarker, track)?]);
                }
            }
            (_, []) => {}
        }
        for (track, seen) in tracks.iter().zip(&seen) {
            let next = Region::of_landmarks(&seen.points_px);
            let is_new = self.tracks.iter().all(|other| other.region.overlap(&next) <= SAME_HAND);
            if seen.presence < self.config.min_hand_score || jumped(track.region, next) {
                self.remember(track, captured_ns);
            } else if is_new {
                self.keep(track.evidence, next, seen);
            }
        }
        Ok(())
    }

    /// Searches while nothing is followed, and beside what is followed otherwise: a hand that is missing does not hold up the other one. A
    /// bench that is empty and unchanged is searched now and then, and at once when anything in its picture changes.
    fn search_where_one_is_missing(
        &mut self,
        image: &ImageView<'_>,
        followed: usize,
        timings: &mut Timings,
    ) -> Result<(), PerceptionError> {
        let has_searched = std::mem::take(&mut self.is_searching);
        if has_searched && self.is_one_missing() && !self.tracks.is_empty() {
            let (palms, took_ns) = self.palms.finish()?;
            timings.palm_ns += took_ns;
            self.look_at(image, &palms)?;
        }
        if !self.must_search(followed) {
            return Ok(());
        }
        if self.tracks.is_empty() {
            let is_due = self.frames_since_search >= self.config.search_every_frames;
            return if !is_due && self.empty_bench.is_unchanged(image) {
                Ok(())
            } else {
                self.search(image, timings)
            };
        }
        self.frames_since_search = 0;
        self.is_searching = true;
        self.palms.begin(image)
    }

    fn is_one_missing(&self) -> bool {
        self.config
            .sides
            .iter()
            .any(|side| self.tracks.iter().all(|track| track.evidence.side() != Some(*side)))
    }

    /// Whether palm detection may have to run. A wanted hand is missing, and no hand is followed, one was just lost, or the pause since the last
    /// search is over.
    fn must_search(&self, followed: usize) -> bool {
        let lost_now = self.tracks.len() < followed;
        let is_due = self.frames_since_search >= self.config.search_every_frames;
        self.is_one_missing() && self.tracks.len() < HANDS && (self.tracks.is_empty() || lost_now || is_due)
    }

    /// Looks for hands in the whole picture.
    fn search(&mut self, image: &ImageView<'_>, timings: &mut Timings) -> Result<(), PerceptionError> {
        self.frames_since_search = 0;
        self.is_searching = false;
        let begin = Instant::now();
        let palms = self.palms.palms(image)?;
        timings.palm_ns += begin.elapsed().as_nanos() as u64;
        self.look_at(image, &palms)?;
        if self.tracks.is_empty() {
            self.empty_bench.found_nothing(image);
        }
        Ok(())
    }

    fn look_at(&mut self, image: &ImageView<'_>, palms: &Palms) -> Result<(), PerceptionError> {
        palms.iter().try_for_each(|palm| self.look(image, palm.region()))
    }

    /// Looks for a hand in a region, unless a followed hand is in it.
    fn look(&mut self, image: &ImageView<'_>, region: Region) -> Result<(), PerceptionError> {
        let taken = |tracks: &[Track], region: &Region| {
            tracks.iter().any(|track| track.region.overlap(region) > SAME_HAND)
        };
        let Some(landmarker) = self.landmarkers.first_mut() else { return Ok(()) };
        if self.tracks.is_full() || taken(&self.tracks, &region) {
            return Ok(());
        }
        let seen = landmarker.at(image, region)?;
        let next = Region::of_landmarks(&seen.points_px);
        if seen.presence >= self.config.min_hand_score && !taken(&self.tracks, &next) {
            let evidence = recall(&mut self.lost, &next);
            let seen = landmarker.nearer(image, region, evidence, seen)?;
            self.keep(evidence, Region::of_landmarks(&seen.points_px), &seen);
        }
        Ok(())
    }

    fn keep(&mut self, mut evidence: Evidence, region: Region, seen: &Landmarks) {
        evidence.take(seen.right);
        let track = Track { region, evidence, seen: *seen };
        // There is room: `look` has checked, and `follow` keeps no more than it took.
        let _ = self.tracks.push(track);
    }

    fn remember(&mut self, track: &Track, now_ns: u64) {
        if self.lost.is_full() {
            self.lost.remove(0);
        }
        // There is room now.
        let _ = self.lost.push(Lost { region: track.region, evidence: track.evidence, since_ns: now_ns });
    }

    /// Drops hands that are not wanted. One is followed only while it may still turn out to be a wanted one.
    fn drop_unwanted(&mut self) {
        let wanted = &self.config.sides;
        let complete =
            wanted.iter().all(|side| self.tracks.iter().any(|track| track.evidence.side() == Some(*side)));
        if complete {
            self.tracks.retain(|track| track.evidence.side().is_some_and(|side| wanted.contains(&side)));
        }
    }

    fn found(&self) -> Vec<Found, HANDS> {
        let wanted = |side: &Side| self.config.sides.contains(side);
        self.tracks
            .iter()
            .filter_map(|track| {
                let side = track.evidence.side().filter(wanted)?;
                let Landmarks { points_px, shape_m, presence, .. } = track.seen;
                Some(Found { side, score: presence, landmarks_px: points_px, shape_m })
            })
            .collect()
    }
}

/// The evidence for the hand that was lost here, if one was.
fn recall(lost: &mut Vec<Lost, HANDS>, region: &Region) -> Evidence {
    let nearest = (0..lost.len())
        .max_by(|&a, &b| lost[a].region.overlap(region).total_cmp(&lost[b].region.overlap(region)));
    match nearest {
        Some(index) if lost[index].region.overlap(region) > REMEMBERED_OVERLAP => {
            lost.swap_remove(index).evidence
        }
        _ => Evidence::default(),
    }
}

/// Whether the landmarks have left the hand for something else.
fn jumped(expected: Region, seen: Region) -> bool {
    let shift = (seen.centre[0] - expected.centre[0]).hypot(seen.centre[1] - expected.centre[1]);
    let growth = (seen.side / expected.side).max(expected.side / seen.side);
    // Written so that NaN counts as a jump.
    !(shift <= MAX_SHIFT * expected.side && growth <= MAX_GROWTH)
}
