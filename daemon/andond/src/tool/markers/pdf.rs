//! Sheets as PDF in true size.

use pdf_writer::{Content, Finish as _, Name, Pdf, Rect, Ref, Str};

use super::sheet::{Face, Item, Sheet};

/// Points per millimetre: PDF counts in 72nds of an inch.
const POINTS: f64 = 72.0 / 25.4;

const FACES: [(Face, &[u8], &[u8]); 3] = [
    (Face::Plain, b"F1", b"Helvetica"),
    (Face::Bold, b"F2", b"Helvetica-Bold"),
    (Face::Fixed, b"F3", b"Courier"),
];

/// The sheets as pages of one file.
pub(super) fn pdf(sheets: &[Sheet]) -> Vec<u8> {
    let mut next = 0;
    let mut reference = || {
        next += 1;
        Ref::new(next)
    };
    let (catalog, tree) = (reference(), reference());
    let fonts = FACES.map(|_| reference());
    let pages: Vec<(Ref, Ref)> = sheets.iter().map(|_| (reference(), reference())).collect();
    let mut pdf = Pdf::new();
    let mut root = pdf.catalog(catalog);
    root.pages(tree);
    // A reader proposes to print in true size then, and not to fit the page.
    root.viewer_preferences().pair(Name(b"PrintScaling"), Name(b"None"));
    root.finish();
    pdf.pages(tree).kids(pages.iter().map(|(page, _)| *page)).count(pages.len() as i32);
    for ((_, _, name), font) in FACES.into_iter().zip(fonts) {
        pdf.type1_font(font).base_font(Name(name)).encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    for (sheet, (page, content)) in sheets.iter().zip(&pages) {
        let [width, height] = sheet.size.map(points);
        let mut dictionary = pdf.page(*page);
        dictionary.parent(tree).media_box(Rect::new(0.0, 0.0, width, height)).contents(*content);
        let mut resources = dictionary.resources();
        let mut names = resources.fonts();
        for ((_, name, _), font) in FACES.into_iter().zip(fonts) {
            names.pair(Name(name), font);
        }
        names.finish();
        resources.finish();
        dictionary.finish();
        pdf.stream(*content, &drawn(sheet));
    }
    pdf.finish()
}

fn points(millimetres: f64) -> f32 {
    (millimetres * POINTS) as f32
}

fn drawn(sheet: &Sheet) -> Vec<u8> {
    let mut content = Content::new();
    // PDF has its origin at the bottom left corner, and y points up.
    let place = |[x, y]: [f64; 2]| [points(x), points(sheet.size[1] - y)];
    for item in &sheet.items {
        match item {
            Item::Black { at, size: [width, height] } => {
                let [x, y] = place([at[0], at[1] + height]);
                content.rect(x, y, points(*width), points(*height)).fill_nonzero();
            }
            Item::Line { from, to, width, is_dashed } => {
                let dashes: &[f32] = if *is_dashed { &[points(2.0), points(1.5)] } else { &[] };
                let (from, to) = (place(*from), place(*to));
                content.set_line_width(points(*width)).set_dash_pattern(dashes.iter().copied(), 0.0);
                content.move_to(from[0], from[1]).line_to(to[0], to[1]).stroke();
            }
            Item::Text { at, size, face, text } => {
                let [x, y] = place(*at);
                let name =
                    FACES.iter().find(|(known, _, _)| known == face).map_or(&b"F1"[..], |(_, name, _)| name);
                content.begin_text().set_font(Name(name), points(*size));
                content.next_line(x, y).show(Str(&latin(text))).end_text();
            }
        }
    }
    content.finish().into_vec()
}

/// Text in the encoding of the fonts that every reader has: the letters of western languages. Others become a question mark; the id beside
/// them tells the parts apart.
pub(super) fn latin(text: &str) -> Vec<u8> {
    text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap_or(b'?')).collect()
}
