//! The kinds of values that a key can have: which values are allowed, and how they are read and written.

use std::fmt::{Debug, Display};
use std::net::IpAddr;
use std::path::{Path, PathBuf};

use andon_ipc::is_station_name;
use shm_schemas::STATION_BYTES;
use toml::de::DeValue;

/// A kind of value.
pub(super) trait Value: Sized {
    /// What restricts it, such as a range.
    type Limit;

    /// What is allowed, so that it completes "must be ...".
    fn allowed(limit: &Self::Limit) -> String;

    /// The value, or `None` where `raw` is not allowed. `folder` is the folder of the file, absolute.
    fn read(raw: &DeValue<'_>, limit: &Self::Limit, folder: &Path) -> Option<Self>;

    /// The value as TOML.
    fn write(&self) -> String;

    /// What was probably meant by a value that is not allowed.
    fn meant(_raw: &DeValue<'_>, _limit: &Self::Limit) -> Option<String> {
        None
    }

    /// All words that are allowed, where the value is one of several words.
    fn words() -> Vec<&'static str> {
        Vec::new()
    }
}

/// An inclusive range with its unit; the unit is empty for a count.
pub(super) struct Within<T> {
    min: T,
    max: T,
    unit: &'static str,
    /// Why it begins where it begins, if that is a surprise.
    reason: &'static str,
}

/// From `min` to `max`, both included.
pub(super) fn within<T>(min: T, max: T, unit: &'static str) -> Within<T> {
    Within { min, max, unit, reason: "" }
}

/// As [`within`], for a count that begins at `min` for this reason.
pub(super) fn counted_within<T>(min: T, max: T, reason: &'static str) -> Within<T> {
    Within { min, max, unit: "", reason }
}

impl<T: Debug + PartialOrd> Within<T> {
    fn describe(&self, kind: &str) -> String {
        let space = if self.unit.is_empty() { "" } else { " " };
        let reason = if self.reason.is_empty() { String::new() } else { format!(" ({})", self.reason) };
        format!("{kind} from {:?} to {:?}{space}{}{reason}", self.min, self.max, self.unit)
    }

    fn hold(&self, value: T) -> Option<T> {
        (value >= self.min && value <= self.max).then_some(value)
    }
}

macro_rules! whole_number {
    ($($kind:ty),*) => {$(
        impl Value for $kind {
            type Limit = Within<$kind>;

            fn allowed(limit: &Self::Limit) -> String {
                limit.describe("a whole number")
            }

            fn read(raw: &DeValue<'_>, limit: &Self::Limit, _: &Path) -> Option<Self> {
                let integer = raw.as_integer()?;
                limit.hold(<$kind>::from_str_radix(integer.as_str(), integer.radix()).ok()?)
            }

            fn write(&self) -> String {
                self.to_string()
            }
        }
    )*};
}
whole_number!(u8, u16, u32);

impl Value for f32 {
    type Limit = Within<f32>;

    fn allowed(limit: &Self::Limit) -> String {
        limit.describe("a number")
    }

    fn read(raw: &DeValue<'_>, limit: &Self::Limit, _: &Path) -> Option<Self> {
        let text = raw.as_float().map(|f| f.as_str()).or_else(|| {
            let integer = raw.as_integer()?;
            (integer.radix() == 10).then(|| integer.as_str())
        })?;
        limit.hold(text.parse().ok()?)
    }

    /// Lengths are in metres; who writes them in millimetres is shown what they are.
    fn meant(raw: &DeValue<'_>, limit: &Self::Limit) -> Option<String> {
        let millimetres = Self::read(raw, &within(limit.max, f32::MAX, ""), Path::new(""))?;
        let metres = limit.hold(millimetres / 1000.0).filter(|_| limit.unit == "m")?;
        Some(metres.to_string())
    }

    fn write(&self) -> String {
        format!("{self:?}")
    }
}

impl Value for bool {
    type Limit = ();

    fn allowed((): &()) -> String {
        "true or false".into()
    }

    fn read(raw: &DeValue<'_>, (): &(), _: &Path) -> Option<Self> {
        raw.as_bool()
    }

    fn write(&self) -> String {
        self.to_string()
    }
}

/// What a text may consist of.
pub(super) enum Text {
    /// What is safe in the name of a file, a unit and a service.
    Name,
    /// Any text on one line.
    Line,
    /// The name of a machine on a network.
    Host,
}

/// Longest text, in characters.
const TEXT_CHARACTERS: usize = 32;

/// Longest name of a machine, in characters (RFC 1035).
const HOST_CHARACTERS: usize = 253;

impl Value for String {
    type Limit = Text;

    fn allowed(limit: &Text) -> String {
        match limit {
            Text::Name => {
                format!("1 to {STATION_BYTES} of the characters a-z, 0-9 and '-', in quotes")
            }
            Text::Line => {
                format!("1 to {TEXT_CHARACTERS} characters on one line, not blanks alone, in quotes")
            }
            Text::Host => {
                format!("1 to {HOST_CHARACTERS} letters, digits, dots and dashes, in quotes")
            }
        }
    }

    fn read(raw: &DeValue<'_>, limit: &Text, _: &Path) -> Option<Self> {
        let text = raw.as_str()?;
        let fits = match limit {
            Text::Name => is_station_name(text),
            Text::Line => {
                (1..=TEXT_CHARACTERS).contains(&text.chars().count())
                    && !text.contains(char::is_control)
                    && !text.trim().is_empty()
            }
            Text::Host => {
                (1..=HOST_CHARACTERS).contains(&text.len())
                    && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b".-".contains(&byte))
            }
        };
        fits.then(|| text.to_owned())
    }

    fn write(&self) -> String {
        quoted(self)
    }
}

/// A path. A relative one starts at the folder of the file that contains it.
impl Value for PathBuf {
    type Limit = ();

    fn allowed((): &()) -> String {
        "a path in quotes".into()
    }

    fn read(raw: &DeValue<'_>, (): &(), folder: &Path) -> Option<Self> {
        let text = raw.as_str()?;
        (!text.is_empty() && !text.contains('\0')).then(|| folder.join(text))
    }

    fn write(&self) -> String {
        quoted(&self.display())
    }
}

impl Value for IpAddr {
    type Limit = ();

    fn allowed((): &()) -> String {
        "an IP address in quotes".into()
    }

    fn read(raw: &DeValue<'_>, (): &(), _: &Path) -> Option<Self> {
        raw.as_str()?.parse().ok()
    }

    fn write(&self) -> String {
        quoted(self)
    }
}

/// A point in metres.
impl Value for [f32; 3] {
    type Limit = Within<f32>;

    fn allowed(limit: &Self::Limit) -> String {
        format!("[x, y, z], each {}", f32::allowed(limit))
    }

    fn read(raw: &DeValue<'_>, limit: &Self::Limit, folder: &Path) -> Option<Self> {
        let [x, y, z] = raw.as_array()?.get(..)? else { return None };
        let axis = |raw: &toml::Spanned<DeValue<'_>>| f32::read(raw.get_ref(), limit, folder);
        Some([axis(x)?, axis(y)?, axis(z)?])
    }

    fn write(&self) -> String {
        format!("{self:?}")
    }
}

/// A point in pixels.
impl Value for [u32; 2] {
    type Limit = Within<u32>;

    fn allowed(limit: &Self::Limit) -> String {
        format!("[x, y], each {}", u32::allowed(limit))
    }

    fn read(raw: &DeValue<'_>, limit: &Self::Limit, folder: &Path) -> Option<Self> {
        let [x, y] = raw.as_array()?.get(..)? else { return None };
        let axis = |raw: &toml::Spanned<DeValue<'_>>| u32::read(raw.get_ref(), limit, folder);
        Some([axis(x)?, axis(y)?])
    }

    fn write(&self) -> String {
        format!("{self:?}")
    }
}

/// How many, and of what.
pub(super) struct Several<L> {
    min: usize,
    max: usize,
    each: L,
}

/// From `min` to `max` values, each within `each`.
pub(super) fn several<L>(min: usize, max: usize, each: L) -> Several<L> {
    Several { min, max, each }
}

impl<T: Value> Value for Vec<T> {
    type Limit = Several<T::Limit>;

    fn allowed(limit: &Self::Limit) -> String {
        format!("a list of {} to {}, each {}", limit.min, limit.max, T::allowed(&limit.each))
    }

    fn read(raw: &DeValue<'_>, limit: &Self::Limit, folder: &Path) -> Option<Self> {
        let array = raw.as_array()?;
        if !(limit.min..=limit.max).contains(&array.len()) {
            return None;
        }
        array.iter().map(|raw| T::read(raw.get_ref(), &limit.each, folder)).collect()
    }

    fn write(&self) -> String {
        let items: Vec<String> = self.iter().map(T::write).collect();
        format!("[{}]", items.join(", "))
    }

    fn words() -> Vec<&'static str> {
        T::words()
    }
}

fn quoted(text: &impl Display) -> String {
    toml::Value::String(text.to_string()).to_string()
}

/// `"a", "b" or "c"`.
pub(super) fn one_of(words: &[&str]) -> String {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let between = match words.len() - index {
            _ if index == 0 => "",
            1 => " or ",
            _ => ", ",
        };
        text.push_str(between);
        text.push_str(&quoted(word));
    }
    text
}

/// Makes a key of a type that is a choice of words. It is a type whose values name themselves, of which `$all` is an iterable, or an enum with a word
/// for each variant.
macro_rules! words {
    ($kind:ty, $all:expr, $name:expr) => {
        impl $crate::config::value::Value for $kind {
            type Limit = ();

            fn allowed((): &()) -> String {
                $crate::config::value::one_of(&Self::words())
            }

            fn read(raw: &toml::de::DeValue<'_>, (): &(), _: &std::path::Path) -> Option<Self> {
                let text = raw.as_str()?;
                $all.into_iter().find(|value| $name(*value) == text)
            }

            fn write(&self) -> String {
                format!("{:?}", $name(*self))
            }

            fn words() -> Vec<&'static str> {
                $all.into_iter().map($name).collect()
            }
        }
    };
    ($kind:ty { $($variant:path = $word:literal),+ $(,)? }) => {
        $crate::config::value::words!(
            $kind,
            [$($variant),+],
            |value: $kind| match value { $($variant => $word,)+ }
        );
    };
}
pub(super) use words;
