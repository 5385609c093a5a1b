//! The stages of the line after the frames, each in a process of its own, and writers and readers of verdicts.

use crate::{FOREVER, Outcome, number};
use andon_ipc::{ChannelMessage, MonotonicTime, Node, Port, Reader, Wake, Writer};
use shm_schemas::{Couples, Detections, RoleId, Verdict, VerdictLevel, VerdictOutcome, flag};
use std::time::Duration;

/// Stands for perceive: sends a message for each frame, as fast as encode takes them.
pub(crate) fn frames_to_detections(node: &Node) -> Outcome {
    let mut frames = node.frame_reader()?;
    let mut writer = node.writer::<Detections>()?;
    writer.follow(&[RoleId::Encode]);
    println!("up");
    let mut ended = false;
    while !ended && goes_on(node, &mut [&mut frames])? {
        while let Some(frame) = frames.take()? {
            ended = frame.header().flags & flag::END_OF_STREAM != 0;
            send(node, &mut writer, |detections: &mut Detections| {
                detections.stamp = frame.header().stamp;
                detections.flags = frame.header().flags;
            })?;
        }
    }
    finish(node, frames.lost(), frames.received())
}

/// Stands for encode: sends couples for each message of detections.
pub(crate) fn detections_to_couples(node: &Node) -> Outcome {
    let mut writer = node.writer::<Couples>()?;
    writer.follow(&[RoleId::Judge]);
    relay(node, writer, |detections: &Detections, couples: &mut Couples| {
        couples.stamp = detections.stamp;
        couples.flags = detections.flags;
        detections.flags & flag::END_OF_STREAM != 0
    })
}

/// Stands for judge: sends a verdict for each message of couples. The last one has no outcome.
pub(crate) fn couples_to_verdicts(node: &Node) -> Outcome {
    let mut writer = node.writer::<Verdict>()?;
    writer.follow(&[RoleId::Journal]);
    relay(node, writer, |couples: &Couples, verdict: &mut Verdict| {
        let ended = couples.flags & flag::END_OF_STREAM != 0;
        verdict.stamp = couples.stamp;
        verdict.outcome = if ended { 0 } else { VerdictOutcome::NotJudged.code() };
        ended
    })
}

fn relay<A: ChannelMessage, B: ChannelMessage>(
    node: &Node,
    mut writer: Writer<B>,
    mut step: impl FnMut(&A, &mut B) -> bool,
) -> Outcome {
    let mut reader: Reader<A> = node.reader()?;
    println!("up");
    let mut ended = false;
    while !ended && goes_on(node, &mut [&mut reader])? {
        while let Some(message) = reader.take()? {
            send(node, &mut writer, |follower| ended = step(&message, follower))?;
        }
    }
    finish(node, reader.lost(), reader.received())
}

fn send<T: ChannelMessage>(node: &Node, writer: &mut Writer<T>, fill: impl FnOnce(&mut T)) -> Outcome {
    match node.wait_for_room(writer, FOREVER)? {
        Wake::Room => (),
        other => return Err(format!("waiting for room ended with {other:?}").into()),
    }
    let mut loan = writer.loan()?;
    fill(&mut loan);
    writer.send(loan)?;
    Ok(())
}

/// Waits for messages. False when a stop was requested.
fn goes_on(node: &Node, ports: &mut [&mut dyn Port]) -> Result<bool, Box<dyn std::error::Error>> {
    Ok(node.wait(ports, FOREVER)? != Wake::Stop)
}

/// Stays until it is stopped: a later stage may still be reading in the memory of this process.
fn finish(node: &Node, lost: u64, received: u64) -> Outcome {
    println!("lost={lost}");
    println!("received={received}");
    println!("done");
    node.stop().wait(FOREVER);
    Ok(())
}

/// `write-verdicts COUNT PAUSE_US`: sends live, then answers late readers until it is stopped. COUNT 0 never ends.
pub(crate) fn write_verdicts(node: &Node, arguments: &[String]) -> Outcome {
    let (count, pause) = (number(arguments, 0)?, Duration::from_micros(number(arguments, 1)?));
    let mut writer = node.writer::<Verdict>()?;
    println!("up");
    let mut sent = 0;
    while count == 0 || sent < count {
        if !pause.is_zero() && node.wait(&mut [&mut writer], pause)? == Wake::Stop {
            return Ok(());
        }
        let mut verdict = writer.loan()?;
        verdict.stamp.captured_ns = MonotonicTime::now().nanoseconds();
        verdict.level = VerdictLevel::Iu.code();
        verdict.outcome = VerdictOutcome::Ok.code();
        sent = writer.send(verdict)?;
    }
    println!("done");
    while node.wait(&mut [&mut writer], FOREVER)? != Wake::Stop {}
    Ok(())
}

/// `read-verdicts COUNT PAUSE_US`: reads until it has seen `seq` COUNT or the end of the stream, with a pause after each message. 0 reads until it is
/// stopped. Prints how many came and how late they were.
pub(crate) fn read_verdicts(node: &Node, arguments: &[String]) -> Outcome {
    let (last, pause) = (number(arguments, 0)?, Duration::from_micros(number(arguments, 1)?));
    let mut reader: Reader<Verdict> = node.reader()?;
    let mut late_ns = Vec::with_capacity(1 << 20);
    println!("up");
    let mut ended = false;
    while !ended && goes_on(node, &mut [&mut reader])? {
        while let Some(verdict) = reader.take()? {
            let sent = MonotonicTime::from_nanoseconds(verdict.stamp.sent_ns);
            late_ns.push(MonotonicTime::now().since(sent).as_nanos());
            ended = verdict.stamp.seq == last || verdict.outcome == 0;
            if !pause.is_zero() {
                std::thread::sleep(pause);
            }
        }
    }
    late_ns.sort_unstable();
    let at = |quantile: f64| late_ns.get((late_ns.len() as f64 * quantile) as usize).copied().unwrap_or(0);
    println!("p50_ns={}", at(0.50));
    println!("p99_ns={}", at(0.99));
    println!("lost={}", reader.lost());
    println!("received={}", reader.received());
    Ok(())
}

/// `wait`: blocks on a channel that nobody writes, with a deadline after the end of any test.
pub(crate) fn wait_for_nothing(node: &Node) -> Outcome {
    let mut reader: Reader<Verdict> = node.reader()?;
    println!("up");
    let wake = node.wait(&mut [&mut reader], FOREVER)?;
    println!("woken={wake:?}");
    Ok(())
}
