//! Track files and job files come from outside: what cannot be trusted is refused, with its place and the reason.

#![allow(clippy::unwrap_used)]

use andon_learn::file::NotText;
use andon_learn::job_file::{JobFault, JobFile};
use andon_learn::recording;

/// A track file with these parts of its header, and one frame.
fn tracks(hands: &str, objects: &str, frame: &str) -> String {
    format!(
        "{{\"format\":\"andon.tracks\",\"version\":1,\"rate_hz\":30,\"space\":\"plane\",\"landmarks\":5,\
         \"hands\":[{hands}],\"objects\":[{objects}]}}\n{frame}\n"
    )
}

/// A frame of a track file with one object and the right hand.
fn frame(frame: &str) -> String {
    tracks("\"right\"", r#"{"id":5,"interaction_points":[[0,0,0]]}"#, frame)
}

fn hand(entry: &str) -> String {
    frame(&format!("{{\"t\":0,\"hands\":[{entry}]}}"))
}

fn object(entry: &str) -> String {
    frame(&format!("{{\"t\":0,\"objects\":[{entry}]}}"))
}

#[test]
fn an_object_of_a_track_file_without_points_has_one_at_its_centre() {
    let header = tracks("", r#"{"id":5,"name":"brick"}"#, "{\"t\":0}");
    let recording = recording::read("good", header.as_bytes()).unwrap();
    assert_eq!(recording.header.objects[0].shape.interaction_points.as_slice(), [[0.0; 3]]);
}

#[test]
fn a_track_file_that_cannot_be_trusted_is_refused_with_its_line_and_the_reason() {
    const OBJECT: &str = r#"{"id":5,"p":[0,0,0],"q":[1,0,0,0]}"#;
    const HAND: &str = r#"{"id":"right","landmarks":[[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0]]}"#;
    recording::read("good", object(OBJECT).as_bytes()).unwrap();
    recording::read("good", hand(HAND).as_bytes()).unwrap();

    let nine_points = format!("{{\"id\":5,\"interaction_points\":[{}]}}", ["[0,0,0]"; 9].join(","));
    let thirty_three: Vec<_> =
        (1..=33).map(|id| format!("{{\"id\":{id},\"interaction_points\":[[0,0,0]]}}")).collect();
    let cases = [
        (String::new(), 1, "the file is empty"),
        ("{\"form".into(), 1, "the header is missing"),
        (frame("").replace("andon.tracks", "other"), 1, "the format is \"other\""),
        (frame("").replace("\"version\":1", "\"version\":2"), 1, "version 2 of the track format is unknown"),
        (frame("").replace("30", "0"), 1, "rate_hz is 0; it must be in greater than 0"),
        (frame("").replace(":5,\"hands\"", ":6,\"hands\""), 1, "\"landmarks\" is 6"),
        (tracks("\"right\",\"right\"", "", ""), 1, "the right hand occurs twice"),
        (tracks("", r#"{"id":0,"interaction_points":[[0,0,0]]}"#, ""), 1, "an object has id 0"),
        (tracks("", r#"{"id":5,"interaction_points":[]}"#, ""), 1, "object 5 has 0 interaction points"),
        (tracks("", &nine_points, ""), 1, "object 5 has 9 interaction points"),
        (tracks("", &thirty_three.join(","), ""), 1, "there are 33 objects"),
        (
            tracks("", r#"{"id":5,"interaction_points":[[0,0,1e9]]}"#, ""),
            1,
            "an interaction point of object 5 lies",
        ),
        (frame(""), 3, "no frame comes after the header"),
        (frame("{\"t\":0}").repeat(2), 3, "another recording begins here"),
        (frame("{\"t\":0}\n{\"t\":0}"), 3, "t is 0 s after 0 s"),
        (frame("{\"t\":-1}"), 2, "t is -1; it must be in 0 to 1e9 seconds"),
        (frame("{\"t\":\"now\"}"), 2, "invalid type: string \"now\", expected f64, at column 10"),
        (frame(&" ".repeat((1 << 20) + 1)), 2, "the line is longer than"),
        (hand(&HAND.replace("right", "left")), 2, "the left hand is not in the header"),
        (hand(&HAND.replace("\"id\"", "\"score\":2,\"id\"")), 2, "score is 2"),
        (hand(&HAND.replacen("[0,0,0],", "", 1)), 2, "a hand has 4 landmarks"),
        (hand(&HAND.replacen("[0,0,0]", "[0,0,1e9]", 1)), 2, "a landmark is"),
        (hand(&[HAND; 2].join(",")), 2, "the right hand occurs twice"),
        (object(&OBJECT.replace('5', "6")), 2, "object 6 is not in the header"),
        (object(&OBJECT.replace("[1,", "[2,")), 2, "q of object 5 has length 2"),
        (object(&[OBJECT; 2].join(",")), 2, "object 5 occurs twice"),
    ];
    for (text, line, reason) in cases {
        let error = recording::read("bad", text.as_bytes()).unwrap_err();
        assert_eq!(error.line, line, "{error}");
        assert!(error.to_string().contains(reason), "{error}: not {reason:?}");
    }
}

#[test]
fn a_job_file_that_cannot_be_used_is_refused_with_the_reason() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");
    let good = std::fs::read_to_string(path).unwrap();
    let invalid = JobFile { max_slowdown: 0.5, ..JobFile::parse(path, good.as_bytes()).unwrap() };
    let refused = |bytes: &[u8]| JobFile::parse("job.toml", bytes).unwrap_err().fault;
    assert!(matches!(refused(b"a\xff"), JobFault::NotText(NotText::Encoding(1))));
    assert!(matches!(refused(b"\0\0\0\x20ftypisom"), JobFault::NotText(NotText::Binary)));
    assert!(matches!(refused(b"\r\n"), JobFault::Empty));
    assert!(matches!(refused(b"format = "), JobFault::Toml(_)));
    assert!(matches!(refused(good.replace("andon.job", "other").as_bytes()), JobFault::Format(_)));
    assert!(matches!(
        refused(good.replacen("version = 2", "version = 99", 1).as_bytes()),
        JobFault::Version(99)
    ));
    assert!(matches!(refused(invalid.to_toml().as_bytes()), JobFault::Invalid { .. }));
}

/// Windows' editors end lines in their own way, and some put a mark before the text. Names are there to be edited.
#[test]
fn a_job_file_that_any_editor_has_saved_is_the_same_job() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");
    let good = std::fs::read_to_string(path).unwrap();
    let job = JobFile::parse(path, good.as_bytes()).unwrap();
    let crlf = good.replace('\n', "\r\n");
    for saved in [crlf.clone(), format!("\u{feff}{good}"), format!("\u{feff}{crlf}")] {
        let read = JobFile::parse("saved.toml", saved.as_bytes()).unwrap();
        assert_eq!((read.model_hash(), read.to_toml()), (job.model_hash(), good.clone()));
    }
    // As a word processor saves the names that were changed.
    let (before, names) = good.split_once("[names]").unwrap();
    let quoted = names.replacen("\"", "\u{201c}", 1).replacen("\"", "\u{201d}", 1);
    let said =
        JobFile::parse("saved.toml", format!("{before}[names]{quoted}").as_bytes()).unwrap_err().to_string();
    assert!(said.contains("where a straight \" is meant"), "{said}");
    let utf16: Vec<u8> = good.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let said = JobFile::parse("saved.toml", &utf16).unwrap_err().to_string();
    assert!(said.contains("UTF-16") && said.contains("save it as UTF-8"), "{said}");
}

const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");

/// A job file with the checksum of its text.
fn sealed(text: &str) -> String {
    let JobFault::Checksum { stated, computed } =
        JobFile::parse("old.toml", text.as_bytes()).unwrap_err().fault
    else {
        unreachable!("the checksum covers all of it");
    };
    text.replacen(&stated, &computed, 1)
}

/// A job that was taught when a short time at no other part was wrong is read as one without that rule.
#[test]
fn a_job_file_with_a_minimum_of_the_duration_is_still_read() {
    let new = std::fs::read_to_string(SHIPPED).unwrap();
    let old = sealed(&new.replacen("bounds = { max", "bounds = { min_duration = 0.55, max", 1));
    let read = JobFile::parse("old.toml", old.as_bytes()).unwrap();
    assert_eq!(JobFile { older: None, ..read }.to_toml(), new);
}

/// A PLC selects a job by its hash, which covers keys and comments as well, and a recording has it by that hash.
#[test]
fn a_job_in_the_words_of_an_older_build_keeps_its_text_and_its_hash_until_it_is_changed() {
    let new = std::fs::read_to_string(SHIPPED).unwrap();
    let old = sealed(&new.replacen("do not edit the file, teach", "do not edit this file: teach", 1));
    let stated = old.split_once("sha256:").unwrap().1;
    let hash = u64::from_str_radix(&stated[..16], 16).unwrap();
    let read = JobFile::parse("old.toml", old.as_bytes()).unwrap();
    assert_eq!((read.model_hash(), read.to_toml()), (hash, old));
    let named = JobFile { step_names: vec!["polish".to_owned(), "measure".to_owned()], ..read.clone() };
    let again = JobFile::parse("named.toml", named.to_toml().as_bytes()).unwrap();
    assert_eq!((again.model_hash(), again), (hash, named));
    let changed = JobFile { id: 2, ..read.clone() };
    let from_new = JobFile { id: 2, ..JobFile::parse(SHIPPED, new.as_bytes()).unwrap() };
    assert_eq!(changed.to_toml(), from_new.to_toml());
    assert_ne!(changed.model_hash(), hash);
}

#[test]
fn the_shipped_job_is_in_the_words_of_this_build() {
    let job = JobFile::parse(SHIPPED, &std::fs::read(SHIPPED).unwrap()).unwrap();
    assert_eq!(job.older, None, "a word of the job file has changed");
}

/// A track file of two seconds at 30 Hz as a tracker of this kind writes it. A hand moves and a part turns in it.
fn tracked(write: impl Fn(f64, [f64; 3], [f64; 4]) -> (String, String, String)) -> String {
    let lines = (0..60).map(|frame| {
        let t = f64::from(frame) / 30.0;
        let half_turn = 0.2 + 0.3 * t;
        let q = [half_turn.cos(), 0.0, 0.0, half_turn.sin()];
        let (t, p, q) = write(t, [0.1 + 0.05 * t, 0.2, 0.0], q);
        let tip = p.replace("0.2", "0.38").replace("200", "380");
        let hand = format!("{{\"id\":\"right\",\"landmarks\":[{p},{tip},{p},{tip},{tip}]}}");
        format!("{{\"t\":{t},\"hands\":[{hand}],\"objects\":[{{\"id\":5,\"p\":{p},\"q\":{q}}}]}}\n")
    });
    let lines: String = lines.collect();
    tracks("\"right\"", r#"{"id":5}"#, lines.trim_end())
}

fn list<const N: usize>(numbers: [f64; N]) -> String {
    format!("[{}]", numbers.map(|number| number.to_string()).join(","))
}

#[test]
fn what_another_tracker_writes_is_read_where_it_is_certain() {
    let plain = tracked(|t, p, q| (t.to_string(), list(p), list(q)));
    let expected = recording::read("plain", plain.as_bytes()).unwrap().frames;
    assert_eq!(expected.len(), 60);
    let with_mark = format!("\u{feff}{}", plain.replace('\n', "\r\n"));
    assert_eq!(recording::read("mark", with_mark.as_bytes()).unwrap().frames, expected);
    let since_1970 = tracked(|t, p, q| (format!("{:.6}", 1.7e9 + t), list(p), list(q)));
    let times: Vec<u64> = recording::read("1970", since_1970.as_bytes())
        .unwrap()
        .frames
        .iter()
        .map(|frame| (frame.captured_ns + 500_000) / 1_000_000)
        .collect();
    assert_eq!(times[..4], [0, 33, 67, 100]);
    // Most frames are missing, and most that came are a second apart.
    let sparse = |t: f64| (t * 30.0).round() - 0.5 * (t * 10.0 + 0.01).floor();
    let sparse = tracked(|t, p, q| (sparse(t).to_string(), list(p), list(q)));
    assert_eq!(recording::read("sparse", sparse.as_bytes()).unwrap().frames.len(), 60);
}

/// Python writes NaN where nothing was seen, and other programs null.
#[test]
fn a_part_or_a_hand_without_a_place_was_not_seen() {
    for gap in ["null", "[null,null,null]", "[NaN,NaN,NaN]", "[0.1,nan,-NaN]"] {
        let text = tracked(|t, p, q| {
            (t.to_string(), if t > 0.5 && t < 1.0 { gap.to_owned() } else { list(p) }, list(q))
        });
        let frames = recording::read("gap", text.as_bytes()).unwrap().frames;
        let without = |frame: &&andon_core::input::Frame| frame.hands.is_empty() && frame.objects.is_empty();
        assert_eq!((frames.len(), frames.iter().filter(without).count()), (60, 14), "{gap}");
    }
    let name = tracked(|t, p, q| (t.to_string(), list(p), list(q)))
        .replace("{\"id\":5}", "{\"id\":5,\"name\":\"a NaN \\\" nan\"}");
    assert_eq!(recording::read("name", name.as_bytes()).unwrap().header.objects[0].name, "a NaN \" nan");
}

#[test]
fn what_another_tracker_means_by_its_numbers_is_refused_by_its_name() {
    let scaled = |p: [f64; 3], factor: f64| list(p.map(|metres| (metres * factor * 1e6).round() / 1e6));
    let cases = [
        (tracked(|t, p, q| (t.to_string(), scaled(p, 1000.0), list(q))), "millimetres; divide them by 1000"),
        (tracked(|t, p, q| ((t * 1e3).to_string(), list(p), list(q))), "milliseconds; divide it by 1000"),
        (
            tracked(|t, p, q| ((t * 1e9).to_string(), list(p), list(q))),
            "nanoseconds; divide it by 1000000000",
        ),
        (tracked(|t, p, q| ((1.7e12 + t * 1e3).to_string(), list(p), list(q))), "milliseconds"),
        (tracked(|t, p, q| ((t * 30.0).round().to_string(), list(p), list(q))), "frames; divide it by 30"),
        (
            tracked(|t, [x, ..], q| {
                let height = if t > 1.0 { 0.2 } else { 0.29 };
                (t.to_string(), list([x, 0.0, height]), list(q))
            }),
            "write [x, z, y]",
        ),
        (tracked(|t, p, [w, x, y, z]| (t.to_string(), list(p), list([x, y, z, w]))), "x, y, z, w"),
        (
            tracked(|t, p, q| {
                (t.to_string(), if t > 1.0 { "[Infinity,0,0]".to_owned() } else { list(p) }, list(q))
            }),
            "write null",
        ),
        (
            tracked(|t, p, q| (t.to_string(), list(p), list(q)))
                .replace("{\"id\":5}", "{\"id\":5,\"interaction_points\":[[104,0,0]]}"),
            "points are in metres",
        ),
    ];
    for (text, said) in cases {
        let error = recording::read("other", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(said), "{error}: not {said:?}");
    }
    let utf16: Vec<u8> = tracked(|t, p, q| (t.to_string(), list(p), list(q)))
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let error = recording::read("other", &utf16).unwrap_err().to_string();
    assert!(error.contains("UTF-16") && error.contains("save it as UTF-8"), "{error}");
}

#[test]
fn a_text_that_is_no_track_file_is_called_what_it_is() {
    let good = frame("{\"t\":0}");
    let lines: Vec<&str> = good.lines().collect();
    let cases = [
        (format!("[{}]", lines.join(",\n")), "it is one list in JSON"),
        (good.replace("{\"form", "{\n  \"form"), "an object goes over several lines"),
        (good.replace('"', "'"), "json.dumps"),
        (format!("{},\n", lines.join(",\n")), "a comma stands at the end of a line"),
        (good.replace("30,", "30,0,"), "key must be a string, at column"),
        (good.replace('\n', "\r"), "carriage return alone"),
        ("t,id,x,y,z\n0,5,0.1,0.2,0\n".to_owned(), "a table (CSV)"),
    ];
    for (text, said) in cases {
        let error = recording::read("other", text.as_bytes()).unwrap_err();
        assert!(error.line == 1 && error.to_string().contains(said), "{error}: not {said:?}");
    }
    let packed = recording::read("other", b"\x1f\x8b\x08\0 and so on").unwrap_err().to_string();
    assert!(packed.contains("gunzip"), "{packed}");
}
