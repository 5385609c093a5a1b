//! Recordings, and stations that play them.

use andon_core::input::Frame;
use andon_ipc::{FrameReader, Node, Stop};
use andon_learn::recording;
use andon_tests::line::{Line, PATIENCE, Watcher, andond};
use serde_json::Value;
use shm_schemas::{FrameHeader, RoleId, RoleState, Verdict, VerdictLevel, VerdictOutcome, flag};
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// On a busy machine frames may not reach the recorder, which says so, and that one should record again.
const TRIES: usize = 5;

/// The roles after the steward; each writer of a paced recording waits for the reader after it.
const PLAYING: [&str; 5] = ["journal", "judge", "encode", "perceive", "capture"];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Frames of a clip of `tests/footage`.
#[derive(Clone, Copy)]
pub(crate) struct Clip {
    pub(crate) name: &'static str,
    pub(crate) first: usize,
    pub(crate) frames: usize,
}

/// A recording of a clip. Its files are deleted when it is dropped.
pub(crate) struct Bag {
    clip: Clip,
    folder: TempDir,
}

impl Clip {
    /// The recording and the pixels that it was made of.
    pub(crate) fn bag(self) -> Bag {
        self.record(&[])
    }

    /// The recording alone.
    pub(crate) fn only_bag(self) -> Bag {
        self.record(&["--bag-only"])
    }

    fn record(self, arguments: &[&str]) -> Bag {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
        let bag = Bag { clip: self, folder };
        let footage = repository().join("tests/footage");
        let made = Command::new("python3")
            .arg(repository().join("tests/realsense/make_bag.py"))
            .arg(footage.join(format!("{}.mp4", self.name)))
            .arg(footage.join(format!("{}.truth.jsonl", self.name)))
            .arg(bag.path())
            .args(["--first", &self.first.to_string(), "--frames", &self.frames.to_string()])
            .args(arguments)
            .status()
            .unwrap();
        assert!(made.success(), "make_bag.py has failed, see above");
        bag
    }
}

impl Bag {
    fn path(&self) -> PathBuf {
        self.folder.path().join("clip.bag")
    }

    /// The bytes of all `colour` or `depth` pictures.
    pub(crate) fn pixels(&self, plane: &str) -> Vec<u8> {
        fs::read(self.path().with_extension(plane)).unwrap()
    }

    /// The optics of the camera.
    pub(crate) fn calibration(&self) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path().with_extension("json")).unwrap()).unwrap()
    }

    /// The centre of each marker in a frame of the colour picture, in pixels, and its distance from the camera in metres.
    pub(crate) fn markers(&self, frame: usize) -> Vec<([f64; 2], f64)> {
        let truth = repository().join(format!("tests/footage/{}.truth.jsonl", self.clip.name));
        let truth = fs::read_to_string(truth).unwrap();
        let line =
            |number: usize| -> Value { serde_json::from_str(truth.lines().nth(number).unwrap()).unwrap() };
        let camera_height = number(&line(0)["camera"]["height_m"]);
        let marker = |object: &Value| {
            let corners = object["marker_px"].as_array().unwrap();
            let centre =
                [0, 1].map(|axis| corners.iter().map(|corner| number(&corner[axis])).sum::<f64>() / 4.0);
            (centre, camera_height - number(&object["p"][2]))
        };
        line(1 + self.clip.first + frame)["objects"].as_array().unwrap().iter().map(marker).collect()
    }

    /// All frames of the recording, as `capture` sends them, and the header that flagged the end.
    pub(crate) fn play(&self) -> (Vec<Read>, Option<FrameHeader>) {
        let (played, end) = capture(self, false).frames(usize::MAX);
        assert_eq!(played.len(), self.clip.frames);
        (played, end)
    }

    fn source(&self) -> String {
        format!("source = \"bag\"\npath = {:?}\nspeed = \"max\"\n", self.path())
    }
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A station, running from the steward to `capture`, that plays a recording as fast as its reader takes the frames.
pub(crate) fn capture(bag: &Bag, repeat: bool) -> Playing {
    let mut line = Line::configured(|folder, _| {
        format!("{}loop = {repeat}\n\n{}", head(folder, &bag.source()), rest(folder))
    });
    line.start("steward");
    let node = Node::open(&line.station, RoleId::Perceive, PATIENCE, &Stop::new().unwrap()).unwrap();
    let frames = node.frame_reader().unwrap();
    line.start("capture");
    Playing { frames, node, line }
}

/// A running `capture` and a reader in the place of `perceive`.
pub(crate) struct Playing {
    frames: FrameReader,
    node: Node,
    line: Line,
}

/// A frame as it was received.
pub(crate) struct Read {
    pub(crate) header: FrameHeader,
    pub(crate) bytes: Vec<u8>,
}

impl Playing {
    /// Frames until the end of the stream, with the header that flagged it; or the first `max` frames.
    pub(crate) fn frames(&mut self, max: usize) -> (Vec<Read>, Option<FrameHeader>) {
        let until = Instant::now() + PATIENCE;
        let mut read = Vec::new();
        while read.len() < max {
            assert!(
                Instant::now() < until,
                "{} frames, then none:\n{}",
                read.len(),
                self.line.log("capture")
            );
            self.node.wait(&mut [&mut self.frames], Duration::from_millis(200)).unwrap();
            while let Some(frame) = self.frames.take().unwrap() {
                let header = *frame.header();
                if header.flags & flag::END_OF_STREAM != 0 {
                    return (read, Some(header));
                }
                read.push(Read { header, bytes: frame.bytes().to_vec() });
            }
        }
        (read, None)
    }
}

impl Read {
    /// Depth in metres of the point at `pixel` of the colour picture and `distance` metres from the colour camera, as the depth camera measures it.
    /// The median of those of 5 x 5 pixels that have depth.
    pub(crate) fn depth_at(&self, pixel: [f64; 2], distance: f64) -> f64 {
        let FrameHeader { colour, depth, colour_from_depth: between, .. } = self.header;
        let (width, start) = (self.header.depth_width as usize, self.header.colour_bytes().unwrap());
        let ray = [
            (pixel[0] - f64::from(colour.cx)) / f64::from(colour.fx),
            (pixel[1] - f64::from(colour.cy)) / f64::from(colour.fy),
            1.0,
        ];
        let moved: Vec<f64> =
            ray.iter().zip(between.translation_m).map(|(p, t)| p * distance - f64::from(t)).collect();
        // The inverse of a rotation is its transpose.
        let seen = [0, 1, 2]
            .map(|k| (0..3).map(|row| f64::from(between.rotation[row][k]) * moved[row]).sum::<f64>());
        let column = (seen[0] / seen[2] * f64::from(depth.fx) + f64::from(depth.cx)).round() as usize;
        let row = (seen[1] / seen[2] * f64::from(depth.fy) + f64::from(depth.cy)).round() as usize;
        let mut steps: Vec<u16> = (row - 2..=row + 2)
            .flat_map(|row| (column - 2..=column + 2).map(move |column| start + (row * width + column) * 2))
            .map(|byte| u16::from_le_bytes([self.bytes[byte], self.bytes[byte + 1]]))
            .filter(|&steps| steps > 0)
            .collect();
        steps.sort_unstable();
        f64::from(steps[steps.len() / 2]) * f64::from(self.header.depth_unit_m)
    }
}

/// A configuration up to and including the section `[camera]`, to which keys can be added.
fn head(folder: &Path, source: &str) -> String {
    format!("[station]\nname = \"line\"\nroot = {folder:?}\n\n[camera]\n{source}")
}

/// The other sections: metric mode, the models, and the objects of the footage.
fn rest(folder: &Path) -> String {
    let demo = fs::read_to_string(repository().join("config/stations/demo.toml")).unwrap();
    let objects = &demo[demo.find("[[objects]]").unwrap()..demo.find("[plc]").unwrap()];
    let models = repository().join("target/runtime").canonicalize().unwrap();
    format!(
        "[bench]\nspace = \"metric\"\n\n[perception]\nmodels = {models:?}\nhands = [\"right\"]\n\n\
         [journal]\npath = \"{}/journal.sqlite\"\n\n{objects}",
        folder.display()
    )
}

/// A line that plays this recording in metric mode.
pub(crate) struct MetricLine {
    line: Line,
}

impl MetricLine {
    /// With a job to judge by, or with none.
    pub(crate) fn new(bag: &Bag, job: Option<&Path>) -> Self {
        let line = Line::configured(|folder, _| {
            let job = job.map_or(String::new(), |job| format!("job = {job:?}\n"));
            head(folder, &bag.source()).replacen("\n\n", &format!("\n{job}\n"), 1) + "\n" + &rest(folder)
        });
        Self { line }
    }

    /// Plays the recording into a track file with the real `andond record`. Returns its path, and its frames, of which there must be this number.
    pub(crate) fn record(&mut self, count: usize) -> (PathBuf, Vec<Frame>) {
        let out = self.line.path("recorded.tracks.jsonl");
        for _ in 0..TRIES {
            let is_whole = self.records_all(&out);
            let frames = recording::read("recorded", &fs::read(&out).unwrap()).unwrap().frames;
            if is_whole && frames.len() == count {
                return (out, frames);
            }
            eprintln!("{} of {count} frames", frames.len());
        }
        panic!("frames are lost every time:\n{}", self.line.log("perceive"));
    }

    /// Whether every frame reached the recorder.
    fn records_all(&mut self, out: &Path) -> bool {
        self.line.start("steward");
        // The recorder waits for a steward for two seconds only.
        drop(Watcher::join(&self.line.station));
        let mut recorder = Command::new(andond())
            .args(["record", "--config"])
            .arg(self.line.config())
            // One that is not whole is recorded once more.
            .arg("--force")
            .arg("--out")
            .arg(out)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (mut errors, mut line) = (BufReader::new(recorder.stderr.take().unwrap()), String::new());
        errors.read_line(&mut line).unwrap();
        assert!(line.contains("recording"), "{line}");
        for role in PLAYING {
            self.line.start(role);
        }
        let until = Instant::now() + PATIENCE;
        while recorder.try_wait().unwrap().is_none() {
            assert!(Instant::now() < until, "{}", self.line.log("perceive"));
            std::thread::sleep(Duration::from_millis(50));
        }
        self.stop();
        recorder.wait().unwrap().success()
    }

    /// What `andond look` says of its camera.
    pub(crate) fn looks(&self) -> String {
        let output = self.line.command("look", &["--seconds", "1"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Teaches a job from a track file.
    pub(crate) fn teach(&self, tracks: &Path) -> PathBuf {
        let job = self.line.path("job.toml");
        let taught = self.line.command("teach", &[tracks.to_str().unwrap(), "--out", job.to_str().unwrap()]);
        assert!(taught.status.success(), "{}", String::from_utf8_lossy(&taught.stderr));
        job
    }

    /// Every verdict of the recording, by the real line.
    pub(crate) fn judge(&mut self) -> Vec<Verdict> {
        self.line.start("steward");
        let mut watcher = Watcher::join(&self.line.station);
        for role in PLAYING {
            self.line.start(role);
        }
        let until = Instant::now() + PATIENCE;
        while !watcher.is(RoleId::Judge, RoleState::Finished) {
            assert!(Instant::now() < until, "{}", self.line.log("perceive"));
            watcher.listen(Duration::from_millis(100));
        }
        self.stop();
        watcher.verdicts
    }

    fn stop(&mut self) {
        for role in &mut self.line.roles {
            role.signal(rustix::process::Signal::TERM);
            assert!(role.wait().success(), "{} did not end with success", role.role);
        }
        self.line.roles.clear();
    }
}

/// The number of verdicts of this level and outcome.
pub(crate) fn count(verdicts: &[Verdict], level: VerdictLevel, outcome: VerdictOutcome) -> usize {
    let is = |verdict: &&Verdict| verdict.level() == Ok(level) && verdict.outcome() == Ok(outcome);
    verdicts.iter().filter(is).count()
}
