//! `capture`: pictures of a camera or a recording to frames. The role itself is in the crate `andon-video`, whose binary links the
//! video library.

use std::os::unix::process::CommandExt as _;
use std::process::Command;

use super::RoleError;
use crate::video::helper_path;

/// Continues as `andond-video` with the same arguments: systemd sees one process. Returns only where that fails.
pub(super) fn replace_this_process() -> RoleError {
    let path = helper_path();
    let source = Command::new(&path).args(std::env::args_os().skip(1)).exec();
    RoleError::Start { path: path.display().to_string(), source }
}
