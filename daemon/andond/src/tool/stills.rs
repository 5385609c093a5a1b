//! Pictures that a tool writes: as PNG or JPEG, whole or not at all.

use std::path::Path;

use andon_host::atomic;
use andon_host::video::pipe::PictureFormat;

use super::{ToolError, cannot_write, check_writable};
use crate::video::StillEncoder;

/// Checks before the work that a picture can be written to this path.
///
/// # Errors
/// An ending that belongs to no picture format, and what the system says.
pub(super) fn check(option: &'static str, path: &Path) -> Result<(), ToolError> {
    if ending(path).is_none() {
        let given = path.display().to_string();
        return Err(ToolError::Option { option, given, expected: "a picture ends in .png or .jpg" });
    }
    check_writable(path)
}

/// Writes a picture: blue, green, red, without padding.
///
/// # Errors
/// What the encoder or the system says.
pub(super) fn write(path: &Path, format: PictureFormat, picture: &[u8]) -> Result<(), ToolError> {
    let file = StillEncoder::new(ending(path).unwrap_or("png"), format)?.encode(picture)?;
    atomic::write(path, &file).map_err(cannot_write(path))
}

fn ending(path: &Path) -> Option<&'static str> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    ["png", "jpg", "jpeg"].into_iter().find(|known| *known == ending)
}
