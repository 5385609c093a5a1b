//! Python with the package that the tests need.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Pinned: it must be the version of the crate.
const PACKAGE: &str = "iceoryx2==0.10.0";

/// A Python that has the package, in a venv under `target` that is made once.
pub(crate) fn python() -> PathBuf {
    let venv = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plc-venv");
    // Several tests may run at the same time.
    let lock = File::create(venv.with_extension("lock")).unwrap();
    lock.lock().unwrap();
    let python = venv.join("bin/python");
    let complete = venv.join("complete");
    if fs::read_to_string(&complete).is_ok_and(|package| package == PACKAGE) {
        return python;
    }
    let made = Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv).output().unwrap();
    let text = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "python3 -m venv failed (apt install python3-venv?): {text}");
    let pip = Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
        .arg(PACKAGE)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&pip.stderr);
    assert!(pip.status.success(), "pip must reach a registry that has {PACKAGE}: {text}");
    fs::write(complete, PACKAGE).unwrap();
    python
}
