//! Which IUs are alike, in motion and in context (paper III-C, IV-A).
//!
//! [`with_learned_contacts`] finds where hands and objects touch. A [`Kind`] says which IUs are compared, [`Analysis`] computes distances,
//! clusters and barycentres, and [`report`] draws them. [`Order`] is the job that the recordings teach, drawn by [`draw_order`]. [`selection`] shows how candidates drop out while an activity is
//! carried out (paper III-D).

mod candidates;
mod compare;
mod contacts;
mod drilling;
mod kind;
mod matrix;
mod order;
mod picture;
mod report;

pub use candidates::{Candidate, Dropped, Selection, selection};
pub use compare::{Analysis, AnalysisError, Sample};
pub use contacts::with_learned_contacts;
pub(crate) use drilling::DRILLING;
pub use drilling::Drilling;
pub use kind::Kind;
pub use matrix::Matrix;
pub use order::Order;
pub use picture::draw_order;
pub use report::{Report, report};
