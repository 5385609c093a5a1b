//! What a line says of its own sight: in the log, in the health, to the PLC, by its tools and in the journal.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::environment;
use andon_tests::line::{Line, NOISE, PATIENCE, Watcher, andond, root};
use shm_schemas::{RoleId, Sight};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// As fast as it can be processed: nothing is dropped.
const MAX: &str = "speed = \"max\"";

/// A station that plays a shipped clip again and again; from its fourth second on this is done to it, until its ninth.
fn line_that_shows(filter: &str) -> Line {
    let filter = format!("{filter},{NOISE}");
    Line::with_film(MAX, "", &["-i", "p1_none_r1.mp4", "-t", "12", "-vf", &filter])
}

/// Runs a command until it prints this; panics after [`PATIENCE`].
fn until_printed(line: &Line, command: &str, expected: &str) -> std::process::Output {
    until_printed_by(line, &[command], expected)
}

fn until_printed_by(line: &Line, command: &[&str], expected: &str) -> std::process::Output {
    let until = Instant::now() + PATIENCE;
    loop {
        let output = line.command(command[0], &command[1..]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if text.contains(expected) {
            return output;
        }
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(Instant::now() < until, "`andond {command:?}` does not say {expected}:\n{text}{errors}");
    }
}

fn until_sees(watcher: &mut Watcher, sight: Sight) {
    watcher.until(sight.name(), |watcher| {
        watcher.health(RoleId::Perceive).is_some_and(|health| health.sight == sight.code())
    });
}

/// Waits for a message with this code and these words; panics after [`PATIENCE`]. Other messages with the code may come before it.
fn until_logged(line: &Line, role: &str, code: &str, words: &str) {
    let until = Instant::now() + PATIENCE;
    let is_logged =
        || line.log(role).lines().any(|message| message.contains(code) && message.contains(words));
    while !is_logged() {
        assert!(Instant::now() < until, "{role} does not log {code} with {words}:\n{}", line.log(role));
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// What is said of this trouble in the log, with a part of its remedy, and the word for it.
struct Words {
    code: &'static str,
    meaning: &'static str,
    remedy: &'static str,
    word: &'static str,
}

/// Starts the line and waits until a trouble is said: in health, log and `status`.
fn said(line: &mut Line, sight: Sight, words: &Words) -> Watcher {
    let mut watcher = line.launch();
    line.start("capture");
    until_sees(&mut watcher, sight);
    line.wait_for_log("perceive", words.code, words.remedy);
    let status = until_printed(line, "status", words.word);
    assert_eq!(status.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&status.stdout).contains(words.code), "{status:?}");
    watcher
}

/// And to the PLC; and that it is over by itself, in `tail` and in the journal as well.
fn said_and_undone(mut line: Line, sight: Sight, words: &Words) {
    let mut watcher = said(&mut line, sight, words);
    until_logged(&line, "plc", "AND-510", "does not see its bench");
    let file = |name: &str| std::fs::File::create(line.path(name)).unwrap();
    let follow = |json: &[&str], said: &str, verdicts: &str| {
        let mut tail = Command::new(andond());
        tail.args(["tail", "-c"]).arg(line.config()).args(json);
        tail.stdout(file(verdicts)).stderr(file(said)).spawn().unwrap()
    };
    let tails = [follow(&[], "tail.log", "tail.verdicts"), follow(&["--json"], "tail.errors", "json.log")];
    until_sees(&mut watcher, Sight::Clear);
    line.wait_for_log("perceive", "AND-221", "");
    until_printed(&line, "history", "-- not watching until 2");
    until_logged(&line, "tail", &format!("not watching: {}", words.meaning), words.remedy);
    until_logged(&line, "tail", "watching again", "");
    until_logged(&line, "json", r#"{"kind":"Sight","#, &format!(r#""code":"{}""#, words.code));
    until_logged(&line, "json", r#"{"kind":"Sight","#, r#""sight":"Clear""#);
    for mut tail in tails {
        tail.kill().unwrap();
        tail.wait().unwrap();
    }
    // Once for each time that the film was played, never twice without an end between.
    let log = line.log("perceive");
    let told: Vec<bool> = log
        .lines()
        .filter(|message| message.contains(words.code) || message.contains("AND-221"))
        .map(|message| message.contains(words.code))
        .collect();
    assert!(told.windows(2).all(|two| two != [true, true]), "{log}");
}

/// A trouble that blinds the line.
const fn blind(code: &'static str, meaning: &'static str, remedy: &'static str) -> Words {
    Words { code, meaning, remedy, word: "BLIND" }
}

/// What is done to the picture, and what is said of it.
const SHOWN: [(&str, Sight, Words); 6] = [
    (
        "lutyuv=y=16:u=128:v=128",
        Sight::Black,
        blind("AND-213", "the picture is black", "Switch on the light"),
    ),
    (
        "lutyuv=y=255:u=128:v=128",
        Sight::White,
        blind("AND-214", "the picture is white", "lower camera.exposure_us"),
    ),
    (
        "drawbox=c=0x6a4030:t=fill",
        Sight::Covered,
        blind("AND-215", "something lies over the lens", "Clear the camera's view"),
    ),
    ("gblur=sigma=12", Sight::Blurred, blind("AND-216", "the picture is blurred", "Clean the lens")),
    (
        "noise=alls=100:allf=t",
        Sight::Noisy,
        blind("AND-217", "the picture is so noisy", "Light the bench better"),
    ),
    (
        "rotate=0.08:c=gray",
        Sight::CameraMoved,
        blind("AND-222", "the camera has been moved", "Put the camera back"),
    ),
];

/// Each draw tries one in three; `ANDON_EVERY=1` tries all.
#[test]
fn what_blinds_a_picture_is_said_everywhere_and_undone_when_it_is_over() {
    for (filter, sight, words) in environment::one_in(3, SHOWN.iter().collect()) {
        println!("{filter}");
        said_and_undone(line_that_shows(&format!("{filter}:enable='between(t,4,9)'")), *sight, words);
    }
}

#[test]
fn a_picture_that_stands_still_is_said_everywhere_and_undone_when_it_is_over() {
    // The noise comes first: a camera that has stopped repeats it as well.
    let film = format!("{NOISE},loop=loop=180:size=1:start=120");
    let line = Line::with_film(MAX, "", &["-i", "p1_none_r1.mp4", "-t", "14", "-vf", &film]);
    said_and_undone(line, Sight::Frozen, &blind("AND-212", "the picture has stopped", "Unplug the camera"));
}

#[test]
fn parts_that_move_without_a_hand_are_said_everywhere_and_undone_when_they_lie_still() {
    // The upper half of a picture without a hand, in which the brick moves to the right after two seconds, then lies still.
    let film = format!(
        "crop=640:235:0:0,pad=640:480:0:0:0x9a7550,split[a][b];[b]crop=120:50:260:164[brick];\
         [a]drawbox=260:164:120:50:0x9a7550:t=fill[bench];\
         [bench][brick]overlay=x='260+40*clip(t-2,0,5)':y=164,{NOISE}"
    );
    let still = ["-loop", "1", "-framerate", "30", "-t", "14", "-i", "picture.png"];
    let line = Line::with_film(MAX, "", &["-f", "lavfi", "-i", "color=s=640x480:d=0.1"]);
    let picture = line.path("picture.png");
    let ffmpeg = |arguments: &[&str], out: &Path| {
        let status = Command::new("ffmpeg")
            .args(["-v", "error", "-y"])
            .args(arguments)
            .arg(out)
            .current_dir(out.parent().unwrap())
            .status()
            .unwrap();
        assert!(status.success());
    };
    let clip = root().join("tests/footage/p2_none_r1.mp4");
    ffmpeg(&["-i", clip.to_str().unwrap(), "-frames:v", "1"], &picture);
    let lossless = ["-pix_fmt", "yuv420p", "-preset", "ultrafast", "-qp", "0"];
    let arguments = [&still[..], &["-filter_complex", &film], &lossless].concat();
    ffmpeg(&arguments, &line.path("film.mkv"));
    said_and_undone(
        line,
        Sight::NoHands,
        &blind("AND-220", "parts move, and no hand is found", "Light the hands"),
    );
}

#[test]
fn too_few_frames_are_said_everywhere_and_undone_when_there_are_enough() {
    // Of ten pictures a second, of four, and of ten again: the job needs 7.5.
    let film = "setpts='if(lt(N,60),N/10,if(lt(N,100),6+(N-60)/4,16+(N-100)/10))/TB'";
    let line = Line::with_film(
        "speed = \"file\"",
        "",
        &[
            "-stream_loop",
            "-1",
            "-i",
            "p1_none_r1.mp4",
            "-frames:v",
            "180",
            "-vf",
            film,
            "-fps_mode",
            "passthrough",
        ],
    );
    let words = Words {
        code: "AND-218",
        meaning: "too few pictures are processed",
        remedy: "Stop what else runs",
        word: "SLOW",
    };
    said_and_undone(line, Sight::TooFewFrames, &words);
}

#[test]
fn markers_of_another_dictionary_and_other_ids_are_said_everywhere() {
    let words = blind("AND-219", "none of the station's markers", "Compare the printed markers");
    let clip = ["-i", "p1_none_r1.mp4", "-t", "8", "-vf", NOISE];
    let mut line = Line::with_film(MAX, "dictionary = \"DICT_5X5_50\"", &clip);
    said(&mut line, Sight::NoMarkers, &words);
    let mut line = Line::with_film(MAX, "", &clip);
    for (own, other) in [(5, 25), (6, 26), (3, 23)] {
        line.reconfigure(&format!("id = {own}\n"), &format!("id = {other}\n"));
    }
    // The job has other parts.
    let text = std::fs::read_to_string(line.config()).unwrap();
    let without_job: Vec<&str> = text.lines().filter(|line| !line.starts_with("job = ")).collect();
    std::fs::write(line.config(), without_job.join("\n")).unwrap();
    said(&mut line, Sight::NoMarkers, &words);
}

#[test]
fn what_a_running_line_sees_is_looked_at_without_opening_its_camera() {
    let mut line = Line::with_film("", "", &["-i", "p1_none_r1.mp4"]);
    line.launch();
    line.start("capture");
    let picture = line.path("seen.png");
    let output = until_printed_by(
        &line,
        &["look", "--seconds", "2", "--save", picture.to_str().unwrap()],
        "right hand  seen in",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with("the running station line: 640 x 480 pixels"), "{text}");
    assert!(text.contains("meter       its marker is 30 px wide"), "{text}");
    assert!(picture.exists());
}

#[test]
fn a_mirrored_film_and_a_negative_one_each_say_their_cause() {
    for (filter, cause) in [("hflip", "the picture is mirrored"), ("negate", "the picture is a negative")] {
        let line = Line::with_film(MAX, "", &["-i", "p1_none_r1.mp4", "-t", "1", "-vf", filter]);
        let film = line.path("film.mkv");
        let film = film.to_str().unwrap();
        let looked = line.command("look", &[film]);
        assert!(String::from_utf8_lossy(&looked.stdout).contains(cause), "{looked:?}");
        let job = root().join("config/jobs/polish-and-measure.toml");
        let replayed = line.command("replay", &["--job", job.to_str().unwrap(), film]);
        let said = String::from_utf8_lossy(&replayed.stderr);
        assert!(said.contains("shows no marker of the job's parts; `andond look "), "{said}");
        assert_eq!(replayed.status.code(), Some(2));
    }
}
