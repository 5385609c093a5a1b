//! `andond teach --live`: somebody shows a job at the bench, and answers line by line. The test sees in the place of `perceive`.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_core::input::Frame;
use andon_learn::job_file::JobFile;
use andon_tests::line::{Line, Sender, Settings, andond};
use andon_tests::simulator::{Flaw, Noise, Performance, perform};
use shm_schemas::{Detections, LANDMARKS, RoleId, flag};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};

/// Between two performances the bench is not looked at for so long.
const PAUSE_NS: u64 = 1_000_000_000;

/// The landmarks of a hand that a simulated worker has.
const USED: [usize; 5] = [0, 8, 9, 12, 16];

/// A bench at which somebody works, and the program that learns from it.
struct Bench {
    line: Line,
    perceive: Sender<Detections>,
    next_ns: u64,
    teach: Child,
    input: Option<ChildStdin>,
    said: BufReader<ChildStderr>,
}

impl Bench {
    /// A program that wants so many runs.
    fn new(count: &str) -> Self {
        let mut line = Line::new(Settings::default());
        line.start("steward");
        let perceive = Sender::new(&line, RoleId::Perceive, &[RoleId::Tool]);
        let mut command = Command::new(andond());
        command.args(["teach", "--live", "--count", count, "--config"]).arg(line.config());
        command.arg("--out").arg(line.path("shown.toml"));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut teach = command.spawn().unwrap();
        let input = teach.stdin.take();
        let said = BufReader::new(teach.stderr.take().unwrap());
        let mut bench = Self { line, perceive, next_ns: 0, teach, input, said };
        bench.show(&work(1)[..1]);
        bench.hears("looking through the running station line");
        bench.hears("all parts are seen on the bench: ");
        bench
    }

    /// Lets the bench be seen like this.
    fn show(&mut self, frames: &[Frame]) {
        let (began_ns, first_ns) = (self.next_ns, frames[0].captured_ns);
        for frame in frames {
            let source_ns = began_ns + frame.captured_ns - first_ns;
            self.perceive.send(|message| {
                message.source_ns = source_ns;
                write(frame, message);
            });
            self.next_ns = source_ns + PAUSE_NS;
        }
    }

    fn answers(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    /// The next line that it says, which must contain these words.
    #[track_caller]
    fn hears(&mut self, words: &str) -> String {
        let mut line = String::new();
        self.said.read_line(&mut line).unwrap();
        assert!(line.contains(words), "{line:?} instead of {words:?}");
        line
    }

    /// Nobody answers any more. Returns how it ends, and what it has printed.
    fn ends(&mut self) -> (Option<i32>, String) {
        self.input = None;
        let mut report = String::new();
        std::io::Read::read_to_string(&mut self.teach.stdout.take().unwrap(), &mut report).unwrap();
        (self.teach.wait().unwrap().code(), report)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.teach.kill();
        let _ = self.teach.wait();
    }
}

/// A correct run of the simulated worker.
fn work(repetition: u64) -> Vec<Frame> {
    perform(&Performance { seed: 4, person: 9, repetition, noise: Noise::default() }, Flaw::None).0.frames
}

fn write(frame: &Frame, message: &mut Detections) {
    for (hand, slot) in frame.hands.iter().zip(message.hands.iter_mut()) {
        (slot.hand, slot.score) = (hand.side as u8, hand.score);
        slot.landmarks_m = [[f32::NAN; 3]; LANDMARKS];
        let [index, middle, ring] = hand.tips;
        for (landmark, point) in USED.into_iter().zip([hand.wrist, index, hand.middle_knuckle, middle, ring])
        {
            slot.landmarks_m[landmark] = point;
        }
    }
    for (object, slot) in frame.objects.iter().zip(message.objects.iter_mut()) {
        (slot.id, slot.flags, slot.quality) = (object.id, flag::SEEN, 1.0);
        (slot.position_m, slot.orientation) = (object.position, object.orientation);
    }
    (message.hands_len, message.objects_len) = (frame.hands.len() as u32, frame.objects.len() as u32);
}

#[test]
fn a_job_is_shown_at_the_bench_and_each_run_is_kept_or_dropped() {
    let mut bench = Bench::new("3");
    let asks = "Enter keeps it; d drops it; t keeps it and teaches now; q gives up";

    bench.hears("run 1 of 3: show the whole job once; press Enter when the bench is as at the start");
    bench.show(&work(1));
    bench.answers("");
    let seen = bench.hears("  run 1: ");
    assert!(seen.contains(" at 30 frames a second: right hand: polisher at brick ("), "{seen}");
    assert!(seen.contains(", right hand: brick at meter (") && !seen.contains("never seen"), "{seen}");
    bench.hears(asks);
    bench.answers("");
    bench.hears("  kept as shown-run1.tracks.jsonl");

    // Nobody has worked, which is not asked about.
    bench.hears("run 2 of 3: ");
    let idle: Vec<Frame> =
        work(2).into_iter().take(30).map(|frame| Frame { hands: Default::default(), ..frame }).collect();
    bench.show(&idle);
    bench.answers("");
    bench.hears("no hand was seen");
    bench.hears("not kept: there is nothing to learn from it");

    bench.hears("run 2 of 3: ");
    bench.show(&work(2));
    bench.answers("");
    bench.hears("  run 2: ");
    bench.hears(asks);
    bench.answers("d");
    bench.hears("  dropped");

    bench.hears("run 2 of 3: ");
    bench.show(&work(3));
    bench.answers("");
    bench.hears("  run 2: ");
    bench.hears(asks);
    bench.answers("t");
    bench.hears("  kept as shown-run2.tracks.jsonl");

    let (code, report) = bench.ends();
    assert_eq!(code, Some(0), "{report}");
    assert!(report.starts_with("usable, because the 2 runs agree in all their steps"), "{report}");
    let job = std::fs::read(bench.line.path("shown.toml")).unwrap();
    let job = JobFile::parse("shown.toml", &job).unwrap();
    let sources: Vec<&str> = job.provenance.sources.iter().map(|source| source.name.as_str()).collect();
    assert_eq!(sources, ["shown-run1.tracks.jsonl", "shown-run2.tracks.jsonl"]);
    // That of the station has the number 1.
    assert_eq!((job.id, job.name.as_str()), (2, "shown"));
}

#[test]
fn what_nobody_has_kept_teaches_nothing() {
    let mut bench = Bench::new("1");
    bench.hears("run 1 of 1: ");
    bench.show(&work(1));
    bench.answers("");
    bench.hears("  run 1: ");
    bench.hears("Enter keeps it");
    assert_eq!(bench.ends(), (Some(1), String::new()));
    bench.hears("dropped, because nobody has kept it");
    bench.hears("no run was kept: nothing is taught");
    let files = std::fs::read_dir(bench.line.path("")).unwrap().flatten();
    let left: Vec<_> =
        files.map(|file| file.file_name()).filter(|name| name.to_string_lossy().contains("shown")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_showing_that_is_given_up_leaves_what_was_kept_and_says_how_to_go_on() {
    let mut bench = Bench::new("2");
    bench.hears("run 1 of 2: ");
    bench.show(&work(1));
    bench.answers("");
    bench.hears("  run 1: ");
    bench.hears("Enter keeps it");
    bench.answers("");
    bench.hears("  kept as ");
    bench.hears("run 2 of 2: ");
    bench.answers("q");
    let said = bench.hears("given up: nothing is taught. The runs that were kept are there: andond teach ");
    assert!(said.contains("shown-run1.tracks.jsonl --out "), "{said}");
    assert_eq!(bench.ends().0, Some(1));
    assert!(bench.line.path("shown-run1.tracks.jsonl").is_file());
}
