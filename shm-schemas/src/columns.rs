//! The values of a verdict as a table: what each is called, and how its number is meant.
//!
//! It is made of [`verdict_fields`](crate::verdict_fields). What writes verdicts down goes through it: the columns of the journal, its rows and their
//! way back, CSV, and [`Verdict::NONE`]. What has no meaning in a verdict is [`Value::None`] there, whatever number stands for it on the wire.
//!
//! Two outputs have more to say of a value than its name and kind, and name it themselves. A table of that would be longer than they are. JSON nests
//! values, leaves some out where they say nothing, and names objects and steps. A replay writes it of the method's own verdict, without a wire. A
//! register has an address that never changes, a unit without fractions, and a meaning for who programs a controller. The time of a verdict is two of
//! them. A test of `andond`, `verdict_columns`, holds both to this table.

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
pub struct Column<M = Verdict> {
    /// Its name, in the journal and, but for the unit of times, in CSV.
    pub name: &'static str,
    /// Reads it.
    pub get: for<'m> fn(&'m M) -> Value<'m>,
    /// Writes it. A value that does not fit becomes none.
    pub set: fn(&mut M, Value<'_>),
}

impl<M> Column<M> {
    /// In a place that no column has taken yet.
    const FREE: Self = Self { name: "", get: |_| Value::None, set: |_, _| () };
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
    ($list:ident $to:expr, $value:expr) => { $to = code($value, |text| $list::named(text).map($list::code)) };
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

macro_rules! name {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $name:ident) => {
        stringify!($name)
    };
}

/// Makes the table of a list of fields, and the message in which nothing has a meaning.
macro_rules! columns_of_fields {
    ($type_name:literal, $bytes:literal, filled up by $filling:ident: $filling_ty:ty; $(#[$doc:meta])+ struct $message:ident $( $group:ident {
        $( $(#[$field_doc:meta])+ $field:ident: $ty:ty { $( $place:literal $kind:ident $($name:ident($($part:tt)+))? ),+ } )+
    } )+) => {
        /// The table, in the order in which it is read.
        pub const COLUMNS: &[Column<$message>] = &{
            let mut columns = [Column::<$message>::FREE; [$( $( $( $place, )+ )+ )+].len()];
            $( $( $( columns[$place] = Column::<$message> {
                name: name!($field $($name)?),
                get: |message| get!($kind message.$field $($($part)+)?),
                set: |message, value| set!($kind message.$field $($($part)+)?, value),
            }; )+ )+ )+
            columns
        };

        impl $message {
            /// One in which nothing has a meaning: what is read before the first one.
            pub const NONE: Self = {
                let mut message = <Self as Layout>::ZERO;
                $( $( $( none!($kind message.$field $($($part)+)?); )+ )+ )+
                message
            };
        }

        const _: () = {
            let in_columns = 0 $( $( $( + size_of_val(&$message::NONE.$field $($($part)+)?) )+ )+ )+;
            assert!(in_columns + size_of::<$filling_ty>() == $bytes, "a part of a field has no column, or two");
            let mut place = 0;
            while place < COLUMNS.len() {
                assert!(!COLUMNS[place].name.is_empty(), "a place has two columns, and another none");
                place += 1;
            }
        };
    };
}

crate::verdict_fields!(columns_of_fields);

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, unreachable_pub)] // the macros make public items
    use super::*;
    use crate::layout::wire_of_fields;

    /// A message of three fields, each of which is one row of a list.
    mod row {
        use super::*;

        macro_rules! fields {
            ($to:ident) => {
                $to! { "test.Count", 8, filled up by reserved: [u8; 1];
                    /// A count.
                    struct Count
                    all {
                        /// How many.
                        count: u32 { 1 whole }
                        /// Of which part.
                        index: u16 { 0 index }
                        /// The share.
                        share: u8 { 2 percent }
                    }
                }
            };
        }
        fields!(wire_of_fields);
        fields!(columns_of_fields);
    }

    #[test]
    fn a_row_of_the_list_makes_a_field_on_the_wire_a_column_and_what_stands_for_none() {
        let [index, count, share] = row::COLUMNS else { unreachable!("three rows") };
        assert_eq!([index.name, count.name, share.name], ["index", "count", "share"]);
        let mut message = row::Count::NONE;
        assert_eq!((message.count, message.index, message.share), (0, NO_INDEX, NO_PERCENT));
        (share.set)(&mut message, Value::Whole(40));
        assert_eq!(((share.get)(&message), (index.get)(&message)), (Value::Whole(40), Value::None));
        assert_eq!(message.share, 40);
    }

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
