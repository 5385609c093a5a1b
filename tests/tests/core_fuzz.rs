//! What the fuzzer runs for hours, here for a moment: its seeds, whole and broken, and random bytes from fixed seeds.
#![allow(clippy::unwrap_used)]

use andon_learn::job_file::JobFile;
use andon_learn::recording;
use andon_tests::fuzz::{couple_stream, job_file, seal, track_file};
use oorandom::Rand32;

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = format!("{}/fuzz/seeds/{target}", env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|file| std::fs::read(file).unwrap()).collect()
}

/// The bytes with up to three changes: a byte is replaced, or a few bytes are removed or repeated.
fn broken(bytes: &[u8], random: &mut Rand32) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..random.rand_range(1..4) {
        let at = random.rand_range(0..bytes.len() as u32) as usize;
        let to = (at + random.rand_range(1..40) as usize).min(bytes.len());
        match random.rand_range(0..4) {
            0 => bytes[at] = random.rand_u32() as u8,
            1 => bytes[at] = b"0123456789-.e[]{}\"\n,"[random.rand_range(0..20) as usize],
            2 => drop(bytes.drain(at..to)),
            _ => bytes.extend_from_within(at..to),
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// Runs the seeds of a target, and `count` broken ones.
fn run(target: &str, entry: fn(&[u8]), count: usize) {
    let seeds = seeds(target);
    assert!(!seeds.is_empty());
    seeds.iter().for_each(|bytes| entry(bytes));
    let mut random = Rand32::new(1);
    for bytes in seeds.iter().cycle().take(count) {
        entry(&broken(bytes, &mut random));
    }
}

#[test]
fn no_track_file_breaks_its_reader() {
    assert!(
        recording::read("seed", &seeds("track_file")[0]).is_ok(),
        "the fuzzer must start from a file that is accepted"
    );
    run("track_file", track_file, 2000);
}

#[test]
fn no_job_file_breaks_its_reader() {
    let seed = seal(str::from_utf8(&seeds("job_file")[0]).unwrap()).unwrap();
    JobFile::parse("seed", seed.as_bytes()).unwrap();
    run("job_file", job_file, 2000);
}

#[test]
fn no_worker_breaks_the_core() {
    run("couple_stream", couple_stream, 100);
    let mut random = Rand32::new(2);
    for _ in 0..200 {
        let bytes: Vec<u8> = (0..random.rand_range(0..4000)).map(|_| random.rand_u32() as u8).collect();
        couple_stream(&bytes);
    }
}
