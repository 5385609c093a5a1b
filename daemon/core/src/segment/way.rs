//! How far a hand goes round on its way with a part. A detour that is spread over the whole way makes it hardly longer. By the largest distance from
//! the straight line it is found in 29 of 30 ways, without it in 7.

use super::measures::MOVED_M;
use crate::couple::geometry::{distance, dot, squared_distance, subtract};
use crate::input::Point;
use heapless::Vec;

/// Maximum number of points that are kept of a way. One that is longer than as many steps is kept with every second of them.
const MAX_POINTS: usize = 64;

/// The way of a hand with a part to where it is now, in fixed memory.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// Where it has been, from where the way began.
    points: Vec<Point, MAX_POINTS>,
    /// The minimum distance of two points that are kept, in metres.
    spacing_m: f32,
    /// Where the newest step ended.
    step: Point,
    /// The maximum distance in metres that a point of it had from the line between its begin and where the hand was then.
    pub(super) lateral_m: f32,
    /// In how many frames just before its first point the hand was not seen.
    pub(super) unseen_before: u32,
}

impl Way {
    /// A way that begins after as many frames in which the hand was not seen.
    pub(super) const fn after(unseen: u32) -> Self {
        Self { points: Vec::new(), spacing_m: MOVED_M, step: [0.0; 3], lateral_m: 0.0, unseen_before: unseen }
    }

    /// Takes the next frame, with the finger tips in the bench frame if they are known.
    pub(super) fn push(&mut self, tips: Option<Point>) {
        let (began, tips) = match (self.points.first(), tips) {
            (Some(began), Some(tips)) => (*began, tips),
            (Some(_), None) => return,
            (None, None) => {
                self.unseen_before = self.unseen_before.saturating_add(1);
                return;
            }
            (None, Some(tips)) => {
                self.keep(tips);
                self.step = tips;
                return;
            }
        };
        if distance(self.step, tips) < MOVED_M {
            return;
        }
        self.step = tips;
        let off = self.points.iter().map(|point| squared_distance_from_line(*point, began, tips));
        self.lateral_m = self.lateral_m.max(libm::sqrtf(off.fold(0.0, f32::max)));
        if self.points.last().is_none_or(|last| distance(*last, tips) >= self.spacing_m) {
            self.keep(tips);
        }
    }

    fn keep(&mut self, point: Point) {
        if self.points.is_full() {
            let mut index = 0;
            self.points.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.spacing_m *= 2.0;
        }
        // There is room now.
        let _ = self.points.push(point);
    }
}

/// The squared distance of a point from the line between two others, which ends there.
fn squared_distance_from_line(point: Point, from: Point, to: Point) -> f32 {
    let (along, off) = (subtract(to, from), subtract(point, from));
    let squared_length = dot(along, along);
    let share = if squared_length > 0.0 { (dot(off, along) / squared_length).clamp(0.0, 1.0) } else { 0.0 };
    squared_distance(off, along.map(|length| share * length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI;
    use std::vec::Vec;

    /// The lateral deviation after each frame of this way.
    fn laterals(way: impl IntoIterator<Item = Option<Point>>) -> Vec<f32> {
        let mut measured = Way::after(0);
        let lateral = |tips| {
            measured.push(tips);
            measured.lateral_m
        };
        way.into_iter().map(lateral).collect()
    }

    /// A metre along x in 60 frames, and so far off it in the middle.
    fn arc(off_m: f32) -> Vec<Option<Point>> {
        let at = |frame: i32| frame as f32 / 60.0;
        (0..=60).map(|frame| Some([at(frame), 0.0, off_m * libm::sinf(PI * at(frame))])).collect()
    }

    #[test]
    fn a_way_is_off_by_as_much_as_an_arc_is_high_or_by_the_whole_length_of_a_way_out_and_back() {
        let out: Vec<_> = (0..30).map(|frame| Some([0.25 * frame as f32 / 29.0, 0.0, 0.0])).collect();
        let back = out.iter().copied().chain(out.iter().rev().copied()).collect();
        let hidden = arc(0.3).into_iter().enumerate().map(|(frame, tips)| tips.filter(|_| frame % 7 != 0));
        let noise = [0.0, 0.004, -0.004, 0.003, -0.002];
        let trembles = (0..500).map(|frame| Some([noise[frame % 5], noise[frame % 3], 0.0])).collect();
        // Three circles, which come no farther from the line than their diameter, in the same memory.
        let angle = |frame: i32| 6.0 * PI * frame as f32 / 600.0;
        let circle = |frame: i32| Some([libm::cosf(angle(frame)), libm::sinf(angle(frame)), 0.0]);
        for (what, way, expected_m) in [
            ("a straight line", arc(0.0), 0.0),
            ("a low arc", arc(0.1), 0.1),
            ("a high arc", arc(0.3), 0.3),
            ("out and back", back, 0.25),
            ("an arc with frames missing", hidden.collect(), 0.3),
            ("a hand that trembles", trembles, 0.0),
            ("many metres", (0..=600).map(circle).collect(), 2.0),
        ] {
            let lateral_m = laterals(way).pop().unwrap_or_default();
            assert!((lateral_m - expected_m).abs() < 0.02, "{what}: {lateral_m}");
        }
    }

    #[test]
    fn how_far_off_a_way_has_led_is_known_before_its_end_and_never_taken_back() {
        let laterals = laterals(arc(0.3));
        assert!(laterals.is_sorted());
        assert!(laterals[45] > 0.15, "{}", laterals[45]);
    }

    #[test]
    fn frames_in_which_the_hand_is_not_seen_are_counted_before_the_first_point() {
        let mut way = Way::after(2);
        [None, None, Some([0.0; 3]), None].into_iter().for_each(|tips| way.push(tips));
        assert_eq!(way.unseen_before, 4);
    }
}
