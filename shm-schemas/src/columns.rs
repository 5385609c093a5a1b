//! The values of a verdict as a table: what each is called, and how its number is meant.
//!
//! It is declared once, and whoever writes verdicts down goes through it: the rows of the journal and their way back, CSV, and [`Verdict::NONE`].
//! What has no meaning in a verdict is [`Value::None`] there, whatever number stands for it on the wire.
//!
//! Three outputs have more to say of a value than its name and kind. A table of that would be longer than they are. JSON nests values, and names
//! objects and steps. A register has an address that never changes, and a meaning for who programs a controller. The struct for C must stand in the
//! source with its comments, because the generator of the header reads it there. A test of `andond`, `verdict_columns`, holds all three to this
//! table.

use crate::layout::Layout;
use crate::part::PartId;
use crate::verdict::{
    HandCode, NO_INDEX, NO_PERCENT, OrderFault, STATION_BYTES, Verdict, VerdictLevel, VerdictMeasure,
    VerdictNote, VerdictOutcome, VerdictReason,
};

/// One value of a verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'v> {
    /// It has no meaning in this verdict.
    None,
    /// A whole number.
    Whole(u64),
    /// A number of 64 bits that is written in hexadecimal digits.
    Hash(u64),
    /// A time in nanoseconds of source time.
    Time(u64),
    /// A number.
    Number(f32),
    /// A word of a list.
    Word(&'static str),
    /// A number that is in no list of this build.
    Unknown(u8),
    /// A text.
    Text(&'v str),
}

/// A column of the table.
pub struct Column {
    /// Its name, in the journal and, but for the unit of times, in CSV.
    pub name: &'static str,
    /// Reads it.
    pub get: for<'v> fn(&'v Verdict) -> Value<'v>,
    /// Writes it. A value that does not fit becomes none.
    pub set: fn(&mut Verdict, Value<'_>),
}

/// How the numbers of a kind become values, and come back.
macro_rules! get {
    (whole $number:expr) => {
        Value::Whole($number.into())
    };
    (long $number:expr) => {
        Value::Whole($number)
    };
    (hash $number:expr) => {
        Value::Hash($number)
    };
    (time $number:expr) => {
        Value::Time($number)
    };
    (object $number:expr) => {
        if $number == 0 { Value::None } else { Value::Whole($number.into()) }
    };
    (index $number:expr) => {
        if $number == NO_INDEX { Value::None } else { Value::Whole($number.into()) }
    };
    (percent $number:expr) => {
        if $number == NO_PERCENT { Value::None } else { Value::Whole($number.into()) }
    };
    (number $number:expr) => {
        if $number.is_nan() { Value::None } else { Value::Number($number) }
    };
    (station $bytes:expr) => {
        Value::Text(station(&$bytes))
    };
    (part $id:expr) => {
        Value::Text($id.text())
    };
    ($list:ident $number:expr) => {
        $list::try_from($number).map_or(Value::Unknown($number), |word| Value::Word(word.name()))
    };
}

macro_rules! set {
    (whole $to:expr, $value:expr) => { $to = whole($value).and_then(|number| number.try_into().ok()).unwrap_or_default() };
    (long $to:expr, $value:expr) => { $to = whole($value).unwrap_or_default() };
    (hash $to:expr, $value:expr) => { $to = whole($value).unwrap_or_default() };
    (time $to:expr, $value:expr) => { $to = whole($value).unwrap_or_default() };
    (object $to:expr, $value:expr) => { set!(whole $to, $value) };
    (index $to:expr, $value:expr) => { $to = whole($value).and_then(|number| number.try_into().ok()).unwrap_or(NO_INDEX) };
    (percent $to:expr, $value:expr) => { $to = whole($value).and_then(|number| number.try_into().ok()).unwrap_or(NO_PERCENT) };
    (number $to:expr, $value:expr) => { $to = if let Value::Number(number) = $value { number } else { f32::NAN } };
    (station $to:expr, $value:expr) => { $to = station_bytes($value) };
    (part $to:expr, $value:expr) => { $to = part($value) };
    ($list:ident $to:expr, $value:expr) => { $to = code($value, |text| {
        $list::ALL.iter().find(|word| word.name() == text).map(|word| word.code())
    }) };
}

/// What stands for none on the wire: of most kinds it is 0.
macro_rules! none {
    (index $to:expr) => {
        $to = NO_INDEX
    };
    (percent $to:expr) => {
        $to = NO_PERCENT
    };
    (number $to:expr) => {
        $to = f32::NAN
    };
    ($kind:ident $to:expr) => {};
}

fn whole(value: Value<'_>) -> Option<u64> {
    match value {
        Value::Whole(number) | Value::Hash(number) | Value::Time(number) => Some(number),
        _ => None,
    }
}

/// The number of a word; a text that is no word of this build may be a number.
fn code(value: Value<'_>, known: impl Fn(&str) -> Option<u8>) -> u8 {
    match value {
        Value::Unknown(code) => code,
        Value::Word(text) | Value::Text(text) => {
            known(text).or_else(|| text.parse().ok()).unwrap_or_default()
        }
        _ => 0,
    }
}

/// The name, without the zeros behind it. It is ASCII.
fn station(bytes: &[u8; STATION_BYTES]) -> &str {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(STATION_BYTES);
    core::str::from_utf8(&bytes[..end]).unwrap_or_default()
}

fn station_bytes(value: Value<'_>) -> [u8; STATION_BYTES] {
    let mut bytes = [0; STATION_BYTES];
    if let Value::Text(text) = value {
        for (to, from) in bytes.iter_mut().zip(text.bytes()) {
            *to = from;
        }
    }
    bytes
}

/// The part id; whatever else another program has put there counts as none.
fn part(value: Value<'_>) -> PartId {
    if let Value::Text(text) = value {
        PartId::new(text.as_bytes()).unwrap_or(PartId::NONE)
    } else {
        PartId::NONE
    }
}

macro_rules! columns {
    ($( $kind:ident $name:ident: ($($path:tt)+); )+) => {
        /// The table, in the order in which it is read.
        pub const COLUMNS: &[Column] = &[ $( Column {
            name: stringify!($name),
            get: |verdict| get!($kind verdict.$($path)+),
            set: |verdict, value| set!($kind verdict.$($path)+, value),
        } ),+ ];

        impl Verdict {
            /// A verdict in which nothing has a meaning: what is read before the first one.
            pub const NONE: Self = {
                let mut verdict = <Self as Layout>::ZERO;
                $( none!($kind verdict.$($path)+); )+
                verdict
            };
        }

        /// What every field on the wire takes, but for those that only fill it.
        const BYTES: usize = 0 $( + size_of_val(&Verdict::NONE.$($path)+) )+;
    };
}

columns! {
    VerdictLevel level: (level);
    VerdictOutcome outcome: (outcome);
    VerdictReason reason: (reason);
    HandCode hand: (hand);
    station station: (station);
    whole job_id: (job_id);
    hash model_hash: (model_hash);
    index activity: (activity);
    index iu: (iu);
    index nearest: (nearest);
    whole x_c0: (x_c[0]);
    whole x_c1: (x_c[1]);
    whole x_c2: (x_c[2]);
    whole x_c3: (x_c[3]);
    number distance: (distance);
    number threshold: (threshold);
    whole early: (early);
    VerdictNote note: (note);
    OrderFault broken: (broken);
    index broken_activity: (broken_activity);
    whole broken_runs: (broken_runs);
    VerdictMeasure measure: (measure);
    number measured: (measured);
    number shown_min: (shown_min);
    number shown_max: (shown_max);
    percent captured_percent: (captured_percent);
    percent seen_percent: (seen_percent);
    HandCode missing_hand: (missing_hand);
    object missing_object: (missing_object);
    number missing_s: (missing_s);
    percent missing_percent: (missing_percent);
    percent needed_percent: (needed_percent);
    time began_ns: (began_ns);
    time ended_ns: (ended_ns);
    time decided_ns: (decided_ns);
    long epoch: (stamp.epoch);
    long seq: (stamp.seq);
    part part: (part);
    long decided_utc_ns: (decided_utc_ns);
    long frame_seq: (stamp.frame_seq);
    long captured_ns: (stamp.captured_ns);
    long sent_ns: (stamp.sent_ns);
}

const _: () = assert!(
    BYTES + size_of_val(&Verdict::NONE.reserved) == size_of::<Verdict>(),
    "a field of the verdict has no column, or two"
);

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A verdict in which every byte that a column has is another than in [`Verdict::NONE`].
    fn filled() -> Verdict {
        let mut verdict = Verdict::NONE;
        for (number, column) in (1_u8..).zip(COLUMNS) {
            let text = [
                Value::Text("bench1"),
                Value::Whole(number.into()),
                Value::Number(number.into()),
                Value::Unknown(99),
            ];
            for value in text {
                let mut tried = verdict;
                (column.set)(&mut tried, value);
                if (column.get)(&tried) != (column.get)(&Verdict::NONE) {
                    verdict = tried;
                }
            }
        }
        verdict
    }

    #[test]
    fn every_value_comes_back_as_it_was_and_none_touches_another() {
        let verdict = filled();
        let mut copy = Verdict::NONE;
        for column in COLUMNS {
            let value = (column.get)(&verdict);
            assert_ne!(value, (column.get)(&Verdict::NONE), "{}", column.name);
            (column.set)(&mut copy, value);
        }
        assert_eq!(copy, verdict);
    }

    #[test]
    fn what_has_no_meaning_is_none() {
        for name in ["activity", "iu", "distance", "shown_max", "seen_percent", "missing_object"] {
            let column = COLUMNS.iter().find(|column| column.name == name).unwrap();
            assert_eq!((column.get)(&Verdict::NONE), Value::None, "{name}");
            let mut verdict = filled();
            (column.set)(&mut verdict, Value::None);
            assert_eq!((column.get)(&verdict), Value::None, "{name}");
        }
    }

    #[test]
    fn a_word_is_read_by_its_name_and_a_number_that_is_none_stays() {
        let mut verdict = Verdict::NONE;
        let level = &COLUMNS[0];
        (level.set)(&mut verdict, Value::Text("activity"));
        assert_eq!((level.get)(&verdict), Value::Word("activity"));
        (level.set)(&mut verdict, Value::Text("77"));
        assert_eq!((level.get)(&verdict), Value::Unknown(77));
        (level.set)(&mut verdict, Value::Text("no word"));
        assert_eq!((level.get)(&verdict), Value::Unknown(0));
    }
}
