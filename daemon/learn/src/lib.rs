//! Teaching and analysis, offline: from demonstrations to a job file.
//!
//! The data path, in the order of the modules:
//!
//! [`recording`] a track file → [`run`] its activities and IUs, by the code that runs live → [`teach`] nominal
//! activities, barycentres, thresholds, bounds → [`job_file`] the job as it is kept.
#![forbid(unsafe_code)]

pub mod analysis;
pub mod barycentre;
pub mod cluster;
pub mod experiment;
pub mod folder;
pub mod job_file;
pub mod recording;
pub mod run;
pub mod teach;
pub mod warp;
