//! Numbers on the wire that stand for words, and the checked way back.

use core::fmt;

/// A number that stands for no word of its list: the message comes from another build, or from damaged memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownCode {
    /// The list, as its Rust name.
    pub list: &'static str,
    /// The number.
    pub code: u32,
}

impl fmt::Display for UnknownCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is no {}: writer and reader are different builds", self.code, self.list)
    }
}

impl core::error::Error for UnknownCode {}

/// Declares an enum that travels as an integer, with a checked conversion back.
///
/// Zero is left out wherever it would be a meaning, so that zeroed memory is never taken for a message.
macro_rules! codes {
    ($(#[$doc:meta])* enum $name:ident: $int:ident { $( $(#[$word_doc:meta])* $word:ident = $code:literal, )* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr($int)]
        pub enum $name { $( $(#[$word_doc])* $word = $code, )* }

        impl $name {
            /// Every word, in the order of the numbers.
            pub const ALL: &[Self] = &[$( Self::$word, )*];

            /// The number on the wire.
            pub const fn code(self) -> $int {
                self as $int
            }

            /// The word as it is written in logs and JSON.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$word => stringify!($word), )* }
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
    use crate::{UnknownCode, VerdictKind, VerdictReason};

    #[test]
    fn every_word_comes_back_from_its_number() {
        for &kind in VerdictKind::ALL {
            assert_eq!(VerdictKind::try_from(kind.code()), Ok(kind));
        }
        for &reason in VerdictReason::ALL {
            assert_eq!(VerdictReason::try_from(reason.code()), Ok(reason));
        }
    }

    #[test]
    fn a_number_without_a_word_is_an_error_that_names_its_list() {
        assert_eq!(VerdictKind::try_from(200), Err(UnknownCode { list: "VerdictKind", code: 200 }));
    }

    #[test]
    fn zeroed_memory_is_no_verdict() {
        assert!(VerdictKind::try_from(crate::Verdict::default().kind).is_err());
    }
}
