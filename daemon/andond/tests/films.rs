//! Films and pictures as telephones, editors and other programs make them: read as they are meant, or refused with the cause.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use andond::video::{Film, VideoError, helper_path};
use tempfile::TempDir;

/// Half a second of two colours, red above blue, and more where a test needs it.
const SOURCE: [&str; 4] = ["-f", "lavfi", "-i", "color=red:s=96x40:r=30:d=2,pad=96:80:0:0:blue"];

fn ffmpeg(folder: &TempDir, arguments: &[&str]) -> PathBuf {
    let name = arguments.last().unwrap();
    let made = Command::new("ffmpeg")
        .args(["-loglevel", "error", "-y"])
        .args(arguments)
        .current_dir(folder.path())
        .status()
        .expect("ffmpeg is needed: run `make test-packages`, or apt install ffmpeg");
    assert!(made.success(), "{arguments:?}");
    folder.path().join(name)
}

/// A film of two seconds.
fn film(folder: &TempDir, name: &str) -> PathBuf {
    ffmpeg(folder, &[&SOURCE[..], &["-c:v", "libx264", "-pix_fmt", "yuv420p", name]].concat())
}

/// The times of all pictures, in milliseconds.
fn times_ms(path: &Path) -> Result<Vec<u64>, VideoError> {
    let mut film = Film::open(path, 30.0)?;
    let mut times = Vec::new();
    while let Some(ns) = film.advance()? {
        times.push((ns + 500_000) / 1_000_000);
    }
    Ok(times)
}

fn refused(path: &Path) -> String {
    times_ms(path).unwrap_err().to_string()
}

#[test]
fn a_film_that_an_editor_has_cut_at_its_front_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    film(&folder, "whole.mp4");
    let cut = ffmpeg(&folder, &["-ss", "1.2", "-i", "whole.mp4", "-c", "copy", "cut.mp4"]);
    let shown = times_ms(&cut).unwrap().len();
    assert!((23..=25).contains(&shown), "{shown} pictures of 0.8 s");
}

/// FFmpeg would make pictures of any text whose name ends in .txt, and open what a playlist names.
#[test]
fn a_text_is_no_film_whatever_it_is_called() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["notes.txt", "tracks.json", "list.m3u8", "page.mp4"] {
        let path = folder.path().join(name);
        std::fs::write(&path, "#EXTM3U\n/etc/hostname\n".repeat(50)).unwrap();
        let said = refused(&path);
        assert!(said.contains("it is text and no film") && said.contains(".tracks.jsonl"), "{name}: {said}");
    }
}

#[test]
fn a_film_whose_sound_is_longer_than_its_pictures_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let sound = ["-f", "lavfi", "-i", "sine=duration=9", "-c:v", "libx264", "-pix_fmt", "yuv420p"];
    for name in ["long.mkv", "long.mp4", "long.mov"] {
        let film = ffmpeg(&folder, &[&SOURCE[..], &sound, &[name]].concat());
        assert_eq!(times_ms(&film).unwrap().len(), 60, "{name}");
    }
}

#[test]
fn a_film_that_ends_before_its_container_says_so_breaks_off_however_little_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let front = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "faststart", "front.mp4"];
    for path in [ffmpeg(&folder, &[&SOURCE[..], &front].concat()), film(&folder, "film.mkv")] {
        let bytes = std::fs::read(&path).unwrap();
        for missing in [1, bytes.len() / 3] {
            std::fs::write(&path, &bytes[..bytes.len() - missing]).unwrap();
            let said = refused(&path);
            assert!(said.contains("it breaks off after"), "{}: {said}", path.display());
        }
    }
}

/// Blue, green and red of the middle of the upper, right, lower and left edge.
fn edges(path: &Path) -> Vec<&'static str> {
    let mut film = Film::open(path, 30.0).unwrap();
    film.advance().unwrap().unwrap();
    let (width, height) = (film.format().width as usize, film.format().height as usize);
    let picture = film.picture();
    let at = |x: usize, y: usize| {
        let pixel = &picture[3 * (y * width + x)..];
        if pixel[2] > pixel[0] { "red" } else { "blue" }
    };
    vec![at(width / 2, 4), at(width - 5, height / 2), at(width / 2, height - 5), at(4, height / 2)]
}

#[test]
fn a_film_that_is_turned_by_its_metadata_is_shown_as_every_player_shows_it() {
    let folder = tempfile::tempdir().unwrap();
    film(&folder, "straight.mp4");
    for (degrees, size) in [("0", [96, 80]), ("90", [80, 96]), ("180", [96, 80]), ("270", [80, 96])] {
        let rotate = format!("rotate={degrees}");
        let turned = ["-i", "straight.mp4", "-c", "copy", "-metadata:s:v:0", &rotate, "turned.mp4"];
        let turned = ffmpeg(&folder, &turned);
        // FFmpeg itself turns the pictures, and the copy says nothing of it any more.
        let upright = ffmpeg(&folder, &["-i", "turned.mp4", "-qp", "0", "upright.mp4"]);
        let format = Film::open(&turned, 30.0).unwrap().format();
        assert_eq!([format.width, format.height], size, "{degrees}");
        assert_eq!(edges(&turned), edges(&upright), "{degrees}");
    }
}

#[test]
fn a_name_with_a_colon_is_the_name_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::rename(film(&folder, "film.mp4"), folder.path().join("10:15:00.mp4")).unwrap();
    let decode = |name: &str| -> Output {
        Command::new(helper_path()).args(["decode", name, "30"]).current_dir(folder.path()).output().unwrap()
    };
    let output = decode("10:15:00.mp4");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.len() > 60 * 96 * 80 * 3);
}

#[test]
fn an_empty_film_and_a_pipe_are_told_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty.mp4");
    std::fs::write(&empty, "").unwrap();
    assert!(refused(&empty).contains("empty.mp4: the file is empty"));
    let pipe = folder.path().join("pipe.mp4");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert!(refused(&pipe).contains("it is a pipe or a device"));
}

#[test]
fn pictures_that_a_program_has_numbered_come_in_their_order_and_at_their_times() {
    let folder = tempfile::tempdir().unwrap();
    film(&folder, "film.mp4");
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).unwrap();
    // Each picture has the colour of its number.
    ffmpeg(&folder, &["-i", "film.mp4", "-vf", "geq=lum=4*N:cb=128:cr=128", "pictures/f_%d.png"]);
    let mut film = Film::open(&pictures, 30.0).unwrap();
    let mut levels = Vec::new();
    while film.advance().unwrap().is_some() {
        levels.push(film.picture()[0]);
    }
    assert_eq!(levels.len(), 60);
    assert!(levels.is_sorted(), "{levels:?}");
    for number in 31..=40 {
        std::fs::remove_file(pictures.join(format!("f_{number}.png"))).unwrap();
    }
    assert_eq!(times_ms(&pictures).unwrap()[28..32], [933, 967, 1333, 1367], "a gap is a gap");
}

#[test]
fn a_picture_of_a_folder_that_is_cut_off_or_empty_is_named() {
    let folder = tempfile::tempdir().unwrap();
    film(&folder, "film.mp4");
    for name in ["%d.jpg", "%d.png", "%d.bmp", "%d.tif"] {
        let pictures = tempfile::tempdir_in(folder.path()).unwrap();
        let pattern = pictures.path().join(name);
        ffmpeg(&folder, &["-i", "film.mp4", "-frames:v", "3", pattern.to_str().unwrap()]);
        let second = pictures.path().join(name.replace("%d", "2"));
        let bytes = std::fs::read(&second).unwrap();
        for length in [bytes.len() * 2 / 3, 0] {
            std::fs::write(&second, &bytes[..length]).unwrap();
            let said = refused(pictures.path());
            assert!(said.contains(second.to_str().unwrap()), "{name} of {length} bytes: {said}");
        }
    }
}
