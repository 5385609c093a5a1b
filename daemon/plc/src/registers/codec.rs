//! Registers as 16-bit words: read from the image, written to the control block.

use shm_schemas::PART_BYTES;
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

/// As many words as the longest value has.
type Words = [u16; PART_BYTES / 2];

/// The words of the value, in the word order.
fn words(register: &Register, image: &Image, order: WordOrder) -> Words {
    let mut out = [0; PART_BYTES / 2];
    let value = match register.get {
        Get::U16(get) => u64::from(get(image)),
        Get::U32(get) => u64::from(get(image)),
        Get::F32(get) => u64::from(get(image).to_bits()),
        Get::U64(get) => get(image),
        Get::Text(get) => {
            // A text is not a number: its registers have one order, whichever numbers have.
            for (word, two) in out.iter_mut().zip(get(image).chunks_exact(2)) {
                *word = u16::from_be_bytes([two[0], two[1]]);
            }
            return out;
        }
    };
    let count = usize::from(register.words());
    for (index, word) in out.iter_mut().take(count).enumerate() {
        let from_low = match order {
            WordOrder::Big => count - 1 - index,
            WordOrder::Little => index,
        };
        *word = (value >> (16 * from_low)) as u16;
    }
    out
}

/// The number in these words.
fn number(words: &[u16], order: WordOrder) -> u64 {
    let append = |value: u64, word: &u16| value << 16 | u64::from(*word);
    match order {
        WordOrder::Big => words.iter().fold(0, append),
        WordOrder::Little => words.iter().rev().fold(0, append),
    }
}

/// The bytes in these words.
fn bytes(words: &[u16]) -> [u8; PART_BYTES] {
    let mut bytes = [0; PART_BYTES];
    for (two, word) in bytes.chunks_exact_mut(2).zip(words) {
        two.copy_from_slice(&word.to_be_bytes());
    }
    bytes
}

/// The first address behind the map.
fn end() -> u16 {
    MAP.last().map_or(0, |register| register.address + register.words())
}

/// `count` registers from `address` on. What has no meaning yet is 0.
///
/// # Errors
/// [`RegisterError::Address`] when a register of the range is not in the map.
pub fn read(image: &Image, order: WordOrder, address: u16, count: u16) -> Result<Vec<u16>, RegisterError> {
    let behind = address.checked_add(count).filter(|behind| count > 0 && *behind <= end());
    let behind = behind.ok_or(RegisterError::Address(address))?;
    let mut out = vec![0; count.into()];
    for register in MAP {
        let values = words(register, image, order);
        for (at, &word) in (register.address..).zip(&values[..register.words().into()]) {
            if (address..behind).contains(&at) {
                out[usize::from(at - address)] = word;
            }
        }
    }
    Ok(out)
}

/// The control block as it is after `values` have been written from `address` on: all of them, or none.
///
/// # Errors
/// [`RegisterError::Address`] when a register of the range is not in the control block. [`RegisterError::Value`] when bits of the control word are
/// written that have no meaning.
pub fn write(
    image: &Image,
    order: WordOrder,
    address: u16,
    values: &[u16],
) -> Result<Control, RegisterError> {
    let refused = RegisterError::Address(address);
    let mut block = read(image, order, CONTROL_BASE, end() - CONTROL_BASE)?;
    let start = usize::from(address.checked_sub(CONTROL_BASE).ok_or(refused)?);
    block.get_mut(start..start + values.len()).ok_or(refused)?.copy_from_slice(values);

    let mut written = image.control;
    for register in MAP.iter().filter(|register| register.address >= CONTROL_BASE) {
        let from = usize::from(register.address - CONTROL_BASE);
        let words = &block[from..from + usize::from(register.words())];
        match register.access {
            Access::Read => {}
            Access::ReadWrite(put) => put(&mut written, number(words, order)),
            Access::WriteText(put) => put(&mut written, bytes(words)),
            Access::Bits(change) if words[0] & !control::ALL == 0 => {
                written.word = change(written.word, words[0]);
            }
            Access::Bits(_) => return Err(RegisterError::Value(words[0])),
        }
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
    use shm_schemas::{PartId, VerdictMeasure};

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
            note: 59,
            measure: 5,
            measured: 12.34,
            shown_min: 0.0,
            shown_max: 99.9,
            distance: 1.5,
            threshold: -2.0,
            decided_utc_ns: 1_700_000_000_123_456_789,
            part: PartId::new(b"result").unwrap(),
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
            next_part: PartId::new(b"next").unwrap(),
            status: 0x0135,
            carried_out: 1,
            refused: 2,
            heartbeat: 3,
            error: 4,
            error_detail: 0x0501_0502,
            queued: 8,
            lost: 0x0901_0902,
            result: Some(super::super::image::ResultBlock { sequence: 0x0B01_0B02, outcome: 32, verdict }),
            control: Control {
                word: 5,
                load_job_id: 0x6501_6502,
                load_model_hash: 0x6701_6702_6703_6704,
                part: *PartId::new(b"P").unwrap().bytes(),
                acknowledge_sequence: 0x7B01_7B02,
            },
        }
    }

    #[test]
    fn no_register_lies_on_another_and_the_control_block_has_no_hole() {
        let mut next = 0;
        for register in MAP {
            let is_control = register.address >= CONTROL_BASE;
            assert!(register.address >= next, "{}", register.name);
            assert!(!is_control || register.address == next.max(CONTROL_BASE), "{}", register.name);
            assert_eq!(!matches!(register.access, Access::Read), is_control, "{}", register.name);
            next = register.address + register.words();
        }
    }

    // Written out by hand: an oracle that shares nothing with the table.
    #[rustfmt::skip]
    const BIG: [u16; 100] = [
        0x0135, 1, 2, 3, 4, 0x0501, 0x0502, 6, 8, 0x0901, 0x0902,
        0x0B01, 0x0B02, 32, 0x0E01, 0x0E02, 0x1001, 0x1002, 0x1003, 0x1004,
        20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30,
        0x3FC0, 0, 0xC000, 0, // 1.5 and -2.0
        0x6553, 0xF100, 123, // 1,700,000,000 s and 123 ms
        0x2601, 0x2602, 0x2603, 0x2604, 0x2A01, 0x2A02, 0x2A03, 0x2A04, 0x0B01, 0x0B02, 0x3001, 0x3002,
        50, 51, 0x3401, 0x3402, 0x3601, 0x3602, 0x3603, 0x3604, 58, 59,
        0x7265, 0x7375, 0x6C74, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // "result"
        0x0B01, 0x0B02,
        0x6E65, 0x7874, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // "next"
        5, 123, 0, 999, 0x0B01, 0x0B02, // 12.34, 0 and 99.9 degrees
    ];
    #[rustfmt::skip]
    const BIG_CONTROL: [u16; 27] = [
        5, 0x6501, 0x6502, 0x6701, 0x6702, 0x6703, 0x6704,
        0x5000, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // "P"
        0x7B01, 0x7B02, 0, 0,
    ];

    #[test]
    fn every_value_lies_where_the_document_says() {
        assert_eq!(read(&sample(), WordOrder::Big, 0, 100).unwrap(), BIG);
        assert_eq!(read(&sample(), WordOrder::Big, 100, 27).unwrap(), BIG_CONTROL);
        assert_eq!(read(&sample(), WordOrder::Big, 48, 52).unwrap(), BIG[48..]);
    }

    #[test]
    fn the_other_word_order_turns_the_registers_of_each_value_around() {
        let little = read(&sample(), WordOrder::Little, 0, 100).unwrap();
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
            (76, 2),
            (98, 2),
        ] {
            assert_eq!(turned(from, count), BIG[from..from + count], "{from}");
        }
        for from in
            (0..5).chain([7, 8, 13]).chain(20..31).chain([37, 50, 51, 58, 59]).chain(60..76).chain(78..98)
        {
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
    fn a_measure_is_shown_in_whole_units_and_stays_within_its_register() {
        let shown = |measure: VerdictMeasure, measured: f32| {
            let mut image = sample();
            let verdict = &mut image.result.as_mut().unwrap().verdict;
            (verdict.measure, verdict.measured) = (measure.code(), measured);
            read(&image, WordOrder::Big, 94, 2).unwrap()
        };
        assert_eq!(shown(VerdictMeasure::Duration, 2.1), [1, 210]);
        assert_eq!(shown(VerdictMeasure::Strokes, 4.5), [2, 45]);
        assert_eq!(shown(VerdictMeasure::Path, 1.042), [4, 1042]);
        assert_eq!(shown(VerdictMeasure::Place, 1000.0), [6, u16::MAX]);
        assert_eq!(shown(VerdictMeasure::None, f32::NAN), [0, 0]);
    }

    #[test]
    fn a_read_outside_the_map_is_refused() {
        for (address, count) in [(127, 1), (126, 2), (3, 125), (65535, 125)] {
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
        let before = sample().control;
        let all = write(&sample(), order, 100, &[3, 0, 9, 1, 2, 3, 4, 0x4142]).unwrap();
        let mut part = [0; PART_BYTES];
        part[..2].copy_from_slice(b"AB");
        let expected =
            Control { word: 3, load_job_id: 9, load_model_hash: 0x0001_0002_0003_0004, part, ..before };
        assert_eq!(all, expected);
        let half = write(&sample(), order, 102, &[5]).unwrap();
        assert_eq!(half.load_job_id, 0x6501_0005, "the other half stays");
        let swapped = write(&sample(), WordOrder::Little, 101, &[5, 6]).unwrap();
        assert_eq!(swapped.load_job_id, 0x0006_0005);
        let swapped = write(&sample(), WordOrder::Little, 107, &[0x4142]).unwrap();
        assert_eq!(swapped.part, part, "a text has one order");
        assert_eq!(write(&sample(), order, 0, &[1]), Err(RegisterError::Address(0)));
        assert_eq!(write(&sample(), order, 126, &[1, 2]), Err(RegisterError::Address(126)));
        assert_eq!(write(&sample(), order, 100, &[0x80]), Err(RegisterError::Value(0x80)));
    }

    #[test]
    fn setting_and_clearing_bits_leaves_those_of_others() {
        let order = WordOrder::Big;
        let set = write(&sample(), order, 125, &[control::RESET_ERROR]).unwrap();
        assert_eq!(set.word, 5 | control::RESET_ERROR);
        let cleared = write(&sample(), order, 126, &[control::ENABLE]).unwrap();
        assert_eq!(cleared.word, 4);
        for address in [125, 126] {
            assert_eq!(write(&sample(), order, address, &[0x80]), Err(RegisterError::Value(0x80)));
        }
    }
}
