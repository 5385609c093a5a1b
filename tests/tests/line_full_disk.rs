//! Whatever writes a file notices that the disk is full, says so with a remedy that is true, and leaves what was there before.
#![allow(clippy::unwrap_used)]

use andon_tests::line::{Line, Settings, andond, root};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Runs a command with a disk of its own at a folder, on which so many bytes are free and one file lies already. Standard output says which files
/// are there afterwards, with their sizes.
const SCRIPT: &str = r#"
disk=$1 free=$2 before=$3; shift 3
mount -t tmpfs -o size=8m none "$disk" || exit 99
[ -z "$before" ] || printf before > "$disk/$before"
room=$(df --output=avail -B1 "$disk" | tail -1)
head -c $((room - free)) /dev/zero > "$disk/filler"
"$@" 1>&2
code=$?
rm "$disk/filler"
cd "$disk" && find . -type f -printf '%P %s\n' | sort
exit $code
"#;

/// A writer: its command line, what it writes first, and whether that lies there already.
struct Writer {
    arguments: Vec<String>,
    replaces: Option<&'static str>,
}

struct Bench {
    line: Line,
    disk: PathBuf,
    film: String,
    archive: String,
}

impl Bench {
    /// A line that runs and has judged something, a film of a second, and an archive.
    fn new() -> Self {
        let mut line = Line::new(Settings::live());
        let mut watcher = line.up();
        watcher.until("a verdict", |watcher| !watcher.verdicts.is_empty());
        let (disk, film, archive) = (line.path("disk"), line.path("film.mp4"), line.path("station.tar"));
        std::fs::create_dir(&disk).unwrap();
        let cut = Command::new("ffmpeg")
            .args(["-loglevel", "error", "-i"])
            .arg(root().join("tests/footage/p1_none_r1.mp4"))
            .args(["-t", "1", "-c", "copy"])
            .arg(&film)
            .status();
        assert!(cut.expect("ffmpeg is needed: run `make test-packages`").success());
        assert!(line.command("backup", &[archive.to_str().unwrap()]).status.success());
        let recordings = line.path("recordings");
        std::fs::create_dir(&recordings).unwrap();
        for repetition in 1..=3 {
            std::fs::copy(line.tracks(), recordings.join(format!("p1_none_r{repetition}.tracks.jsonl")))
                .unwrap();
        }
        std::fs::write(line.path("markers.bmp"), four_markers()).unwrap();
        let text = |path: PathBuf| path.to_str().unwrap().to_owned();
        Self { disk, film: text(film), archive: text(archive), line }
    }

    /// A command line. `@NAME` is a file on the disk, `$NAME` one of the line.
    fn writer(&self, replaces: Option<&'static str>, words: &str) -> Writer {
        let config = format!("-c {}", self.line.config().display());
        let words = words
            .replace("DEMO", "-c config/stations/demo.toml")
            .replace("LINE", &config)
            .replace("FILM", &self.film)
            .replace("ARCHIVE", &self.archive);
        let path = |word: &str| match (word.strip_prefix('@'), word.strip_prefix('$')) {
            (Some(name), _) => self.disk.join(name).to_str().unwrap().to_owned(),
            (_, Some(name)) => self.line.path(name).to_str().unwrap().to_owned(),
            _ => word.to_owned(),
        };
        Writer { arguments: words.split_whitespace().map(path).collect(), replaces }
    }

    /// Everything that writes files. `demo --annotate` writes its films as `replay --annotate` does. `use` and `part` write nothing: the line does.
    fn writers(&self) -> Vec<Writer> {
        vec![
            self.writer(None, "new full --part a=0.03 --camera FILM --out @new.toml"),
            self.writer(None, "markers DEMO --out @"),
            self.writer(Some("look.png"), "look DEMO FILM --save @look.png"),
            self.writer(Some("look.jpg"), "look DEMO FILM --annotated @look.jpg"),
            self.writer(
                Some("a.mp4"),
                "replay DEMO FILM --job config/jobs/polish-and-measure.toml --annotate @a.mp4",
            ),
            self.writer(Some("a.svg"), "segment LINE $work.tracks.jsonl --plot @a.svg"),
            self.writer(Some("f.tracks.jsonl"), "tracks DEMO FILM --force --out @f.tracks.jsonl"),
            self.writer(
                Some("job.toml"),
                "teach LINE --force $work.tracks.jsonl --out @job.toml --plot @job.svg --report @job.html",
            ),
            self.writer(None, "teach LINE --live --out @live.toml"),
            self.writer(None, "record LINE --out @r.tracks.jsonl"),
            self.writer(Some("h.svg"), "history LINE --plot @h.svg"),
            self.writer(Some("b.tar"), "backup LINE @b.tar"),
            self.writer(
                Some("bench.toml"),
                "calibrate DEMO $markers.bmp --side 0.084 --marker 0=0,0 --marker 1=0.4,0 --marker 2=0.4,0.24 \
                 --marker 3=0,0.24 --plot @fit.png --out @bench.toml",
            ),
            self.writer(None, "analyze $recordings --out @report"),
            self.writer(None, "man @"),
        ]
    }

    /// Runs a writer on a disk with so much room.
    fn run(&self, writer: &Writer, free: u64) -> Output {
        let mut child = Command::new("unshare")
            .args(["--mount", "--map-root-user", "sh", "-c", SCRIPT, "sh"])
            .arg(&self.disk)
            .arg(free.to_string())
            .arg(writer.replaces.unwrap_or_default())
            .arg(andond())
            .args(&writer.arguments)
            .current_dir(root())
            // Who shows a job at the bench is waited for.
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let _input = child.stdin.take();
        let output = child.wait_with_output().unwrap();
        assert_ne!(
            output.status.code(),
            Some(99),
            "no disk of its own can be made here; run the tests as root, or allow user namespaces \
             (`sysctl kernel.unprivileged_userns_clone=1`)"
        );
        output
    }
}

/// A picture of the first four markers of DICT_4X4_50, 400 pixels apart from left to right and 240 downwards, as a BMP.
fn four_markers() -> Vec<u8> {
    const WIDTH: u32 = 640;
    const HEIGHT: u32 = 480;
    // The inner four by four cells of each, and where its centre is; rows of a BMP go upwards.
    const MARKERS: [(u16, [u32; 2]); 4] =
        [(0xb532, [120, 120]), (0x0f9a, [520, 120]), (0x332d, [520, 360]), (0x9946, [120, 360])];
    let is_white = |x: u32, y: u32| {
        MARKERS.iter().all(|(cells, [centre_x, centre_y])| {
            let cell = |at: u32, centre: u32| (at + 42).checked_sub(centre).map(|from| from / 14);
            match (cell(x, *centre_x), cell(y, *centre_y)) {
                (Some(column @ 1..=4), Some(row @ 1..=4)) => cells >> (4 * (row - 1) + 4 - column) & 1 == 1,
                (Some(0..=5), Some(0..=5)) => false,
                _ => true,
            }
        })
    };
    let mut file = b"BM".to_vec();
    for number in [54 + 3 * WIDTH * HEIGHT, 0, 54, 40, WIDTH, HEIGHT, 1 | 24 << 16, 0, 0, 0, 0, 0, 0] {
        file.extend(number.to_le_bytes());
    }
    let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    file.extend(pixels.flat_map(|(x, y)| [if is_white(x, y) { 255 } else { 0 }; 3]));
    file
}

/// The files that a command left, with their sizes.
fn left(output: &Output) -> Vec<(String, u64)> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let file =
        |line: &str| line.rsplit_once(' ').map(|(name, size)| (name.to_owned(), size.parse().unwrap()));
    text.lines().filter_map(file).collect()
}

/// How much room there is, beside none at all: a page, and half of what it takes.
fn rooms(taken: u64) -> Vec<u64> {
    const PAGE: u64 = 4096;
    let mut rooms = vec![0, PAGE, taken / 2 / PAGE * PAGE];
    rooms.retain(|room| *room < taken / PAGE * PAGE || *room == 0);
    rooms.dedup();
    rooms
}

/// Tries a writer on disks on which there is less room than it takes.
fn try_full(bench: &Bench, writer: &Writer) {
    let name = &writer.arguments;
    let before: Vec<(String, u64)> = writer.replaces.iter().map(|name| ((*name).to_owned(), 6)).collect();
    // These two go on until somebody stops them.
    let is_endless = name[0] == "record" || name.contains(&"--live".to_owned());
    let rooms = if is_endless {
        vec![0]
    } else {
        let whole = bench.run(writer, 4 << 20);
        let files = left(&whole);
        let said = String::from_utf8_lossy(&whole.stderr).into_owned();
        assert!(files.len() > before.len() || files != before, "{name:?}: {said}");
        rooms(files.iter().map(|(_, size)| size).sum())
    };
    for free in rooms {
        let full = bench.run(writer, free);
        let said = String::from_utf8_lossy(&full.stderr);
        assert_eq!(full.status.code(), Some(64), "{name:?} with {free} bytes: {said}");
        for words in ["No space left on device", "make room on this disk", bench.disk.to_str().unwrap()] {
            assert!(said.contains(words), "{name:?} with {free} bytes: {said}");
        }
        assert_eq!(left(&full), before, "{name:?} with {free} bytes: {said}");
    }
}

#[test]
fn whatever_writes_a_file_notices_that_the_disk_is_full_and_leaves_what_was_there() {
    let mut bench = Bench::new();
    bench.writers().iter().for_each(|writer| try_full(&bench, writer));
    // A running station is not restored.
    bench.line.stop();
    try_full(&bench, &bench.writer(None, "restore ARCHIVE --into @"));
}

#[test]
fn whatever_prints_notices_that_nothing_takes_it() {
    let bench = Bench::new();
    for words in [
        "--help",
        "exit-codes",
        "completions bash",
        "explain AND-104",
        "config LINE",
        "check LINE",
        "jobs LINE",
        "status LINE",
        "history LINE",
        "history LINE --csv",
        "history LINE --summary",
        "history LINE --audit",
        "look DEMO FILM",
        "tracks DEMO FILM --force --out $printed.tracks.jsonl",
        "teach LINE --force $work.tracks.jsonl --out $printed.toml",
        "markers DEMO --out $recordings",
        "backup LINE $printed.tar",
        "analyze $recordings --out $report",
        "segment LINE $work.tracks.jsonl",
        "replay LINE $work.tracks.jsonl --job $job.toml",
        "replay LINE $work.tracks.jsonl --job $job.toml --json",
        "restore ARCHIVE --list",
        "tail LINE",
    ] {
        let writer = bench.writer(None, words);
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output =
            Command::new(andond()).args(&writer.arguments).current_dir(root()).stdout(full).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(70), "{words}: {said}");
        assert!(said.contains("No space left on device") && said.contains("make room"), "{words}: {said}");
    }
}

/// A log that cannot be written must not end the line. A tool whose words nobody can read says so by its exit code.
#[test]
fn a_full_disk_under_the_log_ends_no_role() {
    let mut line = Line::new(Settings::default());
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let mut role = Command::new(andond())
        .args(["run", "steward", "-c"])
        .arg(line.config())
        .stderr(full())
        .spawn()
        .unwrap();
    let mut watcher = andon_tests::line::Watcher::join(&line.station);
    line.start_all_but(&["steward"]);
    watcher.until("a verdict", |watcher| !watcher.verdicts.is_empty());
    assert_eq!(role.try_wait().unwrap(), None, "the steward goes on");
    line.stop_all_but_steward();
    role.kill().unwrap();
    role.wait().unwrap();
    let missing =
        Command::new(andond()).args(["replay", "no.mp4", "--job", "no.toml"]).stderr(full()).status();
    assert_eq!(missing.unwrap().code(), Some(70));
}

#[test]
fn a_film_is_not_begun_where_it_can_never_be_written() {
    let out = Path::new("/proc/a.mp4");
    let job = root().join("config/jobs/polish-and-measure.toml");
    let output = Command::new(andond())
        .current_dir(root())
        .args(["replay", "tests/footage/p1_none_r1.mp4", "--job"])
        .arg(job)
        .arg("--annotate")
        .arg(out)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(64), "{said}");
    assert!(said.contains("/proc/a.mp4: it cannot be written") && output.stdout.is_empty(), "{said}");
}
