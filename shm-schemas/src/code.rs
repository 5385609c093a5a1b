//! Numbers on the wire that stand for words, and the checked way back.

use core::fmt;

/// A number without a word in its list: the message comes from another build or from damaged memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownCode {
    /// The list, as its Rust name.
    pub list: &'static str,
    /// The number.
    pub code: u32,
}

impl fmt::Display for UnknownCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is not a {}: writer and reader are different builds", self.code, self.list)
    }
}

impl core::error::Error for UnknownCode {}

/// Declares an enum that travels as an integer, with a checked conversion back.
///
/// Zero is left out wherever it would be a meaning, so that zeroed memory is never taken for a message.
///
/// In logs, JSON and CSV a word is written as its name here, or as the text after `as`. Its documentation is its meaning. A text after `formerly` is
/// what older rows of journals have for it.
macro_rules! codes {
    (@text $word:ident) => { stringify!($word) };
    (@text $word:ident $text:literal) => { $text };
    ($(#[$doc:meta])* enum $name:ident: $int:ident {
        $( $(#[doc = $word_doc:literal])* $word:ident = $code:literal $(as $text:literal)? $(formerly $former:literal)?, )*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr($int)]
        pub enum $name { $( $(#[doc = $word_doc])* $word = $code, )* }

        impl $name {
            /// Every word, in the order of the numbers.
            pub const ALL: &[Self] = &[$( Self::$word, )*];

            /// The number on the wire.
            pub const fn code(self) -> $int {
                self as $int
            }

            /// The word as it is written in logs, JSON and CSV.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$word => $crate::code::codes!(@text $word $($text)?), )* }
            }

            /// The word that is written like this, or was.
            pub fn named(text: &str) -> Option<Self> {
                let former: &[(&str, Self)] = &[$( $( ($former, Self::$word), )? )*];
                let word = Self::ALL.iter().copied().find(|word| word.name() == text);
                word.or_else(|| former.iter().find(|(name, _)| *name == text).map(|(_, word)| *word))
            }

            /// What the word means: its documentation, from which the header for C and the register map are generated.
            pub const fn meaning(self) -> &'static str {
                match self { $( Self::$word => concat!($($word_doc),*).trim_ascii(), )* }
            }
        }

        impl TryFrom<$int> for $name {
            type Error = $crate::UnknownCode;

            fn try_from(code: $int) -> Result<Self, Self::Error> {
                match code {
                    $( $code => Ok(Self::$word), )*
                    _ => Err($crate::UnknownCode { list: stringify!($name), code: u32::from(code) }),
                }
            }
        }
    };
}

pub(crate) use codes;

#[cfg(test)]
mod tests {
    use crate::{UnknownCode, Verdict, VerdictLevel, VerdictMeasure, VerdictOutcome, VerdictReason};

    #[test]
    fn every_word_comes_back_from_its_number() {
        for &level in VerdictLevel::ALL {
            assert_eq!(VerdictLevel::try_from(level.code()), Ok(level));
        }
        for &outcome in VerdictOutcome::ALL {
            assert_eq!(VerdictOutcome::try_from(outcome.code()), Ok(outcome));
        }
        for &reason in VerdictReason::ALL {
            assert_eq!(VerdictReason::try_from(reason.code()), Ok(reason));
        }
    }

    #[test]
    fn a_word_is_found_by_its_name_and_by_that_which_older_rows_have() {
        let word = VerdictMeasure::LateralDeviation;
        assert_eq!(["LateralDeviation", "Bow"].map(VerdictMeasure::named), [Some(word); 2]);
        assert_eq!((word.name(), VerdictMeasure::named("bow")), ("LateralDeviation", None));
        assert_eq!(VerdictLevel::named("iu"), Some(VerdictLevel::Iu));
    }

    #[test]
    fn the_meaning_of_a_word_is_its_documentation() {
        assert_eq!(VerdictOutcome::Ok.meaning(), "It was done right.");
    }

    #[test]
    fn a_number_without_a_word_is_an_error_that_names_its_list() {
        assert_eq!(VerdictLevel::try_from(200), Err(UnknownCode { list: "VerdictLevel", code: 200 }));
    }

    #[test]
    fn zeroed_memory_is_no_verdict() {
        assert!(Verdict::default().level().is_err());
        assert!(Verdict::default().outcome().is_err());
    }
}
