//! Each value of a verdict is declared once, in `verdict_fields!`. JSON and the registers name each value themselves, or it stands here as one that
//! they leave out. A value that was forgotten fails.
#![allow(clippy::unwrap_used)]

use andon_plc::registers::{CONTROL_BASE, Image, ResultBlock, WordOrder, read};
use andond::report::{Names, VerdictLine};
use andond::wire;
use shm_schemas::{COLUMNS, Column, Value, Verdict};

/// A verdict in which every column has a value.
fn filled() -> Verdict {
    let mut verdict = Verdict::NONE;
    for Column { get, set, .. } in COLUMNS {
        for value in [Value::Unknown(1), Value::Whole(1), Value::Number(1.0), Value::Text("a")] {
            let mut tried = verdict;
            set(&mut tried, value);
            if get(&tried) != get(&Verdict::NONE) {
                verdict = tried;
            }
        }
    }
    verdict
}

/// The verdict with another value in this column.
fn with_another(verdict: &Verdict, Column { name, get, set }: &Column) -> Verdict {
    let bit = if name.ends_with("_ns") { 1_000_000_000 } else { 1 };
    let value = match get(verdict) {
        Value::None => unreachable!("{name} is filled"),
        Value::Whole(number) | Value::Hash(number) | Value::Time(number) => Value::Whole(number ^ bit),
        Value::Number(number) => Value::Number(number + 1.0),
        Value::Word(_) | Value::Unknown(_) => Value::Unknown(2),
        Value::Text(_) => Value::Text("b"),
    };
    let mut other = *verdict;
    set(&mut other, value);
    other
}

fn json(verdict: &Verdict) -> String {
    let of_method = wire::verdict::read(verdict).unwrap();
    let names = Names::new([]);
    serde_json::to_string(&VerdictLine::new(verdict.stamp.seq, &of_method, &verdict.part, &names, None))
        .unwrap()
}

fn registers(verdict: &Verdict) -> String {
    let result = ResultBlock { sequence: 1, outcome: verdict.outcome.into(), verdict: *verdict };
    let image = Image { result: Some(result), ..Image::default() };
    format!("{:?}", read(&image, WordOrder::Big, 0, CONTROL_BASE).unwrap())
}

/// The name of an output, what it shows of a verdict, and the names of the values that it leaves out.
type Output<'a> = (&'a str, &'a dyn Fn(&Verdict) -> String, [&'a [&'a str]; 4]);

#[test]
fn each_value_of_a_verdict_is_shown_in_each_output_or_left_out_by_name() {
    let on_machine = ["frame_seq", "captured_ns", "sent_ns"];
    // JSON comes from one station and one job. A result on the registers has the key of its row in the journal, which has the rest.
    let of_station = ["station", "job_id", "model_hash", "epoch", "decided_utc_ns"];
    let in_row =
        ["station", "broken", "broken_activity", "broken_runs", "began_ns", "ended_ns", "decided_ns"];
    let of_frames = ["captured_percent", "seen_percent"];
    let missing = ["missing_hand", "missing_object", "missing_s", "missing_percent", "needed_percent"];
    let outputs: [Output<'_>; 2] = [
        ("JSON", &json, [&on_machine, &of_station, &[], &[]]),
        ("registers", &registers, [&on_machine, &in_row, &of_frames, &missing]),
    ];
    let verdict = filled();
    for (output, shown, left_out) in outputs {
        for column in COLUMNS {
            let is_shown = shown(&with_another(&verdict, column)) != shown(&verdict);
            assert_ne!(is_shown, left_out.concat().contains(&column.name), "{} in {output}", column.name);
        }
    }
}
