//! The runs as recorded by motion capture, and what is composed of them.

use andon_core::config::{Contact, Method};
use andon_core::input::{Frame, Hand, Object, Point, Side, Space};
use andon_core::object::ObjectShape;
use andon_learn::recording::{Header, Landmarks, NamedObject, Recording};
use andon_tests::simulator::{LastingErrors, Random};
use std::path::PathBuf;

/// Frame rate of the recording.
pub(crate) const RATE_HZ: f32 = 60.0;

/// Number of markers, in the order of the columns: hand top, right, left, thumb, index, middle, box back, left.
const MARKERS: usize = 8;

/// How many of them are those of the hand, which come first.
const HAND_MARKERS: usize = 6;

/// Half a second.
const BRIDGE_FRAMES: usize = RATE_HZ as usize / 2;

/// So many frames before the label says that the box has come, it is in the hand and at the table.
const HOLD_BEFORE_FRAMES: i64 = 3;

/// Id of the box, which is moved from the shelf to the table and back.
pub(crate) const BOX: u16 = 1;
/// Id of the table.
pub(crate) const TABLE: u16 = 2;
/// Id of the shelf.
pub(crate) const SHELF: u16 = 3;

/// Where the hand holds the box, in metres in the frame of the box. The centre of the finger tips while it moves, as median over the runs.
const GRASP: Point = [0.01, 0.115, 0.0];

/// Where the box rests on the table and on the shelf, in metres. On the shelf the position varies by 6 cm to both sides.
const TABLE_AT: Point = [-0.05, 0.12, -0.345];
const SHELF_AT: Point = [0.50, -0.775, 0.19];

/// One frame: the position of each marker in metres, or `None` if it was not seen.
#[derive(Clone, Debug)]
struct Instant {
    number: i64,
    markers: [Option<Point>; MARKERS],
}

/// One run.
#[derive(Clone, Debug)]
pub(crate) struct Capture {
    instants: Vec<Instant>,
    labels: Vec<(String, i64, i64)>,
    /// Rotation of everything about the vertical axis, in radians.
    yaw: f32,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/vmci_pickplace")
}

impl Capture {
    /// Reads a run, 1 to 9.
    pub(crate) fn read(run: u32) -> Self {
        let text = std::fs::read_to_string(folder().join(format!("tracks/subject1_run{run}.csv"))).unwrap();
        let labels = std::fs::read_to_string(
            folder().join(format!("labels/subject1_run{run}_manually_segmented.json")),
        );
        let labels: serde_json::Value = serde_json::from_str(&labels.unwrap()).unwrap();
        let label = |label: &serde_json::Value| {
            let frame = |key: &str| label[key].as_i64().unwrap();
            (label["label"].as_str().unwrap().to_owned(), frame("start index"), frame("end index"))
        };
        Self {
            instants: text.lines().skip(1).map(instant).collect(),
            labels: labels.as_array().unwrap().iter().map(label).collect(),
            yaw: 0.0,
        }
    }

    /// First and last frame of a label.
    fn label(&self, name: &str) -> (i64, i64) {
        let (_, from, to) = self.labels.iter().find(|(label, ..)| label == name).unwrap();
        (*from, *to)
    }

    fn keep(mut self, keep: impl Fn(i64) -> bool) -> Self {
        self.instants.retain(|instant| keep(instant.number));
        self
    }

    /// Ends after the box has been brought to the table.
    pub(crate) fn without_second_half(self) -> Self {
        let last = self.label("move_to_rest_right").1;
        self.keep(|number| number <= last)
    }

    /// Moves the box back to the shelf first, and to the table afterwards.
    pub(crate) fn halves_swapped(self) -> Self {
        let middle = self.label("move_to_rest_right").1;
        let mut second = self.clone().keep(|number| number > middle);
        second.instants.extend(self.keep(|number| number <= middle).instants);
        second
    }

    /// The same, as a person can do it. The hand goes from where one half ends to where the other one begins within half a second. It takes the box
    /// from where it has put it.
    pub(crate) fn halves_swapped_without_a_jump(self) -> Self {
        let middle = self.label("move_to_rest_right").1;
        let (approach, carry) = (self.label("approach_forward"), self.label("move_obj_table"));
        let mut second = self.clone().keep(|number| number > middle);
        let mut first = self.keep(|number| number <= middle);
        let left = first_seen(second.instants.iter().rev());
        let found = first_seen(first.instants.iter());
        let [at, from] = [left, found].map(|markers| mean(&markers[HAND_MARKERS..]).unwrap());
        let shift = [0, 1, 2].map(|axis| at[axis] - from[axis]);
        let share = |number: i64, (from, to): (i64, i64)| {
            eased(((number - from) as f32 / (to - from).max(1) as f32).clamp(0.0, 1.0))
        };
        for Instant { number, markers } in &mut first.instants {
            let of_box = 1.0 - share(*number, carry);
            let of_hand = of_box.min(share(*number, (approach.0, carry.0)));
            for (marker, point) in markers.iter_mut().enumerate() {
                let share = if marker < HAND_MARKERS { of_hand } else { of_box };
                *point = point.map(|point| [0, 1, 2].map(|axis| point[axis] + share * shift[axis]));
            }
        }
        let found = first_seen(first.instants.iter());
        let between = (1..BRIDGE_FRAMES).map(|frame| Instant {
            number: middle,
            markers: std::array::from_fn(|marker| {
                let share = eased(frame as f32 / BRIDGE_FRAMES as f32);
                let ends = left[marker].zip(found[marker]);
                ends.map(|(from, to)| [0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis])))
            }),
        });
        second.instants.extend(between);
        second.instants.extend(first.instants);
        second
    }

    /// Ends halfway back to the shelf.
    pub(crate) fn cut_short(self) -> Self {
        let (from, to) = self.label("move_obj_shelf");
        self.keep(|number| number <= (from + to) / 2)
    }

    /// Has each frame at twice its time, and another frame halfway between each two frames.
    pub(crate) fn half_speed(self) -> Self {
        let halfway = |one: &Instant, next: &Instant| Instant {
            number: one.number,
            markers: std::array::from_fn(|marker| {
                mean(&[Some(one.markers[marker]?), Some(next.markers[marker]?)])
            }),
        };
        let pairs = self.instants.windows(2).flat_map(|pair| [pair[0].clone(), halfway(&pair[0], &pair[1])]);
        let instants = pairs.chain(self.instants.last().cloned()).collect();
        Self { instants, ..self }
    }

    /// Has every second frame, each at half its time.
    pub(crate) fn twice_the_speed(self) -> Self {
        Self { instants: self.instants.into_iter().step_by(2).collect(), ..self }
    }

    /// Stops for so many seconds where the box has come to the table.
    pub(crate) fn held_at_the_table(self, seconds: f32) -> Self {
        let arrival = self.label("move_obj_table").1 - HOLD_BEFORE_FRAMES;
        let repeated = |instant: Instant| {
            let is_held = instant.number == arrival;
            vec![instant; if is_held { (seconds * RATE_HZ) as usize } else { 1 }]
        };
        Self { instants: self.instants.into_iter().flat_map(repeated).collect(), ..self }
    }

    /// Leads hand and box to the table over an arc that is higher by so many metres. Leaves it as gently as it comes to it.
    pub(crate) fn over_an_arc(mut self, metres: f32) -> Self {
        let (from, to) = self.label("move_obj_table");
        for Instant { number, markers } in &mut self.instants {
            let share = ((*number - from) as f32 / (to - from) as f32).clamp(0.0, 1.0);
            let up = metres * (share * std::f32::consts::PI).sin().powi(2);
            markers.iter_mut().flatten().for_each(|point| point[2] += up);
        }
        self
    }

    /// Has the whole bench turned by 30 degrees about the vertical axis.
    pub(crate) fn turned(mut self) -> Self {
        self.yaw = 30_f32.to_radians();
        self
    }

    /// Is seen with an error of its own in each frame for the hand, each of its landmarks and each object. It has this standard deviation along each
    /// axis, in metres. The seed chooses the errors.
    pub(crate) fn recording_with_errors(&self, deviation_m: f64, seed: u64) -> Recording {
        let mut random = Random::new(seed, &[6]);
        let mut recording = self.recording();
        for frame in &mut recording.frames {
            for hand in &mut frame.hands {
                let common = [(); 3].map(|()| random.normal());
                for point in hand.tips.iter_mut().chain([&mut hand.wrist, &mut hand.middle_knuckle]) {
                    let error = common.map(|common| (deviation_m * (common + random.normal())) as f32);
                    *point = [0, 1, 2].map(|axis| point[axis] + error[axis]);
                }
            }
            for object in &mut frame.objects {
                object.position = object.position.map(|value| value + (deviation_m * random.normal()) as f32);
            }
        }
        recording
    }

    /// Is seen by a tracker that filters, so that the error of the hand and that of each object last. It has this standard deviation along each axis,
    /// in metres, and a third of it is left after a third of a second. The seed chooses the errors.
    pub(crate) fn recording_with_lasting_errors(&self, deviation_m: f64, seed: u64) -> Recording {
        let kept = (-3.0 / f64::from(RATE_HZ)).exp();
        let mut random = Random::new(seed, &[7]);
        let mut errors = LastingErrors::new(kept);
        let moved = |point: Point, error: [f64; 3]| {
            [0, 1, 2].map(|axis| point[axis] + (deviation_m * error[axis]) as f32)
        };
        let mut recording = self.recording();
        for frame in &mut recording.frames {
            for hand in &mut frame.hands {
                let error = errors.next(0, &mut random);
                for point in hand.tips.iter_mut().chain([&mut hand.wrist, &mut hand.middle_knuckle]) {
                    *point = moved(*point, error);
                }
            }
            for object in &mut frame.objects {
                object.position = moved(object.position, errors.next(object.id, &mut random));
            }
        }
        recording
    }

    /// The run as a tracker would record it.
    pub(crate) fn recording(&self) -> Recording {
        let frames = self.instants.iter().enumerate().map(|(index, instant)| self.frame(index, instant));
        Recording { header: header(), frames: frames.collect(), truncation: None }
    }

    fn frame(&self, index: usize, instant: &Instant) -> Frame {
        let captured_ns = (index as f64 / f64::from(RATE_HZ) * 1e9).round() as u64;
        let mut frame = Frame { captured_ns, ..Frame::default() };
        let turned = instant.markers.map(|marker| marker.map(|point| turn(point, self.yaw)));
        let [top, right, left, thumb, index, middle, back, side] = turned;
        // A tip that was not seen is assumed where the others are.
        let tips = [thumb, index, middle];
        if let (Some(hand), Some(seen)) = (mean(&[top, right, left]), mean(&tips)) {
            let tips = tips.map(|tip| tip.unwrap_or(seen));
            let hand = Hand { side: Side::Right, score: 1.0, wrist: hand, middle_knuckle: hand, tips };
            frame.hands.push(hand).unwrap();
        }
        if let (Some(back), Some(side)) = (back, side) {
            let yaw = (side[1] - back[1]).atan2(side[0] - back[0]);
            let middle = mean(&[Some(back), Some(side)]).unwrap();
            frame.objects.push(object(BOX, middle, yaw)).unwrap();
        }
        for (id, at) in [(TABLE, TABLE_AT), (SHELF, SHELF_AT)] {
            frame.objects.push(object(id, turn(at, self.yaw), self.yaw)).unwrap();
        }
        frame
    }
}

fn instant(line: &str) -> Instant {
    let mut fields = line.split(',');
    let number = fields.next().unwrap().parse().unwrap();
    // The column of seconds is skipped: it is the number divided by the rate.
    let values: Vec<Option<f32>> =
        fields.skip(1).map(|field| field.parse().ok().map(|mm: f32| 0.001 * mm)).collect();
    let point = |marker: usize| Some([values[3 * marker]?, values[3 * marker + 1]?, values[3 * marker + 2]?]);
    Instant { number, markers: std::array::from_fn(point) }
}

fn header() -> Header {
    let object = |id, name: &str, points: &[Point]| NamedObject {
        name: name.to_owned(),
        shape: ObjectShape {
            id,
            interaction_points: points.iter().copied().collect(),
            ..ObjectShape::default()
        },
    };
    Header {
        rate_hz: RATE_HZ,
        space: Space::Metric,
        hands: vec![Side::Right],
        landmarks: Landmarks::Five,
        objects: vec![
            object(BOX, "box", &[GRASP, [0.0; 3]]),
            object(TABLE, "table", &[[0.0; 3]]),
            object(SHELF, "shelf", &[[-0.05, 0.0, 0.0], [0.0; 3], [0.05, 0.0, 0.0]]),
        ],
    }
}

fn object(id: u16, position: Point, yaw: f32) -> Object {
    Object { id, position, orientation: [(0.5 * yaw).cos(), 0.0, 0.0, (0.5 * yaw).sin()] }
}

fn turn([x, y, z]: Point, yaw: f32) -> Point {
    let (sin, cos) = yaw.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

/// Where each marker is seen first.
fn first_seen<'a>(instants: impl Iterator<Item = &'a Instant>) -> [Option<Point>; MARKERS] {
    instants.fold([None; MARKERS], |first, instant| {
        std::array::from_fn(|marker| first[marker].or(instant.markers[marker]))
    })
}

/// From 0 to 1 as a hand moves: with the least jerk.
fn eased(share: f32) -> f32 {
    share.powi(3) * (10.0 - 15.0 * share + 6.0 * share.powi(2))
}

/// The mean of the points that were seen; `None` if none was seen.
fn mean(points: &[Option<Point>]) -> Option<Point> {
    let seen: Vec<Point> = points.iter().copied().flatten().collect();
    let count = seen.len() as f32;
    (!seen.is_empty())
        .then(|| [0, 1, 2].map(|axis| seen.iter().map(|point| point[axis]).sum::<f32>() / count))
}

/// The constants for these recordings.
pub(crate) fn method() -> Method {
    Method {
        space: Space::Metric,
        rate_hz: RATE_HZ,
        // A finger tip is up to 6 cm from the centre of the tips, where the box is taken.
        hand_contact: Contact { on_m: 0.08, off_m: 0.11 },
        // This is the distance from the centre of the box to its resting place in the other runs.
        object_contact: Contact { on_m: 0.08, off_m: 0.11 },
        // This is a sixth of a second, like five frames at 30 Hz.
        persist_frames: 10,
        ..Method::default()
    }
}
