//! Which IUs are alike, in motion and in context (paper III-C, IV-A).
//!
//! A [`Kind`] says which IUs are compared, [`Analysis`] computes distances, clusters and barycentres, and [`report`] draws them.
//! [`selection`] shows how candidates drop out while an activity is carried out (paper III-D).

mod candidates;
mod compare;
mod drilling;
mod kind;
mod matrix;
mod picture;
mod report;

pub use candidates::{Candidate, Dropped, Selection, selection};
pub use compare::{Analysis, AnalysisError, Sample};
pub(crate) use drilling::DRILLING;
pub use drilling::Drilling;
pub use kind::Kind;
pub use matrix::Matrix;
pub use report::{Report, report};
