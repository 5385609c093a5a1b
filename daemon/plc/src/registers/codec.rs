//! Registers as 16-bit words: read from the image, written to the control block.

use thiserror::Error;

use super::image::{Control, Image, control};
use super::map::{Access, CONTROL_BASE, Get, MAP, Register};

/// The order of the 16-bit words of a longer value. Inside a word Modbus is big-endian.
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
    /// The control word has bits that have no meaning.
    #[error("control word {0:#06x} has bits without a meaning: see REGISTERS.md")]
    Value(u16),
}

/// The words of the value, at most four, in the word order.
fn words(register: &Register, image: &Image, order: WordOrder) -> [u16; 4] {
    let (value, count) = match register.get {
        Get::U16(get) => (u64::from(get(image)), 1),
        Get::U32(get) => (u64::from(get(image)), 2),
        Get::F32(get) => (u64::from(get(image).to_bits()), 2),
        Get::U64(get) => (get(image), 4),
    };
    let mut out = [0; 4];
    for (index, word) in out.iter_mut().take(count).enumerate() {
        let from_low = match order {
            WordOrder::Big => count - 1 - index,
            WordOrder::Little => index,
        };
        *word = (value >> (16 * from_low)) as u16;
    }
    out
}

/// `count` registers from `address` on.
///
/// # Errors
/// [`RegisterError::Address`] when a register of the range is not in the map.
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

/// The control block as it is after `values` have been written from `address` on: all of them, or none.
///
/// # Errors
/// [`RegisterError::Address`] when a register of the range is not in the control block, [`RegisterError::Value`] when the control
/// word has bits that have no meaning.
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

    /// An image whose values all differ, so that a test sees when two are swapped.
    fn sample() -> Image {
        let mut verdict = shm_schemas::Verdict {
            job_id: 0x0E01_0E02,
            model_hash: 0x1001_1002_1003_1004,
            level: 20,
            reason: 21,
            hand: 22,
            activity: 23,
            iu: 24,
            nearest: 25,
            x_c: [26, 27, 28, 29],
            early: 30,
            distance: 1.5,
            threshold: -2.0,
            decided_utc_ns: 1_700_000_000_123_456_789,
            ..Default::default()
        };
        (verdict.stamp.epoch, verdict.stamp.seq) = (0x2601_2602_2603_2604, 0x2A01_2A02_2A03_2A04);
        Image {
            boot: 0x3001_3002,
            executing: 50,
            refusal: 51,
            job_in_force: 0x3401_3402,
            hash_in_force: 0x3601_3602_3603_3604,
            phase: 58,
            status: 0x0135,
            carried_out: 1,
            refused: 2,
            heartbeat: 3,
            error: 4,
            error_detail: 0x0501_0502,
            queued: 8,
            lost: 0x0901_0902,
            result: Some(super::super::image::ResultBlock { sequence: 0x0B01_0B02, outcome: 32, verdict }),
            control: Control { word: 5, load_job_id: 0x6501_6502, load_model_hash: 0x6701_6702_6703_6704 },
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

    // Written out by hand: an oracle that shares nothing with the table.
    #[rustfmt::skip]
    const BIG: [u16; 59] = [
        0x0135, 1, 2, 3, 4, 0x0501, 0x0502, 3, 8, 0x0901, 0x0902,
        0x0B01, 0x0B02, 32, 0x0E01, 0x0E02, 0x1001, 0x1002, 0x1003, 0x1004,
        20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30,
        0x3FC0, 0, 0xC000, 0, // 1.5 and -2.0
        0x6553, 0xF100, 123, // 1,700,000,000 s and 123 ms
        0x2601, 0x2602, 0x2603, 0x2604, 0x2A01, 0x2A02, 0x2A03, 0x2A04, 0x0B01, 0x0B02, 0x3001, 0x3002,
        50, 51, 0x3401, 0x3402, 0x3601, 0x3602, 0x3603, 0x3604, 58,
    ];
    const BIG_CONTROL: [u16; 7] = [5, 0x6501, 0x6502, 0x6701, 0x6702, 0x6703, 0x6704];

    #[test]
    fn every_value_lies_where_the_document_says() {
        assert_eq!(read(&sample(), WordOrder::Big, 0, 59).unwrap(), BIG);
        assert_eq!(read(&sample(), WordOrder::Big, 100, 7).unwrap(), BIG_CONTROL);
    }

    #[test]
    fn the_other_word_order_turns_the_registers_of_each_value_around() {
        let little = read(&sample(), WordOrder::Little, 0, 59).unwrap();
        let turned =
            |from: usize, count: usize| little[from..from + count].iter().rev().copied().collect::<Vec<_>>();
        for (from, count) in [
            (5, 2),
            (9, 2),
            (11, 2),
            (14, 2),
            (16, 4),
            (31, 2),
            (33, 2),
            (35, 2),
            (38, 4),
            (42, 4),
            (46, 2),
            (48, 2),
            (52, 2),
            (54, 4),
        ] {
            assert_eq!(turned(from, count), BIG[from..from + count], "{from}");
        }
        for from in (0..5).chain([7, 8, 13]).chain(20..31).chain([37, 50, 51, 58]) {
            assert_eq!(little[from], BIG[from], "{from}");
        }
    }

    #[test]
    fn before_the_first_result_the_block_shows_that_there_is_none() {
        let block = read(&Image::default(), WordOrder::Big, 11, 37).unwrap();
        assert_eq!([block[0], block[1], block[2], block[9]], [0; 4], "sequence, outcome and level");
        assert_eq!(block[12..15], [0xFFFF; 3], "activity, IU and nearest");
        assert_eq!(block[20..24], [0x7FC0, 0, 0x7FC0, 0], "distance and threshold are NaN");
    }

    #[test]
    fn a_read_outside_the_map_is_refused() {
        for (address, count) in [(59, 1), (58, 2), (99, 2), (107, 1), (65535, 125), (46, 60)] {
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
        assert_eq!(half.load_job_id, 0x6501_0005, "the other half stays");
        let swapped = write(&sample(), WordOrder::Little, 101, &[5, 6]).unwrap();
        assert_eq!(swapped.load_job_id, 0x0006_0005);
        assert_eq!(write(&sample(), order, 0, &[1]), Err(RegisterError::Address(0)));
        assert_eq!(write(&sample(), order, 106, &[1, 2]), Err(RegisterError::Address(106)));
        assert_eq!(write(&sample(), order, 100, &[0x40]), Err(RegisterError::Value(0x40)));
    }
}
