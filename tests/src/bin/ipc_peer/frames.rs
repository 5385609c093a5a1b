//! Frames as fast as they go: written in place, read in place, and each of them checked.

use crate::counting::allocations;
use crate::mapping::Mapping;
use crate::{FOREVER, Outcome, number};
use andon_ipc::{MonotonicTime, Node, Wake};
use shm_schemas::{ColourFormat, FrameHeader, RoleId, flag};
use std::time::Instant;

/// After this many frames everything that happens once has happened: connections, mappings, page tables.
const STEADY: u64 = 100;

/// At its beginning the writer notes where the frame lies in its view: inode and offset, 8 bytes each.
const NOTE_BYTES: usize = 16;

/// `write-frames COUNT WIDTH HEIGHT MODE`: `paced` waits for its reader and `live` does not. `copied` is paced and fills
/// a buffer of its own first, for a comparison with the figures without a copy.
pub(crate) fn write(node: &Node, arguments: &[String]) -> Outcome {
    let (count, width, height) =
        (number(arguments, 0)?, number(arguments, 1)? as u32, number(arguments, 2)? as u32);
    let mode = arguments.get(3).map(String::as_str);
    let bytes = (width * height * 3) as usize;
    let mut writer = node.frame_writer()?;
    writer.warm_up(bytes)?;
    let paced = mode != Some("live");
    if paced {
        writer.follow(&[RoleId::Perceive]);
    }
    let mut own = vec![0; if mode == Some("copied") { bytes } else { 0 }];
    let mut mapping = Mapping::default();
    println!("up");

    let (mut steady_allocations, mut begun) = (0, Instant::now());
    for seq in 1..=count {
        match node.wait_for_room(&mut writer, FOREVER)? {
            Wake::Room => (),
            other => return Err(format!("waiting for room ended with {other:?}").into()),
        }
        let mut loan = writer.loan(bytes)?;
        let place = mapping.place_of(loan.bytes_mut())?;
        if own.is_empty() {
            loan.bytes_mut().fill(marker(seq));
        } else {
            own.fill(marker(seq));
            loan.bytes_mut().copy_from_slice(&own);
        }
        loan.bytes_mut()[..8].copy_from_slice(&place.inode.to_le_bytes());
        loan.bytes_mut()[8..NOTE_BYTES].copy_from_slice(&place.offset.to_le_bytes());
        *loan.header_mut() = header(width, height, if seq == count { flag::END_OF_STREAM } else { 0 });
        writer.send(loan)?;
        if seq == STEADY {
            (steady_allocations, begun) = (allocations(), Instant::now());
        }
    }
    println!("allocations={}", allocations() - steady_allocations);
    println!("nanoseconds={}", begun.elapsed().as_nanos());
    println!("frames={}", count.saturating_sub(STEADY));
    // The reader reads in the memory of this process, which must stay until then.
    if paced {
        let _ = node.wait_for_room(&mut writer, FOREVER)?;
    }
    println!("done");
    node.stop().wait(FOREVER);
    Ok(())
}

/// `read-frames COPY`: reads to the end of the stream. With COPY = 1 it first copies each frame.
pub(crate) fn read(node: &Node, arguments: &[String]) -> Outcome {
    let copy = number(arguments, 0)? == 1;
    let mut reader = node.frame_reader()?;
    let mut mapping = Mapping::default();
    let mut own = Vec::new();
    println!("up");

    let (mut wrong, mut elsewhere, mut steady_allocations) = (0_u64, 0_u64, 0);
    let mut ended = false;
    while !ended {
        match node.wait(&mut [&mut reader], FOREVER)? {
            Wake::Sample => (),
            Wake::WriterGone { .. } => continue,
            other => return Err(format!("waiting for frames ended with {other:?}").into()),
        }
        while let Some(frame) = reader.take()? {
            let colour = if copy {
                own.clear();
                own.extend_from_slice(frame.colour()?);
                &own
            } else {
                frame.colour()?
            };
            let seq = frame.header().stamp.seq;
            wrong += u64::from(!is_marked(colour, marker(seq)));
            let place = mapping.place_of(frame.bytes())?;
            let written_at = (word(frame.bytes(), 0), word(frame.bytes(), 8));
            elsewhere += u64::from(written_at != (place.inode, place.offset));
            ended = frame.header().flags & flag::END_OF_STREAM != 0;
            if seq == STEADY {
                steady_allocations = allocations();
            }
        }
    }
    println!("allocations={}", allocations() - steady_allocations);
    println!("received={}", reader.received());
    println!("lost={}", reader.lost());
    println!("wrong={wrong}");
    println!("elsewhere={elsewhere}");
    Ok(())
}

fn header(width: u32, height: u32, flags: u32) -> FrameHeader {
    let mut header = FrameHeader {
        width,
        height,
        stride: width * 3,
        colour_format: ColourFormat::Rgb8.code(),
        flags: flags | flag::PACED,
        ..FrameHeader::default()
    };
    header.stamp.captured_ns = MonotonicTime::now().nanoseconds();
    header
}

/// The value of all pixels of a frame. Consecutive frames differ, and because 251 is prime, no number of buffers repeats it.
fn marker(seq: u64) -> u8 {
    (seq % 251) as u8
}

/// Whether every cache line and the last byte have this value.
fn is_marked(colour: &[u8], marker: u8) -> bool {
    colour.iter().skip(NOTE_BYTES).step_by(64).chain(colour.last()).all(|&byte| byte == marker)
}

fn word(bytes: &[u8], at: usize) -> u64 {
    bytes[at..at + 8].iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte))
}
