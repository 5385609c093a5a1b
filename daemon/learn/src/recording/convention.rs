//! Whether places, times and rotations are meant as this format has them: other trackers write millimetres, milliseconds and x, y, z, w.
//!
//! Nothing is converted: what is refused here is certainly something else, and which of several units it is, is a guess.

use crate::statistics::median;
use andon_core::input::{Hand, Object, Space};

/// So many hands, and as many steps in time, show the unit: one that a tracker misplaces decides nothing.
const HANDS: usize = 15;
const STEPS: usize = 8;
/// So many rotations show their order.
const ROTATIONS: usize = 20;

/// No hand is as long, from its wrist to the tip of its middle finger, in metres. Those of people are at most 0.23 m long.
const MAX_HAND_M: f64 = 0.6;

/// No point of a part lies farther from its marker, in metres: the longest parts of a bench reach over it.
const MAX_POINT_M: f64 = 5.0;

/// A rate may be wrong by this factor before its unit is doubted: what a header says is often the camera's, not the tracker's.
const MAX_WRONG_RATE: f64 = 4.0;

/// A part that is turned about the bench's normal has no more of a rotation about the other axes than this. It is the square of half of a tilt of 11
/// degrees.
const MAX_TILT: f64 = 0.01;
/// A part is turned so far, by half the angle, that another order of the numbers cannot be meant.
const MIN_TURN: f64 = 0.2;
/// Where there is no rotation about the other axes, because the tracker knows only the bench's normal, hardly any turn is needed. Nothing that is
/// measured keeps to exactly half a turn.
const NO_TILT: f64 = 1e-6;
const MIN_TURN_WITHOUT_TILT: f64 = 0.005;

/// What lies in a plane and has the same second number, to this many metres, has its height second. The third number then differs by so much.
const SAME_M: f32 = 0.001;
const APART_M: f32 = 0.05;

#[derive(Debug)]
pub(super) struct Conventions {
    rate_hz: f64,
    space: Space,
    /// Lengths of hands; none any more when they were looked at.
    hands: Option<Vec<f64>>,
    newest_t: Option<f64>,
    /// Steps in time, likewise.
    steps: Option<Vec<f64>>,
    rotations: Rotations,
    /// How many hands were seen, and the least and the largest y and z of hands and parts.
    places: (usize, [[f32; 2]; 2]),
}

/// The range of the rotations, with the last number positive: q and -q are the same one.
#[derive(Debug, Default)]
struct Rotations {
    count: usize,
    /// The largest square of the first two numbers.
    first_two: f64,
    /// The least and the largest third number.
    third: [f64; 2],
}

impl Conventions {
    pub(super) fn new(rate_hz: f64, space: Space) -> Self {
        Self {
            rate_hz,
            space,
            hands: Some(Vec::new()),
            newest_t: None,
            steps: Some(Vec::new()),
            rotations: Rotations::default(),
            places: (0, [[f32::INFINITY, f32::NEG_INFINITY]; 2]),
        }
    }

    /// Takes the time of a frame, as the file has it.
    pub(super) fn time(&mut self, t: f64) -> Result<(), String> {
        let before = self.newest_t.replace(t);
        let Some(steps) = &mut self.steps else { return Ok(()) };
        steps.extend(before.map(|before| t - before));
        if steps.len() < STEPS { Ok(()) } else { self.look_at_steps() }
    }

    pub(super) fn frame(&mut self, hands: &[Hand], objects: &[Object]) -> Result<(), String> {
        if let Some(lengths) = &mut self.hands {
            lengths.extend(hands.iter().map(length));
            if lengths.len() >= HANDS {
                self.look_at_hands()?;
            }
        }
        objects.iter().try_for_each(|object| self.rotation(object))?;
        self.place(hands, objects)
    }

    /// A hand that works in a plane moves in both of its directions, so a second number that never changes is no y.
    fn place(&mut self, hands: &[Hand], objects: &[Object]) -> Result<(), String> {
        let (count, [y, z]) = &mut self.places;
        let places = hands.iter().map(|hand| hand.wrist).chain(objects.iter().map(|object| object.position));
        for place in places {
            for (range, value) in [(&mut *y, place[1]), (&mut *z, place[2])] {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        *count += hands.len();
        let is_same = *count >= HANDS && y[1] - y[0] < SAME_M && z[1] - z[0] > APART_M;
        if self.space == Space::Plane && is_same {
            Err(format!(
                "all hands and parts have the same y, {}, and their z differ. In space \"plane\" the bench is x and y, and these places \
                 seem to have their height second; write [x, z, y], and turn q likewise",
                f64::from(y[0])
            ))
        } else {
            Ok(())
        }
    }

    /// Looks at what there is of a file that ends here.
    pub(super) fn end(&mut self) -> Result<(), String> {
        self.look_at_hands()?;
        self.look_at_steps()
    }

    fn look_at_hands(&mut self) -> Result<(), String> {
        let Some(lengths) = self.hands.take().filter(|lengths| !lengths.is_empty()) else { return Ok(()) };
        let length = median(&lengths);
        // A fist is at least 40 mm long, and a hand that is stretched 2.5 cm.
        let unit = match length {
            ..=MAX_HAND_M => return Ok(()),
            40.0.. => "millimetres; divide them by 1000",
            2.5.. => "centimetres; divide them by 100 (inches by 39.37)",
            _ => "another unit; convert them",
        };
        Err(format!(
            "a hand is {length:.1} long, from its wrist to the tip of its middle finger: places are in metres, and these seem to be in {unit}"
        ))
    }

    fn look_at_steps(&mut self) -> Result<(), String> {
        let Some(steps) = self.steps.take().filter(|steps| !steps.is_empty()) else { return Ok(()) };
        let step = median(&steps);
        let units = [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)];
        let is_meant = |factor: f64| {
            let times = step * self.rate_hz / factor;
            (1.0 / MAX_WRONG_RATE..=MAX_WRONG_RATE).contains(&times)
        };
        // Frames that are numbered differ by exactly one, or by a whole number where some are missing. A camera that sends one picture per second has no
        // such clock, and of one that sends few there may be two that are a second apart.
        let are_numbered = step == 1.0 && steps.iter().all(|step| step.fract() == 0.0);
        let numbers =
            Some(("frames", self.rate_hz)).filter(|_| are_numbered && self.rate_hz > MAX_WRONG_RATE);
        match units.into_iter().find(|(_, factor)| is_meant(*factor)).or(numbers) {
            None => Ok(()),
            Some((unit, factor)) => Err(format!(
                "t goes on by {step} from frame to frame, and at rate_hz {} it should by {:.4}. t is in seconds, and this seems to be in {unit}; \
                 divide it by {factor}",
                self.rate_hz,
                1.0 / self.rate_hz
            )),
        }
    }

    /// A part on a bench turns about the bench's normal, more than about any other axis. The numbers of the other two axes are small. Where these are
    /// the first two of all rotations, while the third one changes, the real part is the last.
    fn rotation(&mut self, object: &Object) -> Result<(), String> {
        let [a, b, c, d] = object.orientation.map(f64::from);
        let c = if d < 0.0 { -c } else { c };
        let Rotations { count, first_two, third: [least, most] } = &mut self.rotations;
        *count += 1;
        *first_two = first_two.max(a * a + b * b);
        (*least, *most) = (least.min(c), most.max(c));
        // In the plane the third number is zero. In three dimensions a part may lie on its back, and stays so.
        let turn = match self.space {
            Space::Plane => most.max(-*least),
            Space::Metric => (*most - *least) / 2.0,
        };
        let is_last =
            *first_two < MAX_TILT && turn > MIN_TURN || *first_two < NO_TILT && turn > MIN_TURN_WITHOUT_TILT;
        if *count >= ROTATIONS && is_last {
            return Err(format!(
                "q of object {} and of all others turns about no axis that a part on a bench turns about. Its numbers seem to stand in \
                 the order x, y, z, w; here it is [w, x, y, z]: put the last one first",
                object.id
            ));
        }
        Ok(())
    }
}

fn length(hand: &Hand) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(hand.tips[1][axis]) - f64::from(hand.wrist[axis]));
    (x * x + y * y + z * z).sqrt()
}

pub(super) fn packed(line: &[u8]) -> Option<&'static str> {
    line.starts_with(&[0x1f, 0x8b]).then_some("it is compressed; unpack it with gunzip")
}

/// What a first line that is no header says of the file: how another program has written it.
pub(super) fn other_text(line: &[u8]) -> Option<&'static str> {
    let line = line.trim_ascii();
    let lines = line.split(|byte| *byte == b'\r').filter(|line| !line.trim_ascii().is_empty()).count();
    Some(match line {
        _ if lines > 1 => {
            "its lines end with a carriage return alone; save it with the line ends of Unix or Windows"
        }
        [b'[', ..] => {
            "it is one list in JSON; write each of its objects on a line of its own, without brackets and commas around them"
        }
        b"{" => "an object goes over several lines; write each on one line",
        [b'{', b'\'', ..] => "it is what Python prints and no JSON; write each line with json.dumps",
        [b'{', .., b','] => {
            "a comma stands at the end of a line; write each object on a line of its own, without commas between them"
        }
        [b'{', ..] | [] => return None,
        _ => {
            "it is no JSON, as where a table (CSV) has the name of a track file. The lines of a track file are one JSON object each: a header, then a frame in each"
        }
    })
}

pub(super) fn point(id: u16, point: &[f64; 3]) -> Result<(), String> {
    let far = point.iter().fold(0.0_f64, |far, value| far.max(value.abs()));
    if far <= MAX_POINT_M {
        return Ok(());
    }
    Err(format!(
        "an interaction point of object {id} lies {far} from it: points are in metres, as places are: 100 mm is 0.1"
    ))
}

/// A text with `null` in place of each NaN, which is not JSON but what Python writes where nothing was seen. `None` where there is none.
pub(super) fn without_nan(line: &[u8]) -> Result<Option<Vec<u8>>, String> {
    const GAPS: [&[u8]; 4] = [b"NaN", b"nan", b"-NaN", b"-nan"];
    const INFINITE: [&str; 4] = ["Infinity", "-Infinity", "inf", "-inf"];
    let mut text = Vec::with_capacity(line.len());
    let (mut at, mut is_word, mut has_gap) = (0, false, false);
    while at < line.len() {
        let rest = &line[at..];
        if is_word {
            // A quote behind a backslash ends no word.
            let length = if rest[0] == b'\\' { 2.min(rest.len()) } else { 1 };
            is_word = rest[0] != b'"';
            text.extend_from_slice(&rest[..length]);
            at += length;
            continue;
        }
        if let Some(gap) = GAPS.iter().find(|gap| rest.starts_with(gap)) {
            has_gap = true;
            text.extend_from_slice(b"null");
            at += gap.len();
            continue;
        }
        if let Some(word) = INFINITE.iter().find(|word| rest.starts_with(word.as_bytes())) {
            return Err(format!(
                "{word} is no place; write null, or leave the part or the hand out of a frame in which it is not seen"
            ));
        }
        is_word = rest[0] == b'"';
        text.push(rest[0]);
        at += 1;
    }
    Ok(has_gap.then_some(text))
}
