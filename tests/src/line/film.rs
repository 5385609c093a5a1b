//! A station that looks at pictures.

use super::Line;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The filter that makes pictures as a camera gives them: rendered ones have no noise.
pub const NOISE: &str = "noise=alls=4:allf=t";

/// The tree that the tests belong to.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

impl Line {
    /// A station that plays a film which is made by ffmpeg from these arguments, in the folder of the shipped clips.
    pub fn with_film(camera: &str, perception: &str, ffmpeg: &[&str]) -> Self {
        let line = Self::configured(|folder, port| {
            let shipped = fs::read_to_string(root().join("config/stations/film.toml")).unwrap();
            let (_, objects) = shipped.split_once("[[objects]]").unwrap();
            let (objects, _) = objects.split_once("[plc]").unwrap();
            let models = root().join("target/runtime");
            let job = root().join("config/jobs/polish-and-measure.toml");
            format!(
                "[station]\nname = \"line\"\nroot = {folder:?}\njob = {job:?}\n\n\
             [camera]\nsource = \"video\"\npath = \"film.mkv\"\nloop = true\n{camera}\n\n\
             [perception]\nhands = [\"right\"]\nmodels = {models:?}\n{perception}\n\n\
             [journal]\npath = \"journal.sqlite\"\n\n\
             [plc]\nenable = true\nport = {port}\n\n[[objects]]{objects}"
            )
        });
        let lossless = ["-pix_fmt", "yuv420p", "-preset", "ultrafast", "-qp", "0"];
        let status = Command::new("ffmpeg")
            .args(["-v", "error"])
            .args(ffmpeg)
            .args(lossless)
            .arg(line.path("film.mkv"))
            .current_dir(root().join("tests/footage"))
            .status()
            .expect("ffmpeg is needed: run `make test-packages`, or apt install ffmpeg");
        assert!(status.success());
        line
    }
}
