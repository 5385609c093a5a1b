//! What broken and hostile clients send.

use andon_tests::simulator::Random;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// What has been sent so far.
#[derive(Debug, Default)]
pub(crate) struct Sent {
    pub(crate) connections: AtomicU64,
    pub(crate) frames: AtomicU64,
    pub(crate) bytes: AtomicU64,
}

/// Sends until `end` is set, one connection after the other.
pub(crate) fn start(port: u16, seed: u64, sent: &Arc<Sent>, end: &Arc<AtomicBool>) -> JoinHandle<()> {
    let (sent, end) = (Arc::clone(sent), Arc::clone(end));
    std::thread::spawn(move || {
        let mut random = Random::new(seed, &[]);
        while !end.load(Ordering::Relaxed) {
            let Ok(stream) = TcpStream::connect(("127.0.0.1", port)) else {
                std::thread::sleep(Duration::from_millis(10));
                continue;
            };
            sent.connections.fetch_add(1, Ordering::Relaxed);
            connection(stream, &mut random, &sent);
        }
    })
}

/// Some frames, until the server has had enough of it or it has had enough of the server.
fn connection(mut stream: TcpStream, random: &mut Random, sent: &Sent) {
    // Answers are thrown away; a reader that never reads is tried as well.
    let reads = random.index(4) > 0;
    let _ = stream.set_read_timeout(Some(Duration::from_millis(1)));
    let _ = stream.set_write_timeout(Some(Duration::from_millis(200)));
    for _ in 0..=random.index(50) {
        let bytes = frame(random);
        // Whole, or in two parts with a packet between them.
        let cut = if random.index(3) == 0 { random.index(bytes.len() + 1) } else { 0 };
        if stream.write_all(&bytes[..cut]).and_then(|()| stream.write_all(&bytes[cut..])).is_err() {
            return;
        }
        sent.frames.fetch_add(1, Ordering::Relaxed);
        sent.bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        if reads && matches!(stream.read(&mut [0; 512]), Ok(0)) {
            return;
        }
    }
    if random.index(2) == 0 {
        let _ = stream.shutdown(Shutdown::Write);
    }
}

/// Anything from noise to a request that is right but for one byte, and now and then one that is right.
fn frame(random: &mut Random) -> Vec<u8> {
    match random.index(4) {
        0 => noise(random, 300),
        // The header is right, what it heads is noise.
        1 => {
            let length = 1 + random.index(253);
            let pdu = noise(random, length);
            headed(&pdu)
        }
        2 => {
            let mut bytes = headed(&request(random));
            let place = random.index(bytes.len());
            bytes[place] = byte(random);
            bytes
        }
        _ => headed(&request(random)),
    }
}

fn byte(random: &mut Random) -> u8 {
    random.index(256) as u8
}

/// As many bytes as this, or fewer.
fn noise(random: &mut Random, most: usize) -> Vec<u8> {
    (0..=random.index(most)).map(|_| byte(random)).collect()
}

fn headed(pdu: &[u8]) -> Vec<u8> {
    let [high, low] = u16::try_from(pdu.len() + 1).unwrap().to_be_bytes();
    [&[0, 1, 0, 0, high, low, 1], pdu].concat()
}

/// A served function, its address mostly where registers are.
fn request(random: &mut Random) -> Vec<u8> {
    let [function, base] = [[3, 0], [4, 0], [6, 100], [16, 100]][random.index(4)];
    let count = 1 + random.index(8);
    let [high, low] = match random.index(8) {
        0 => [byte(random), byte(random)],
        _ => [0, base + random.index(8) as u8],
    };
    match function {
        6 => vec![6, high, low, byte(random), byte(random) & 63],
        16 => {
            let mut pdu = vec![16, high, low, 0, count as u8, 2 * count as u8];
            pdu.extend((0..2 * count).map(|_| byte(random)));
            pdu
        }
        _ => vec![function, high, low, 0, count as u8],
    }
}
