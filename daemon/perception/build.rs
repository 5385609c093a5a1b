//! Tells the crate which of OpenCV's two ArUco interfaces is installed.

use std::process::Command;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(aruco_in_objdetect)");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PKG_CONFIG_PATH");
    // Without an answer the opencv crate's own build fails first, and names what is missing.
    let version = Command::new("pkg-config").args(["--modversion", "opencv4"]).output().ok();
    let version =
        version.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let mut numbers = version.trim().split('.').map_while(|number| number.parse::<u32>().ok());
    let version = (numbers.next().unwrap_or(4), numbers.next().unwrap_or(0));
    // ArUco moved from contrib's `aruco` to `objdetect` in OpenCV 4.7.
    if version >= (4, 7) {
        println!("cargo::rustc-cfg=aruco_in_objdetect");
        if std::env::var_os("CARGO_FEATURE_OBJDETECT").is_none() {
            println!(
                "cargo::error=OpenCV {}.{} has its marker detector in the module objdetect: build with `make`, or add \
                 `--features andond/objdetect`",
                version.0, version.1
            );
        }
    }
}
