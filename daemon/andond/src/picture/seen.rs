//! Draws what was seen: hands as bones and tips of fingers, markers as outlines with the names of their objects.

use shm_schemas::{Detections, HandDetection};

use super::canvas::{AMBER, BLUE, Canvas, GREEN, WHITE};
use crate::report::Names;

/// The bones of a hand, as pairs of landmarks in MediaPipe's order.
pub(crate) const BONES: [(usize, usize); 21] = [
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

/// Draws all that was seen in a picture. The tips of fingers have this radius, in pixels.
///
/// # Errors
/// That OpenCV cannot draw.
pub(super) fn draw_seen(
    canvas: &mut Canvas,
    seen: &Detections,
    names: &Names,
    tip_px: i32,
) -> opencv::Result<()> {
    for object in seen.seen_objects() {
        canvas.outline(&object.corners_px, GREEN)?;
        let [x, y] = object.corners_px[0];
        canvas.name([x, y - 6.0], &names.object(object.id), WHITE)?;
    }
    seen.hands().iter().try_for_each(|hand| draw_hand(canvas, hand, tip_px))
}

/// As [`draw_seen`], of one hand.
///
/// # Errors
/// That OpenCV cannot draw.
pub(super) fn draw_hand(canvas: &mut Canvas, hand: &HandDetection, tip_px: i32) -> opencv::Result<()> {
    for (from, to) in BONES {
        canvas.line(hand.landmarks_px[from], hand.landmarks_px[to], BLUE, 2)?;
    }
    TIPS.into_iter().try_for_each(|tip| canvas.dot(hand.landmarks_px[tip], tip_px, AMBER))
}
