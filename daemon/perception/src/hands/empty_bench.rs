//! Whether a bench without hands is unchanged: its picture has stayed as it was when no hand was found in it.
//!
//! Such a bench is searched in every tenth frame, and at once when a 768th part of its picture changes by 1.5 grey levels. An empty bench
//! takes 0.08 of a core at 30 Hz then, and took 0.24. A followed hand is looked at in every frame: its picture is unchanged in only 3 to 8 % of
//! the clips' frames.

use crate::image::ImageView;

/// Columns and rows of the blocks whose means are compared. At 640 x 480 pixels a block is as wide as two fingers.
const COLUMNS: usize = 32;
const ROWS: usize = 24;
/// Rows of pixels that are read of each block. At 640 x 480 pixels they hold 300 numbers, which leave a 17th of the noise of each.
const ROWS_OF_BLOCK: usize = 5;
/// A block has changed when its mean has by more than this, in grey levels. A hand that is 40 levels brighter or darker than the bench does it with a
/// 25th of the block. Noise of more than 5 levels does it as well, and then every frame is searched.
const CHANGED: f32 = 1.5;
/// So many searches, one after the other, must have found nothing. A hand that is there and hard to see is found in one of them.
const EMPTY_SEARCHES: u32 = 10;

/// What a bench without hands looks like.
#[derive(Default)]
pub(super) struct EmptyBench {
    /// Means of the blocks of the picture that was searched last, row by row.
    searched: Vec<f32>,
    /// Searches since the picture changed.
    empty_searches: u32,
}

impl EmptyBench {
    /// Takes a picture in which a search has found no hand.
    pub(super) fn found_nothing(&mut self, image: &ImageView<'_>) {
        let means = means(image);
        self.empty_searches = if is_same(&means, &self.searched) { self.empty_searches + 1 } else { 1 };
        self.searched = means;
    }

    /// There is a hand.
    pub(super) fn has_hand(&mut self) {
        self.empty_searches = 0;
    }

    /// Whether this picture still shows what was searched in vain.
    pub(super) fn is_unchanged(&self, image: &ImageView<'_>) -> bool {
        self.empty_searches >= EMPTY_SEARCHES && is_same(&means(image), &self.searched)
    }
}

/// The mean of the bytes of every block, in the first plane of the picture: its brightness or its colours.
fn means(image: &ImageView<'_>) -> Vec<f32> {
    let bytes = image.width() * image.format().bytes();
    let row = |index: usize| {
        let y = index * image.height() / (ROWS * ROWS_OF_BLOCK);
        &image.data()[y * image.stride()..][..bytes]
    };
    let block = |block: usize| {
        let columns = [block % COLUMNS, block % COLUMNS + 1].map(|column| column * bytes / COLUMNS);
        let first = block / COLUMNS * ROWS_OF_BLOCK;
        let rows = (first..first + ROWS_OF_BLOCK).map(|index| &row(index)[columns[0]..columns[1]]);
        let sum: u32 = rows.flatten().map(|byte| u32::from(*byte)).sum();
        // A picture that is narrower than its blocks are many has blocks without a pixel.
        sum as f32 / (ROWS_OF_BLOCK * (columns[1] - columns[0])).max(1) as f32
    };
    (0..ROWS * COLUMNS).map(block).collect()
}

fn is_same(one: &[f32], other: &[f32]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| (one - other).abs() <= CHANGED)
}
