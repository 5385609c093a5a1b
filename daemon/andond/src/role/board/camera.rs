//! What the camera sees, and what the line sees in it: only while a browser waits for a picture, and not for its sake alone.
//!
//! The frames, detections and couples are read from the channels. Who looks at no picture costs nothing: the readers are there only while somebody
//! does, so that the places of the channel `frame` stay free for the tools.

use std::time::{Duration, Instant};

use andon_board::Picture;
use andon_host::config::Config;
use andon_ipc::{Error, FrameReader, FrameSample, Node, Port, Reader};
use andon_record::picture::PictureMaker;
use shm_schemas::{Couples, Detections};

use super::seen::Seen;

/// Between two pictures, at least: a hand can be followed, and it costs the line little.
const BETWEEN: Duration = Duration::from_millis(150);

/// For so long after the last picture the readers stay: the next one is asked for sooner.
const REST: Duration = Duration::from_secs(3);

/// How long a frame waits for what was seen in it. After this `perceive` is not there, and the frame is shown without.
const SEEN_WITHIN: Duration = Duration::from_millis(300);

/// The camera, as long as somebody looks.
pub(super) struct Camera {
    maker: PictureMaker,
    /// What is seen before anything has come.
    nothing: Seen,
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
    seen: Seen,
    shown: Option<Instant>,
}

impl Camera {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            maker: PictureMaker::new(&config.record),
            nothing: Seen::new(config),
            watch: None,
            wanted: Instant::now(),
        }
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
            self.watch = Watch::open(node, self.nothing.clone()).ok();
        }
        let Some(watch) = &mut self.watch else { return Ok(None) };
        watch.take(is_wanted)?;
        let Some(frame) = watch.take_frame() else { return Ok(None) };
        let (header, things) = (frame.header(), watch.seen.things());
        // A frame that cannot be shown is one that the role capture tells of.
        let jpeg = frame.colour().ok().and_then(|colour| self.maker.jpeg(header, colour, frame.jpeg()).ok());
        Ok(jpeg.map(|jpeg| Picture { jpeg, size: [header.width, header.height], things }))
    }
}

impl Watch {
    fn open(node: &Node, seen: Seen) -> Result<Self, Error> {
        Ok(Self {
            frames: node.frame_reader()?,
            detections: node.reader()?,
            couples: node.reader()?,
            frame: None,
            seen,
            shown: None,
        })
    }

    fn ports(&mut self) -> [&mut dyn Port; 3] {
        [&mut self.frames, &mut self.detections, &mut self.couples]
    }

    /// Takes all that waits. Of the frames one is kept where one is to be shown.
    fn take(&mut self, is_wanted: bool) -> Result<(), Error> {
        while let Some(seen) = self.detections.take()? {
            self.seen.take(&seen);
        }
        while let Some(couples) = self.couples.take()? {
            self.seen.hold(&couples);
        }
        if self.frame.is_some() {
            // A reader may hold two: beside the one that waits these go one after the other.
            while self.frames.take()?.is_some() {}
            return Ok(());
        }
        let newest = self.frames.take_newest()?;
        let is_due = self.shown.is_none_or(|shown| shown.elapsed() >= BETWEEN);
        if is_wanted && is_due {
            self.frame = newest.map(|frame| (frame, Instant::now()));
        }
        Ok(())
    }

    /// The frame that waits, once it is known what was seen in it.
    fn take_frame(&mut self) -> Option<FrameSample> {
        let (frame, since) = self.frame.as_ref()?;
        let is_known = self.seen.frame_seq() >= frame.header().stamp.seq;
        if !is_known && since.elapsed() < SEEN_WITHIN {
            return None;
        }
        if !is_known {
            self.seen.miss();
        }
        self.shown = Some(Instant::now());
        self.frame.take().map(|(frame, _)| frame)
    }
}
