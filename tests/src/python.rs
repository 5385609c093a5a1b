//! A Python with pymodbus, with Prometheus's own library and with that of MCAP, for tests with clients that are not ours.
#![allow(clippy::unwrap_used)]

use crate::line::andond;
use std::fs::File;
use std::path::PathBuf;
use std::process::{Command, Output};

/// Its program. It is made once, under the target folder.
pub fn python() -> PathBuf {
    let venv = andond().parent().unwrap().join("../tmp/line-venv");
    let python = venv.join("bin/python");
    let is_complete = || {
        Command::new(&python)
            .args(["-c", "import pymodbus, prometheus_client, mcap_protobuf"])
            .output()
            .is_ok_and(|o| o.status.success())
    };
    // Several test programs want it at the same time, and two that make it would each remove what the other has made.
    let lock = File::create(venv.with_extension("lock")).unwrap();
    lock.lock().unwrap();
    if is_complete() {
        return python;
    }
    let made = Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv).output().unwrap();
    assert!(
        made.status.success(),
        "python3 -m venv failed (apt install python3-venv?): {}",
        all_output(&made)
    );
    let pip = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "pymodbus==3.16.1",
        "prometheus_client==0.26.0",
        "mcap==1.6.0",
        "mcap-protobuf-support==0.6.0",
    ];
    let pip = Command::new(&python).args(pip).output().unwrap();
    assert!(
        pip.status.success() && is_complete(),
        "pip must reach a registry that has pymodbus, prometheus_client, mcap and mcap-protobuf-support: {}",
        all_output(&pip)
    );
    python
}

/// What a program has printed.
pub fn all_output(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}
