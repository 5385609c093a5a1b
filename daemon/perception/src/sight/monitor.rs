//! Follows the measures of the pictures, and what was seen in them.

use super::camera::Camera;
use super::observation::{Observation, distance};
use crate::detections::OBJECTS;
use crate::picture::{CELLS, Picture};
use std::collections::VecDeque;

/// Nanoseconds of a second.
const S: f32 = 1e9;

/// What keeps the line from seeing, the most telling first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Trouble {
    /// The picture does not change at all, not even by noise.
    Frozen,
    /// The picture is black.
    Black,
    /// The picture is white.
    White,
    /// Something lies over the lens.
    Covered,
    /// The picture has lost its sharp edges.
    Blurred,
    /// There is so much noise that nothing is found any more.
    Noisy,
    /// The camera has been moved.
    CameraMoved,
    /// Fewer pictures per second are processed than the job needs, or, without a job, fewer than half of the camera's.
    TooFewFrames,
    /// The markers in the picture are not those of the station, or hands work and no marker has ever been seen.
    NoMarkers,
    /// Parts move, and no hand is found.
    NoHands,
}

impl Trouble {
    /// Every trouble, the most telling first.
    pub const ALL: [Self; 10] = [
        Self::Frozen,
        Self::Black,
        Self::White,
        Self::Covered,
        Self::Blurred,
        Self::Noisy,
        Self::CameraMoved,
        Self::TooFewFrames,
        Self::NoMarkers,
        Self::NoHands,
    ];

    /// Whether nothing that the picture seems to show is seen while it lasts. Where frames or hands are missing, what there is was seen all the
    /// same, and the method knows what it misses.
    pub(super) const fn hides_bench(self) -> bool {
        !matches!(self, Self::TooFewFrames | Self::NoHands)
    }

    /// How long it must last before it is believed. Lamps are switched, exposure settles and arms pass in less.
    const fn patience(self) -> f32 {
        match self {
            // These have measured for so long already.
            Self::Frozen | Self::CameraMoved | Self::NoHands => 0.0,
            Self::TooFewFrames => 0.8,
            _ => 1.0,
        }
    }
}

/// A trouble that lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spell {
    /// What it is.
    pub trouble: Trouble,
    /// Since when, in nanoseconds of the capturing clock.
    pub since_ns: u64,
}

/// What a station should see.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// Pictures per second of a camera; `None` for a recording, which has its own rate.
    pub rate_hz: Option<f32>,
    /// Whether hands are looked for.
    pub hands: bool,
    /// Whether places on the bench come from a calibration, which holds for one place of the camera.
    pub is_calibrated: bool,
}

/// Follows one camera.
pub struct SightMonitor {
    expected: Expected,
    baseline: Baseline,
    stillness: Stillness,
    rate: Rate,
    work: Work,
    camera: Camera,
    /// Whether the newest picture shows the bench.
    is_seen: bool,
    /// By trouble, in the order of [`Trouble::ALL`].
    signs: [Sign; Trouble::ALL.len()],
    current: Option<Spell>,
}

impl SightMonitor {
    /// Nothing has been seen.
    pub fn new(expected: Expected) -> Self {
        Self {
            expected,
            baseline: Baseline::default(),
            stillness: Stillness::default(),
            rate: Rate::default(),
            work: Work::default(),
            camera: Camera::new(expected.is_calibrated),
            is_seen: true,
            signs: [Sign::default(); Trouble::ALL.len()],
            current: None,
        }
    }

    /// Takes the next picture and gives the trouble that lasts, if there is one. The first one stays for as long as it lasts: it is the
    /// cause, and others follow from it.
    pub fn step(&mut self, observation: &Observation) -> Option<Spell> {
        self.stillness.step(observation);
        self.rate.step(observation, self.expected.rate_hz);
        self.work.step(observation);
        self.camera.step(observation);
        let shows = Trouble::ALL.map(|trouble| self.shows(trouble, observation));
        for ((sign, trouble), since_ns) in self.signs.iter_mut().zip(Trouble::ALL).zip(shows) {
            sign.step(trouble, since_ns, observation.at_ns);
        }
        if shows.iter().all(Option::is_none) {
            self.baseline.learn(observation);
        }
        let spell = |trouble: Trouble| {
            self.signs[trouble as usize].believed_ns.map(|since_ns| Spell { trouble, since_ns })
        };
        let lasts = self.current.and_then(|current| spell(current.trouble));
        self.current = lasts.or_else(|| Trouble::ALL.into_iter().find_map(spell));
        let is_sign = |(trouble, shows): (Trouble, Option<u64>)| shows.is_some() && trouble.hides_bench();
        let is_any_sign = Trouble::ALL.into_iter().zip(shows).any(is_sign);
        let lasts = self.current.is_some_and(|spell| spell.trouble.hides_bench());
        self.is_seen = !is_any_sign && !lasts && !self.stillness.repeats && !self.camera.may_be_moved();
        self.current
    }

    /// Whether the newest picture shows the bench. It takes a while before a trouble is believed and told. Meanwhile nothing that a picture with a
    /// sign of one seems to show is taken for seen. That holds from the first that repeats the one before, or in which the markers are moved as one.
    pub fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// The trouble that lasts, if there is one.
    pub fn current(&self) -> Option<Spell> {
        self.current
    }

    /// The pictures per second that the job in force needs; `None` where there is no job, or it does not say.
    pub fn set_needed_hz(&mut self, needed_hz: Option<f32>) {
        self.rate.needed_hz = needed_hz;
    }

    /// How many pictures came and were processed lately.
    pub fn rates(&self) -> Rates {
        self.rate.newest
    }

    /// Since when the picture shows this; `None` where it does not.
    fn shows(&self, trouble: Trouble, observation: &Observation) -> Option<u64> {
        let Observation { at_ns, picture, .. } = observation;
        let now = |shows: bool| shows.then_some(*at_ns);
        let is_uniform = picture.black > FULL || picture.white > FULL;
        let finds_nothing = observation.markers.is_empty() && observation.hands == 0;
        match trouble {
            Trouble::Frozen => self.stillness.frozen_since_ns(),
            Trouble::Black => now(picture.black > FULL && finds_nothing),
            Trouble::White => now(picture.white > FULL && finds_nothing),
            Trouble::Covered => now(!is_uniform && finds_nothing && self.baseline.is_gone(picture)),
            Trouble::Blurred => now(!is_uniform && self.baseline.is_blurred(observation)),
            Trouble::Noisy => now(picture.noise > NOISE && observation.hands == 0),
            Trouble::CameraMoved => self.camera.moved_since_ns(),
            Trouble::TooFewFrames => self.rate.slow_since_ns(),
            Trouble::NoMarkers => now(self.work.is_without_markers(observation)),
            Trouble::NoHands => self.work.handless_since_ns().filter(|_| self.expected.hands),
        }
    }
}

/// A picture of which more than this share is black, or white, shows nothing.
const FULL: f32 = 0.97;
/// Noise in which neither hands nor small markers are found, in grey levels. Twice what a camera has in the light of a lamp at night.
const NOISE: f32 = 20.0;
/// A trouble is over when the picture has been free of it for this long, in seconds.
const RECOVERY_S: f32 = 0.5;

/// Whether a trouble is believed.
#[derive(Clone, Copy, Default)]
struct Sign {
    shown_since_ns: Option<u64>,
    newest_ns: u64,
    believed_ns: Option<u64>,
}

impl Sign {
    fn step(&mut self, trouble: Trouble, shows_since_ns: Option<u64>, at_ns: u64) {
        let after = |from_ns: u64| at_ns.saturating_sub(from_ns) as f32 / S;
        match shows_since_ns {
            Some(since_ns) => {
                let since_ns = *self.shown_since_ns.get_or_insert(since_ns);
                self.newest_ns = at_ns;
                if after(since_ns) >= trouble.patience() {
                    self.believed_ns.get_or_insert(since_ns);
                }
            }
            None if self.believed_ns.is_none() || after(self.newest_ns) >= RECOVERY_S => {
                *self = Self::default()
            }
            None => {}
        }
    }
}

/// What this camera shows when all is well.
#[derive(Default)]
struct Baseline {
    pictures: u32,
    edges: f32,
    patches: f32,
    sharpness: Option<f32>,
    markers: f32,
    cells: [[f32; 3]; CELLS],
}

/// Pictures before anything is held against what is usual: a third of a second.
const KNOWN: u32 = 10;
/// How much a picture counts beside what is usual: 150 pictures are some seconds, longer than any trouble takes to be believed.
const LEARNING: f32 = 1.0 / 150.0;
/// A bench where fewer of the points than this lie on edges has none that it could lose.
const MIN_EDGES: f32 = 0.002;
/// A picture with less than this share of the usual edges has lost them.
const EDGES_LEFT: f32 = 0.1;
/// A cell has changed when it has more or less red, green or blue by this, in levels of 255. The mean of its pixels is steady to less than one. Skin
/// or cloth over the lens may be about as bright as the bench.
const CELL_CHANGE: f32 = 4.0;
/// Share of the cells that a cover changes, and that no worker who leans over the bench does while their own edges are seen.
const CELLS_CHANGED: f32 = 0.6;
/// A picture without sharp edges is out of focus if its patches still differ by this share of what is usual. They must also differ by this many grey
/// levels. Out of focus by a twenty-fifth of the picture's width they differ by 43 % and 6.7 levels at least. Of a bench that was cleared, the share
/// is 26 % at most, and a table without parts has 4.2 levels.
const PATCHES_LEFT: f32 = 0.33;
const MIN_PATCHES: f32 = 5.3;
/// A picture with less than this share of the usual sharpness is blurred if it lost markers as well...
const BLUR: f32 = 0.6;
/// ... that is, if less than this share of the usual markers is found.
const MARKERS_LEFT: f32 = 0.5;

impl Baseline {
    fn learn(&mut self, observation: &Observation) {
        let has_lost_edges = self.has_lost_edges(&observation.picture);
        self.pictures = self.pictures.saturating_add(1);
        // The first pictures count alike.
        let weight = LEARNING.max(1.0 / self.pictures as f32);
        let blend = |mean: &mut f32, now: f32| *mean += weight * (now - *mean);
        blend(&mut self.edges, observation.picture.edges);
        blend(&mut self.markers, observation.markers.len() as f32);
        if let Some(sharpness) = observation.picture.sharpness {
            blend(self.sharpness.get_or_insert(sharpness), sharpness);
        }
        // Of a bench that was cleared it is learnt first that it has no edges. Only then is learnt what else it is like without its parts.
        if !has_lost_edges {
            blend(&mut self.patches, observation.picture.patches);
            let now = observation.picture.cells.as_flattened();
            for (usual, now) in self.cells.as_flattened_mut().iter_mut().zip(now) {
                blend(usual, f32::from(*now));
            }
        }
    }

    fn is_known(&self) -> bool {
        self.pictures >= KNOWN
    }

    /// Share of the cells that have another colour or brightness than usual.
    fn changed(&self, picture: &Picture) -> f32 {
        let has_changed = |(usual, now): (&f32, &u8)| (usual - f32::from(*now)).abs() > CELL_CHANGE;
        let cells = self.cells.iter().zip(&picture.cells);
        cells.filter(|(usual, now)| usual.iter().zip(*now).any(has_changed)).count() as f32 / CELLS as f32
    }

    fn has_lost_edges(&self, picture: &Picture) -> bool {
        self.is_known() && self.edges > MIN_EDGES && picture.edges < EDGES_LEFT * self.edges
    }

    /// Whether what is usual is not there any more: no edges, and another brightness nearly everywhere. On a bench that was cleared the
    /// table is as bright as before.
    fn is_gone(&self, picture: &Picture) -> bool {
        self.has_lost_edges(picture) && self.changed(picture) > CELLS_CHANGED
    }

    /// Whether markers are lost because edges are wider than usual, or so wide that none is left that is narrow.
    fn is_blurred(&self, observation: &Observation) -> bool {
        let has_lost_markers = (observation.markers.len() as f32) < MARKERS_LEFT * self.markers;
        let Observation { picture, .. } = observation;
        let is_wider = self.sharpness.zip(picture.sharpness).is_some_and(|(usual, now)| now < BLUR * usual);
        let is_out_of_focus =
            self.has_lost_edges(picture) && picture.patches > MIN_PATCHES.max(PATCHES_LEFT * self.patches);
        self.is_known() && has_lost_markers && (is_wider || is_out_of_focus)
    }
}

/// How long the same picture comes again and again, bit for bit.
///
/// A still picture that was coded again with losses is not found, because a bench on which nobody moves is coded alike. Both are blocks that are
/// taken over from the picture before. It was tried on films with a camera's noise, of four codecs at seven qualities, frozen for 1.5 s or live. No
/// measure of a window of 0.7 s keeps the two apart. The figures are the largest value of a frozen film and the least of a live one. The share of
/// pixels that differ from one picture to the next is 0.048 and 0.0004. Within the window 0.23 and 0.007 change. The mean change of the block that
/// changes most is 1.0 and 0.8 grey levels. The median packet in the container has 169 and 18 bytes, and against the median of its film
/// 0.85 and 0.12. Within one codec and quality two of them do in most cases, which a line cannot know.
#[derive(Default)]
struct Stillness {
    fingerprint: Option<u64>,
    since_ns: u64,
    still_s: f32,
    /// The newest picture is the one before.
    repeats: bool,
    /// Pictures that were not the one before.
    changes: u32,
    /// The longest time for which this source has shown one picture and gone on by itself.
    usual_s: f32,
}

/// A camera has noise: it never shows the same picture twice, let alone for so long.
const FROZEN_S: f32 = 1.5;
/// Rendered films stand still now and then: the same again, this many times as long as ever before, is no pause.
const STILL_FACTOR: f32 = 4.0;

impl Stillness {
    fn step(&mut self, observation: &Observation) {
        let fingerprint = Some(observation.picture.fingerprint);
        self.repeats = self.fingerprint == fingerprint;
        if !self.repeats {
            // A picture that was frozen is no example.
            if self.frozen_since_ns().is_none() {
                self.usual_s = self.usual_s.max(self.still_s);
            }
            (self.fingerprint, self.since_ns) = (fingerprint, observation.at_ns);
            self.changes = self.changes.saturating_add(1);
        }
        self.still_s = observation.at_ns.saturating_sub(self.since_ns) as f32 / S;
    }

    fn frozen_since_ns(&self) -> Option<u64> {
        let is_moving_source = self.changes > KNOWN;
        let is_frozen = is_moving_source && self.still_s > FROZEN_S.max(STILL_FACTOR * self.usual_s);
        is_frozen.then_some(self.since_ns)
    }
}

/// Pictures per second, over the last second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Those that were processed.
    pub processed_hz: f32,
    /// Those that came, or that the camera should give where those are more.
    pub expected_hz: f32,
    /// Those that the job in force needs; `None` where that is not known.
    pub needed_hz: Option<f32>,
}

/// How many pictures are processed.
#[derive(Default)]
struct Rate {
    began_ns: Option<u64>,
    /// The time of each picture, and those before it that were not processed. The first one came before the time over which they are counted.
    recent: VecDeque<(u64, u32)>,
    needed_hz: Option<f32>,
    newest: Rates,
    slow_since_ns: Option<u64>,
}

/// The time over which pictures are counted, in seconds.
const RATE_OVER_S: f32 = 1.0;
/// A line that comes up leaves out the pictures that came before it was ready.
const SETTLING_S: f32 = 3.0;
/// Without a job, with less than this share of the pictures motion is not measured any more...
const ENOUGH: f32 = 0.5;
/// ... until there are more than this again: a share that lies between the two is not said again and again.
const ENOUGH_AGAIN: f32 = 0.6;
/// Of what the job needs, less than this share is too little: cameras are not exactly as fast as they say.
const ENOUGH_OF_NEEDED: f32 = 0.95;
/// ... until it is more than this again.
const ENOUGH_OF_NEEDED_AGAIN: f32 = 0.98;

impl Rate {
    fn step(&mut self, observation: &Observation, rate_hz: Option<f32>) {
        let began_ns = *self.began_ns.get_or_insert(observation.at_ns);
        let seconds = |from_ns: u64| observation.at_ns.saturating_sub(from_ns) as f32 / S;
        self.recent.push_back((observation.at_ns, observation.dropped));
        while self.recent.get(1).is_some_and(|(at_ns, _)| seconds(*at_ns) > RATE_OVER_S) {
            self.recent.pop_front();
        }
        let over_s = self.recent.front().map_or(0.0, |(at_ns, _)| seconds(*at_ns));
        if seconds(began_ns) <= SETTLING_S || over_s <= 0.0 {
            return;
        }
        let counted = self.recent.iter().skip(1);
        let dropped: u32 = counted.clone().map(|(_, dropped)| dropped).sum();
        let processed_hz = counted.len() as f32 / over_s;
        let expected_hz = (processed_hz + dropped as f32 / over_s).max(rate_hz.unwrap_or_default());
        self.newest = Rates { processed_hz, expected_hz, needed_hz: self.needed_hz };
        let [enough, again] = match self.needed_hz {
            Some(needed_hz) => [ENOUGH_OF_NEEDED, ENOUGH_OF_NEEDED_AGAIN].map(|share| share * needed_hz),
            None => [ENOUGH, ENOUGH_AGAIN].map(|share| share * expected_hz),
        };
        let is_slow = processed_hz < self.slow_since_ns.map_or(enough, |_| again);
        self.slow_since_ns = is_slow.then(|| self.slow_since_ns.unwrap_or(observation.at_ns));
    }

    fn slow_since_ns(&self) -> Option<u64> {
        self.slow_since_ns
    }
}

/// Where the markers of an observation are, by their ids.
type Places = heapless::Vec<(u16, [f32; 2]), OBJECTS>;

/// Whether markers and hands come together.
#[derive(Default)]
struct Work {
    has_seen_markers: bool,
    previous_ns: Option<u64>,
    /// Time with hands and without any marker so far, in seconds.
    hands_alone_s: f32,
    /// The newest observations: when, and where each marker was.
    recent: VecDeque<(u64, Places)>,
    /// Time for which parts have moved since a hand was last seen, in seconds, and since when.
    moving_s: f32,
    moving_since_ns: Option<u64>,
    newest_move_ns: u64,
}

/// Hands that have worked for so long without a marker work at a bench whose markers cannot be seen, in seconds.
const HANDS_ALONE_S: f32 = 5.0;
/// A part has moved when its marker is this far from where it was, in sides of the marker...
const MOVED: f32 = 0.12;
/// ... within this time, in seconds.
const MOVE_S: f32 = 0.25;
/// Parts that move for so long without a hand are moved by one that is not found, in seconds.
const HANDLESS_S: f32 = 1.0;
/// And nothing that moved longer ago than this counts, in seconds.
const FORGET_S: f32 = 5.0;
/// The longest step in time that counts, in seconds: nothing is known of a gap.
const MAX_STEP_S: f32 = 0.1;

impl Work {
    fn step(&mut self, observation: &Observation) {
        let since = |from_ns: u64| observation.at_ns.saturating_sub(from_ns) as f32 / S;
        let step_s = self.previous_ns.map_or(0.0, since).min(MAX_STEP_S);
        self.previous_ns = Some(observation.at_ns);
        self.has_seen_markers |= !observation.markers.is_empty();
        if observation.hands > 0 {
            self.hands_alone_s += step_s;
            self.moving_s = 0.0;
        }
        let moving = self.moving(observation);
        // One or two parts: where all move at once, the camera or the bench does.
        if observation.hands == 0 && moving > 0 && (moving < observation.markers.len() || moving == 1) {
            if self.moving_s == 0.0 {
                self.moving_since_ns = Some(observation.at_ns);
            }
            self.moving_s += step_s;
            self.newest_move_ns = observation.at_ns;
        } else if since(self.newest_move_ns) > FORGET_S {
            self.moving_s = 0.0;
        }
    }

    /// Number of markers that have moved lately. One that was out of sight for longer was moved when nobody saw.
    fn moving(&mut self, observation: &Observation) -> usize {
        let age_s = |at_ns: u64| observation.at_ns.saturating_sub(at_ns) as f32 / S;
        // With few pictures per second, the one before is all there is to compare with.
        let reach_s = |observations: usize| if observations > 1 { MOVE_S } else { 2.0 * MOVE_S };
        while self.recent.front().is_some_and(|(at_ns, _)| age_s(*at_ns) > reach_s(self.recent.len())) {
            self.recent.pop_front();
        }
        let has_moved = |(id, place): &(u16, [f32; 2])| {
            let mut before = self.recent.iter().flat_map(|(_, places)| places);
            before.any(|(known, was)| known == id && distance(*place, *was) > MOVED)
        };
        let places: Places = observation.markers.iter().map(|marker| (marker.id, marker.place())).collect();
        let moving = places.iter().filter(|place| has_moved(place)).count();
        self.recent.push_back((observation.at_ns, places));
        moving
    }

    fn is_without_markers(&self, observation: &Observation) -> bool {
        !self.has_seen_markers && (observation.foreign_markers > 0 || self.hands_alone_s > HANDS_ALONE_S)
    }

    fn handless_since_ns(&self) -> Option<u64> {
        self.moving_since_ns.filter(|_| self.moving_s > HANDLESS_S)
    }
}
