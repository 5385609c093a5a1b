//! Whether the layout of the bench matters: the drilling of all people in all layouts (paper IV-A).

use super::compare::Analysis;
use super::matrix::Matrix;
use crate::folder::Labelled;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_learn::statistics::mean;
use andon_learn::warp::Warp;

/// The beginning of the names of drilling runs; the layout follows.
pub(crate) const DRILLING: &str = "drilling";

/// The drilling IUs of all people in all layouts.
#[derive(Clone, Debug, PartialEq)]
pub struct Drilling {
    /// The distances between all of them, in the order of layout and person.
    pub matrix: Matrix,
    /// Mean DTW distance between two of them in the same layout.
    pub same_layout: f64,
    /// Mean DTW distance between two of them in different layouts.
    pub other_layout: f64,
    /// Mean DTW distance between them and the IUs of the other kinds.
    pub other_kinds: f64,
}

impl Drilling {
    /// Compares the second IU of every drilling run, which is the drill at the brick, with each other and with the samples of `analysis`.
    /// `None` if there are fewer than two such runs.
    ///
    /// # Errors
    /// If an IU is too long to be compared.
    pub fn new(all: &[Labelled], analysis: &Analysis) -> Result<Option<Self>, Refused> {
        let runs = drilling_ius(all);
        if runs.len() < 2 {
            return Ok(None);
        }
        let mut warp = Warp::new(analysis.cost);
        let motions: Vec<&[Motion]> = runs.iter().map(|(_, _, motion)| *motion).collect();
        let distances = warp.matrix(&motions)?;
        let mut layouts: Vec<&str> = runs.iter().map(|(what, ..)| *what).collect();
        layouts.dedup();
        let layout =
            |index: usize| layouts.iter().position(|what| *what == runs[index].0).unwrap_or_default();
        let pairs = (0..runs.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let (same, other): (Vec<_>, Vec<_>) = pairs.partition(|&(i, j)| layout(i) == layout(j));
        let mean_of = |pairs: &[(usize, usize)]| {
            mean(&pairs.iter().map(|&(i, j)| distances.get(i, j)).collect::<Vec<_>>())
        };
        let mut to_kinds = Vec::new();
        for motion in &motions {
            for sample in &analysis.samples {
                to_kinds.push(warp.distance(motion, &sample.motion)?);
            }
        }
        let rows = runs.iter().enumerate().map(|(index, (what, person, _))| {
            let name = what.trim_start_matches(DRILLING).trim_start_matches('_');
            (layout(index), format!("{name} s{person}"))
        });
        Ok(Some(Self {
            matrix: Matrix::new(rows.collect(), |i, j| distances.get(i, j)),
            same_layout: mean_of(&same),
            other_layout: mean_of(&other),
            other_kinds: mean(&to_kinds),
        }))
    }
}

/// Name, person and motion of the second IU of every drilling run, in the order of name and person.
fn drilling_ius(all: &[Labelled]) -> Vec<(&str, u32, &[Motion])> {
    let drilling = all.iter().filter(|one| one.what.starts_with(DRILLING));
    let mut ius: Vec<(&str, u32, &[Motion])> = drilling
        .filter_map(|one| {
            let iu = one.run.activities.first()?.ius.get(1)?;
            Some((one.what.as_str(), one.person, iu.motion.as_slice()))
        })
        .collect();
    ius.sort_by_key(|(what, person, _)| (*what, *person));
    ius
}
