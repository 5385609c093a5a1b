//! The tests of the method through its public functions. They are one program, because to link many takes longer than to run them.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;
mod couple_monotony;
mod couple_properties;
mod doubt_properties;
mod dtw;
mod dtw_golden;
mod encoder;
mod encoder_beside;
mod encoder_doubt;
mod encoder_laws;
mod encoder_names;
mod encoder_noise;
mod judge;
mod judge_cold;
mod judge_doubt;
mod judge_instead;
mod judge_measures;
mod judge_missing;
mod judge_monotony;
mod judge_order;
mod judge_properties;
mod judge_twice;
mod judge_two_pieces;
mod judge_unseen;
mod measures_monotony;
