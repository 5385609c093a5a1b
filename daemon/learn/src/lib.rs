//! Teaching, offline: from demonstrations to a job file.
//!
//! The data path, in the order of the modules:
//!
//! [`recording`] reads a track file → [`run`] finds its activities and IUs with the code that runs live → [`teach`] derives nominal
//! activities, barycentres, thresholds and bounds, the latter two by a [`rule`] → [`job_file`] keeps the job.
//!
//! A [`distribution`] shows people where an execution lies among the runs. [`file`] opens what people and other programs made.
//! [`run_summary`] says what a run shows before anything is learned from it. [`html`] and [`svg`] are pages and pictures for the reports.
#![forbid(unsafe_code)]

pub mod barycentre;
pub mod digest;
pub mod distribution;
pub mod file;
pub mod html;
pub mod job_file;
pub mod recording;
pub mod rule;
pub mod run;
pub mod run_summary;
pub mod statistics;
pub mod strictness;
pub mod svg;
pub mod teach;
pub mod warp;
