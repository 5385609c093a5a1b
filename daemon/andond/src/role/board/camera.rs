//! What the camera sees, and what the line sees in it: only while a browser waits for a picture, and not for its sake alone.
//!
//! The frames, detections and couples are read from the channels. Who looks at no picture costs nothing: the readers are there only while somebody
//! does, so that the places of the channel `frame` stay free for the tools.

use std::time::{Duration, Instant};

use andon_board::{Picture, Thing, Visibility, What};
use andon_core::couple::Couple;
use andon_core::input::Side;
use andon_host::config::Config;
use andon_ipc::{Error, FrameReader, FrameSample, Node, Port, Reader};
use andon_record::picture::PictureMaker;
use shm_schemas::{Couples, Detections, LANDMARKS};

use crate::picture::{BONES, LastSeen};
use crate::wire;

/// Between two pictures, at least: a hand can be followed, and it costs the line little.
const BETWEEN: Duration = Duration::from_millis(150);

/// For so long after the last picture the readers stay: the next one is asked for sooner.
const REST: Duration = Duration::from_secs(3);

/// How long a frame waits for what was seen in it. After this `perceive` is not there, and the frame is shown without.
const SEEN_WITHIN: Duration = Duration::from_millis(300);

/// The camera, as long as somebody looks.
pub(super) struct Camera<'c> {
    config: &'c Config,
    maker: PictureMaker,
    watch: Option<Watch>,
    /// When a browser waited last.
    wanted: Instant,
}

/// The channels, and what has come.
struct Watch {
    frames: FrameReader,
    detections: Reader<Detections>,
    couples: Reader<Couples>,
    /// The frame that is to be shown, and since when it waits for what was seen in it.
    frame: Option<(FrameSample, Instant)>,
    seen: Detections,
    last_seen: LastSeen,
    held: Vec<Couple>,
    shown: Option<Instant>,
}

impl<'c> Camera<'c> {
    pub(super) fn new(config: &'c Config) -> Self {
        Self { config, maker: PictureMaker::new(&config.record), watch: None, wanted: Instant::now() }
    }

    pub(super) fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.watch.iter_mut().flat_map(Watch::ports).collect()
    }

    /// Takes what has come, and returns the next picture if a browser waits for one.
    pub(super) fn look(&mut self, node: &Node, is_wanted: bool) -> Result<Option<Picture>, Error> {
        if is_wanted {
            self.wanted = Instant::now();
        } else if self.wanted.elapsed() > REST {
            self.watch = None;
        }
        if is_wanted && self.watch.is_none() {
            // Where too many look already, there is no picture.
            self.watch = Watch::open(node, self.config.method.blind_ms).ok();
        }
        let Some(watch) = &mut self.watch else { return Ok(None) };
        watch.take(is_wanted)?;
        let Some(frame) = watch.take_frame() else { return Ok(None) };
        let (header, things) = (frame.header(), watch.things(self.config));
        // A frame that cannot be shown is one that the role capture tells of.
        let jpeg = frame.colour().ok().and_then(|colour| self.maker.jpeg(header, colour, frame.jpeg()).ok());
        Ok(jpeg.map(|jpeg| Picture { jpeg, size: [header.width, header.height], things }))
    }
}

impl Watch {
    fn open(node: &Node, blind_ms: u32) -> Result<Self, Error> {
        Ok(Self {
            frames: node.frame_reader()?,
            detections: node.reader()?,
            couples: node.reader()?,
            frame: None,
            seen: Detections::default(),
            last_seen: LastSeen::new(blind_ms),
            held: Vec::new(),
            shown: None,
        })
    }

    fn ports(&mut self) -> [&mut dyn Port; 3] {
        [&mut self.frames, &mut self.detections, &mut self.couples]
    }

    /// Takes all that waits. Of the frames one is kept where one is to be shown.
    fn take(&mut self, is_wanted: bool) -> Result<(), Error> {
        while let Some(seen) = self.detections.take()? {
            self.last_seen.take(&seen);
            self.seen = *seen;
        }
        while let Some(couples) = self.couples.take()? {
            self.held = wire::couples::read(&couples).hands.to_vec();
        }
        let newest = self.frames.take_newest()?;
        let is_due = self.shown.is_none_or(|shown| shown.elapsed() >= BETWEEN);
        if is_wanted && is_due && self.frame.is_none() {
            self.frame = newest.map(|frame| (frame, Instant::now()));
        }
        Ok(())
    }

    /// The frame that waits, once it is known what was seen in it.
    fn take_frame(&mut self) -> Option<FrameSample> {
        let (frame, since) = self.frame.as_ref()?;
        let is_known = self.seen.stamp.frame_seq >= frame.header().stamp.seq;
        if !is_known && since.elapsed() < SEEN_WITHIN {
            return None;
        }
        if !is_known {
            self.seen = Detections { source_ns: u64::MAX, ..Detections::default() };
        }
        self.shown = Some(Instant::now());
        self.frame.take().map(|(frame, _)| frame)
    }

    /// The hands and parts, each with how its place is known.
    fn things(&self, config: &Config) -> Vec<Thing> {
        let hands = config.perception.hands.iter().map(|side| self.hand(*side));
        hands.chain(config.objects.iter().map(|object| self.part(object.id))).collect()
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
