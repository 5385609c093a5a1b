//! The method: from hands and objects on a bench to verdicts.
//!
//! The data path, in the order of the modules:
//!
//! [`input`] what was seen in one frame → [`couple`] with what is known of each [`object`], its feature couple `X = (x_m, x_c)` →
//! [`segment`] Elementary Reaction Units (ERU), Interaction Units (IU), activities and jobs →
//! [`dtw`] distance to the taught references → [`anomaly`] verdicts against the nominal activities of a [`job`].
//!
//! The crate has no clock, no allocator and no IO: time, configuration and memory are arguments.
//!
//! ```
//! use andon_core::anomaly::Judge;
//! use andon_core::bounds::Bounds;
//! use andon_core::config::Method;
//! use andon_core::couple::{Context, Encoder, Motion};
//! use andon_core::input::{Frame, Hand, Object, Side};
//! use andon_core::job::{Job, LocalCost, MeasureBounds, NominalActivity, NominalIu};
//! use andon_core::object::ObjectShape;
//! use andon_core::verdict::{Level, Outcome, Reason};
//!
//! // The job: the right hand rests on object 5 for about a second.
//! let iu = NominalIu {
//!     context: Context([1, 5, 0, 0]),
//!     reference: &[Motion([0, 0, 0, 1, 0, 0, 0]); 30],
//!     threshold: 2.0,
//!     frames: Bounds { min: 20, max: 40 },
//!     reversals: Bounds { min: 0, max: 1 },
//!     measures: MeasureBounds::ANY,
//! };
//! let activities = &[NominalActivity { activity: 0, ius: &[iu] }];
//! let (laws, objects, passive_contacts, cost) = (&[], &[], &[], LocalCost::Circular { bins: 8 });
//! let (max_slowdown, has_free_ends, min_captured) = (2.0, false, 0.5);
//! let job = Job { activities, laws, objects, passive_contacts, cost, max_slowdown, has_free_ends, min_captured };
//!
//! let method = Method::default();
//! let tool = ObjectShape { id: 5, interaction_points: [[0.0; 3]].into_iter().collect(), ..ObjectShape::default() };
//! let mut encoder = Encoder::new(method, &[tool])?;
//! let mut judge = Judge::new(&job, method)?.at_start_of_job();
//!
//! // The hand stays on the tool.
//! let mut verdicts = Vec::new();
//! for k in 0..60 {
//!     let mut frame = Frame { captured_ns: k * 33_333_333, ..Frame::default() };
//!     let at = |y| [0.0, y, 0.0];
//!     let (wrist, middle_knuckle, tips) = (at(-0.17), at(-0.08), [at(0.0); 3]);
//!     frame.hands.extend([Hand { side: Side::Right, score: 1.0, wrist, middle_knuckle, tips }]);
//!     frame.objects.extend([Object { id: 5, position: at(0.0), orientation: [1.0, 0.0, 0.0, 0.0] }]);
//!     encoder.step(&frame, &mut |couples| judge.step(&couples, &mut |event| verdicts.extend(event.verdict())))?;
//! }
//!
//! // That the hand rests is known from frame 3 on. In its 41st frame the IU is too long, so it has its verdict while it still continues.
//! assert_eq!((verdicts[0].level, verdicts[0].outcome), (Level::Iu, Outcome::Anomaly));
//! assert_eq!((verdicts[0].reason, verdicts[0].early), (Reason::TooLong, true));
//! assert_eq!(verdicts[0].decided_ns, (3 + 40 + 5) * 33_333_333);
//! assert_eq!((verdicts[1].level, verdicts[1].outcome), (Level::Activity, Outcome::Anomaly));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

#[cfg(test)]
#[path = "../tests/method/common/cases.rs"]
mod cases;

pub mod anomaly;
pub mod bounds;
pub mod capacity;
pub mod config;
pub mod couple;
pub mod dtw;
pub mod input;
pub mod job;
pub mod object;
pub mod segment;
pub mod set;
pub mod verdict;
