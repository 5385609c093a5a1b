//! The C example, which reads verdicts as a soft PLC on the same machine does.

use super::andond;
use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiles it in this folder against the library beside the binary.
pub fn soft_plc(folder: &Path) -> PathBuf {
    let plc = Path::new(env!("CARGO_MANIFEST_DIR")).join("../daemon/plc");
    let library = andond().with_file_name("libandon_plc.so");
    // Programs ask for the library by the name that it was given when it was linked.
    std::fs::copy(&library, folder.join("libandon_plc.so.0")).unwrap_or_else(|error| {
        panic!("{}: {error}: build it first with `cargo build --release -p andon-plc`", library.display())
    });
    let program = folder.join("soft_plc");
    let status = Command::new("cc")
        .args(["-std=c11", "-O2", "-o"])
        .arg(&program)
        .arg(format!("-I{}", plc.join("include").display()))
        .arg(plc.join("examples/soft_plc.c"))
        .arg(folder.join("libandon_plc.so.0"))
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .status()
        .unwrap();
    assert!(status.success(), "the example does not compile");
    // While a node opens in another thread, files that this process makes are for nobody to execute.
    std::fs::set_permissions(&program, Permissions::from_mode(0o700)).unwrap();
    program
}
