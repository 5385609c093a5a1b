//! Between the image and 16-bit words.

use thiserror::Error;

use super::image::{Control, Image, control};
use super::map::{Access, CONTROL_BASE, Get, MAP, Register};

/// In which order the 16-bit words of a longer value lie. Inside a word Modbus is big-endian.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordOrder {
    /// The most significant word at the lowest address.
    #[default]
    Big,
    /// The least significant word at the lowest address.
    Little,
}

/// Why a request for registers was refused.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum RegisterError {
    /// There is no such register, or it cannot be written.
    #[error("no register {0} for this function: see REGISTERS.md")]
    Address(u16),
    /// The value has no meaning.
    #[error("control word {0:#06x} has bits without a meaning: see REGISTERS.md")]
    Value(u16),
}

/// The value's words, at most four, most significant first or last by `order`.
fn words(register: &Register, image: &Image, order: WordOrder) -> [u16; 4] {
    let (value, count) = match register.get {
        Get::U16(get) => (u64::from(get(image)), 1),
        Get::U32(get) => (u64::from(get(image)), 2),
        Get::F32(get) => (u64::from(get(image).to_bits()), 2),
        Get::U64(get) => (get(image), 4),
    };
    let mut out = [0; 4];
    for (place, word) in out.iter_mut().take(count).enumerate() {
        let from_low = match order {
            WordOrder::Big => count - 1 - place,
            WordOrder::Little => place,
        };
        *word = (value >> (16 * from_low)) as u16;
    }
    out
}

/// `count` registers from `address` on.
///
/// # Errors
/// [`RegisterError::Address`] where the range leaves a block of the map.
pub fn read(image: &Image, order: WordOrder, address: u16, count: u16) -> Result<Vec<u16>, RegisterError> {
    let end = u32::from(address) + u32::from(count);
    let mut out = Vec::with_capacity(count.into());
    for register in MAP {
        let values = words(register, image, order);
        for (at, &word) in (register.address..).zip(&values[..register.words().into()]) {
            if (u32::from(address)..end).contains(&u32::from(at)) {
                out.push(word);
            }
        }
    }
    if out.len() != usize::from(count) {
        return Err(RegisterError::Address(address));
    }
    Ok(out)
}

/// The control block after `values` have been written from `address` on; all of them or none.
///
/// # Errors
/// [`RegisterError::Address`] where the range leaves the control block, [`RegisterError::Value`] where the control
/// word has bits without a meaning.
pub fn write(
    image: &Image,
    order: WordOrder,
    address: u16,
    values: &[u16],
) -> Result<Control, RegisterError> {
    let refused = RegisterError::Address(address);
    let writable = || MAP.iter().filter(|register| register.address >= CONTROL_BASE);
    let length: u16 = writable().map(Register::words).sum();
    let mut block = read(image, order, CONTROL_BASE, length)?;
    let start = usize::from(address.checked_sub(CONTROL_BASE).ok_or(refused)?);
    block.get_mut(start..start + values.len()).ok_or(refused)?.copy_from_slice(values);

    let mut written = image.control;
    for register in writable() {
        let Access::ReadWrite(put) = register.access else { continue };
        let from = usize::from(register.address - CONTROL_BASE);
        let words = &block[from..from + usize::from(register.words())];
        let append = |value: u64, word: &u16| value << 16 | u64::from(*word);
        let value = match order {
            WordOrder::Big => words.iter().fold(0, append),
            WordOrder::Little => words.iter().rev().fold(0, append),
        };
        put(&mut written, value);
    }
    if written.word & !control::ALL != 0 {
        return Err(RegisterError::Value(written.word));
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// An image whose values are all different, so that a swap shows.
    fn sample() -> Image {
        let mut verdict = shm_schemas::Verdict {
            model_hash: 0x1122_3344_5566_7788,
            job_id: 0xAABB_CCDD,
            distance: 1.5,
            decided_utc_ns: 1_700_000_000_123_456_789,
            ..Default::default()
        };
        verdict.stamp.seq = 7;
        Image {
            status: 0x0135,
            result: Some(super::super::image::ResultBlock { sequence: 0x0001_0002, outcome: 32, verdict }),
            ..Default::default()
        }
    }

    #[test]
    fn the_blocks_of_the_map_have_no_hole_and_no_overlap() {
        let mut next = 0;
        for register in MAP {
            if register.address == CONTROL_BASE {
                next = CONTROL_BASE;
            }
            assert_eq!(register.address, next, "{}", register.name);
            assert_eq!(
                matches!(register.access, Access::ReadWrite(_)),
                register.address >= CONTROL_BASE,
                "{}",
                register.name
            );
            next += register.words();
        }
    }

    // Addresses and bytes written out by hand: an oracle that shares nothing with the table.
    #[test]
    fn values_lie_where_the_document_says_in_both_word_orders() {
        let big = read(&sample(), WordOrder::Big, 0, 48).unwrap();
        assert_eq!(big[0], 0x0135);
        assert_eq!(big[11..13], [1, 2]);
        assert_eq!(big[14..16], [0xAABB, 0xCCDD]);
        assert_eq!(big[16..20], [0x1122, 0x3344, 0x5566, 0x7788]);
        assert_eq!(big[31..33], [0x3FC0, 0]);
        assert_eq!((u32::from(big[35]) << 16) + u32::from(big[36]), 1_700_000_000);
        assert_eq!(big[37], 123);
        assert_eq!(big[42..46], [0, 0, 0, 7]);
        assert_eq!(big[46..48], [1, 2]);
        let little = read(&sample(), WordOrder::Little, 0, 48).unwrap();
        assert_eq!(little[11..13], [2, 1]);
        assert_eq!(little[16..20], [0x7788, 0x5566, 0x3344, 0x1122]);
        assert_eq!(little[31..33], [0, 0x3FC0]);
    }

    #[test]
    fn a_read_outside_the_map_is_refused() {
        for (address, count) in [(48, 1), (47, 2), (99, 2), (107, 1), (65535, 125), (46, 60)] {
            assert_eq!(
                read(&sample(), WordOrder::Big, address, count),
                Err(RegisterError::Address(address)),
                "{address}+{count}"
            );
        }
    }

    #[test]
    fn a_write_changes_all_registers_or_none_and_only_the_control_block() {
        let order = WordOrder::Big;
        let all = write(&sample(), order, 100, &[3, 0, 9, 1, 2, 3, 4]).unwrap();
        assert_eq!(all, Control { word: 3, load_job_id: 9, load_model_hash: 0x0001_0002_0003_0004 });
        let half = write(&sample(), order, 102, &[5]).unwrap();
        assert_eq!(half.load_job_id, 5);
        let swapped = write(&sample(), WordOrder::Little, 101, &[5, 6]).unwrap();
        assert_eq!(swapped.load_job_id, 0x0006_0005);
        assert_eq!(write(&sample(), order, 0, &[1]), Err(RegisterError::Address(0)));
        assert_eq!(write(&sample(), order, 106, &[1, 2]), Err(RegisterError::Address(106)));
        assert_eq!(write(&sample(), order, 100, &[0x40]), Err(RegisterError::Value(0x40)));
    }
}
