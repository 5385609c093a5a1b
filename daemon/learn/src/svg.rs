//! Text of an SVG picture.

use crate::html::escaped;
use std::fmt::Write as _;

/// Colours of text, lines and marks. They are the same in every picture, so that a page can have several.
const STYLE: &str = "<style>\
.t{font:12px system-ui,sans-serif;fill:#30363d}.s{font-size:10px}.n{font-weight:600}.e{text-anchor:end}.m{text-anchor:middle}\
.a{stroke:#8b949e;fill:none}.g{stroke:#8b949e;stroke-opacity:.35;fill:none}.w{stroke:#8b949e;stroke-opacity:.6;fill:none}\
.b{stroke:#0b5cad;stroke-width:2;fill:none}.o{stroke:#c2410c;stroke-width:2;fill:none}.p{fill:#0b5cad}.d{fill:#c2410c}\
.rb{stroke:#0b5cad;fill:#eef5fc;stroke-width:1.5}.lb{stroke:#8250df;fill:#f6f1fe;stroke-width:1.5}.ob{stroke-dasharray:3 4}\
.la,.na{stroke-width:1.8;fill:none}.la{stroke:#24292f}.na{stroke:#9a6700;stroke-dasharray:7 5}.lh{fill:#24292f}.nh{fill:#9a6700}\
.h{fill:#5b8def}.k{stroke:#fff;stroke-width:1.5}\
.c0,.c1,.c2,.c3,.c4,.c5{stroke-width:2;fill:none}.c0{stroke:#0b5cad}.c1{stroke:#8250df}.c2{stroke:#1a7f37}.c3{stroke:#9a6700}.c4{stroke:#bf3989}.c5{stroke:#57606a}\
@media(prefers-color-scheme:dark){.t{fill:#d0d7de}.b{stroke:#6cb6ff}.o{stroke:#ff9d5c}.p{fill:#6cb6ff}.d{fill:#ff9d5c}.k{stroke:#0d1117}.rb{stroke:#6cb6ff;fill:#10243a}.lb{stroke:#c297ff;fill:#221a36}\
.la{stroke:#d0d7de}.na{stroke:#e3b341}.lh{fill:#d0d7de}.nh{fill:#e3b341}\
.c0{stroke:#6cb6ff}.c1{stroke:#c297ff}.c2{stroke:#57d364}.c3{stroke:#e3b341}.c4{stroke:#f778ba}.c5{stroke:#9da7b3}}\
</style>";

/// A picture that is being drawn. Lengths are in pixels from its upper left corner; a class is one of its style sheet.
pub struct Svg {
    text: String,
}

impl Svg {
    /// An empty picture of this size.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" role=\"img\">\
             <title>{}</title>",
            escaped(title)
        );
        text += STYLE;
        Self { text }
    }

    /// Adds text whose base line begins at a point.
    pub fn text(&mut self, x: f64, y: f64, class: &str, text: &str) {
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" class=\"t {class}\">{}</text>",
            escaped(text)
        ));
    }

    /// Adds a straight line.
    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let ([x1, y1], [x2, y2]) = (from, to);
        self.add(format_args!(
            "<line class=\"{class}\" x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\"/>"
        ));
    }

    /// Adds a line through points.
    pub fn polyline(&mut self, class: &str, points: impl IntoIterator<Item = [f64; 2]>) {
        let mut all = String::new();
        for [x, y] in points {
            // Writing to a string cannot fail.
            let _ = write!(all, "{x:.1},{y:.1} ");
        }
        self.add(format_args!("<polyline class=\"{class}\" points=\"{}\"/>", all.trim_end()));
    }

    /// Adds an element of SVG as it is.
    pub fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(element);
    }

    /// The whole picture.
    pub fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }
}
