//! `andond markers`: the markers of a station to print in true size, as one PDF and an SVG for each sheet.

mod layout;
mod pdf;
mod sheet;
mod svg;

use std::path::PathBuf;

use andon_host::config::{Config, Object};
use andon_host::exit::Code;
use andon_perception::Dictionary;

use super::{ToolError, load_config_to_learn, new_or_forced, write_together};
use crate::cli::Markers;
use crate::cli::metres::position;
use layout::{BenchCorners, Label, Sheets};
use sheet::Sheet;

pub use layout::LayoutError;

/// Side of the markers for `andond calibrate`, in metres: at 800 pixels per metre they have 32 pixels, and `andond look` wants 30.
const BENCH_SIDE_M: f64 = 0.04;

/// Runs the command.
///
/// # Errors
/// A marker that no sheet holds, an id that the dictionary does not have, a file that exists or cannot be written.
pub fn run(arguments: &Markers) -> Result<Code, ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    let corners = corners(&arguments.bench, &config)?;
    let sheets = sheets(&config, arguments, &corners)?;
    let station = &config.station.name;
    let pdf = (arguments.out.join(format!("{station}-markers.pdf")), pdf::pdf(&sheets));
    let svgs = (1..).zip(&sheets).map(|(number, sheet)| {
        let path = arguments.out.join(format!("{station}-markers-{number}.svg"));
        (path, svg::svg(sheet).into_bytes())
    });
    let files: Vec<(PathBuf, Vec<u8>)> = std::iter::once(pdf).chain(svgs).collect();
    // None is written where one cannot be, so that no sheets of two stations lie together.
    files.iter().try_for_each(|(path, _)| new_or_forced(path, arguments.force))?;
    write_together(files.iter().map(|(path, bytes)| (path.as_path(), bytes.as_slice())))?;
    files.iter().for_each(|(path, _)| println!("{}", path.display()));
    println!(
        "\nPrint at 100 % (\"actual size\"), on matte paper, and hold a ruler against the one on the sheet. Cut along the dashed lines: the white\n\
         around a marker belongs to it. Stick it flat on the part, where no hand covers it.\n\
         Next: `andond look` says whether the camera sees them; `andond calibrate` is only needed where the camera does not look\nstraight down."
    );
    Ok(Code::Stopped)
}

/// The sheets: the parts' markers first, then the bench's.
fn sheets(config: &Config, arguments: &Markers, corners: &BenchCorners) -> Result<Vec<Sheet>, LayoutError> {
    let dictionary = config.perception.dictionary;
    let mut sheets = Sheets::new(arguments.paper, &config.station.name, dictionary);
    let labels: Vec<Label> = config.objects.iter().filter_map(label).collect();
    for label in &labels {
        for _ in 0..arguments.copies {
            sheets.marker(label)?;
        }
    }
    let spare_m = labels.iter().map(|label| label.side_m).fold(0.0, f64::max);
    let taken: Vec<u16> = labels.iter().map(|label| label.id).chain(corners.ids).collect();
    let free = (1..dictionary.markers() as u16).filter(|id| !taken.contains(id));
    for id in free.take(arguments.spare.into()) {
        sheets.marker(&Label { id, name: "spare".into(), side_m: spare_m })?;
    }
    let file = config.files.last().and_then(|file| file.file_name()).unwrap_or_default().to_string_lossy();
    sheets.bench(corners, BENCH_SIDE_M, &file)?;
    Ok(sheets.finish())
}

/// What is printed for a part that carries a marker.
fn label(object: &Object) -> Option<Label> {
    let (id, side_m) = (object.marker_id()?, metres(object.marker_side_m?));
    Some(Label { id, name: object.name.clone(), side_m })
}

/// A length as the file has it: 0.036, not the nearest number of 32 bits.
fn metres(length: f32) -> f64 {
    length.to_string().parse().unwrap_or(f64::from(length))
}

/// Where the bench's markers lie, with the highest ids that no part has.
fn corners(bench: &str, config: &Config) -> Result<BenchCorners, ToolError> {
    let refused = |expected| ToolError::Option { option: "--bench", given: bench.to_owned(), expected };
    let size =
        bench.split_once('x').and_then(|(width, depth)| Some([position(width).ok()?, position(depth).ok()?]));
    let Some(size) = size.filter(|size| size.iter().all(|length| *length >= 3.0 * BENCH_SIDE_M)) else {
        return Err(refused(
            "give the width and the depth of the rectangle in metres, at least 0.12, as in 0.5x0.3",
        ));
    };
    let is_free = |id: &u16| config.objects.iter().all(|object| object.marker_id() != Some(*id));
    let highest = highest_id(config.perception.dictionary);
    let mut free = (1..=highest).rev().filter(is_free);
    let mut ids = [0; 4];
    // From the highest down, so that they stay the same when parts are added.
    for id in ids.iter_mut().rev() {
        *id = free.next().ok_or(refused(
            "the dictionary has no four markers left: choose a larger one in perception.dictionary",
        ))?;
    }
    Ok(BenchCorners { ids, size_m: size })
}

fn highest_id(dictionary: Dictionary) -> u16 {
    // A dictionary has a few thousand markers at most.
    dictionary.markers().saturating_sub(1) as u16
}

#[cfg(test)]
mod tests;
