//! Many references at once.

use super::cost::{LocalCosts, ORIGIN, UNREACHED};
use super::row::slot;
use super::symbols::{BLOCK, PLANES};
use super::{Refused, accept};
use crate::capacity::IU_FRAMES;
use crate::couple::Motion;

/// Bytes of the symbols of one motion in a bank: two symbols of four bits each.
pub(super) const PACKED: usize = PLANES.div_ceil(2);

/// One place of 32 references: memory of a [`Bank`]. How many are needed: [`Bank::columns`].
#[derive(Clone, Debug)]
#[repr(align(32))]
pub struct Column {
    /// The newest rows, in the order of `Row`.
    pub(super) sums: [i32; BLOCK],
    /// Symbols of the references, packed to keep a large bank in the cache: `ordered` and `φ_hj`, `φ_jl` and `θ_hj`, `θ_jl`.
    pub(super) symbols: [[u8; BLOCK]; PACKED],
}

impl Column {
    const EMPTY: Self = Self { sums: [UNREACHED; BLOCK], symbols: [[0; BLOCK]; PACKED] };
}

impl Default for Column {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// What is known of 32 references: memory of a [`Bank`]. How many are needed: [`Bank::groups`].
#[derive(Clone, Debug)]
pub struct Group {
    /// Its columns.
    start: usize,
    end: usize,
    /// Least values of the newest rows, and lengths, in the order of `Row`.
    pub(super) least: [i32; BLOCK],
    pub(super) lengths: [i32; BLOCK],
    /// Length of the shortest reference.
    pub(super) shortest: usize,
    /// All references have symbols.
    has_symbols: bool,
    /// Any elevation is not 0.
    pub(super) elevated: bool,
}

impl Default for Group {
    fn default() -> Self {
        Self {
            start: 0,
            end: 0,
            least: [ORIGIN; BLOCK],
            lengths: [0; BLOCK],
            shortest: 0,
            has_symbols: false,
            elevated: false,
        }
    }
}

/// DTW of one growing sequence against many references: as one [`OnlineDtw`](super::OnlineDtw) each, several times as fast. A SIMD
/// lane is a reference, so that no cell waits for its neighbour in the same vector.
///
/// References are taken in groups of 32 in their order; a group costs as much as 32 of its longest. Put like lengths together.
///
/// ```
/// use andon_core::couple::Motion;
/// use andon_core::dtw::{Bank, LocalCosts};
/// use andon_core::job::LocalCost;
///
/// let (still, left) = ([Motion([0; 7]); 40], [Motion([0, 0, 4, 0, 0, 0, 0]); 30]);
/// let references: [&[Motion]; 2] = [&still, &left];
/// let mut columns = vec![Default::default(); Bank::columns(&references)];
/// let mut groups = vec![Default::default(); Bank::groups(&references)];
/// let mut bank = Bank::new(&LocalCosts::new(LocalCost::Ordinal), &references, &mut columns, &mut groups)?;
/// bank.append(&Motion([0, 0, 4, 0, 0, 0, 0]))?;
/// assert_eq!(bank.distance(1), Some(0.0));
/// assert_eq!(bank.lower_bound(0), Some(4.0));
/// # Ok::<(), andon_core::dtw::Refused>(())
/// ```
#[derive(Debug)]
pub struct Bank<'a> {
    costs: LocalCosts,
    references: &'a [&'a [Motion]],
    columns: &'a mut [Column],
    groups: &'a mut [Group],
    /// Frames appended.
    frames: usize,
}

impl<'a> Bank<'a> {
    /// Columns that a bank of these references needs.
    pub fn columns(references: &[&[Motion]]) -> usize {
        references.chunks(BLOCK).map(longest).sum()
    }

    /// Groups that a bank of these references needs.
    pub fn groups(references: &[&[Motion]]) -> usize {
        references.len().div_ceil(BLOCK)
    }

    /// Reads the references. What is in the memory does not matter.
    ///
    /// # Errors
    /// If a reference is empty or longer than [`IU_FRAMES`], or the memory too small.
    pub fn new(
        costs: &LocalCosts,
        references: &'a [&'a [Motion]],
        columns: &'a mut [Column],
        groups: &'a mut [Group],
    ) -> Result<Self, Refused> {
        references.iter().try_for_each(|reference| accept(reference))?;
        for (needed, given) in
            [(Self::columns(references), columns.len()), (Self::groups(references), groups.len())]
        {
            if given < needed {
                return Err(Refused::Memory { needed, given });
            }
        }
        let groups = &mut groups[..Self::groups(references)];
        let mut start = 0;
        for (group, references) in groups.iter_mut().zip(references.chunks(BLOCK)) {
            let end = start + longest(references);
            *group = Group { start, end, ..read(costs, references, &mut columns[start..end]) };
            start = end;
        }
        let mut bank = Self { costs: costs.clone(), references, columns, groups, frames: 0 };
        bank.begin();
        Ok(bank)
    }

    /// Starts anew with the same references.
    pub fn begin(&mut self) {
        for column in self.columns.iter_mut() {
            column.sums = [UNREACHED; BLOCK];
        }
        for group in self.groups.iter_mut() {
            group.least = [ORIGIN; BLOCK];
        }
        self.frames = 0;
    }

    /// Appends one frame to the sequence.
    ///
    /// # Errors
    /// If [`IU_FRAMES`] frames have been appended; then nothing has changed.
    pub fn append(&mut self, frame: &Motion) -> Result<(), Refused> {
        if self.frames == IU_FRAMES {
            return Err(Refused::TooLong { frames: IU_FRAMES + 1 });
        }
        let border = if self.frames == 0 { ORIGIN } else { UNREACHED };
        for (group, references) in self.groups.iter_mut().zip(self.references.chunks(BLOCK)) {
            let columns = &mut self.columns[group.start..group.end];
            let by_simd = match (self.costs.simd(), self.costs.tables()) {
                (Some(simd), Some(tables)) if group.has_symbols => {
                    simd.advance_group(tables, frame, border, group, columns)
                }
                _ => None,
            };
            if by_simd.is_none() {
                advance(&self.costs, frame, border, references, group, columns);
            }
        }
        self.frames += 1;
        Ok(())
    }

    /// The DTW distance of all appended frames and this reference, equal to [`distance`](super::distance) in every bit; `None` before the first
    /// frame, or if there is no such reference.
    pub fn distance(&self, reference: usize) -> Option<f64> {
        let last = self.references.get(reference)?.len() - 1;
        let column = &self.columns[self.groups[reference / BLOCK].start + last];
        (self.frames > 0).then(|| self.costs.distance_of(column.sums[slot(reference)]))
    }

    /// A bound that this distance cannot fall under any more, see [`OnlineDtw::lower_bound`](super::OnlineDtw::lower_bound); `None` if
    /// there is no such reference.
    pub fn lower_bound(&self, reference: usize) -> Option<f64> {
        let group = self.groups.get(reference / BLOCK).filter(|_| reference < self.references.len())?;
        Some(self.costs.distance_of(group.least[slot(reference)]))
    }

    /// Frames appended.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// The references.
    pub fn references(&self) -> &'a [&'a [Motion]] {
        self.references
    }
}

fn longest(references: &[&[Motion]]) -> usize {
    references.iter().map(|reference| reference.len()).max().unwrap_or(0)
}

/// Reads up to 32 references.
fn read(costs: &LocalCosts, references: &[&[Motion]], columns: &mut [Column]) -> Group {
    columns.fill(Column::EMPTY);
    let mut group = Group { has_symbols: true, shortest: columns.len(), ..Group::default() };
    // Lanes without a reference are never looked at; as long as the longest, they cost no masking.
    group.lengths = [columns.len() as i32; BLOCK];
    for (lane, reference) in references.iter().enumerate() {
        group.lengths[slot(lane)] = reference.len() as i32;
        group.shortest = group.shortest.min(reference.len());
        for (motion, column) in reference.iter().zip(columns.iter_mut()) {
            group.elevated |= motion.0[1] != 0 || motion.0[4] != 0;
            match costs.tables().and_then(|tables| tables.symbols(motion)) {
                Some([ordered, phi_hj, phi_jl, theta_hj, theta_jl]) => {
                    let pack = |low: u8, high: u8| low & 15 | high << 4;
                    let packed = [pack(ordered, phi_hj), pack(phi_jl, theta_hj), pack(theta_jl, 0)];
                    for (plane, byte) in column.symbols.iter_mut().zip(packed) {
                        plane[lane] = byte;
                    }
                }
                None => group.has_symbols = false,
            }
        }
    }
    group
}

/// Makes the next rows of a group in place.
fn advance(
    costs: &LocalCosts,
    frame: &Motion,
    border: i32,
    references: &[&[Motion]],
    group: &mut Group,
    columns: &mut [Column],
) {
    for (lane, reference) in references.iter().enumerate() {
        let lane = slot(lane);
        let (mut diagonal, mut left, mut least) = (border, UNREACHED, UNREACHED);
        for (place, column) in reference.iter().zip(columns.iter_mut()) {
            let up = column.sums[lane];
            left = diagonal.min(up).min(left) + costs.between(frame, place);
            column.sums[lane] = left;
            diagonal = up;
            least = least.min(left);
        }
        group.least[lane] = least;
    }
}
