//! Draws what was seen and judged on a film: landmarks, markers and names, contacts, the running IU, the verdict.
//!
//! What was seen has full lines. What was not seen, but is assumed to lie where it was last seen or to move with a hand, has dashes and
//! the word "assumed". What has been out of sight for longer than `method.blind_ms` is not drawn, and the panel says so.

use std::path::Path;

use andon_core::couple::{Couple, Sight};
use andon_core::verdict::{Outcome, Verdict};
use shm_schemas::{Detections, HandDetection, flag};

use super::assumed::LastSeen;
use super::canvas::{AMBER, BLUE, Canvas, Colour, GREEN, RED, WHITE};
use crate::recording::View;
use crate::report::{Names, on_recording, verdict_sentence};
use crate::video::pipe::PictureFormat;
use crate::video::{FilmWriter, VideoError};

/// Rows below the picture: the running IU, what is not seen, and the newest verdicts.
const PANEL: u32 = 154;

/// How many lines of verdicts stay on the panel.
const LINES: usize = 4;

/// Width of a letter of the verdicts, in pixels: that of the widest letters of OpenCV's plain font at the scale below.
const LETTER_PX: usize = 8;

/// Scale of the verdicts' letters.
const LETTER_SCALE: f64 = 0.42;

/// For how long the red frame stays after an anomaly, in nanoseconds.
const ALARM_NS: u64 = 2_000_000_000;

/// For how long the last picture stays, in seconds: the time to read three lines.
pub const END_S: f64 = 2.0;

/// The bones of a hand, as pairs of landmarks in MediaPipe's order.
pub(super) const BONES: [(usize, usize); 21] = [
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
pub(super) const TIPS: [usize; 3] = [8, 12, 16];

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
    verdicts: Vec<Verdict>,
    alarm_until_ns: u64,
}

impl Annotator {
    /// Starts the film. Its pictures are as wide as `format` says, and higher by the panel. What has not been seen for longer than
    /// `blind_ms` is not assumed to be anywhere.
    ///
    /// # Errors
    /// That the file cannot be written.
    pub fn create(
        file: &Path,
        format: PictureFormat,
        names: Names,
        blind_ms: u32,
    ) -> Result<Self, AnnotateError> {
        // Codecs want an even height.
        let height = (format.height + PANEL).next_multiple_of(2);
        let film = FilmWriter::create(file, PictureFormat { height, ..format })?;
        let canvas = Canvas::new(format.width, height);
        let last_seen = LastSeen::new(blind_ms);
        Ok(Self { film, canvas, names, last_seen, verdicts: Vec::new(), alarm_until_ns: 0 })
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
        self.canvas.show(view.picture);
        self.last_seen.take(view.seen);
        self.draw_objects(view.seen)?;
        for hand in view.seen.hands() {
            self.draw_hand(hand)?;
        }
        self.draw_assumed(view.seen)?;
        self.draw_contacts(view.seen, couples)?;
        self.verdicts.extend_from_slice(verdicts);
        if verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly) {
            self.alarm_until_ns = now_ns + ALARM_NS;
        }
        self.draw_panel(&view, couples)?;
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

    fn draw_objects(&mut self, seen: &Detections) -> opencv::Result<()> {
        for object in seen.objects().iter().filter(|object| object.flags & flag::SEEN != 0) {
            self.canvas.outline(&object.corners_px, GREEN)?;
            let [x, y] = object.corners_px[0];
            self.canvas.text([x, y - 6.0], &self.names.object(object.id), 0.45, WHITE)?;
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

    fn draw_assumed(&mut self, seen: &Detections) -> opencv::Result<()> {
        for (index, (id, corners)) in self.last_seen.objects(seen).into_iter().enumerate() {
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                self.canvas.dashes(*from, *to, AMBER)?;
            }
            // Parts that lie at each other would have their words at the same place.
            let [x, y] = if index % 2 == 0 { corners[0] } else { corners[3] };
            let below = if index % 2 == 0 { -6.0 } else { 16.0 };
            let words = format!("{} assumed", self.names.object(id));
            self.canvas.text([x, y + below], &words, 0.45, AMBER)?;
        }
        for landmarks_px in self.last_seen.hands(seen) {
            for (from, to) in BONES {
                self.canvas.dashes(landmarks_px[from], landmarks_px[to], AMBER)?;
            }
            self.canvas.text(landmarks_px[0], "hand assumed", 0.45, AMBER)?;
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

    fn draw_panel(&mut self, view: &View<'_>, couples: &[Couple]) -> opencv::Result<()> {
        let top = view.format.height as f32;
        let running = running(couples, &self.names);
        let letters = self.canvas.width() / LETTER_PX;
        for (row, line) in wrap(&format!("IU: {running}"), letters).iter().take(2).enumerate() {
            self.canvas.text([8.0, top + 18.0 + 16.0 * row as f32], line, LETTER_SCALE, WHITE)?;
        }
        let lost = self.last_seen.lost(view.seen, &self.names);
        if !lost.is_empty() {
            let words = format!("not seen: {}", lost.join(", "));
            self.canvas.text([8.0, top + 50.0], &words, LETTER_SCALE, AMBER)?;
        }
        // A verdict has at least one line: older ones cannot be among the newest lines.
        let oldest = self.verdicts.len().saturating_sub(LINES);
        let lines: Vec<(Colour, String)> = self.verdicts[oldest..]
            .iter()
            .flat_map(|verdict| {
                let when = on_recording(verdict.decided_ns);
                let sentence = format!("{when}  {}", verdict_sentence(verdict, &self.names));
                wrap(&sentence, letters).into_iter().map(|line| (colour(verdict), line))
            })
            .collect();
        for (row, (colour, line)) in lines[lines.len().saturating_sub(LINES)..].iter().enumerate() {
            let at = [8.0, top + 74.0 + 22.0 * row as f32];
            self.canvas.text(at, line, LETTER_SCALE, *colour)?;
        }
        Ok(())
    }
}

/// The IU of each hand that acts.
fn running(couples: &[Couple], names: &Names) -> String {
    let acts = couples.iter().filter(|couple| couple.context.0 != [0; 4]);
    let ius: Vec<String> = acts
        .map(|couple| {
            let (context, unseen) = (names.context(couple.context), unseen(couple, names));
            format!("{} {:?} {context}{unseen}", couple.side.name(), couple.context.0)
        })
        .collect();
    if ius.is_empty() { "idle".to_string() } else { ius.join("   ") }
}

/// What of a couple was assumed, and what was not seen.
fn unseen(couple: &Couple, names: &Names) -> String {
    let [_, j, _, l] = couple.context.0;
    let parts = ["hand".into(), names.object(j), names.object(l)];
    let of = |sight: Sight, word: &str| -> Vec<String> {
        let parts = parts.iter().zip(couple.sight).filter(|(_, of_part)| *of_part == sight);
        parts.map(|(part, _)| format!("{part} {word}")).collect()
    };
    let mut words = [of(Sight::Assumed, "assumed"), of(Sight::Unseen, "not seen")].concat();
    words.extend(couple.motion.is_none().then(|| "motion not measured".to_owned()));
    if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) }
}

/// Breaks a sentence between words, and indents every line but the first.
fn wrap(sentence: &str, letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in sentence.split(' ') {
        let full =
            lines.last().is_some_and(|line| line.len() + word.len() > letters && !line.trim().is_empty());
        if full {
            lines.push("           ".into());
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(word);
            line.push(' ');
        }
    }
    lines
}

fn centre(seen: &Detections, id: u16) -> Option<[f32; 2]> {
    let mut objects = seen.objects().iter().filter(|object| object.flags & flag::SEEN != 0);
    let object = objects.find(|object| object.id == id)?;
    let sum = object.corners_px.iter().fold([0.0; 2], |sum, corner| [sum[0] + corner[0], sum[1] + corner[1]]);
    Some(sum.map(|coordinate| coordinate / 4.0))
}

fn colour(verdict: &Verdict) -> Colour {
    match verdict.outcome {
        Outcome::Ok => GREEN,
        Outcome::Anomaly => RED,
        Outcome::NotJudged => AMBER,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Context;
    use andon_core::input::Side;

    #[test]
    fn the_panel_says_what_was_assumed_not_seen_and_not_measured() {
        let names = Names::new([(5, "polisher".to_string()), (6, "brick".to_string())]);
        let couple = Couple {
            context: Context([1, 5, 5, 6]),
            motion: None,
            sight: [Sight::Seen, Sight::Assumed, Sight::Unseen],
            ..Couple::idle(Side::Right, 0)
        };
        assert_eq!(unseen(&couple, &names), " (polisher assumed, brick not seen, motion not measured)");
        let seen = Couple { sight: [Sight::Seen; 3], motion: Some(Default::default()), ..couple };
        assert_eq!(unseen(&seen, &names), "");
    }

    #[test]
    fn a_long_sentence_loses_no_word_and_no_line_is_wider_than_the_picture() {
        let sentence = "5.57 s  right  ANOMALY  activity 1 IU 2: cut short against the demonstrations";
        let lines = wrap(sentence, 40);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.trim_end().len() <= 40), "{lines:?}");
        let words = |text: &str| text.split_whitespace().map(str::to_string).collect::<Vec<_>>();
        assert_eq!(words(&lines.join(" ")), words(sentence));
    }
}
