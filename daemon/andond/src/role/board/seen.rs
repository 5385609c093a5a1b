//! What the line sees of a picture: each hand and part, and how its place is known.

use andon_board::{Thing, Visibility, What};
use andon_core::couple::Couple;
use andon_core::input::Side;
use andon_host::config::Config;
use shm_schemas::{Couples, Detections, LANDMARKS};

use crate::picture::{BONES, LastSeen};
use crate::wire;

/// What was seen last, and what is assumed by it.
#[derive(Clone)]
pub(super) struct Seen {
    hands: Vec<Side>,
    parts: Vec<u16>,
    seen: Detections,
    last_seen: LastSeen,
    held: Vec<Couple>,
}

impl Seen {
    /// The hands and parts of a station, none of which was seen yet.
    pub(super) fn new(config: &Config) -> Self {
        Self {
            hands: config.perception.hands.clone(),
            parts: config.objects.iter().map(|object| object.id).collect(),
            seen: Detections::default(),
            last_seen: LastSeen::new(config.method.blind_ms),
            held: Vec::new(),
        }
    }

    /// What was seen in the next picture.
    pub(super) fn take(&mut self, seen: &Detections) {
        self.last_seen.take(seen);
        self.seen = *seen;
    }

    /// What the hands hold by now.
    pub(super) fn hold(&mut self, couples: &Couples) {
        self.held = wire::couples::read(couples).hands.to_vec();
    }

    /// Nobody knows what is in the next picture.
    pub(super) fn miss(&mut self) {
        self.seen = Detections { source_ns: u64::MAX, ..Detections::default() };
    }

    /// The number of the newest picture of which it is known what was seen in it.
    pub(super) fn frame_seq(&self) -> u64 {
        self.seen.stamp.frame_seq
    }

    /// The hands and parts, each with how its place is known.
    pub(super) fn things(&self) -> Vec<Thing> {
        let hands = self.hands.iter().map(|side| self.hand(*side));
        hands.chain(self.parts.iter().map(|id| self.part(*id))).collect()
    }

    fn hand(&self, side: Side) -> Thing {
        let what = match side {
            Side::Right => What::RightHand,
            Side::Left => What::LeftHand,
        };
        let code = wire::verdict::hand(side).code();
        let mut hands = self.seen.hands().iter();
        let seen = hands.find(|hand| hand.hand == code).map(|hand| bones(&hand.landmarks_px));
        let mut hidden = self.last_seen.hands(&self.seen).into_iter();
        let assumed = || hidden.find(|(hand, _)| *hand == code).map(|(_, landmarks)| bones(&landmarks));
        thing(what, seen, assumed)
    }

    fn part(&self, id: u16) -> Thing {
        let mut objects = self.seen.seen_objects();
        let seen = objects.find(|object| object.id == id).map(|object| outline(&object.corners_px));
        let mut hidden = self.last_seen.objects(&self.seen, &self.held).into_iter();
        let assumed = || hidden.find(|(part, _)| *part == id).map(|(_, corners)| outline(&corners));
        thing(What::Part(id), seen, assumed)
    }
}

type Lines = Vec<[[f32; 2]; 2]>;

fn thing(what: What, seen: Option<Lines>, assumed: impl FnOnce() -> Option<Lines>) -> Thing {
    let (visibility, lines) = match (seen, assumed) {
        (Some(lines), _) => (Visibility::Seen, lines),
        (None, assumed) => {
            assumed().map_or((Visibility::Unseen, Vec::new()), |lines| (Visibility::Assumed, lines))
        }
    };
    Thing { what, visibility, lines }
}

fn bones(landmarks: &[[f32; 2]; LANDMARKS]) -> Lines {
    BONES.iter().map(|(from, to)| [landmarks[*from], landmarks[*to]]).collect()
}

fn outline(corners: &[[f32; 2]; 4]) -> Lines {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(from, to)| [*from, *to]).collect()
}
