//! Python with the packages of other people that the tests check against.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Pinned: iceoryx2 must be the version of the crate.
const PACKAGES: [&str; 2] = ["iceoryx2==0.10.0", "pymodbus==3.16.1"];

/// A Python that has the packages, in a venv under `target`, made once.
pub(crate) fn python() -> PathBuf {
    let venv = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plc-venv");
    // Tests of several files run at the same time.
    let lock = File::create(venv.with_extension("lock")).unwrap();
    lock.lock().unwrap();
    let python = venv.join("bin/python");
    let complete = venv.join("complete");
    if fs::read_to_string(&complete).is_ok_and(|packages| packages == PACKAGES.join(" ")) {
        return python;
    }
    let made = Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv).output().unwrap();
    let text = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "python3 -m venv failed (apt install python3-venv?): {text}");
    let pip = Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
        .args(PACKAGES)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&pip.stderr);
    assert!(pip.status.success(), "pip must reach a registry that has {}: {text}", PACKAGES.join(" and "));
    fs::write(complete, PACKAGES.join(" ")).unwrap();
    python
}
