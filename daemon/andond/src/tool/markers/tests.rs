#![allow(clippy::unwrap_used)]
use super::*;
use crate::cli::Paper;
use andon_host::cli::ConfigArgs;
use andon_perception::{ImageView, MarkerFinder, PixelFormat};
use sheet::Item;

/// Pixels per millimetre of what the tests draw.
const SCALE: f64 = 8.0;

fn arguments(paper: Paper) -> Markers {
    let config = ConfigArgs::default();
    Markers { config, out: ".".into(), paper, copies: 1, spare: 2, bench: "0.5x0.3".into(), force: false }
}

fn config(parts: &[(u16, &str, f32)]) -> Config {
    let object = |(id, name, side): &(u16, &str, f32)| Object {
        id: *id,
        name: (*name).into(),
        marker_side_m: Some(*side),
        marker: None,
        interaction_points: None,
    };
    let mut config = Config { objects: parts.iter().map(object).collect(), ..Config::default() };
    config.station.name = "bench1".into();
    config
}

fn made(parts: &[(u16, &str, f32)], arguments: &Markers) -> Result<Vec<Sheet>, String> {
    let config = config(parts);
    let corners = corners(&arguments.bench, &config).map_err(|error| error.to_string())?;
    sheets(&config, arguments, &corners).map_err(|error| error.to_string())
}

/// What a sheet shows, in grey levels, without its text.
fn drawn(sheet: &Sheet) -> (usize, usize, Vec<u8>) {
    let [width, height] = sheet.size.map(|length| (SCALE * length) as usize);
    let mut pixels = vec![250; width * height];
    for item in &sheet.items {
        let (at, size) = match item {
            Item::Black { at, size } => (*at, *size),
            Item::Line { from, to, width, .. } => {
                let at = [0, 1].map(|axis| from[axis].min(to[axis]));
                (at, [0, 1].map(|axis| (to[axis] - from[axis]).abs().max(*width)))
            }
            Item::Text { .. } => continue,
        };
        let [x, y] = [0, 1].map(|axis| {
            (SCALE * at[axis]).round() as usize..(SCALE * (at[axis] + size[axis])).round() as usize
        });
        for row in y {
            pixels[row * width + x.start..row * width + x.end].fill(10);
        }
    }
    (width, height, pixels)
}

/// The ids that are found on a sheet, with their sides in millimetres.
fn found(sheet: &Sheet) -> Vec<(u16, f64)> {
    let (width, height, pixels) = drawn(sheet);
    let image = ImageView::new(width, height, width, PixelFormat::Gray8, &pixels).unwrap();
    let seen = MarkerFinder::new(Dictionary::default()).unwrap().find(&image).unwrap();
    let side = |[a, b, ..]: [[f32; 2]; 4]| f64::from((a[0] - b[0]).hypot(a[1] - b[1])) / SCALE;
    seen.iter().map(|marker| (marker.id, side(marker.corners))).collect()
}

#[test]
fn every_marker_is_found_on_its_sheet_in_the_size_of_the_station_file() {
    for paper in [Paper::A4, Paper::Letter] {
        let parts = [(1, "brick", 0.03312), (2, "polisher", 0.036), (7, "meter", 0.025)];
        let [parts, bench] = &made(&parts, &arguments(paper)).unwrap()[..] else {
            unreachable!("two sheets")
        };
        let expected = [
            (1, 33.12),
            (2, 36.0),
            (3, 36.0),
            (4, 36.0),
            (7, 25.0),
            (46, 40.0),
            (47, 40.0),
            (48, 40.0),
            (49, 40.0),
        ];
        let all: Vec<_> = found(parts).into_iter().chain(found(bench)).collect();
        assert_eq!(all.len(), expected.len(), "{all:?}");
        for ((id, side), (known, expected)) in all.iter().zip(expected) {
            assert_eq!(*id, known);
            assert!((side - expected).abs() < 0.2, "marker {id} has {side} mm and should have {expected}");
        }
    }
}

#[test]
fn nothing_leaves_the_paper_or_lies_on_something_else() {
    let parts: Vec<(u16, String)> = (1..=32).map(|id| (id, format!("part {id}"))).collect();
    let parts: Vec<_> =
        parts.iter().map(|(id, name)| (*id, name.as_str(), 0.01 + 0.002 * f32::from(*id))).collect();
    for paper in [Paper::A4, Paper::Letter] {
        let sheets = made(&parts, &arguments(paper)).unwrap();
        assert!(sheets.len() > 2);
        assert_eq!(sheets.iter().map(|sheet| found(sheet).len()).sum::<usize>(), 32 + 2 + 4);
        for sheet in &sheets {
            for item in &sheet.items {
                let (Item::Black { at, .. } | Item::Line { from: at, .. } | Item::Text { at, .. }) = item;
                let is_inside = |axis: usize| (8.0..=sheet.size[axis] - 8.0).contains(&at[axis]);
                assert!(is_inside(0) && is_inside(1), "{item:?}");
            }
        }
    }
}

#[test]
fn the_markers_of_the_bench_are_none_of_a_part_and_the_sheet_says_the_command() {
    let sheets = made(&[(48, "brick", 0.04)], &arguments(Paper::A4)).unwrap();
    let bench = sheets.last().unwrap();
    let texts: Vec<&str> = bench
        .items
        .iter()
        .filter_map(|item| if let Item::Text { text, .. } = item { Some(text.as_str()) } else { None })
        .collect();
    let all = texts.join("\n");
    assert!(all.contains("--marker 45=-0.250,-0.150 --marker 46=0.250,-0.150"), "{all}");
    assert!(all.contains("--marker 47=0.250,0.150 --marker 49=-0.250,0.150"), "{all}");
    assert!(all.contains("--side 0.04 "), "{all}");
}

#[test]
fn a_marker_that_no_sheet_holds_is_refused_with_the_largest_one() {
    let error = made(&[(1, "door", 0.3)], &arguments(Paper::A4)).unwrap_err();
    assert!(error.contains("the marker of door has a side of 300 mm, and a sheet holds 140 mm"), "{error}");
}

#[test]
fn a_rectangle_that_cannot_be_one_is_refused_with_an_example() {
    for bench in ["", "0.5", "500x300", "0.05x0.3", "wide"] {
        let arguments = Markers { bench: bench.into(), ..arguments(Paper::A4) };
        let error = made(&[(1, "brick", 0.04)], &arguments).unwrap_err();
        assert!(error.contains("as in 0.5x0.3"), "{bench}: {error}");
    }
}

#[test]
fn a_name_that_no_font_has_is_printed_as_far_as_it_can_be() {
    let sheets = made(&[(1, "Bügel <2> деталь", 0.04)], &arguments(Paper::A4)).unwrap();
    assert!(svg::svg(&sheets[0]).contains("Bügel &lt;2&gt; деталь"));
    assert_eq!(pdf::latin("Bügel деталь"), b"B\xfcgel ??????");
}

/// The first page of a PDF in grey levels at 150 dots per inch, by a renderer that shares nothing with the writer.
fn printed(pdf: &[u8]) -> (usize, usize, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sheet.pdf");
    std::fs::write(&file, pdf).unwrap();
    let renderer = std::process::Command::new("pdftoppm")
        .args(["-r", "150", "-gray", "-f", "1", "-l", "1"])
        .arg(&file)
        .output();
    let picture = renderer.expect("poppler-utils is needed: run `make test-packages`").stdout;
    // P5, width, height and the largest grey level, each followed by one white character.
    let mut begin = picture.splitn(4, |byte| byte.is_ascii_whitespace());
    let mut field = || std::str::from_utf8(begin.next().unwrap()).unwrap();
    assert_eq!(field(), "P5");
    let (width, height) = (field().parse::<usize>().unwrap(), field().parse::<usize>().unwrap());
    (width, height, picture[picture.len() - width * height..].to_vec())
}

#[test]
fn a_reader_of_pdf_shows_markers_and_ruler_in_true_size() {
    let px_per_mm = 150.0 / 25.4;
    for paper in [Paper::A4, Paper::Letter] {
        let sheets = made(&[(1, "brick", 0.03312), (2, "polisher", 0.036)], &arguments(paper)).unwrap();
        let (width, height, pixels) = printed(&pdf::pdf(&sheets));
        let image = ImageView::new(width, height, width, PixelFormat::Gray8, &pixels).unwrap();
        let seen = MarkerFinder::new(Dictionary::default()).unwrap().find(&image).unwrap();
        for ((id, side_mm), marker) in [(1, 33.12), (2, 36.0)].into_iter().zip(&seen) {
            assert_eq!(marker.id, id);
            let [a, b, c, _] = marker.corners;
            for (from, to) in [(a, b), (b, c)] {
                let measured_mm = f64::from((from[0] - to[0]).hypot(from[1] - to[1])) / px_per_mm;
                assert!((measured_mm - side_mm).abs() < 0.15, "{measured_mm} mm instead of {side_mm}");
            }
        }
        // The line below the marks of the ruler is the longest one on the sheet.
        let longest = |row: &[u8]| row.split(|pixel| *pixel > 160).map(<[u8]>::len).max().unwrap_or_default();
        let ruler_mm = pixels.chunks(width).map(longest).max().unwrap_or_default() as f64 / px_per_mm;
        assert!((ruler_mm - 100.0).abs() < 0.5, "the ruler has {ruler_mm} mm");
    }
}
