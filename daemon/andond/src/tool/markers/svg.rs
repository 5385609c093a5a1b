//! A sheet as SVG in true size.

use std::fmt::Write as _;

use super::sheet::{Face, Item, Sheet};

/// The sheet as SVG: one unit is one millimetre.
pub(super) fn svg(sheet: &Sheet) -> String {
    let [width, height] = sheet.size;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for item in &sheet.items {
        // Writing to a `String` cannot fail.
        let _ = match item {
            // Without soft edges no bright seam is left between two squares; a thin line would vanish on a screen.
            Item::Black { at: [x, y], size: [width, height] } => writeln!(
                out,
                "<rect x=\"{x:.4}\" y=\"{y:.4}\" width=\"{width:.4}\" height=\"{height:.4}\" shape-rendering=\"crispEdges\"/>"
            ),
            Item::Line { from: [x1, y1], to: [x2, y2], width, is_dashed } => {
                let dashes = if *is_dashed { " stroke-dasharray=\"2 1.5\"" } else { "" };
                writeln!(
                    out,
                    "<path d=\"M{x1:.3} {y1:.3}L{x2:.3} {y2:.3}\" stroke=\"black\" stroke-width=\"{width}\"{dashes}/>"
                )
            }
            Item::Text { at: [x, y], size, face, text } => {
                let face = match face {
                    Face::Plain => "font-family=\"Helvetica, Arial, sans-serif\"",
                    Face::Bold => "font-family=\"Helvetica, Arial, sans-serif\" font-weight=\"bold\"",
                    Face::Fixed => "font-family=\"Courier, monospace\" xml:space=\"preserve\"",
                };
                writeln!(
                    out,
                    "<text x=\"{x:.3}\" y=\"{y:.3}\" font-size=\"{size:.3}\" {face}>{}</text>",
                    escaped(text)
                )
            }
        };
    }
    out.push_str("</svg>\n");
    out
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
