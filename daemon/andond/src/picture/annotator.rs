//! Draws what was seen and judged on a film: landmarks, markers and names, contacts, the running IU, the verdict.

use std::path::Path;

use andon_core::couple::Couple;
use andon_core::verdict::{Kind, Verdict};
use shm_schemas::{Detections, HandDetection};

use super::canvas::{AMBER, BLUE, Canvas, Colour, GREEN, RED, WHITE};
use crate::recording::View;
use crate::report::{Names, is_anomaly, verdict_sentence};
use crate::video::pipe::PictureFormat;
use crate::video::{FilmWriter, VideoError};

/// Rows below the picture: the running IU and the newest verdicts.
const PANEL: u32 = 100;

/// How many verdicts stay on the panel.
const VERDICTS: usize = 3;

/// For how long the red frame stays after the cord was pulled, in nanoseconds.
const ALARM_NS: u64 = 2_000_000_000;

/// The bones of a hand, as pairs of landmarks in MediaPipe's order.
const BONES: [(usize, usize); 21] = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 4),
    (0, 5),
    (5, 6),
    (6, 7),
    (7, 8),
    (5, 9),
    (9, 10),
    (10, 11),
    (11, 12),
    (9, 13),
    (13, 14),
    (14, 15),
    (15, 16),
    (13, 17),
    (17, 18),
    (18, 19),
    (19, 20),
    (0, 17),
];

/// Landmarks 8, 12 and 16: the interaction points of a hand.
const TIPS: [usize; 3] = [8, 12, 16];

/// Why a film could not be annotated.
#[derive(Debug, thiserror::Error)]
pub enum AnnotateError {
    /// The film cannot be written.
    #[error(transparent)]
    Video(#[from] VideoError),
    /// Nothing can be drawn.
    #[error("cannot draw on a picture: {0}")]
    OpenCv(#[from] opencv::Error),
}

/// A film in the making.
pub struct Annotator {
    film: FilmWriter,
    canvas: Canvas,
    names: Names,
    verdicts: Vec<Verdict>,
    alarm_until_ns: u64,
}

impl Annotator {
    /// Starts the film; its pictures are as wide as `format` says and a panel higher.
    ///
    /// # Errors
    /// That the file cannot be written.
    pub fn create(file: &Path, format: PictureFormat, names: Names) -> Result<Self, AnnotateError> {
        // Codecs want an even height.
        let height = (format.height + PANEL).next_multiple_of(2);
        let film = FilmWriter::create(file, PictureFormat { height, ..format })?;
        let canvas = Canvas::new(format.width, height);
        Ok(Self { film, canvas, names, verdicts: Vec::new(), alarm_until_ns: 0 })
    }

    /// Adds one picture: what it shows, the newest couples of the hands, the verdicts that came with it.
    ///
    /// # Errors
    /// That the film cannot be written.
    pub fn draw(
        &mut self,
        view: View<'_>,
        couples: &[Couple],
        verdicts: &[Verdict],
    ) -> Result<(), AnnotateError> {
        let now_ns = view.seen.source_ns;
        self.canvas.show(view.picture);
        self.draw_objects(view.seen)?;
        for hand in view.seen.hands() {
            self.draw_hand(hand)?;
        }
        self.draw_contacts(view.seen, couples)?;
        self.verdicts.extend_from_slice(verdicts);
        if verdicts.iter().any(is_anomaly) {
            self.alarm_until_ns = now_ns + ALARM_NS;
        }
        self.draw_panel(view.format.height as f32, couples)?;
        if now_ns < self.alarm_until_ns {
            self.canvas.frame(RED, 10)?;
        }
        Ok(self.film.write(now_ns, self.canvas.pixels())?)
    }

    /// Ends the film.
    ///
    /// # Errors
    /// That it cannot be written to its end.
    pub fn finish(self) -> Result<(), AnnotateError> {
        Ok(self.film.finish()?)
    }

    fn draw_objects(&mut self, seen: &Detections) -> opencv::Result<()> {
        for object in seen.objects() {
            self.canvas.outline(&object.corners_px, GREEN)?;
            let [x, y] = object.corners_px[0];
            self.canvas.words([x, y - 6.0], &self.names.object(object.id), 0.45, WHITE)?;
        }
        Ok(())
    }

    fn draw_hand(&mut self, hand: &HandDetection) -> opencv::Result<()> {
        for (from, to) in BONES {
            self.canvas.line(hand.landmarks_px[from], hand.landmarks_px[to], BLUE, 1)?;
        }
        for tip in TIPS {
            self.canvas.dot(hand.landmarks_px[tip], 3, AMBER)?;
        }
        Ok(())
    }

    /// A line along every contact of the path hand, `o_j`, `o_l`.
    fn draw_contacts(&mut self, seen: &Detections, couples: &[Couple]) -> opencv::Result<()> {
        for couple in couples {
            let [hand, j, _, l] = couple.context.0;
            let tip = seen
                .hands()
                .iter()
                .find(|seen| u16::from(seen.hand) == hand)
                .map(|seen| seen.landmarks_px[12]);
            let (first, second) = (centre(seen, j), centre(seen, l));
            for (from, to) in [(tip, first), (first, second)] {
                if let (Some(from), Some(to)) = (from, to) {
                    self.canvas.line(from, to, AMBER, 2)?;
                }
            }
        }
        Ok(())
    }

    fn draw_panel(&mut self, top: f32, couples: &[Couple]) -> opencv::Result<()> {
        let running: Vec<String> = couples
            .iter()
            .filter(|couple| couple.context.0 != [0; 4])
            .map(|couple| {
                format!("{:?} {:?} {}", couple.side, couple.context.0, self.names.context(couple.context))
            })
            .collect();
        let running = if running.is_empty() { "idle".to_string() } else { running.join("   ") };
        self.canvas.words([8.0, top + 20.0], &format!("IU: {running}"), 0.5, WHITE)?;
        let newest = self.verdicts.len().saturating_sub(VERDICTS);
        for (line, verdict) in self.verdicts[newest..].iter().enumerate() {
            let at = [8.0, top + 44.0 + 22.0 * line as f32];
            self.canvas.words(at, &verdict_sentence(verdict, &self.names), 0.42, colour(verdict))?;
        }
        Ok(())
    }
}

fn centre(seen: &Detections, id: u16) -> Option<[f32; 2]> {
    let object = seen.objects().iter().find(|object| object.id == id)?;
    let sum = object.corners_px.iter().fold([0.0; 2], |sum, corner| [sum[0] + corner[0], sum[1] + corner[1]]);
    Some(sum.map(|coordinate| coordinate / 4.0))
}

fn colour(verdict: &Verdict) -> Colour {
    match verdict.kind {
        Kind::NotJudged => AMBER,
        _ if is_anomaly(verdict) => RED,
        _ => GREEN,
    }
}
