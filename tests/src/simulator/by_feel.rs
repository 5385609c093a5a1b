//! Work of two hands that nobody has drilled, as people do it at home and at a bench: by feel.
//!
//! One hand works with a tool at a base for as long as it likes. The other one holds the base, fetches a bottle, pours, puts it back, and begins
//! and ends when it likes. Counts, durations, ways and places differ widely from run to run (log-normal where they are times). Tool and bottle
//! are both at the base, so that now this one is nearer to the other and now that one. Hands wait and correct their grips, and the marker of
//! the bottle may be lost while it is held.

use super::arm::{Arm, Swing, see};
use super::bench::{
    BOTTLE_ID, BOWL_ID, BRUSH_ID, Bench, CLOTH_ID, GLUE_ID, PLATE_ID, SPRAY_ID, TRAY_ID, WHISK_ID,
};
use super::performance::Performance;
use super::{Random, Vector, add};
use andon_core::input::Side;
use andon_learn::recording::Recording;
use std::ops::Range;

/// Work that is done by feel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ByFeel {
    /// The right hand stirs in a bowl with a whisk, the left one holds the bowl and then pours from a bottle.
    Kitchen,
    /// The right hand brushes in a tray, the left one holds the tray and then draws lines of glue in it.
    Workshop,
    /// The left hand wipes a plate with a cloth, for as long as it likes. The right one holds the plate, and sprays while it is wiped or afterwards.
    Cleaning,
}

/// What may be wrong with such work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lapse {
    /// The hand works for three tenths of the time.
    CutShort,
    /// The bottle is taken and put back without pouring.
    NotPoured,
    /// The bottle is never taken.
    BottleLeft,
    /// The bottle comes before the base is held.
    BottleFirst,
}

impl ByFeel {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Kitchen, Self::Workshop, Self::Cleaning];

    /// A name for files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kitchen => "kitchen",
            Self::Workshop => "workshop",
            Self::Cleaning => "cleaning",
        }
    }

    /// The hand that works with the tool, and the one that helps.
    const fn hands(self) -> [Side; 2] {
        match self {
            Self::Kitchen | Self::Workshop => [Side::Right, Side::Left],
            Self::Cleaning => [Side::Left, Side::Right],
        }
    }

    const fn layout(self) -> Layout {
        match self {
            Self::Kitchen => Layout {
                tool: (WHISK_ID, [0.24, 0.16]),
                bottle: (BOTTLE_ID, [-0.21, 0.22]),
                base: (BOWL_ID, [0.0, 0.1]),
                worked_at: [0.05, -0.02],
                poured_at: [-0.025, -0.01],
                held_at: [-0.085, -0.01],
            },
            Self::Workshop => Layout {
                tool: (BRUSH_ID, [0.22, 0.02]),
                bottle: (GLUE_ID, [-0.14, 0.32]),
                base: (TRAY_ID, [0.0, 0.12]),
                worked_at: [0.035, -0.03],
                poured_at: [-0.015, 0.025],
                held_at: [-0.075, -0.05],
            },
            Self::Cleaning => Layout {
                tool: (CLOTH_ID, [-0.2, 0.05]),
                bottle: (SPRAY_ID, [0.24, 0.2]),
                base: (PLATE_ID, [0.0, 0.1]),
                worked_at: [-0.03, 0.02],
                poured_at: [0.035, 0.0],
                held_at: [0.08, -0.03],
            },
        }
    }
}

impl Lapse {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::CutShort, Self::NotPoured, Self::BottleLeft, Self::BottleFirst];

    /// A name for files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CutShort => "cut_short",
            Self::NotPoured => "not_poured",
            Self::BottleLeft => "bottle_left",
            Self::BottleFirst => "bottle_first",
        }
    }
}

/// The parts and where they lie, and where the hands bring them, seen from the base.
struct Layout {
    tool: (u16, Vector),
    bottle: (u16, Vector),
    base: (u16, Vector),
    worked_at: Vector,
    poured_at: Vector,
    held_at: Vector,
}

/// For how long and where a person does what, by habit or in one run.
#[derive(Clone, Copy, Debug)]
struct Plan {
    /// When the working and the helping hand begin.
    begins_s: [f64; 2],
    works_s: f64,
    /// For how long the working hand stops in between.
    stops_s: f64,
    /// For how long the helping hand holds the base after the work has begun.
    holds_on_s: f64,
    pours_s: f64,
    /// For how long the working hand goes on after the bottle is back, where it waits for that.
    goes_on_s: f64,
    worked_at: Vector,
    poured_at: Vector,
    held_at: Vector,
    swing: Swing,
}

impl Plan {
    /// The habits of people in general.
    fn usual(work: ByFeel) -> Self {
        let Layout { worked_at, poured_at, held_at, .. } = work.layout();
        let (roundness, along, period_s) = match work {
            ByFeel::Kitchen => (0.7, 0.8, 0.7),
            ByFeel::Workshop => (0.25, 0.2, 0.6),
            ByFeel::Cleaning => (0.4, 2.0, 0.8),
        };
        Self {
            begins_s: [0.6, 0.5],
            works_s: 7.0,
            stops_s: 0.8,
            holds_on_s: 0.8,
            pours_s: 2.5,
            goes_on_s: 0.9,
            worked_at,
            poured_at,
            held_at,
            swing: Swing { size_m: 0.034, roundness, along, period_s },
        }
    }

    /// Times that differ by factors of this deviation, and places by centimetres of three times as much.
    fn varied(self, deviation: f64, random: &mut Random) -> Self {
        let mut place = |[x, y]: Vector| {
            let deviation_m = 0.03 * deviation;
            [x + deviation_m * random.normal(), y + deviation_m * random.normal()]
        };
        let (worked_at, poured_at, held_at) =
            (place(self.worked_at), place(self.poured_at), place(self.held_at));
        let along = self.swing.along + deviation * random.normal();
        let mut time = |seconds: f64, share: f64| seconds * random.factor(share * deviation);
        Self {
            begins_s: self.begins_s.map(|begins_s| time(begins_s, 1.6)),
            works_s: time(self.works_s, 0.8),
            stops_s: time(self.stops_s, 1.5),
            holds_on_s: time(self.holds_on_s, 1.5),
            pours_s: time(self.pours_s, 1.2),
            goes_on_s: time(self.goes_on_s, 1.5),
            worked_at,
            poured_at,
            held_at,
            swing: Swing {
                size_m: time(self.swing.size_m, 0.7),
                roundness: time(self.swing.roundness, 1.0),
                along,
                period_s: time(self.swing.period_s, 0.4),
            },
        }
    }
}

/// Does the work by feel: right, or with this lapse. What one person does in the same repetition is the same but for the lapse.
pub fn perform_by_feel(performance: &Performance, work: ByFeel, lapse: Option<Lapse>) -> Recording {
    let (person, mut random) = performance.person(200 + work as u64);
    let mut habit = Random::new(performance.seed, &[6, performance.person, work as u64]);
    let plan = Plan::usual(work).varied(0.25, &mut habit).varied(0.25, &mut random);
    let layout = work.layout();
    let parts = [layout.tool, layout.bottle, layout.base].map(|(id, [x, y])| (id, x, y, 0.0));
    let mut bench = Bench::new(&parts);
    performance.settle(&mut bench, &person, &mut random);
    let rate_hz = performance.noise.rate_hz;
    let arm = |side: Side| {
        let own = Random::new(
            performance.seed,
            &[7, performance.person, performance.repetition, side as u64, work as u64],
        );
        let mut arm = Arm::new(&person, side, rate_hz, own);
        let aside = if side == Side::Left { -0.11 } else { 0.08 };
        arm.rest_at([aside + 0.02 * random.normal(), -0.1 + 0.02 * random.normal()]);
        arm
    };
    let mut arms = work.hands().map(arm);
    let bottle = layout.bottle.0;
    let own = Random::new(performance.seed, &[8, performance.person, performance.repetition, work as u64]);
    let mut stage = Stage { bench: &bench, layout, plan, work, lapse, random: own };
    let carried = stage.act(&mut arms);
    arms.iter_mut().for_each(Arm::go_home);
    if work.hands()[0] == Side::Left {
        arms.reverse();
    }
    let mut habit = Random::new(performance.seed, &[4, performance.person]);
    let mut seen = see(arms, &bench, &performance.noise, &mut habit, &mut random);
    if let Some(carried) = carried
        && random.uniform() < 0.3
    {
        lose(&mut seen, bottle, carried, &mut random);
    }
    seen
}

/// Loses the marker of a part for 0.3 to 1.5 s within this time, in seconds.
fn lose(recording: &mut Recording, id: u16, held_s: Range<f64>, random: &mut Random) {
    let from_s = random.between(held_s.start, held_s.end);
    let lost_s = from_s..(from_s + random.between(0.3, 1.5)).min(held_s.end);
    for frame in &mut recording.frames {
        if lost_s.contains(&(frame.captured_ns as f64 * 1e-9)) {
            frame.objects.retain(|object| object.id != id);
        }
    }
}

struct Stage<'a> {
    bench: &'a Bench,
    layout: Layout,
    plan: Plan,
    work: ByFeel,
    lapse: Option<Lapse>,
    random: Random,
}

impl<'a> Stage<'a> {
    /// Both hands do their work. The time in which the bottle is held, in seconds, if it is.
    fn act(&mut self, [working, helping]: &mut [Arm<'a>; 2]) -> Option<Range<f64>> {
        let plan = self.plan;
        let (tool, base) = (self.layout.tool.0, self.at(self.layout.base.0));
        working.wait(plan.begins_s[0]);
        helping.wait(plan.begins_s[1]);
        working.grasp(tool, self.at(tool));
        working.lift();
        let worked_at = add(base, plan.worked_at);
        working.wander_to(worked_at);
        let begun_s = working.now_s();
        let carried = self.accompany(helping, begun_s + plan.holds_on_s);
        let mut works_s = match self.work {
            ByFeel::Kitchen | ByFeel::Workshop => {
                plan.works_s.max(helping.now_s() + plan.goes_on_s - begun_s)
            }
            ByFeel::Cleaning => plan.works_s,
        };
        if self.lapse == Some(Lapse::CutShort) {
            works_s *= 0.3;
        }
        if self.random.uniform() < 0.4 {
            working.work(worked_at, plan.swing, begun_s + self.random.uniform() * works_s);
            working.wait(plan.stops_s);
        }
        working.work(worked_at, plan.swing, begun_s + works_s);
        working.put(self.at(tool));
        carried
    }

    /// The helping hand holds the base until this time or longer, and pours. The time in which it holds the bottle.
    fn accompany(&mut self, helping: &mut Arm<'a>, held_until_s: f64) -> Option<Range<f64>> {
        if self.lapse == Some(Lapse::BottleFirst) {
            let carried = self.fetch(helping);
            self.hold(helping, held_until_s);
            return Some(carried);
        }
        self.hold(helping, held_until_s);
        (self.lapse != Some(Lapse::BottleLeft)).then(|| self.fetch(helping))
    }

    fn hold(&mut self, helping: &mut Arm<'a>, until_s: f64) {
        let base = self.layout.base.0;
        helping.grasp(base, add(self.at(base), self.plan.held_at));
        helping.fidget(0.0015, (until_s - helping.now_s()).max(0.6));
        helping.release();
    }

    /// The hand takes the bottle, pours, and puts it back. The time in which it holds it.
    fn fetch(&mut self, helping: &mut Arm<'a>) -> Range<f64> {
        let bottle = self.layout.bottle.0;
        let (lies, base) = (self.at(bottle), self.at(self.layout.base.0));
        helping.grasp(bottle, lies);
        let taken_s = helping.now_s();
        helping.lift();
        if self.lapse != Some(Lapse::NotPoured) {
            let poured_at = add(base, self.plan.poured_at);
            helping.wander_to(poured_at);
            match self.work {
                ByFeel::Kitchen | ByFeel::Cleaning => helping.fidget(0.006, self.plan.pours_s),
                ByFeel::Workshop => {
                    let lines = Swing { size_m: 0.018, roundness: 0.2, along: 0.1, period_s: 1.4 };
                    helping.work(poured_at, lines, helping.now_s() + self.plan.pours_s);
                }
            }
        }
        helping.put(lies);
        taken_s..helping.now_s()
    }

    fn at(&self, id: u16) -> Vector {
        self.bench.pose(id).at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulator::{Noise, length, subtract};

    fn recording(work: ByFeel, repetition: u64, lapse: Option<Lapse>) -> Recording {
        let noise = Noise::motion_capture();
        perform_by_feel(&Performance { seed: 71, person: 1, repetition, noise }, work, lapse)
    }

    /// Where a part is seen, with the time in seconds.
    fn seen(recording: &Recording, id: u16) -> Vec<(f64, Vector)> {
        let of_frame = |frame: &andon_core::input::Frame| {
            let object = frame.objects.iter().find(|object| object.id == id)?;
            let [x, y, _] = object.position.map(f64::from);
            Some((frame.captured_ns as f64 * 1e-9, [x, y]))
        };
        recording.frames.iter().filter_map(of_frame).collect()
    }

    /// How far two parts are from each other in each frame that shows both, in metres.
    fn gaps_m(recording: &Recording, one: u16, other: u16) -> Vec<(f64, f64)> {
        let others = seen(recording, other);
        let gap_m = |(time_s, at): &(f64, Vector)| {
            let same = others.iter().find(|(other_s, _)| other_s == time_s)?;
            Some((*time_s, length(subtract(*at, same.1))))
        };
        seen(recording, one).iter().filter_map(gap_m).collect()
    }

    /// How near two parts come to each other, in metres.
    fn nearest_m(recording: &Recording, one: u16, other: u16) -> f64 {
        gaps_m(recording, one, other).iter().map(|(_, gap_m)| *gap_m).fold(f64::INFINITY, f64::min)
    }

    /// For how long a part is away from where it first is, in seconds.
    fn away_s(recording: &Recording, id: u16) -> f64 {
        let places = seen(recording, id);
        let is_away = |at: Vector| length(subtract(at, places[0].1)) > 0.1;
        places.iter().filter(|(_, at)| is_away(*at)).count() as f64 / 30.0
    }

    #[test]
    fn a_lapse_leaves_out_what_every_right_run_has() {
        for work in ByFeel::ALL {
            let Layout { tool: (tool, _), bottle: (bottle, _), base: (base, _), .. } = work.layout();
            for repetition in 0..10 {
                let with = |lapse| recording(work, repetition, lapse);
                let right = with(None);
                assert!(nearest_m(&right, bottle, base) < 0.07);
                assert!(nearest_m(&with(Some(Lapse::NotPoured)), bottle, base) > 0.1);
                assert!(away_s(&with(Some(Lapse::BottleLeft)), bottle) < 0.1);
                let cut_short = with(Some(Lapse::CutShort));
                assert!(away_s(&cut_short, tool) < 0.6 * away_s(&right, tool));
                let moved_s = |recording: &Recording| {
                    let places = seen(recording, bottle);
                    let first = places[0].1;
                    places
                        .iter()
                        .find(|(_, at)| length(subtract(*at, first)) > 0.1)
                        .map(|(time_s, _)| *time_s)
                };
                assert!(moved_s(&with(Some(Lapse::BottleFirst))) < moved_s(&right));
            }
        }
    }

    #[test]
    fn the_bottle_at_the_base_is_nearer_to_the_tool_in_some_runs_and_never_in_others() {
        let noise = Noise::motion_capture();
        for work in ByFeel::ALL {
            let Layout { tool: (tool, _), bottle: (bottle, _), base: (base, _), .. } = work.layout();
            let is_nearer_to_tool = |run: &u64| {
                let performance = Performance { seed: 71, person: run / 4, repetition: *run, noise };
                let recording = perform_by_feel(&performance, work, None);
                let (to_base, to_tool) = (gaps_m(&recording, bottle, base), gaps_m(&recording, bottle, tool));
                to_base.iter().zip(&to_tool).any(|(base, tool)| base.1 < 0.08 && tool.1 < base.1)
            };
            let count = (0..40).filter(is_nearer_to_tool).count();
            assert!((2..=38).contains(&count), "{work:?}: {count} of 40");
        }
    }

    #[test]
    fn the_marker_of_the_bottle_is_lost_in_some_runs() {
        let whole = |repetition: &u64| {
            let seen_run = recording(ByFeel::Kitchen, *repetition, None);
            seen(&seen_run, BOTTLE_ID).len() == seen_run.frames.len()
        };
        assert!((1..20).contains(&(0..20).filter(whole).count()));
    }

    #[test]
    fn the_same_seed_gives_the_same_runs() {
        let again = || recording(ByFeel::Workshop, 3, None).frames;
        assert_eq!(again(), again());
    }
}
