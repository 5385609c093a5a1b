//! Recordings as they are written, read, cut, repaired and damaged.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::Channel;
use andon_record::{
    Attachment, End, Entry, Item, ReadError, RecordingReader, RecordingWriter, Repaired, Topic, index::Index,
    places::places, repair,
};
use shm_schemas::{Detections, Verdict, VerdictLevel, VerdictOutcome, bytes_of};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Cursor;
use std::path::Path;
use std::time::{Duration, SystemTime};

const SECOND: u64 = 1_000_000_000;

fn entry(topic: Topic, sent_ns: u64, data: &[u8]) -> Entry {
    Entry { topic, time_ns: sent_ns - 1, sent_ns, data: data.into() }
}

/// What a line sends in some seconds, with a file in its middle.
fn items(seconds: u64) -> Vec<Item> {
    let mut items =
        vec![Item::Attachment(Attachment { name: "configuration.toml".into(), data: b"a = 1"[..].into() })];
    for tenth in 10..10 + 10 * seconds {
        let sent_ns = tenth * SECOND / 10;
        let mut detections = Detections { source_ns: sent_ns, ..Detections::default() };
        detections.stamp.seq = tenth;
        items.push(Item::Entry(entry(Topic::Raw(Channel::Detections), sent_ns, bytes_of(&detections))));
        items.push(Item::Entry(entry(Topic::Picture, sent_ns, &vec![tenth as u8; 20_000])));
        if tenth % 10 == 0 {
            let (level, outcome) = (VerdictLevel::Iu.code(), VerdictOutcome::Anomaly.code());
            let mut verdict = Verdict { level, outcome, ..Verdict::NONE };
            (verdict.stamp.epoch, verdict.stamp.seq) = (7, tenth / 10);
            items.push(Item::Entry(entry(Topic::Raw(Channel::Verdict), sent_ns, bytes_of(&verdict))));
        }
    }
    let middle = items.len() / 2;
    items.insert(middle, Item::Attachment(Attachment { name: "job.toml".into(), data: b"b = 2"[..].into() }));
    items
}

/// As the recorder writes it: each second is brought to the disk.
fn write(items: &[Item]) -> Vec<u8> {
    let mut writer = RecordingWriter::new(Cursor::new(Vec::new()), 0).unwrap();
    for (index, item) in items.iter().enumerate() {
        match item {
            Item::Entry(entry) => writer.write(entry).unwrap(),
            Item::Attachment(attachment) => writer.attach(attachment, SECOND).unwrap(),
        }
        if index % 21 == 20 {
            writer.flush().unwrap();
        }
    }
    writer.finish().unwrap().into_inner()
}

fn read(bytes: &[u8]) -> Result<(Vec<Item>, End), ReadError> {
    let mut reader = RecordingReader::new(bytes, Path::new("run.mcap"))?;
    let mut items = Vec::new();
    while let Some(item) = reader.next_item()? {
        items.push(item);
    }
    Ok((items, reader.end()))
}

#[test]
fn what_is_written_comes_out_in_the_order_in_which_it_was_received() {
    let items = items(10);
    assert_eq!(read(&write(&items)).unwrap(), (items, End::Complete));
}

#[test]
fn the_times_of_a_file_are_utc_whatever_the_clock_of_its_messages_is() {
    let mut writer = RecordingWriter::new(Cursor::new(Vec::new()), 1_000 * i128::from(SECOND)).unwrap();
    writer.write(&entry(Topic::Log, 5 * SECOND, b"x")).unwrap();
    let (items, _) = read(&writer.finish().unwrap().into_inner()).unwrap();
    let [Item::Entry(read)] = items.as_slice() else { panic!("{items:?}") };
    assert_eq!((read.time_ns, read.sent_ns), (1005 * SECOND - 1, 1005 * SECOND));
}

#[test]
fn single_messages_are_found_by_their_times_and_read_without_the_rest_also_where_the_file_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let items = items(10);
    let bytes = write(&items);
    let topics = [Topic::Picture, Topic::Raw(Channel::Verdict)];
    let of = |times: std::ops::RangeInclusive<u64>| -> Vec<Entry> {
        let entries = items.iter().filter_map(|item| match item {
            Item::Entry(entry) => Some(entry.clone()),
            Item::Attachment(_) => None,
        });
        entries.filter(|entry| topics.contains(&entry.topic) && times.contains(&entry.time_ns)).collect()
    };
    let found = |times: &std::ops::RangeInclusive<u64>, most| {
        let file = File::open(&path).unwrap();
        let places = places(&path, &topics, times, most).unwrap();
        places
            .iter()
            .map(|place| (place.topic, place.time_ns, place.read(&file).unwrap()))
            .collect::<Vec<_>>()
    };
    let told = |entries: &[Entry]| -> Vec<_> {
        entries.iter().map(|entry| (entry.topic, entry.time_ns, entry.data.to_vec())).collect()
    };
    std::fs::write(&path, &bytes).unwrap();
    for times in [0..=u64::MAX, 3 * SECOND..=5 * SECOND, 0..=SECOND, 90 * SECOND..=99 * SECOND] {
        assert_eq!(found(&times, 1000), told(&of(times.clone())), "{times:?}");
    }
    assert_eq!(found(&(0..=u64::MAX), 7).len(), 7);
    let all = told(&of(0..=u64::MAX));
    let mut longest = 0;
    for end in (100..bytes.len()).step_by(9973) {
        std::fs::write(&path, &bytes[..end]).unwrap();
        match places(&path, &topics, &(0..=u64::MAX), 1000) {
            Ok(places) => {
                assert!(places.len() >= longest && places.len() <= all.len(), "{end}");
                longest = places.len();
                let file = File::open(&path).unwrap();
                assert!(places.iter().all(|place| place.read(&file).is_ok()), "{end}");
            }
            Err(error) => assert!(matches!(error, ReadError::Cut { .. }), "{end}: {error}"),
        }
    }
    assert!(longest + 12 > all.len(), "{longest} of {}", all.len());
    std::fs::write(&path, b"no recording").unwrap();
    assert!(matches!(places(&path, &topics, &(0..=1), 1), Err(ReadError::NotMcap { .. })));
}

#[test]
fn bytes_that_were_changed_lead_to_no_panic_and_claim_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let bytes = write(&items(2));
    for place in (0..bytes.len()).step_by(bytes.len() / 400) {
        let mut changed = bytes.clone();
        for byte in &mut changed[place..(place + 4).min(bytes.len())] {
            *byte = 0xff;
        }
        std::fs::write(&path, &changed).unwrap();
        if let Ok(places) = places(&path, &[Topic::Picture], &(0..=u64::MAX), 1000) {
            let file = File::open(&path).unwrap();
            let read = places
                .iter()
                .filter_map(|place| place.read(&file).ok())
                .map(|bytes| bytes.len())
                .sum::<usize>();
            assert!(read <= bytes.len(), "{place}");
        }
    }
}

#[test]
fn a_file_that_is_cut_anywhere_is_read_up_to_its_last_whole_chunk() {
    let items = items(10);
    let bytes = write(&items);
    let mut longest = 0;
    for end in (0..bytes.len()).step_by(997) {
        match read(&bytes[..end]) {
            Ok((found, End::Cut(_))) => {
                assert_eq!(found, items[..found.len()]);
                assert!(found.len() >= longest, "more of the file holds less");
                longest = found.len();
            }
            Ok((_, End::Complete)) => panic!("{end} of {} bytes are complete", bytes.len()),
            Err(ReadError::Empty { .. }) => assert_eq!(end, 0),
            Err(error) => assert!(matches!(error, ReadError::Cut { .. }), "{end}: {error}"),
        }
    }
    assert!(longest + 25 > items.len(), "{longest} of {}", items.len());
}

#[test]
fn a_file_that_is_cut_is_completed_with_everything_that_is_whole_in_it_and_its_index() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let items = items(10);
    let bytes = write(&items);
    let cut = &bytes[..bytes.len() * 2 / 3];
    let (whole, _) = read(cut).unwrap();
    std::fs::write(&path, cut).unwrap();
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_secs(SECOND);
    File::options().write(true).open(&path).unwrap().set_modified(long_ago).unwrap();
    assert_eq!(repair(&path).unwrap(), Repaired::Completed);
    assert_eq!(path.metadata().unwrap().modified().unwrap(), long_ago, "its days go on");
    assert_eq!(read(&std::fs::read(&path).unwrap()).unwrap(), (whole, End::Complete));
    let index = Index::beside(&path).unwrap();
    let verdicts: Vec<_> = index.verdicts.iter().map(|verdict| (verdict.epoch, verdict.seq)).collect();
    assert!(verdicts.len() > 4 && verdicts.is_sorted() && verdicts[0] == (7, 1), "{verdicts:?}");
    assert_eq!(repair(&path).unwrap(), Repaired::Whole);
}

#[test]
fn what_is_no_recording_is_refused_by_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let missing = RecordingReader::open(&folder.path().join("none.mcap")).map(|_| ()).unwrap_err();
    assert!(missing.to_string().contains("give a recording (.mcap)"), "{missing}");
    let a_folder = RecordingReader::open(folder.path()).map(|_| ()).unwrap_err();
    assert!(a_folder.to_string().contains("it is no file"), "{a_folder}");

    let bytes = write(&items(1));
    let replaced = |from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut other = bytes.clone();
        other[at..at + to.len()].copy_from_slice(to.as_bytes());
        other
    };
    let layout = format!("{:016x}", Channel::Detections.layout());
    for (bytes, words) in [
        (Vec::new(), "run.mcap: the file is empty"),
        (bytes[..7].to_vec(), "run.mcap: the file has 7 of the 8 bytes"),
        (b"ftypisom, a film and no recording at all".to_vec(), "run.mcap: this is no MCAP file"),
        (bytes[..20].to_vec(), "run.mcap: the file is cut before its first whole record"),
        (replaced("andon-1", "ros2   "), "an MCAP file of \"andon-record"),
        (replaced("andon-1", "andon-2"), "a recording in the arrangement \"andon-2\""),
    ] {
        let error = read(&bytes).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let error = read(&with_layout("0123456789abcdef")).map(|_| ()).unwrap_err();
    assert!(matches!(error, ReadError::OtherLayout { channel: Channel::Detections, .. }), "{error}");
    let words =
        "its messages of the channel detections have the layout 0123456789abcdef, and this program has ";
    assert!(error.to_string().contains(words), "{error}");
    assert_eq!(read(&with_layout(&layout)).unwrap().0.len(), 1);
}

/// A recording whose detections have this layout.
fn with_layout(layout: &str) -> Vec<u8> {
    let mut mcap = mcap::WriteOptions::new()
        .profile("andon-1")
        .compression(None)
        .create(Cursor::new(Vec::new()))
        .unwrap();
    let schema = mcap.add_schema("andon.detections", "andon-layout", layout.as_bytes()).unwrap();
    let channel_id = mcap.add_channel(schema, "/raw/detections", "andon", &BTreeMap::new()).unwrap();
    let header = mcap::records::MessageHeader { channel_id, sequence: 1, log_time: 1, publish_time: 1 };
    mcap.write_to_known_channel(&header, &[0; 3096]).unwrap();
    mcap.finish().unwrap();
    mcap.into_inner().into_inner()
}

/// A seed that each run draws and prints; `ANDON_SEED=n` repeats one.
fn seed() -> u64 {
    let drawn = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let seed = std::env::var("ANDON_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(drawn % 100_000);
    println!("ANDON_SEED={seed}");
    seed
}

/// The same recording without checksums of its chunks, as other writers leave them: what is damaged in a chunk is read.
fn without_checksums(bytes: &[u8]) -> Vec<u8> {
    let mut without = bytes.to_vec();
    for chunk in chunks(bytes) {
        without[chunk + HEAD..][24..28].fill(0);
    }
    without
}

/// A record is a byte for its kind, its length in eight bytes, and its content. That of a chunk begins with two times and its length.
const HEAD: usize = 9;
const CHUNK: u8 = 6;

/// Where the chunks of a recording begin.
fn chunks(bytes: &[u8]) -> Vec<usize> {
    let (mut chunks, mut at) = (Vec::new(), mcap::MAGIC.len());
    while let Some(length) = bytes.get(at + 1..at + HEAD) {
        if bytes[at] == CHUNK {
            chunks.push(at);
        }
        at += HEAD + u64::from_le_bytes(length.try_into().unwrap()) as usize;
    }
    chunks
}

#[test]
fn a_chunk_within_a_chunk_is_none_and_the_rest_of_the_outer_one_is_read() {
    let mut bytes = without_checksums(&write(&items(2)));
    let whole = read(&bytes).unwrap();
    let outer = chunks(&bytes)[0];
    // Two times, a length, a checksum, no compression, and nothing in it.
    let inner = [&[CHUNK][..], &40_u64.to_le_bytes(), &[0; 40]].concat();
    for length in [outer + 1, outer + HEAD + 16, outer + HEAD + 32] {
        let longer = u64::from_le_bytes(bytes[length..length + 8].try_into().unwrap()) + inner.len() as u64;
        bytes[length..length + 8].copy_from_slice(&longer.to_le_bytes());
    }
    let first = outer + HEAD + 40;
    bytes.splice(first..first, inner);
    assert_eq!(read(&bytes).unwrap(), whole);
}

#[test]
fn whatever_is_done_to_a_file_it_is_read_or_refused() {
    let cases: u32 = std::env::var("ANDON_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(300);
    let mut draw = oorandom::Rand64::new(seed().into());
    let with = write(&items(2));
    let without = without_checksums(&with);
    assert_eq!(read(&with).unwrap(), read(&without).unwrap());
    for _ in 0..cases {
        let mut damaged = if draw.rand_range(0..2) == 0 { with.clone() } else { without.clone() };
        for _ in 0..draw.rand_range(1..6) {
            if damaged.is_empty() {
                break;
            }
            let at = draw.rand_range(0..damaged.len() as u64) as usize;
            // Lengths and kinds of records lie at the start of the file and of each chunk. Half of the damage is done to the start.
            let at = if draw.rand_range(0..2) == 0 { at % 4096.min(damaged.len()) } else { at };
            match draw.rand_range(0..4) {
                0 => damaged[at] = draw.rand_u64() as u8,
                1 => damaged[at] ^= 1 << draw.rand_range(0..8),
                2 => damaged.truncate(at),
                _ => {
                    let end = (at + draw.rand_range(1..64) as usize).min(damaged.len());
                    damaged.drain(at..end);
                }
            }
        }
        match read(&damaged) {
            Ok((items, _)) => assert!(items.len() <= 100),
            Err(error) => assert!(error.to_string().starts_with("run.mcap: "), "{error}"),
        }
    }
}
