//! Draws what was seen and judged on a film: landmarks, markers and names, contacts, the running IU, the verdict.
//!
//! What was seen has full lines. What was not seen has dashes and the word "assumed". It is assumed to lie where it was, or to move with the hand
//! that holds it by the newest couples.
//! What has been out of sight for longer than `method.blind_ms` is not drawn, and the panel says so.

use std::path::Path;

use andon_core::couple::Couple;
use andon_core::verdict::{Outcome, Verdict};
use andon_host::video::pipe::PictureFormat;
use shm_schemas::Detections;

use super::assumed::LastSeen;
use super::canvas::{AMBER, Canvas, RED};
use super::panel;
use super::seen::{BONES, draw_seen};
use super::steps::Steps;
use crate::recording::View;
use crate::report::Names;
use crate::video::{FilmWriter, VideoError};

/// For how long the red frame stays after an anomaly, in nanoseconds.
const ALARM_NS: u64 = 2_000_000_000;

/// How large the tips of fingers are drawn, in pixels.
const TIP_PX: i32 = 5;

/// For how long the last picture stays, in seconds: the time to read three lines.
pub const END_S: f64 = 2.0;

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
    last_seen: LastSeen,
    steps: Steps,
    alarm_until_ns: u64,
}

impl Annotator {
    /// Starts the film. Its pictures have those of `format`, enlarged where they are small, and what is written beside and below them. What has not
    /// been seen for longer than `blind_ms` is not assumed to be anywhere.
    ///
    /// # Errors
    /// That the file cannot be written.
    pub fn create(
        file: &Path,
        format: PictureFormat,
        names: Names,
        blind_ms: u32,
    ) -> Result<Self, AnnotateError> {
        let canvas = Canvas::new(format.width, format.height, panel::WIDTH, panel::STRIP);
        let [width, height] = canvas.size();
        let film = FilmWriter::create(file, PictureFormat { width, height, ..format })?;
        let last_seen = LastSeen::new(blind_ms);
        let steps = Steps::new(names.clone());
        Ok(Self { film, canvas, names, last_seen, steps, alarm_until_ns: 0 })
    }

    /// Adds one picture with what was seen in it, the newest couples of the hands, and the verdicts that came with it.
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
        self.canvas.show(view.picture)?;
        self.last_seen.take(view.seen);
        draw_seen(&mut self.canvas, view.seen, &self.names, TIP_PX)?;
        self.draw_assumed(view.seen, couples)?;
        self.draw_contacts(view.seen, couples)?;
        verdicts.iter().for_each(|verdict| self.steps.judge(verdict));
        self.steps.run(couples);
        if verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly) {
            self.alarm_until_ns = now_ns + ALARM_NS;
        }
        panel::draw_steps(&mut self.canvas, &self.steps, &self.names)?;
        let lost = self.last_seen.lost(view.seen, couples, &self.names);
        panel::draw_strip(&mut self.canvas, couples, &lost, &self.names)?;
        if now_ns < self.alarm_until_ns {
            self.canvas.frame(RED, 10)?;
        }
        Ok(self.film.write(now_ns, self.canvas.pixels())?)
    }

    /// Shows the last picture for another [`END_S`] seconds, with the verdicts that came after it.
    ///
    /// # Errors
    /// As [`Annotator::draw`].
    pub fn draw_end(&mut self, view: View<'_>, verdicts: &[Verdict]) -> Result<(), AnnotateError> {
        self.draw(view, &[], verdicts)?;
        for _ in 1..(END_S * view.format.rate_hz) as u64 {
            self.draw(view, &[], &[])?;
        }
        Ok(())
    }

    /// Ends the film.
    ///
    /// # Errors
    /// That it cannot be written to its end.
    pub fn finish(self) -> Result<(), AnnotateError> {
        Ok(self.film.finish()?)
    }

    fn draw_assumed(&mut self, seen: &Detections, couples: &[Couple]) -> opencv::Result<()> {
        for (id, corners) in self.last_seen.objects(seen, couples) {
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                self.canvas.dashes(*from, *to, AMBER)?;
            }
            let [x, y] = corners[0];
            let words = format!("{} assumed", self.names.object(id));
            self.canvas.name([x, y - 6.0], &words, AMBER)?;
        }
        for (_, landmarks_px) in self.last_seen.hands(seen) {
            for (from, to) in BONES {
                self.canvas.dashes(landmarks_px[from], landmarks_px[to], AMBER)?;
            }
            self.canvas.name(landmarks_px[0], "hand assumed", AMBER)?;
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
                    self.canvas.line(from, to, AMBER, 3)?;
                }
            }
        }
        Ok(())
    }
}

fn centre(seen: &Detections, id: u16) -> Option<[f32; 2]> {
    let mut objects = seen.seen_objects();
    let object = objects.find(|object| object.id == id)?;
    let sum = object.corners_px.iter().fold([0.0; 2], |sum, corner| [sum[0] + corner[0], sum[1] + corner[1]]);
    Some(sum.map(|coordinate| coordinate / 4.0))
}
