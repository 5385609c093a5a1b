//! Recordings whose messages are in any order, missing, doubled or of any bytes: their replay ends with verdicts or with a reason.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::Channel;
use andon_record::picture::{Decoded, encode};
use andon_record::viewer::CompressedImage;
use andon_record::{Attachment, Entry, RecordingWriter, Topic};
use andond::blackbox::again::{Recorded, judge};
use andond::blackbox::{BlackboxError, Plan, Run, Sight, first_picture, only_piece, piece_of};
use oorandom::Rand64;
use prost::Message as _;
use shm_schemas::{
    Command, CommandKind, CommandSource, Couples, Detections, Judging, Layout, MessageId, Stamp, Verdict,
    VerdictLevel, bytes_of,
};
use std::fs::File;
use std::path::{Path, PathBuf};

/// How many recordings; `ANDON_CASES=n` takes more.
const CASES: u64 = 60;
/// Of so many recordings one is looked at again.
const LOOKED_AT: u64 = 20;
const PERIOD_NS: u64 = 33_333_333;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn below(draw: &mut Rand64, count: u64) -> u64 {
    draw.rand_range(0..count)
}

fn message<T: Layout>(channel: Channel, at_ns: u64, message: &T) -> Entry {
    Entry { topic: Topic::Raw(channel), time_ns: at_ns, sent_ns: at_ns, data: bytes_of(message).into() }
}

/// What a line of a few seconds might have sent, in which each role may start again and each time may be any other.
fn entries(draw: &mut Rand64, model_hash: u64) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut epoch = 1;
    for seq in 1..=90 {
        let at_ns = seq * PERIOD_NS;
        epoch += u64::from(below(draw, 40) == 0);
        let hash = [model_hash, 0, 7][below(draw, 20).saturating_sub(17) as usize];
        let source_ns = if below(draw, 30) == 0 { below(draw, at_ns) } else { at_ns };
        let stamp = Stamp { epoch, seq, captured_ns: at_ns, sent_ns: at_ns, ..Stamp::default() };
        entries.push(message(
            Channel::Detections,
            at_ns,
            &Detections { stamp, source_ns, ..Detections::default() },
        ));
        let couples = Couples { stamp, model_hash: hash, began_ns: epoch * PERIOD_NS, ..Couples::default() };
        entries.push(message(Channel::Couple, at_ns, &couples));
        if below(draw, 20) == 0 {
            let data = picture(16, 16).into();
            entries.push(Entry { topic: Topic::Picture, time_ns: at_ns, sent_ns: at_ns, data });
        }
        if seq % 7 == 0 {
            let judging = Judging {
                stamp,
                model_hash: hash,
                command: below(draw, 9),
                obeyed_epoch: epoch,
                obeyed_seq: below(draw, seq + 2),
                first_epoch: epoch,
                first_seq: below(draw, seq + 2),
                is_enabled: below(draw, 2) as u8,
                phase: below(draw, 5) as u8,
                ..Judging::default()
            };
            entries.push(message(Channel::Judging, at_ns, &judging));
            let kinds = CommandKind::ALL;
            let kind = kinds[below(draw, kinds.len() as u64) as usize].code();
            let source = CommandSource::Plc.code();
            let command = Command { stamp, number: below(draw, 9), kind, source, ..Command::default() };
            entries.push(message(Channel::Command, at_ns, &command));
            let level = VerdictLevel::ALL[below(draw, 3) as usize].code();
            let verdict =
                Verdict { stamp, level, began_ns: below(draw, at_ns), ended_ns: at_ns, ..Verdict::NONE };
            entries.push(message(Channel::Verdict, at_ns, &verdict));
        }
    }
    entries
}

/// Messages change their places, go, come twice, or have other bytes.
fn disturb(entries: &mut Vec<Entry>, draw: &mut Rand64) {
    for _ in 0..below(draw, 40) {
        let at = below(draw, entries.len() as u64) as usize;
        match below(draw, 5) {
            0 => drop(entries.remove(at)),
            1 => entries.insert(at, entries[at].clone()),
            2 => {
                let other = below(draw, entries.len() as u64) as usize;
                entries.swap(at, other);
            }
            _ => {
                let mut data = entries[at].data.to_vec();
                for _ in 0..=below(draw, 30) {
                    let byte = below(draw, data.len() as u64) as usize;
                    data[byte] = draw.rand_u64() as u8;
                }
                entries[at].data = data.into();
            }
        }
    }
}

fn write(path: &Path, files: &[Attachment], entries: &[Entry], draw: &mut Rand64) {
    let mut writer = RecordingWriter::new(File::create(path).unwrap(), 0).unwrap();
    files.iter().for_each(|file| writer.attach(file, 1).unwrap());
    entries.iter().for_each(|entry| writer.write(entry).unwrap());
    let file = writer.finish().unwrap();
    if below(draw, 3) == 0 {
        let length = file.metadata().unwrap().len();
        file.set_len(below(draw, length)).unwrap();
    }
}

/// Looks at the pictures again.
fn look(path: &Path) -> Result<(), BlackboxError> {
    let plan = Plan::read(path)?;
    let sight = Sight::of(path, &plan.station, root().join("target/runtime"))?;
    let paths = [path.to_path_buf()];
    let again =
        Recorded { paths: &paths, plan: &plan, instead: None, wants_pictures: false, sight: Some(&sight) };
    judge(again, &mut |_step| Ok::<(), BlackboxError>(())).map(drop)
}

/// How many frames were judged.
fn replay(path: &Path) -> Result<u64, BlackboxError> {
    let plan = Plan::read(path)?;
    let paths = [path.to_path_buf()];
    let mut frames = 0;
    let was = Recorded { paths: &paths, plan: &plan, instead: None, wants_pictures: true, sight: None };
    judge(was, &mut |_step| {
        frames += 1;
        Ok::<(), BlackboxError>(())
    })?;
    if let Some(job) = plan.station.jobs.values().next() {
        let would_be = Recorded { instead: Some(job), ..was };
        judge(would_be, &mut |_step| Ok::<(), BlackboxError>(()))?;
    }
    for verdict in plan.verdicts.iter().take(3) {
        let _ = piece_of(path, verdict.stamp.id());
    }
    let _ = piece_of(path, MessageId::default());
    let _ = only_piece(path);
    let mut run = Run::open(path)?;
    while run.next_frame()?.is_some() {}
    Ok(frames)
}

/// What a recording of the shipped station carries, and the hash of its job.
fn station() -> ([Attachment; 2], u64) {
    let read = |path: &str| std::fs::read(root().join(path)).unwrap();
    let job = read("config/jobs/polish-and-measure.toml");
    let model_hash = andon_learn::job_file::JobFile::parse("job.toml", &job).unwrap().model_hash();
    let shipped = String::from_utf8(read("config/stations/film.toml")).unwrap();
    let (_, objects) = shipped.split_once("[[objects]]").unwrap();
    let (objects, _) = objects.split_once("[plc]").unwrap();
    let configuration = format!("[station]\nname = \"line\"\n\n[[objects]]{objects}");
    let files = [("configuration.toml", configuration.into_bytes()), ("job-0.toml", job)]
        .map(|(name, data)| Attachment { name: name.into(), data: data.into() });
    (files, model_hash)
}

#[test]
fn whatever_is_in_a_recording_its_replay_ends_with_verdicts_or_with_a_reason() {
    let drawn = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let seed = number("ANDON_SEED", drawn % 100_000);
    println!("ANDON_SEED={seed}");
    let mut draw = Rand64::new(seed.into());
    let (files, model_hash) = station();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut judged = 0;
    for case in 0..number("ANDON_CASES", CASES) {
        let mut entries = entries(&mut draw, model_hash);
        if case > 0 {
            disturb(&mut entries, &mut draw);
        }
        write(&path, &files, &entries, &mut draw);
        match replay(&path) {
            Ok(frames) => judged += u64::from(frames > 0),
            Err(error) => assert!(error.to_string().contains("run.mcap"), "{error}"),
        }
        // To load the models takes longer than everything else.
        if case % LOOKED_AT == 0
            && let Err(error) = look(&path)
        {
            assert!(error.to_string().contains("run.mcap"), "{error}");
        }
    }
    assert!(judged > 0, "none of them was judged");
}

/// A picture of a few bytes that says how large it is.
fn picture(width: u16, height: u16) -> Vec<u8> {
    let small = Decoded { width: 16, height: 16, pixels: vec![0; 16 * 16 * 3] };
    let mut jpeg = encode(&small, 80).unwrap();
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 7].copy_from_slice(&height.to_be_bytes());
    jpeg[frame + 7..frame + 9].copy_from_slice(&width.to_be_bytes());
    CompressedImage { data: jpeg, format: "jpeg".into(), ..CompressedImage::default() }.encode_to_vec()
}

#[test]
fn a_picture_of_gigapixels_is_refused_by_its_size_wherever_it_lies() {
    let (files, model_hash) = station();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    for huge in [0, 1] {
        let mut draw = Rand64::new(1);
        let mut entries = entries(&mut draw, model_hash);
        entries.retain(|entry| entry.topic != Topic::Picture);
        // Each comes with the detections of its time.
        let times = [PERIOD_NS, 50 * PERIOD_NS];
        for (number, time_ns) in times.into_iter().enumerate().rev() {
            let data = if number == huge { picture(30_000, 29_000) } else { picture(16, 16) }.into();
            let at = entries.iter().position(|entry| entry.time_ns == time_ns).unwrap();
            entries.insert(at, Entry { topic: Topic::Picture, time_ns, sent_ns: time_ns, data });
        }
        let mut writer = RecordingWriter::new(File::create(&path).unwrap(), 0).unwrap();
        files.iter().for_each(|file| writer.attach(file, 1).unwrap());
        entries.iter().for_each(|entry| writer.write(entry).unwrap());
        writer.finish().unwrap();
        let error = replay(&path).unwrap_err().to_string();
        assert!(error.contains("run.mcap") && error.contains("30000 x 29000 pixels"), "{error}");
        assert_eq!(first_picture(&path).is_err(), huge == 0);
    }
}
