//! Bytes as files: what was read and written is read again in the same way.

use andon_core::anomaly::Judge;
use andon_core::couple::Encoder;
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;
use andon_learn::recording;

/// The beginning of the line with the digest in a job file.
const CHECKSUM: &str = "checksum = \"sha256:";

/// Reads a track file, and writes and encodes its frames.
pub fn track_file(bytes: &[u8]) {
    let Ok(first) = recording::read("fuzz", bytes) else { return };
    assert!(first.frames.windows(2).all(|pair| pair[0].captured_ns <= pair[1].captured_ns));
    let mut text = Vec::new();
    recording::write(&mut text, &first.header, &first.frames).expect("memory accepts it");
    // Times are rounded to a microsecond when they are written, so two frames that are closer together than that get the same time.
    let are_apart = first.frames.windows(2).all(|pair| pair[1].captured_ns - pair[0].captured_ns > 2_000);
    match recording::read("fuzz", &text[..]) {
        Ok(again) => assert_eq!((again.frames.len(), again.truncation), (first.frames.len(), None)),
        Err(error) => assert!(!are_apart, "what was written is refused: {error}"),
    }
    let Ok(mut encoder) = Encoder::new(Default::default(), &first.header.shapes()) else { return };
    for frame in &first.frames {
        let _ = encoder.step(frame, &mut |_| {});
    }
}

/// Reads a job file as it is and with the right checksum, and prepares a judge for it.
pub fn job_file(bytes: &[u8]) {
    read_job(bytes);
    if let Some(sealed) = str::from_utf8(bytes).ok().and_then(seal) {
        read_job(sealed.as_bytes());
    }
}

fn read_job(bytes: &[u8]) {
    let Ok(job) = JobFile::parse("fuzz", bytes) else { return };
    // In the words that were read, and in those of this build.
    for job in [&job, &JobFile { older: None, ..job.clone() }] {
        let text = job.to_toml();
        let again = JobFile::parse("fuzz", text.as_bytes()).expect("what was written is accepted");
        assert_eq!(again.to_toml(), text);
        assert_eq!(again.model_hash(), job.model_hash());
    }
    job.with_job(|lent| Judge::<Vec<_>>::with_memory(lent, job.method).is_ok());
}

/// Puts the right digest into the text of a job file; `None` if the text has no line for it.
pub fn seal(text: &str) -> Option<String> {
    let at = text.find(CHECKSUM)? + CHECKSUM.len();
    let end = at + text[at..].find('"')?;
    let digest = sha256_hex([&text[..at], &text[end..]].concat().as_bytes());
    Some([&text[..at], &digest, &text[end..]].concat())
}
