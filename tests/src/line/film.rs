//! A station that looks at pictures.

use super::Line;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The filter that makes pictures as a camera gives them: rendered ones have no noise.
pub const NOISE: &str = "noise=alls=4:allf=t";

/// From when to when the line does not watch one of the films of [`UNSEEN`], in seconds of the film. That is in the middle of the strokes of a right
/// run.
pub const UNSEEN_S: [f64; 2] = [4.0, 7.0];

/// What a film shows while the line does not watch it, and the filter that makes it so.
pub const UNSEEN: [(&str, &str); 8] = [
    ("a black picture", "lutyuv=y=16:u=128:v=128:enable='between(t,4,7)'"),
    ("a white picture", "lutyuv=y=255:u=128:v=128:enable='between(t,4,7)'"),
    ("a picture that stands still", "loop=loop=90:size=1:start=120,setpts=N/30/TB"),
    ("a covered lens", "drawbox=c=0x6a4030:t=fill:enable='between(t,4,7)'"),
    ("a blurred picture", "gblur=sigma=12:enable='between(t,4,7)'"),
    ("a picture full of noise", "noise=alls=100:allf=t:enable='between(t,4,7)'"),
    ("a camera that was moved", "rotate=0.08:c=gray:enable='between(t,4,7)'"),
    ("too few frames", "select='not(between(t,4,7))+not(mod(n,8))'"),
];

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
