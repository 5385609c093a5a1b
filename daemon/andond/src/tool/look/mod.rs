//! stub
use super::ToolError;
use crate::cli::Look;
use crate::exit::Code;
/// stub
pub fn run(_: &Look) -> Result<Code, ToolError> {
    Ok(Code::Stopped)
}
