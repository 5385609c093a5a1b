//! Measures what is said of a picture that something is done to, and after how long.
//!
//! The first seconds of a clip are shown as they are, then changed for some seconds, then as they are again. All pictures have the noise of
//! a camera: rendered ones have none. How strongly a picture is changed is drawn, so that no threshold fits one strength alone.

mod deeds;
mod play;

use crate::Error;
use andon_perception::sight::{Spell, Trouble};
use andon_tests::workers;
use deeds::Case;
use oorandom::Rand64;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Clips with their truth beside them.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// Only what is done under names that contain this.
    #[arg(long)]
    only: Option<String>,
    /// Only every n-th of these.
    #[arg(long, default_value_t = NonZeroUsize::MIN)]
    every: NonZeroUsize,
    /// How many come before the first one.
    #[arg(long, default_value_t = 0)]
    skip: usize,
    /// Draws how strongly the pictures are changed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Seconds in which a change should be found, and should be known to be over.
const IN_TIME_S: f64 = 2.0;
/// Seconds in which it should be found that the camera was moved.
const MOVED_IN_TIME_S: f64 = 5.0;

pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let wanted = |case: &Case| arguments.only.as_deref().is_none_or(|only| case.name.contains(only));
    let mut todo: Vec<(&PathBuf, Case)> = Vec::new();
    for (index, clip) in arguments.clips.iter().enumerate() {
        let mut random = Rand64::new(u128::from(arguments.seed) << 64 | index as u128);
        let cases = deeds::cases(&mut random).into_iter().filter(wanted);
        todo.extend(cases.skip(arguments.skip).step_by(arguments.every.get()).map(|case| (clip, case)));
    }
    let wrong = AtomicUsize::new(0);
    workers::for_each(&todo, |(clip, case)| -> Result<(), Error> {
        let said = play::play(clip, case, runtime)?;
        let is_right = said.is_right(case.expected);
        wrong.fetch_add(usize::from(!is_right), Ordering::Relaxed);
        let clip = clip.file_stem().unwrap_or_default().to_string_lossy();
        let expected = case.expected.map_or("nothing".into(), |trouble| format!("{trouble:?}"));
        let word = if is_right { "right" } else { "WRONG" };
        println!("{clip} | {} | {} | {expected} | {said} | {word}", case.name, case.deed);
        Ok(())
    })?;
    println!("{} of {} wrong", wrong.into_inner(), todo.len());
    Ok(())
}

/// What was said; times in seconds of the clip.
struct Said {
    /// When what is done began to show, and when it ended.
    begin_s: f64,
    end_s: f64,
    /// Trouble, when it was said, when it was over.
    spells: Vec<(Trouble, f64, Option<f64>)>,
    newest: Option<Spell>,
}

impl Said {
    fn note(&mut self, spell: Option<Spell>, at_s: f64) {
        if spell == self.newest {
            return;
        }
        if self.newest.is_some()
            && let Some((_, _, over_s)) = self.spells.last_mut()
        {
            *over_s = Some(at_s);
        }
        self.spells.extend(spell.map(|spell| (spell.trouble, at_s, None)));
        self.newest = spell;
    }

    /// Whether this, and nothing else, was said in time and taken back in time.
    fn is_right(&self, expected: Option<Trouble>) -> bool {
        let (trouble, said_s, over_s) = match self.spells[..] {
            [] => return expected.is_none(),
            [(trouble, said_s, Some(over_s))] => (trouble, said_s, over_s),
            _ => return false,
        };
        let in_time_s = if trouble == Trouble::CameraMoved { MOVED_IN_TIME_S } else { IN_TIME_S };
        Some(trouble) == expected
            && (0.0..=in_time_s).contains(&(said_s - self.begin_s))
            && over_s - self.end_s <= IN_TIME_S
    }
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.spells.is_empty() {
            return f.write_str("nothing");
        }
        for (index, (trouble, said_s, over_s)) in self.spells.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{trouble:?} after {:.1} s", said_s - self.begin_s)?;
            if let Some(over_s) = over_s {
                write!(f, ", over {:.1} s after the end", over_s - self.end_s)?;
            }
        }
        Ok(())
    }
}
