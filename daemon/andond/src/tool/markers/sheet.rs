//! A printed sheet, as both formats draw it. Lengths are in millimetres, x to the right and y down from the top left corner.

use crate::cli::Paper;

/// A typeface that every reader of PDF and SVG has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Face {
    Plain,
    Bold,
    /// For what is typed into a terminal.
    Fixed,
}

/// Something on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// A black rectangle.
    Black { at: [f64; 2], size: [f64; 2] },
    /// A line of this width.
    Line { from: [f64; 2], to: [f64; 2], width: f64, is_dashed: bool },
    /// Text whose first letter stands at `at`, on its base line.
    Text { at: [f64; 2], size: f64, face: Face, text: String },
}

/// A sheet of paper.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    pub(super) size: [f64; 2],
    pub(super) items: Vec<Item>,
}

impl Sheet {
    pub(super) fn new(paper: Paper) -> Self {
        let size = match paper {
            Paper::A4 => [210.0, 297.0],
            Paper::Letter => [215.9, 279.4],
        };
        Self { size, items: Vec::new() }
    }

    pub(super) fn black(&mut self, at: [f64; 2], size: [f64; 2]) {
        self.items.push(Item::Black { at, size });
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64) {
        self.items.push(Item::Line { from, to, width, is_dashed: false });
    }

    /// Where to cut.
    pub(super) fn cut(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2]) {
        let corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            self.items.push(Item::Line { from: *from, to: *to, width: 0.15, is_dashed: true });
        }
    }

    pub(super) fn text(&mut self, at: [f64; 2], size: f64, face: Face, text: impl Into<String>) {
        self.items.push(Item::Text { at, size, face, text: text.into() });
    }
}
