//! What broken and hostile clients send.

use andon_tests::simulator::Random;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Counts of what has been sent.
#[derive(Debug, Default)]
pub(crate) struct Sent {
    pub(crate) connections: AtomicU64,
    pub(crate) frames: AtomicU64,
    pub(crate) bytes: AtomicU64,
}

/// Starts a thread that opens one connection after the other and sends, until `end` is set.
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

/// Sends up to 50 frames, or fewer when the server closes the connection.
fn connection(mut stream: TcpStream, random: &mut Random, sent: &Sent) {
    // Answers are not looked at; a client that never reads them is tried as well.
    let reads = random.index(4) > 0;
    let _ = stream.set_read_timeout(Some(Duration::from_millis(1)));
    let _ = stream.set_write_timeout(Some(Duration::from_millis(200)));
    for _ in 0..=random.index(50) {
        let bytes = frame(random);
        // In one packet or in two.
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

/// Noise, a good header before noise, a good request with one byte changed, or a good request.
fn frame(random: &mut Random) -> Vec<u8> {
    match random.index(4) {
        0 => noise(random, 300),
        1 => {
            let length = 1 + random.index(253);
            let pdu = noise(random, length);
            with_header(&pdu)
        }
        2 => {
            let mut bytes = with_header(&request(random));
            let index = random.index(bytes.len());
            bytes[index] = byte(random);
            bytes
        }
        _ => with_header(&request(random)),
    }
}

fn byte(random: &mut Random) -> u8 {
    random.index(256) as u8
}

/// Between 1 and `max` random bytes.
fn noise(random: &mut Random, max: usize) -> Vec<u8> {
    (0..=random.index(max)).map(|_| byte(random)).collect()
}

fn with_header(pdu: &[u8]) -> Vec<u8> {
    let [high, low] = u16::try_from(pdu.len() + 1).unwrap().to_be_bytes();
    [&[0, 1, 0, 0, high, low, 1], pdu].concat()
}

/// A request of a function that is served; its address is that of a register in most cases.
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
