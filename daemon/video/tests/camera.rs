//! The role `capture` when its camera is missing, is unplugged, comes back, or is not what the configuration says.

#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::config::Config;
use andon_host::role;
use andon_host::video::pipe::PictureFormat;
use andon_ipc::{Limits, Node, Station, Steward, Stop};
use andon_video::{OpenError, capture, source::Source};
use rustix::process::{Pid, Signal, kill_process};
use shm_schemas::{Health, RoleId, RoleState};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Names the configuration in the process under test.
const INSIDE: &str = "ANDON_TEST_CAMERA";
/// Limit for what must happen sooner or later; only a failing test waits this long.
const PATIENCE: Duration = Duration::from_secs(60);

/// A camera of 4 x 2 pixels that is unplugged after a few pictures.
struct Camera {
    left: u32,
}

impl Source for Camera {
    fn format(&self) -> PictureFormat {
        PictureFormat { width: 4, height: 2, rate_hz: 100.0, count: 0 }
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        self.left = self.left.checked_sub(1).ok_or("the cable is out")?;
        std::thread::sleep(Duration::from_millis(10));
        picture.fill(7);
        Ok(Some(0))
    }
}

/// Unplugged after five pictures, missing at the next two tries, unplugged again after five more, then back for good.
fn unreliable(_: &Config) -> Result<Box<dyn Source>, OpenError> {
    static OPENED: AtomicU32 = AtomicU32::new(0);
    match OPENED.fetch_add(1, Ordering::Relaxed) {
        0 | 3 => Ok(Box::new(Camera { left: 5 })),
        1 | 2 => Err(OpenError::Gone("no such device".into())),
        _ => Ok(Box::new(Camera { left: u32::MAX })),
    }
}

/// Unplugged after five pictures, and replaced by a camera that does not have the configured mode.
fn replaced(_: &Config) -> Result<Box<dyn Source>, OpenError> {
    static OPENED: AtomicU32 = AtomicU32::new(0);
    match OPENED.fetch_add(1, Ordering::Relaxed) {
        0 => Ok(Box::new(Camera { left: 5 })),
        _ => Err(OpenError::Refused("it has no such mode".into())),
    }
}

/// Works, at the rate of its format.
fn steady(_: &Config) -> Result<Box<dyn Source>, OpenError> {
    Ok(Box::new(Camera { left: u32::MAX }))
}

/// In the process under test: runs the role with a scripted camera and does not return. Elsewhere it does nothing.
fn run_scripted(open: impl Fn(&Config) -> Result<Box<dyn Source>, OpenError>) {
    let Some(path) = std::env::var_os(INSIDE) else { return };
    let config = Config::load(&[path]).unwrap();
    let taken = andon_host::taken::Taken { config, changed: None };
    role::start_log(RoleId::Capture, &taken);
    let config = taken.config;
    let code = role::run_with(&config, RoleId::Capture, |node| capture::run(node, &config, open));
    std::process::exit(code as i32);
}

/// Starts the current test once more, as the process under test.
fn start_scripted(config: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args([std::thread::current().name().unwrap(), "--exact", "--nocapture"])
        .env(INSIDE, config)
        .env_remove("JOURNAL_STREAM")
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// A station of its own with a steward, and a node that reads its channels.
struct Bench {
    node: Node,
    // Cleans up when everybody else is gone.
    _steward: Steward,
    station: Station,
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        // Under /tmp whatever TMPDIR says: the path must be short.
        let folder = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
        let station = Station::under("camera", &folder.path().join("camera")).unwrap();
        let steward = Steward::create(&station, Limits { frame_bytes: 4096 }).unwrap();
        let node = Node::open(&station, RoleId::Tool, PATIENCE, &Stop::new().unwrap()).unwrap();
        Self { node, _steward: steward, station, folder }
    }

    fn config(&self, camera: &str) -> std::path::PathBuf {
        let path = self.folder.path().join("camera.toml");
        let root = self.folder.path();
        let text = format!(
            "[station]\nname = \"camera\"\nroot = {root:?}\n[camera]\n{camera}\n[[objects]]\nid = 1\nname = \"cup\"\n\
             marker_side_m = 0.03\ninteraction_points = [[0.0, 0.0, 0.0]]\n"
        );
        std::fs::write(&path, text).unwrap();
        path
    }
}

fn run_capture(config: &Path) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_andond-video"));
    command.args(["run", "capture", "--config"]).arg(config).env_remove("JOURNAL_STREAM");
    command.stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends SIGTERM and returns the output of the process.
fn stop(child: Child) -> Output {
    kill_process(Pid::from_raw(i32::try_from(child.id()).unwrap()).unwrap(), Signal::TERM).unwrap();
    child.wait_with_output().unwrap()
}

fn lines(output: &Output, code: &str) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.lines().filter(|line| line.contains(code)).map(str::to_owned).collect()
}

#[test]
fn a_lost_camera_is_reported_once_per_loss_is_a_fault_meanwhile_and_sends_frames_when_it_is_back() {
    run_scripted(unreliable);
    let bench = Bench::new();
    let config = bench.config("source = \"v4l2\"");
    let mut frames = bench.node.frame_reader().unwrap();
    let mut health = bench.node.reader::<Health>().unwrap();
    let child = start_scripted(&config);
    let (mut newest, mut faults) = (0, Vec::new());
    let until = Instant::now() + PATIENCE;
    // More than the five frames before each loss: the camera has come back twice.
    while newest < 13 {
        assert!(Instant::now() < until, "the camera does not come back after frame {newest}");
        bench.node.wait(&mut [&mut frames, &mut health], Duration::from_millis(100)).unwrap();
        while let Some(frame) = frames.take().unwrap() {
            newest = frame.header().stamp.seq;
        }
        while let Some(health) = health.take().unwrap() {
            if health.state == RoleState::Fault.code() {
                faults.push((newest, health.last_error));
            }
        }
    }
    let output = stop(child);
    assert_eq!(output.status.code(), Some(0));
    for frames_before in [5, 10] {
        assert!(faults.contains(&(frames_before, 104)), "health reported no fault: {faults:?}");
    }
    let [gone, back] = ["AND-104", "AND-103"].map(|code| lines(&output, code));
    assert!(gone.len() == 2 && gone[0].contains("the cable is out. Check its plug"), "{gone:?}");
    assert_eq!(back.len(), 2, "{back:?}");
    assert_eq!(lines(&output, "AND-101").len(), 1);
}

#[test]
fn a_camera_that_comes_back_without_the_configured_mode_ends_the_role() {
    run_scripted(replaced);
    let bench = Bench::new();
    let output = start_scripted(&bench.config("source = \"v4l2\"")).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(78));
    let refused = lines(&output, "AND-105");
    assert!(refused.len() == 1 && refused[0].contains("it has no such mode"), "{refused:?}");
    // What to do is in the message itself: a remedy that fits every refusal would contradict some.
    assert!(refused[0].trim_end().ends_with("it has no such mode"), "{refused:?}");
}

#[test]
fn a_camera_that_sends_fewer_frames_than_configured_is_reported_with_the_rate_that_it_has() {
    run_scripted(steady);
    let bench = Bench::new();
    let mut health = bench.node.reader::<Health>().unwrap();
    let child = start_scripted(&bench.config("source = \"v4l2\"\nrate_hz = 240.0"));
    let (mut last_error, until) = (0, Instant::now() + PATIENCE);
    while last_error != 106 {
        assert!(Instant::now() < until, "a rate of at most 100 Hz instead of 240 Hz is not reported");
        bench.node.wait(&mut [&mut health], Duration::from_millis(100)).unwrap();
        while let Some(health) = health.take().unwrap() {
            last_error = health.last_error;
        }
    }
    let slow = lines(&stop(child), "AND-106");
    assert!(slow.len() == 1 && slow[0].contains("Give it more light"), "{slow:?}");
}

#[test]
fn a_device_that_is_not_there_is_waited_for() {
    let bench = Bench::new();
    let config = bench.config("source = \"v4l2\"\ndevice = \"/dev/video-of-nobody\"");
    let mut health = bench.node.reader::<Health>().unwrap();
    let child = run_capture(&config);
    let (mut faults, until) = (0, Instant::now() + PATIENCE);
    // More than two tries.
    while faults < 4 {
        assert!(Instant::now() < until, "no sign of life");
        bench.node.wait(&mut [&mut health], Duration::from_millis(100)).unwrap();
        while let Some(health) = health.take().unwrap() {
            faults += u32::from(health.state == RoleState::Fault.code());
        }
    }
    let output = stop(child);
    assert_eq!(output.status.code(), Some(0));
    let gone = lines(&output, "AND-104");
    assert!(gone.len() == 1 && gone[0].contains("ls /dev/video*"), "{gone:?}");
}

#[cfg(not(feature = "realsense"))]
#[test]
fn a_camera_that_this_build_does_not_support_is_refused_and_not_tried_again() {
    let bench = Bench::new();
    let mut child = run_capture(&bench.config("source = \"realsense\""));
    assert_eq!(child.wait().unwrap().code(), Some(78));
    let output = std::io::read_to_string(child.stderr.take().unwrap()).unwrap();
    assert!(output.contains("AND-109") && output.contains("--features andon-video/realsense"), "{output}");
}

#[test]
fn a_recording_that_vanishes_between_two_repetitions_ends_the_role_with_a_remedy() {
    let bench = Bench::new();
    let folder = bench.folder.path().join("pictures");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("1.bmp"), bitmap(4, 2)).unwrap();
    let camera = format!("source = \"images\"\npath = {folder:?}\nloop = true\nrate_hz = 240.0");
    let mut frames = bench.node.frame_reader().unwrap();
    let child = run_capture(&bench.config(&camera));
    let until = Instant::now() + PATIENCE;
    while frames.take().unwrap().is_none() {
        assert!(Instant::now() < until, "no frame of {:?}", bench.station.root());
        bench.node.wait(&mut [&mut frames], Duration::from_millis(100)).unwrap();
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let output = child.wait_with_output().unwrap();
    // It was being read, or it was to be opened again, which does not help as long as it is gone.
    assert!([Some(70), Some(78)].contains(&output.status.code()), "{output:?}");
    let damaged = lines(&output, "AND-108");
    assert!(damaged.len() == 1 && damaged[0].contains("Copy it again"), "{damaged:?}");
}

/// A black picture.
fn bitmap(width: u32, height: u32) -> Vec<u8> {
    let pixels = 3 * width * height;
    assert_eq!(3 * width % 4, 0, "rows are padded to four bytes");
    let mut bytes = b"BM".to_vec();
    for word in [54 + pixels, 0, 54, 40, width, height, 24 << 16 | 1, 0, pixels, 0, 0, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.resize(bytes.len() + pixels as usize, 0);
    bytes
}
