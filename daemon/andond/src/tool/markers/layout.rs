//! Where markers, labels and the ruler lie on the sheets.

use andon_perception::{Dictionary, PerceptionError};

use super::sheet::{Face, Sheet};
use crate::cli::Paper;

/// Printers leave this much white at the edges, in millimetres.
const MARGIN: f64 = 12.0;
/// Below the title.
const TOP: f64 = 36.0;
/// Above the ruler.
const BOTTOM: f64 = 30.0;
/// Between two cutting lines.
const GAP: f64 = 4.0;
/// The label below a marker.
const LABEL: f64 = 10.0;
/// The narrowest label that can be read.
const NARROWEST: f64 = 24.0;
/// The drawing of the bench and the command below the bench's markers.
const DRAWING: f64 = 82.0;
/// Width of a letter of the widest typeface that is used, as a share of its size.
const LETTER: f64 = 0.6;

/// Why there are no sheets.
#[derive(Debug, thiserror::Error)]
pub enum LayoutError {
    /// A marker is larger than the paper.
    #[error(
        "the marker of {name} has a side of {side_mm:.0} mm, and a sheet holds {max_mm:.0} mm: make marker_side_m smaller, or print it on a plotter"
    )]
    TooLarge {
        /// The part.
        name: String,
        /// Its side.
        side_mm: f64,
        /// The largest that fits.
        max_mm: f64,
    },
    /// There is no such marker.
    #[error(transparent)]
    Pattern(#[from] PerceptionError),
}

/// What is printed with a marker.
pub(super) struct Label {
    pub(super) id: u16,
    pub(super) name: String,
    pub(super) side_m: f64,
}

/// The four markers of the bench, with the width and depth of the rectangle of their centres, whose middle is the origin. Their ids are in this
/// order: left and right near the worker, right and left away from the worker.
pub(super) struct BenchCorners {
    pub(super) ids: [u16; 4],
    pub(super) size_m: [f64; 2],
}

impl BenchCorners {
    /// The centres in metres, in the order of the ids.
    fn centres_m(&self) -> [[f64; 2]; 4] {
        let [x, y] = self.size_m.map(|length| length / 2.0);
        [[-x, -y], [x, -y], [x, y], [-x, y]]
    }
}

/// The sheets in the making.
pub(super) struct Sheets {
    paper: Paper,
    station: String,
    dictionary: Dictionary,
    done: Vec<Sheet>,
    sheet: Sheet,
    /// Where the next marker goes, and where the row after it begins.
    at: [f64; 2],
    next_row: f64,
}

impl Sheets {
    pub(super) fn new(paper: Paper, station: &str, dictionary: Dictionary) -> Self {
        let (station, at) = (station.to_owned(), [MARGIN, TOP]);
        let sheet = blank(paper, &station, dictionary);
        Self { paper, station, dictionary, done: Vec::new(), sheet, at, next_row: TOP }
    }

    /// Adds a marker with its label and cutting line.
    ///
    /// # Errors
    /// [`LayoutError`].
    pub(super) fn marker(&mut self, label: &Label) -> Result<(), LayoutError> {
        let side = 1000.0 * label.side_m;
        // The marker is found by the step from black to white around it.
        let pattern = self.dictionary.pattern(label.id)?;
        let module = side / pattern.modules as f64;
        let quiet = module.max(3.0);
        let size = [(side + 2.0 * quiet).max(NARROWEST), side + 2.0 * quiet + LABEL];
        let [x, y] = self.place(size).ok_or_else(|| self.too_large(label, pattern.modules as f64))?;
        let left = x + (size[0] - side) / 2.0;
        for row in 0..pattern.modules {
            // Neighbours are one rectangle: between two, a printer may leave a white hair.
            for (first, count) in runs(&pattern.black[row * pattern.modules..(row + 1) * pattern.modules]) {
                let at = [left + module * first as f64, y + quiet + module * row as f64];
                self.sheet.black(at, [module * count as f64, module]);
            }
        }
        self.sheet.cut([x, y], size);
        let base = y + size[1];
        self.line_of_text([x + 2.0, base - 5.6], 3.6, Face::Bold, &label.name, size[0] - 4.0);
        let second = format!("id {}, side {}", label.id, millimetres(side));
        self.line_of_text([x + 2.0, base - 2.0], 2.8, Face::Plain, &second, size[0] - 4.0);
        Ok(())
    }

    /// Adds a sheet with the markers of the bench, where they go, and the command for it.
    ///
    /// # Errors
    /// [`LayoutError`].
    pub(super) fn bench(
        &mut self,
        corners: &BenchCorners,
        side_m: f64,
        file: &str,
    ) -> Result<(), LayoutError> {
        self.new_sheet();
        // Away from the worker first, so that they lie on the sheet as on the bench.
        let names = ["near left", "near right", "far right", "far left"];
        for [left, right] in [[3, 2], [0, 1]] {
            for corner in [left, right] {
                let name = format!("bench {}", names[corner]);
                self.marker(&Label { id: corners.ids[corner], name, side_m })?;
            }
            self.at = [MARGIN, self.next_row];
        }
        let top = self.next_row;
        self.draw_bench(corners, top);
        self.write_command(corners, side_m, file, top + 62.0);
        self.next_row = top + DRAWING;
        Ok(())
    }

    pub(super) fn finish(mut self) -> Vec<Sheet> {
        self.done.push(self.sheet);
        self.done
    }

    /// The next free place of this size, on a new sheet if need be; `None` where none is large enough.
    fn place(&mut self, [width, height]: [f64; 2]) -> Option<[f64; 2]> {
        let [right, bottom] = [self.sheet.size[0] - MARGIN, self.sheet.size[1] - BOTTOM];
        if MARGIN + width > right || TOP + height > bottom {
            return None;
        }
        if self.at[0] + width > right {
            self.at = [MARGIN, self.next_row];
        }
        if self.at[1] + height > bottom {
            self.new_sheet();
        }
        let at = self.at;
        self.at[0] += width + GAP;
        self.next_row = self.next_row.max(at[1] + height + GAP);
        Some(at)
    }

    fn new_sheet(&mut self) {
        let blank = blank(self.paper, &self.station, self.dictionary);
        let full = std::mem::replace(&mut self.sheet, blank);
        self.done.push(full);
        (self.at, self.next_row) = ([MARGIN, TOP], TOP);
    }

    fn too_large(&self, label: &Label, modules: f64) -> LayoutError {
        let wide = self.sheet.size[0] - 2.0 * MARGIN;
        let high = self.sheet.size[1] - TOP - BOTTOM - LABEL;
        let max_mm = wide.min(high) * modules / (modules + 2.0);
        LayoutError::TooLarge { name: label.name.clone(), side_mm: 1000.0 * label.side_m, max_mm }
    }

    /// Text that is made smaller where it would not fit.
    fn line_of_text(&mut self, at: [f64; 2], size: f64, face: Face, text: &str, width: f64) {
        let letters = text.chars().count().max(1) as f64;
        self.sheet.text(at, size.min(width / (LETTER * letters)), face, text);
    }

    fn draw_bench(&mut self, corners: &BenchCorners, top: f64) {
        let heading = "Only for a camera that does not look straight down: lay these four flat on the bench, upright as they are here.";
        let width = self.sheet.size[0] - 2.0 * MARGIN;
        self.line_of_text([MARGIN, top + 4.0], 3.2, Face::Plain, heading, width);
        let ([bench_width, bench_depth], middle) = (corners.size_m, [self.sheet.size[0] / 2.0, top + 29.0]);
        // The drawing is 110 mm wide or 32 mm high, whichever is less.
        let scale = (110.0 / bench_width).min(32.0 / bench_depth);
        let on_sheet = |[x, y]: [f64; 2]| [middle[0] + scale * x, middle[1] - scale * y];
        let sheet = &mut self.sheet;
        for (index, centre) in corners.centres_m().into_iter().enumerate() {
            let [x, y] = on_sheet(centre);
            sheet.black([x - 2.0, y - 2.0], [4.0, 4.0]);
            let words = format!("{}  at {:.3},{:.3}", corners.ids[index], centre[0], centre[1]);
            let left = if index == 1 || index == 2 { x + 4.0 } else { x - 36.0 };
            sheet.text([left, y + 1.0], 3.0, Face::Plain, words);
        }
        let [x, y] = middle;
        sheet.line([x, y], [x + 14.0, y], 0.3);
        sheet.line([x, y], [x, y - 10.0], 0.3);
        sheet.text([x + 15.0, y + 1.0], 3.0, Face::Plain, "x");
        sheet.text([x + 1.0, y - 9.0], 3.0, Face::Plain, "y, away from the worker");
        sheet.text([x - 14.0, y + 4.0], 3.0, Face::Plain, "0,0");
        let across =
            format!("centre to centre: {} across, {} deep", metres(bench_width), metres(bench_depth));
        sheet.text([x - 30.0, top + 54.0], 3.2, Face::Plain, across);
    }

    /// What to type when the markers lie where they should.
    fn write_command(&mut self, corners: &BenchCorners, side_m: f64, file: &str, top: f64) {
        let marker = |corner: usize| {
            let [x, y] = corners.centres_m()[corner];
            format!("--marker {}={x:.3},{y:.3}", corners.ids[corner])
        };
        let lines = [
            format!("andond look -c {file} --save bench.png"),
            format!("andond calibrate -c {file} bench.png --side {side_m} \\"),
            format!("    {} {} \\", marker(0), marker(1)),
            format!("    {} {} --out {}.calibration.toml", marker(2), marker(3), self.station),
        ];
        let width = self.sheet.size[0] - 2.0 * MARGIN;
        for (row, line) in (0..).zip(lines) {
            self.line_of_text([MARGIN, top + 4.6 * f64::from(row)], 3.0, Face::Fixed, &line, width);
        }
    }
}

/// A sheet with title and ruler.
fn blank(paper: Paper, station: &str, dictionary: Dictionary) -> Sheet {
    let mut sheet = Sheet::new(paper);
    let title = format!("Markers of the station {station}");
    sheet.text([MARGIN, 18.0], 5.0, Face::Bold, title);
    let words = [
        format!("{}. Print at 100 % (\"actual size\", not \"fit to page\") on matte paper.", dictionary.name()),
        "Cut along the dashed lines: the white around a marker belongs to it. Stick it flat, where no hand covers it.".to_owned(),
    ];
    for (row, words) in (0..).zip(words) {
        sheet.text([MARGIN, 24.0 + 4.5 * f64::from(row)], 3.2, Face::Plain, words);
    }
    ruler(&mut sheet);
    sheet
}

/// A ruler of 100 mm with marks at every millimetre.
fn ruler(sheet: &mut Sheet) {
    let y = sheet.size[1] - 20.0;
    sheet.line([MARGIN, y], [MARGIN + 100.0, y], 0.2);
    for mark in 0..=100 {
        let height = match mark {
            _ if mark % 10 == 0 => 5.0,
            _ if mark % 5 == 0 => 3.5,
            _ => 2.0,
        };
        let x = MARGIN + f64::from(mark);
        sheet.line([x, y], [x, y - height], 0.2);
        if mark % 10 == 0 {
            sheet.text([x - 0.8, y + 3.5], 2.6, Face::Plain, (mark / 10).to_string());
        }
    }
    sheet.text(
        [MARGIN + 104.0, y - 1.5],
        3.0,
        Face::Plain,
        "100 mm by a ruler? If not, print again without scaling,",
    );
    sheet.text(
        [MARGIN + 104.0, y + 2.5],
        3.0,
        Face::Plain,
        "or write the side that you measure into the station file.",
    );
}

/// The black modules of a row, as first module and number.
fn runs(row: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (column, _) in row.iter().enumerate().filter(|(_, black)| **black) {
        match runs.last_mut() {
            Some((first, count)) if *first + *count == column => *count += 1,
            _ => runs.push((column, 1)),
        }
    }
    runs
}

/// A length without zeros that say nothing: 36 mm, 33.12 mm.
fn millimetres(length: f64) -> String {
    format!("{} mm", (100.0 * length).round() / 100.0)
}

fn metres(length: f64) -> String {
    format!("{} m", (1000.0 * length).round() / 1000.0)
}
