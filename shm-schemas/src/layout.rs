//! The layout of a wire type as a number, computed at compile time.

/// A type whose bytes mean the same in every process.
///
/// # Safety
/// Only plain integers, `f32`, arrays of them and `repr(C)` structs of them without padding: no pointer, no handle,
/// every bit pattern valid. [`wire!`] proves this for structs; the rest is in this file.
pub unsafe trait Layout: Copy + 'static {
    /// Changes when the name, type, order or offset of a field changes, in this type or in a type of its fields.
    const HASH: u64;

    /// All bytes are 0.
    // SAFETY: every bit pattern is valid.
    const ZERO: Self = unsafe { core::mem::zeroed() };
}

/// The bytes of a value as they lie in memory: a recording keeps them.
pub fn bytes_of<T: Layout>(value: &T) -> &[u8] {
    // SAFETY: a Layout has no padding, so each of its bytes has a value, and they are borrowed for as long as it.
    unsafe { core::slice::from_raw_parts(core::ptr::from_ref(value).cast(), size_of::<T>()) }
}

/// The value that these bytes are; `None` where there are more or fewer than it has.
pub fn from_bytes<T: Layout>(bytes: &[u8]) -> Option<T> {
    if bytes.len() != size_of::<T>() {
        return None;
    }
    // SAFETY: there are as many bytes as it has, each bit pattern of a Layout is valid, and the read needs no alignment.
    Some(unsafe { core::ptr::read_unaligned(bytes.as_ptr().cast()) })
}

macro_rules! plain {
    ($($ty:ident)*) => { $(
        // SAFETY: a number without invalid bit patterns.
        unsafe impl Layout for $ty {
            const HASH: u64 = fold_str(SEED, stringify!($ty));
        }
    )* };
}
plain!(u8 i8 u16 i16 u32 i32 u64 i64 f32);

// SAFETY: an array has no padding that its elements do not have.
unsafe impl<T: Layout, const N: usize> Layout for [T; N] {
    const HASH: u64 = fold(fold_str(T::HASH, "[]"), N as u64);
}

/// FNV-1a: it is well known and takes three lines. It only has to distinguish builds, not to withstand an attacker.
pub(crate) const SEED: u64 = 0xcbf2_9ce4_8422_2325;

const fn fold_byte(hash: u64, byte: u8) -> u64 {
    (hash ^ byte as u64).wrapping_mul(0x0000_0100_0000_01b3)
}

pub(crate) const fn fold(mut hash: u64, value: u64) -> u64 {
    let bytes = value.to_le_bytes();
    let mut i = 0;
    while i < bytes.len() {
        hash = fold_byte(hash, bytes[i]);
        i += 1;
    }
    hash
}

pub(crate) const fn fold_str(mut hash: u64, text: &str) -> u64 {
    let bytes = text.as_bytes();
    let mut i = 0;
    while i < bytes.len() {
        hash = fold_byte(hash, bytes[i]);
        i += 1;
    }
    // With the length, "ab", "c" differs from "a", "bc".
    fold(hash, bytes.len() as u64)
}

/// Declares a wire struct: `wire! { "type name on the wire", size in bytes; /// docs struct Name { field: Type, } }`.
///
/// It checks at compile time that every field is [`Layout`], that the size is as stated, and that the fields fill it without padding.
macro_rules! wire {
    ($type_name:literal, $bytes:literal; $(#[$doc:meta])* struct $name:ident {
        $( $(#[$field_doc:meta])* $field:ident: $ty:ty, )*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[repr(C)]
        pub struct $name { $( $(#[$field_doc])* pub $field: $ty, )* }

        // SAFETY: repr(C), every field is Layout, and the assert below shows that there is no padding.
        unsafe impl $crate::layout::Layout for $name {
            const HASH: u64 = {
                let hash = $crate::layout::fold_str($crate::layout::SEED, $type_name);
                $(
                    let hash = $crate::layout::fold_str(hash, stringify!($field));
                    let hash = $crate::layout::fold(hash, core::mem::offset_of!($name, $field) as u64);
                    let hash = $crate::layout::fold(hash, <$ty as $crate::layout::Layout>::HASH);
                )*
                hash
            };
        }

        // SAFETY: Layout is stricter than ZeroCopySend. The name is fixed, so those who open a service compare the layout hash too.
        unsafe impl iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend for $name {
            unsafe fn type_name() -> &'static str {
                $type_name
            }
        }

        const _: () = assert!(size_of::<$name>() == $bytes, "the size differs from the stated one");
        const _: () = assert!(0 $( + size_of::<$ty>() )* == $bytes, "there is padding: make it a field");
    };
}

pub(crate) use wire;

/// Makes the struct on the wire of a list of fields.
macro_rules! wire_of_fields {
    ($type_name:literal, $bytes:literal, filled up by $filling:ident: $filling_ty:ty; $(#[$doc:meta])+ struct $name:ident $( $group:ident {
        $( $(#[$field_doc:meta])+ $field:ident: $ty:ty { $($columns:tt)+ } )+
    } )+) => {
        $crate::layout::wire! { $type_name, $bytes; $(#[$doc])+ struct $name {
            $( $( $(#[$field_doc])+ $field: $ty, )+ )+
            /// Keeps the size a multiple of 8.
            $filling: $filling_ty,
        } }
    };
}
pub(crate) use wire_of_fields;

#[cfg(test)]
#[allow(unreachable_pub)] // the macro makes public types
mod tests {
    use super::{Layout, bytes_of, from_bytes};

    mod as_it_is {
        wire! { "test.Point", 8; /// p
        struct Point { /// x
            x: f32, /// y
            y: f32, } }
        wire! { "test.Line", 16; /// l
        struct Line { /// from
            from: Point, /// to
            to: Point, } }
    }
    mod fields_swapped {
        wire! { "test.Point", 8; /// p
        struct Point { /// y
            y: f32, /// x
            x: f32, } }
        wire! { "test.Line", 16; /// l
        struct Line { /// from
            from: Point, /// to
            to: Point, } }
    }
    mod other_type_of_same_size {
        wire! { "test.Point", 8; /// p
        struct Point { /// x
            x: f32, /// y
            y: u32, } }
    }

    #[test]
    fn another_order_or_type_of_fields_has_another_hash() {
        assert_eq!(as_it_is::Point::HASH, as_it_is::Point::HASH);
        assert_ne!(as_it_is::Point::HASH, fields_swapped::Point::HASH);
        assert_ne!(as_it_is::Point::HASH, other_type_of_same_size::Point::HASH);
    }

    #[test]
    fn a_change_inside_a_field_changes_the_hash_of_the_whole() {
        assert_ne!(as_it_is::Line::HASH, fields_swapped::Line::HASH);
    }

    #[test]
    fn a_value_comes_out_of_its_bytes_as_it_went_in() {
        let line = as_it_is::Line {
            from: as_it_is::Point { x: 1.0, y: f32::NAN },
            to: as_it_is::Point { x: -0.0, y: 4.0 },
        };
        let bytes = bytes_of(&line);
        let read: as_it_is::Line = from_bytes(bytes).unwrap_or_default();
        assert_eq!(bytes_of(&read), bytes);
        assert!(from_bytes::<as_it_is::Line>(bytes.get(1..).unwrap_or_default()).is_none());
    }

    #[test]
    fn arrays_of_other_lengths_have_other_hashes() {
        assert_ne!(<[f32; 2]>::HASH, <[f32; 3]>::HASH);
        assert_ne!(<[[f32; 2]; 3]>::HASH, <[[f32; 3]; 2]>::HASH);
    }
}
