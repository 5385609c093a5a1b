//! A recording is looked at again. Where its pictures are what the camera sent, the same is detected in them. Where they are not it says so.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Channel, FrameWriter, MonotonicTime, Node, Wake};
use andon_record::{Attachment, Entry, Item, RecordingReader, RecordingWriter, Topic, picture};
use andon_tests::line::{Line, Settings, root, stand_in};
use andon_tests::python::all_output;
use shm_schemas::{ColourFormat, Detections, FrameHeader, RoleId, RoleState, bytes_of, flag, from_bytes};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const FILM: &str = "p1_order_r1.mp4";
/// Its fault is in the first half of these.
const FRAMES: &str = "260";
const INTERVAL_NS: u64 = 33_333_333;

/// A camera that sends JPEG, in the place of `capture`. It waits for the recorder too, so that no frame is lost, however busy the machine is.
struct Camera {
    node: Node,
    frames: FrameWriter,
    sent: u64,
}

impl Camera {
    fn new(line: &Line) -> Self {
        let node = stand_in(line, RoleId::Capture);
        let mut frames = node.frame_writer().unwrap();
        frames.follow(&[RoleId::Perceive, RoleId::Record]);
        Self { node, frames, sent: 0 }
    }

    /// Sends a picture as `capture` does, decoded and as it was sent.
    fn send(&mut self, jpeg: &[u8]) {
        let picture = picture::decode(jpeg).unwrap();
        self.send_frame(picture.pixels.len() + jpeg.len(), |header, bytes| {
            let (width, height) = (picture.width, picture.height);
            (header.width, header.height, header.stride) = (width, height, 3 * width);
            header.colour_format = ColourFormat::Bgr8.code();
            header.jpeg_bytes = jpeg.len().try_into().unwrap();
            let (pixels, room) = bytes.split_at_mut(picture.pixels.len());
            pixels.copy_from_slice(&picture.pixels);
            room.copy_from_slice(jpeg);
        });
    }

    fn send_frame(&mut self, bytes: usize, fill: impl FnOnce(&mut FrameHeader, &mut [u8])) {
        let room = self.node.wait_for_room(&mut self.frames, Duration::from_secs(60)).unwrap();
        assert_eq!(room, Wake::Room);
        let mut frame = self.frames.loan(bytes).unwrap();
        let mut header = FrameHeader { flags: flag::PACED, ..FrameHeader::default() };
        header.stamp.captured_ns = MonotonicTime::now().nanoseconds();
        header.source_ns = self.sent * INTERVAL_NS;
        fill(&mut header, frame.bytes_mut());
        *frame.header_mut() = header;
        self.frames.send(frame).unwrap();
        self.sent += 1;
    }

    fn end(&mut self) {
        self.send_frame(1, |header, _| header.flags |= flag::END_OF_STREAM);
    }
}

/// The pictures of a film as JPEG files.
fn pictures(folder: &Path) -> Vec<Vec<u8>> {
    fs::create_dir(folder).unwrap();
    let film = root().join("tests/footage").join(FILM);
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(film)
        .args(["-frames:v", FRAMES, "-q:v", "3"])
        .arg(folder.join("%05d.jpg"))
        .status()
        .expect("ffmpeg is needed: run `make test-packages`, or apt install ffmpeg");
    assert!(status.success());
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

/// What a recording says, and the exit code.
fn replayed(line: &Line, recording: &Path, more: &[&str]) -> (String, i32) {
    let mut arguments = vec!["--from-frames", recording.to_str().unwrap()];
    arguments.extend(more);
    let output = line.command("replay", &arguments);
    (all_output(&output), output.status.code().unwrap())
}

/// The two numbers of the line that says how many detections, or verdicts, are equal.
fn equal(text: &str, what: &str) -> [u64; 2] {
    let mut rows = text.lines().filter(|row| row.starts_with("as recorded: ") && row.contains(what));
    let row = rows.next().unwrap_or_else(|| panic!("{text}"));
    let numbers: Vec<u64> = row.split(' ').filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().unwrap()
}

/// A line that records everything, with these keys of `[record]`, and plays no film by itself.
fn line(record: &str) -> Line {
    let line = Line::with_film("speed = \"max\"", "", &["-i", FILM, "-frames:v", "1"]);
    line.record("always");
    line.reconfigure("[record]\n", &format!("[record]\n{record}"));
    line
}

/// A line that has watched a film through such a camera. `perceive` is killed after so many frames, and then begins again.
fn recorded(killed_after: Option<usize>) -> (Line, PathBuf, u64) {
    let mut line = line("");
    let mut watcher = line.launch_recorded();
    let mut camera = Camera::new(&line);
    let pictures = pictures(&line.path("pictures"));
    for (number, jpeg) in pictures.iter().enumerate() {
        if Some(number) == killed_after {
            line.role("perceive").kill();
            line.start("perceive");
        }
        camera.send(jpeg);
    }
    camera.end();
    watcher.until_judged();
    drop((watcher, camera));
    let failures = line.stop_recorded();
    assert!(failures.is_empty(), "{failures:?}");
    let found = line.recordings();
    let [recording] = found.as_slice() else { panic!("{found:?}") };
    (line, recording.clone(), pictures.len() as u64)
}

/// Everything that is in a recording.
fn read(path: &Path) -> (Vec<Attachment>, Vec<Entry>) {
    let (mut files, mut entries) = (Vec::new(), Vec::new());
    let mut reader = RecordingReader::open(path).unwrap();
    while let Some(item) = reader.next_item().unwrap() {
        match item {
            Item::Attachment(file) => files.push(file),
            Item::Entry(entry) => entries.push(entry),
        }
    }
    (files, entries)
}

fn write(path: &Path, files: &[Attachment], entries: &[Entry]) {
    let mut writer = RecordingWriter::new(File::create(path).unwrap(), 0).unwrap();
    files.iter().for_each(|file| writer.attach(file, 1).unwrap());
    entries.iter().for_each(|entry| writer.write(entry).unwrap());
    writer.finish().unwrap();
}

const OF_DETECTIONS: Topic = Topic::Raw(Channel::Detections);
const SAME: &str = "program, models, libraries and processor features are those of the recording";

#[test]
fn what_a_camera_sent_as_jpeg_is_seen_again_to_the_bit_and_whatever_is_not_so_is_said() {
    let (line, recording, frames) = recorded(None);
    let film = line.path("seen.mp4");
    let (text, code) = replayed(&line, &recording, &["--annotate", film.to_str().unwrap()]);
    assert_eq!(code, 1, "{text}");
    assert!(text.contains(SAME) && !text.contains("differ"), "{text}");
    assert_eq!(equal(&text, "detections"), [frames, frames], "{text}");
    let [same, sent] = equal(&text, "verdicts");
    assert!(same == sent && sent > 2, "{text}");
    // What comes before the first couples nobody has judged.
    let drawn = packets(&film);
    assert!((frames - 10..=frames).contains(&drawn), "{drawn} of {frames} frames are drawn");

    let (files, entries) = read(&recording);
    let changed = line.path("changed.mcap");
    let again = |files: &[Attachment], entries: &[Entry]| -> String {
        write(&changed, files, entries);
        let (text, code) = replayed(&line, &changed, &[]);
        assert!(code < 3, "{text}");
        text
    };

    // Another library, and another processor.
    let mut others = files.clone();
    let hashes = others.iter_mut().find(|file| file.name == "hashes.txt").unwrap();
    let known = String::from_utf8(hashes.data.to_vec()).unwrap();
    let jpeg = known.lines().find(|line| line.contains(" libjpeg.so")).unwrap();
    let (hash, library) = jpeg.split_once(' ').unwrap();
    let other = known.replace(hash, &"0".repeat(64)).replace("processor x86_64", "processor x86_64 abacus");
    hashes.data = other.into_bytes().into();
    let text = again(&others, &entries);
    assert!(!text.contains(SAME) && text.contains("detections may differ"), "{text}");
    let said: Vec<&str> =
        text.lines().filter(|row| row.contains(": recorded with ")).map(str::trim).collect();
    let [one, two] = said.as_slice() else { panic!("{text}") };
    assert!(one.starts_with(&format!("{library}: recorded with 000")), "{text}");
    assert!(two.starts_with("processor: recorded with x86_64 abacus"), "{text}");
    let silent: Vec<_> = files.iter().filter(|file| file.name != "hashes.txt").cloned().collect();
    assert!(again(&silent, &entries).contains("does not say what it was made with"));

    // Pictures that the recorder has made of what the camera sent.
    let anew: Vec<Entry> = entries.iter().cloned().map(encoded_anew).collect();
    let text = again(&files, &anew);
    assert!(text.contains(&format!("{frames} pictures are not those that the camera sent")), "{text}");
    assert!(text.contains("may differ"), "{text}");
    assert!(equal(&text, "detections")[0] < frames, "losses are seen: {text}");
    let mut masked = files.clone();
    let configuration = masked.iter_mut().find(|file| file.name == "configuration.toml").unwrap();
    let text = String::from_utf8(configuration.data.to_vec()).unwrap();
    let hidden = "masks = [[[0, 0], [9, 0], [9, 9]]]\nsize = [640, 480]";
    assert!(text.contains("masks = []"), "{text}");
    configuration.data = text.replace("masks = []", hidden).into_bytes().into();
    let text = again(&masked, &entries);
    assert!(text.contains(&format!("{frames} pictures are not those that the camera sent")), "{text}");

    // Frames that the recorder lost: `perceive` has seen them.
    let mut number = 0;
    let without_some: Vec<Entry> = entries
        .iter()
        .filter(|entry| {
            number += u64::from(entry.topic == Topic::Picture);
            !(entry.topic == Topic::Picture && (100..110).contains(&number))
        })
        .cloned()
        .collect();
    let text = again(&files, &without_some);
    assert!(text.contains("10 frames have no picture") && text.contains("may differ"), "{text}");

    // Detections that it lost, in the middle and at the start.
    let without = |numbers: std::ops::Range<u64>| -> Vec<Entry> {
        let seq = |entry: &Entry| from_bytes::<Detections>(&entry.data).map(|seen| seen.stamp.seq);
        let is_lost = |entry: &&Entry| {
            entry.topic == OF_DETECTIONS && seq(entry).is_some_and(|seq| numbers.contains(&seq))
        };
        entries.iter().filter(|entry| !is_lost(entry)).cloned().collect()
    };
    let text = again(&files, &without(100..105));
    assert!(text.contains("5 frames were looked at") && text.contains("may differ"), "{text}");
    let text = again(&files, &without(0..3));
    assert!(
        text.contains("1 starts of `perceive` lack their first frames") && text.contains("may differ"),
        "{text}"
    );

    // Nothing to look at.
    let blind: Vec<Entry> = entries.iter().filter(|entry| entry.topic != Topic::Picture).cloned().collect();
    write(&changed, &files, &blind);
    let (text, code) = replayed(&line, &changed, &[]);
    assert!(
        code == 64 && text.contains("no picture of the camera is in it: leave out --from-frames"),
        "{text}"
    );

    // A recorder that waits for `perceive` writes the picture behind what was detected in it, another one before that.
    for is_behind in [true, false] {
        write(&changed, &files, &in_turn(&entries, is_behind));
        let output =
            line.command("replay", &[changed.to_str().unwrap(), "--annotate", film.to_str().unwrap()]);
        assert_eq!((output.status.code(), packets(&film)), (Some(1), drawn), "{}", all_output(&output));
    }
}

/// A picture as the recorder encodes what it may not store as it is.
fn encoded_anew(mut entry: Entry) -> Entry {
    if entry.topic == Topic::Picture {
        let decoded = picture::picture_in(&entry).unwrap();
        let jpeg = picture::encode(&decoded, 80).unwrap();
        entry.data = picture::message_of(jpeg, entry.time_ns).into();
    } else if entry.topic == Topic::Raw(Channel::Frame) {
        let header: FrameHeader = from_bytes(&entry.data).unwrap();
        entry.data = bytes_of(&FrameHeader { jpeg_bytes: 0, ..header }).into();
    }
    entry
}

/// The same with each picture right behind the detections of its frame, or right before them.
fn in_turn(entries: &[Entry], is_behind: bool) -> Vec<Entry> {
    let is_picture = |entry: &&Entry| entry.topic == Topic::Picture;
    let mut sorted = Vec::new();
    for entry in entries.iter().filter(|entry| !is_picture(entry)) {
        let is_of_it = |picture: &&Entry| entry.topic == OF_DETECTIONS && picture.time_ns == entry.time_ns;
        let picture = entries.iter().filter(is_picture).find(is_of_it);
        let (before, behind) = if is_behind { (None, picture) } else { (picture, None) };
        sorted.extend(before.into_iter().chain([entry]).chain(behind).cloned());
    }
    sorted
}

/// How many pictures a film has.
fn packets(film: &Path) -> u64 {
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-count_packets", "-select_streams", "v"])
        .args(["-show_entries", "stream=nb_read_packets", "-of", "csv=p=0"])
        .arg(film)
        .output()
        .expect("ffprobe is needed: run `make test-packages`, or apt install ffmpeg");
    all_output(&output).trim().parse().unwrap()
}

#[test]
fn a_perceive_that_was_killed_begins_anew_when_its_pictures_are_looked_at_again() {
    let (line, recording, frames) = recorded(Some(150));
    let (text, code) = replayed(&line, &recording, &[]);
    assert!(code < 3, "{text}");
    let [same, all] = equal(&text, "detections");
    // What was sent while it was away nobody has looked at.
    assert!(same == all && (frames - 20..frames).contains(&all), "{text}");
    assert!(text.contains(SAME) && !text.contains("may differ"), "{text}");
}

#[test]
fn what_a_camera_sent_as_jpeg_is_black_in_the_file_where_it_may_not_be_seen() {
    let mut line = line("size = [640, 480]\nmasks = [[[0, 0], [400, 0], [400, 479], [0, 479]]]\n");
    let mut watcher = line.launch_recorded();
    let mut camera = Camera::new(&line);
    let sent = pictures(&line.path("pictures"));
    sent.iter().take(20).for_each(|jpeg| camera.send(jpeg));
    camera.end();
    watcher.until("the end", |watcher| watcher.is(RoleId::Perceive, RoleState::Finished));
    drop((watcher, camera));
    assert!(line.stop_recorded().is_empty());
    let (_, entries) = read(&line.recordings()[0]);
    let (stored, others): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| entry.topic == Topic::Picture);
    assert_eq!(stored.len(), 20);
    for picture in stored {
        let picture = picture::picture_in(picture).unwrap();
        let brightest = |columns: std::ops::Range<usize>| {
            let rows = picture.pixels.chunks_exact(3 * 640);
            rows.flat_map(|row| row[3 * columns.start..3 * columns.end].iter().copied()).max()
        };
        assert_eq!((brightest(0..384), brightest(410..640) > Some(100)), (Some(0), true));
    }
    // Nor is it anywhere else in the file.
    let smallest = sent.iter().map(Vec::len).min().unwrap();
    assert!(others.iter().all(|entry| entry.data.len() < smallest / 2));
}

#[test]
fn what_was_recorded_without_pictures_is_not_looked_at_again() {
    let mut line = Line::new(Settings::default());
    line.record("always");
    let mut watcher = line.launch_recorded();
    watcher.until_judged();
    drop(watcher);
    assert!(line.stop_recorded().is_empty());
    let (text, code) = replayed(&line, &line.recordings()[0], &[]);
    assert!(code == 64 && text.contains("its station played what was detected"), "{text}");
}
