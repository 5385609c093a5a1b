//! The paper's study, repeated on recordings: for whoever wants to know how well the method works, and not for a station.
//!
//! [`folder`] reads recordings with the labels of their names or of a table. [`analysis`] says which IUs are alike (paper III-C, IV-A), by the
//! [`cluster`]s of their motions and contexts, and draws it. [`experiment`] repeats the two experiments of the paper (IV), also with one part of
//! the method after the other left out.
#![forbid(unsafe_code)]

pub mod analysis;
pub mod cluster;
pub mod experiment;
pub mod folder;
