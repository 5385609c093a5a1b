//! Single pictures for people: what is seen in one, and how well the markers of a calibration fit.

use andon_host::video::pipe::PictureFormat;
use andon_perception::BenchPoint;
use andon_perception::bench::{Examination, MarkerResidual};
use shm_schemas::Detections;

use super::canvas::{AMBER, Canvas, GREEN, RED, WHITE};
use super::seen::{draw_hand, draw_seen};
use crate::report::Names;

/// How many times as long as they are the residuals are drawn.
const EXAGGERATED: f64 = 10.0;
/// Below the picture: what the colours mean.
const LEGEND_PX: u32 = 46;
/// The width of a character of the words beneath a picture.
const CHARACTER_PX: usize = 9;
/// Between two lines of the bench's grid, in metres.
const GRID_M: f64 = 0.1;

/// A marker in a picture, with the words beside it.
pub struct Marked {
    /// Its corners in pixels.
    pub corners_px: [[f32; 2]; 4],
    /// What is written above it.
    pub words: String,
    /// Whether something should be changed about it.
    pub is_doubtful: bool,
}

/// The picture with outlines and words of its markers, and with the hands that were seen in it.
///
/// # Errors
/// That OpenCV cannot draw.
pub fn with_seen(
    format: PictureFormat,
    picture: &[u8],
    markers: &[Marked],
    seen: &Detections,
) -> opencv::Result<Vec<u8>> {
    let mut canvas = Canvas::at_its_size([format.width, format.height], format.height);
    canvas.show(picture)?;
    for (index, marked) in markers.iter().enumerate() {
        let colour = if marked.is_doubtful { AMBER } else { GREEN };
        canvas.outline(&marked.corners_px, colour)?;
        let [[left, _], [top, bottom]] = [0, 1].map(|axis| range(&marked.corners_px, axis));
        // Parts that lie at each other would have their words at the same place.
        let y = if index % 2 == 0 { (top - 8.0).max(12.0) } else { bottom + 18.0 };
        canvas.text([left, y], &marked.words, 0.45, if marked.is_doubtful { AMBER } else { WHITE })?;
    }
    for hand in seen.hands() {
        draw_hand(&mut canvas, hand, 3)?;
    }
    Ok(canvas.pixels().to_vec())
}

/// The picture that an anomaly was decided on, with what was seen in it, and beneath it what was said. The format is that of the result, which is
/// higher than the picture.
///
/// # Errors
/// That OpenCV cannot draw.
pub fn with_verdict(
    format: PictureFormat,
    picture: &[u8],
    seen: Option<&Detections>,
    names: &Names,
    words: &str,
) -> opencv::Result<(PictureFormat, Vec<u8>)> {
    let higher = PictureFormat { height: format.height + LEGEND_PX, ..format };
    let mut canvas = Canvas::at_its_size([format.width, format.height], higher.height);
    canvas.show(picture)?;
    if let Some(seen) = seen {
        draw_seen(&mut canvas, seen, names, 4)?;
    }
    for (line, words) in (1_u8..).zip(lines(words, format.width as usize / CHARACTER_PX)).take(2) {
        canvas.text([8.0, format.height as f32 + 20.0 * f32::from(line)], &words, 0.5, WHITE)?;
    }
    Ok((higher, canvas.pixels().to_vec()))
}

/// Text in lines of at most this many characters, broken at blanks.
fn lines(text: &str, longest: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() || line.len() + 1 + word.len() <= longest => {
                line.push_str(if line.is_empty() { "" } else { " " });
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The picture that a calibration was made from, with the bench's grid. It shows where each marker is said to lie and where the others place it.
/// Below it is what the colours mean. The format is that of the result, which is higher than the picture.
///
/// # Errors
/// That OpenCV cannot draw.
pub fn with_residuals(
    format: PictureFormat,
    picture: &[u8],
    examined: &Examination,
) -> opencv::Result<(PictureFormat, Vec<u8>)> {
    let higher = PictureFormat { height: format.height + LEGEND_PX, ..format };
    let mut canvas = Canvas::at_its_size([format.width, format.height], higher.height);
    canvas.show(picture)?;
    draw_grid(&mut canvas, examined, format.height as f32)?;
    for marker in &examined.markers {
        draw_residual(&mut canvas, examined, marker)?;
    }
    let top = format.height as f32;
    let legend = "orange: the bench in steps of 10 cm; green: where a marker is said to lie;";
    canvas.text([8.0, top + 18.0], legend, 0.45, WHITE)?;
    canvas.text(
        [8.0, top + 36.0],
        "red: from there to where the others place it, ten times as far",
        0.45,
        WHITE,
    )?;
    Ok((higher, canvas.pixels().to_vec()))
}

fn draw_residual(canvas: &mut Canvas, examined: &Examination, marker: &MarkerResidual) -> opencv::Result<()> {
    canvas.outline(&marker.corners_px, GREEN)?;
    let BenchPoint { x, y } = marker.stated;
    let way = [marker.measured.x - x, marker.measured.y - y].map(|metres| EXAGGERATED * metres);
    let ends = [BenchPoint::new(x, y), BenchPoint::new(x + way[0], y + way[1])];
    if let [Some(from), Some(to)] = ends.map(|end| examined.pixel(end)) {
        canvas.line(from, to, RED, 2)?;
        canvas.dot(from, 4, GREEN)?;
        canvas.dot(to, 3, RED)?;
    }
    let words = format!("{}: {:.1} mm", marker.id, 1000.0 * marker.distance_m());
    let [[left, _], [top, _]] = [0, 1].map(|axis| range(&marker.corners_px, axis));
    canvas.text([left, (top - 8.0).max(12.0)], &words, 0.5, WHITE)
}

/// The least and the greatest coordinate of a marker's corners.
fn range(corners: &[[f32; 2]; 4], axis: usize) -> [f32; 2] {
    let along = || corners.iter().map(|corner| corner[axis]);
    [along().fold(f32::INFINITY, f32::min), along().fold(f32::NEG_INFINITY, f32::max)]
}

/// The grid between the outermost markers; the axes are thicker.
fn draw_grid(canvas: &mut Canvas, examined: &Examination, height: f32) -> opencv::Result<()> {
    let range = |axis: fn(BenchPoint) -> f64| {
        let steps = || examined.markers.iter().map(|marker| axis(marker.stated) / GRID_M);
        steps().fold(f64::INFINITY, f64::min).floor() as i32
            ..=steps().fold(f64::NEG_INFINITY, f64::max).ceil() as i32
    };
    let (columns, rows) = (range(|point| point.x), range(|point| point.y));
    let mut line = |from: [i32; 2], to: [i32; 2], thickness: i32| {
        let ends = [from, to]
            .map(|[x, y]| examined.pixel(BenchPoint::new(GRID_M * f64::from(x), GRID_M * f64::from(y))));
        match ends {
            // What lies below the picture would be drawn over the legend.
            [Some(from), Some(to)] if from[1] < height && to[1] < height => {
                canvas.line(from, to, AMBER, thickness)
            }
            _ => Ok(()),
        }
    };
    for y in rows.clone() {
        for x in columns.clone() {
            let thickness = |is_axis: bool| if is_axis { 2 } else { 1 };
            if x < *columns.end() {
                line([x, y], [x + 1, y], thickness(y == 0))?;
            }
            if y < *rows.end() {
                line([x, y], [x, y + 1], thickness(x == 0))?;
            }
        }
    }
    Ok(())
}
