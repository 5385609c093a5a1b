//! What pictures are looked at with: programs, models, libraries and the processor. The same pictures give the same detections only with the same.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use andon_host::config::Config;
use andon_learn::digest::sha256_hex;

use crate::identity::program;

/// What the names of the libraries begin with that decode pictures, look at them or compute. They are those of the system; ONNX Runtime lies beside
/// the models.
const LIBRARIES: [&str; 7] =
    ["libopencv_", "libjpeg.", "libturbojpeg.", "liblapack.", "libblas.", "libopenblas", "libm."];

/// The words that a line begins with where it holds no checksum.
const NAMES: [&str; 4] = ["program", "processor", "opencv", "libjpeg-turbo"];

/// So many of the 64 digits of a checksum tell one file from the other.
const DIGITS: usize = 12;

/// What this program looks at pictures with, one thing a line. That is its name and which it is, or the SHA-256 of a file and its name.
pub(crate) fn hashes(config: &Config) -> String {
    let mut lines = vec![format!("program {}", program()), format!("processor {}", processor())];
    lines.extend(opencv::core::get_version_string().map(|version| format!("opencv {version}")));
    for path in models(&config.perception.models).into_iter().chain(libraries()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        match fs::read(&path) {
            Ok(bytes) => {
                lines.extend(turbo_version(&bytes).filter(|_| name.starts_with("libjpeg.")));
                lines.push(format!("{} {name}", sha256_hex(&bytes)));
            }
            Err(error) => lines.push(format!("unread {name}: {error}")),
        }
    }
    lines.push(String::new());
    lines.join("\n")
}

/// The hand models and ONNX Runtime.
fn models(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_used = |ending: &std::ffi::OsStr| ending == "onnx" || ending == "so";
    let mut files: Vec<_> =
        entries.filter(|path| path.is_file() && path.extension().is_some_and(is_used)).collect();
    files.sort();
    files
}

/// The libraries of the system that this process has loaded. One that was replaced since has another path, which cannot be read.
fn libraries() -> BTreeSet<PathBuf> {
    let maps = fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let paths = maps.lines().filter_map(|line| line.find('/').map(|begin| PathBuf::from(&line[begin..])));
    let is_used = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        LIBRARIES.iter().any(|begin| name.starts_with(begin))
    };
    paths.filter(is_used).collect()
}

/// What libjpeg-turbo says of itself: its file has no other number than that of the interface.
fn turbo_version(library: &[u8]) -> Option<String> {
    const WORDS: &[u8] = b"libjpeg-turbo version ";
    let begin = library.windows(WORDS.len()).position(|bytes| bytes == WORDS)? + WORDS.len();
    let version = library[begin..].split(|byte| *byte == 0).next()?;
    Some(format!("libjpeg-turbo {}", String::from_utf8_lossy(version)))
}

/// The features of the processor by which OpenCV, ONNX Runtime and the mathematics of the system choose how they compute.
fn processor() -> String {
    #[cfg(target_arch = "x86_64")]
    let features = {
        macro_rules! features {
            ($($name:tt),*) => { [$(($name, is_x86_feature_detected!($name))),*] };
        }
        features!(
            "sse4.1",
            "sse4.2",
            "avx",
            "f16c",
            "fma",
            "avx2",
            "avxvnni",
            "avx512f",
            "avx512bw",
            "avx512dq",
            "avx512vl",
            "avx512vnni"
        )
    };
    #[cfg(not(target_arch = "x86_64"))]
    let features = [("", false)];
    let there: Vec<&str> = features.iter().filter(|(_, is_there)| *is_there).map(|(name, _)| *name).collect();
    format!("{} {}", std::env::consts::ARCH, there.join(" "))
}

/// What this machine has in another version than the one that made a recording, in a line each, which begins with its name. A recording that says
/// nothing differs in nothing.
pub(crate) fn differences(then: &str, now: &str) -> Vec<String> {
    let (then, now) = (things(then), things(now));
    if then.is_empty() {
        return Vec::new();
    }
    let names: BTreeSet<&str> = then.keys().chain(now.keys()).copied().collect();
    let words = |name: &str| match (then.get(name), now.get(name)) {
        (Some(then), Some(now)) => (then != now).then(|| format!("{name}: recorded with {then}, here {now}")),
        (Some(then), None) => Some(format!("{name}: recorded with {then}, here there is none")),
        (None, Some(now)) => Some(format!("{name}: the recording does not say which it had, here {now}")),
        (None, None) => None,
    };
    names.into_iter().filter_map(words).collect()
}

/// The lines by their names.
fn things(text: &str) -> BTreeMap<&str, &str> {
    text.lines().filter_map(thing).collect()
}

/// What a line is of, and what it says of it.
fn thing(line: &str) -> Option<(&str, &str)> {
    let (first, rest) = line.split_once(' ')?;
    Some(match first {
        name if NAMES.contains(&name) => (name, rest),
        "unread" => rest.split_once(": ")?,
        hash => (rest, hash.get(..DIGITS).unwrap_or(hash)),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn it_is_said_in_a_line_each_what_a_recording_was_made_with_and_is_not_here() {
        let then = "program andond 0.1.0 of today\nprocessor x86_64 avx2\nopencv 4.6.0\n12ab hands.onnx\n34cd libm.so.6\n";
        assert!(differences(then, then).is_empty() && differences("", then).is_empty());
        for (now, expected) in [
            (
                then.replace("today", "yesterday"),
                vec!["program: recorded with andond 0.1.0 of today, here andond 0.1.0 of yesterday"],
            ),
            (then.replace("12ab", "56ef"), vec!["hands.onnx: recorded with 12ab, here 56ef"]),
            (then.replace("34cd libm.so.6\n", ""), vec!["libm.so.6: recorded with 34cd, here there is none"]),
            (
                then.replace("34cd", "unread").replace("libm.so.6", "libm.so.6: not allowed"),
                vec!["libm.so.6: recorded with 34cd, here not allowed"],
            ),
            (
                format!("{then}78ab libjpeg.so.62.3.0\n"),
                vec!["libjpeg.so.62.3.0: the recording does not say which it had, here 78ab"],
            ),
            (
                then.replace("avx2", "avx2 fma").replace("4.6.0", "4.10.0"),
                vec![
                    "opencv: recorded with 4.6.0, here 4.10.0",
                    "processor: recorded with x86_64 avx2, here x86_64 avx2 fma",
                ],
            ),
        ] {
            assert_eq!(differences(then, &now), expected, "{now}");
        }
    }

    #[test]
    fn programs_models_libraries_and_processor_are_named_each_with_its_version_or_checksum() {
        let models = tempfile::tempdir().unwrap();
        fs::write(models.path().join("hands.onnx"), "").unwrap();
        let mut config = Config::default();
        config.perception.models = models.path().into();
        let text = hashes(&config);
        let things = things(&text);
        assert!(things["program"].starts_with("andond ") && things["processor"].starts_with("x86_64"));
        assert!(things["opencv"].starts_with(|digit: char| digit.is_ascii_digit()), "{text}");
        assert!(things["libjpeg-turbo"].starts_with(|digit: char| digit.is_ascii_digit()), "{text}");
        assert_eq!(things["hands.onnx"], &sha256_hex(b"")[..DIGITS]);
        for begin in ["libopencv_core.", "libopencv_imgcodecs.", "libjpeg.", "libturbojpeg.", "libm."] {
            let found = things.iter().find(|(name, _)| name.starts_with(begin));
            assert!(found.is_some_and(|(_, hash)| hash.len() == DIGITS), "{begin}\n{text}");
        }
    }
}
