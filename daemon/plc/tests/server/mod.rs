//! A Modbus server over channels instead of shared memory, and a client that is nothing but bytes.
#![allow(dead_code)] // every test file uses a part

use andon_plc::handshake::{Ask, Fault, Line};
use andon_plc::modbus::{CommandSink, Config, Counters, Event, ModbusServer, VerdictSource};
use shm_schemas::{NO_INDEX, Verdict, VerdictKind};
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longer than anything takes here; a test that waits for so long has failed.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

struct Events(Receiver<Event>);

impl VerdictSource for Events {
    fn next(&mut self, wait: Duration) -> Option<Event> {
        match self.0.recv_timeout(wait) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                thread::sleep(wait);
                None
            }
        }
    }
}

struct Told(Sender<Ask>);

impl CommandSink for Told {
    fn tell(&mut self, ask: &Ask) -> bool {
        self.0.send(*ask).is_ok()
    }
}

/// A server that runs until it is dropped. A healthy line reports to it all the time, until told otherwise.
pub(crate) struct TestServer {
    pub(crate) address: SocketAddr,
    pub(crate) counters: Arc<Counters>,
    pub(crate) asks: Receiver<Ask>,
    events: Sender<Event>,
    stop: Arc<AtomicBool>,
    well: Arc<AtomicBool>,
    threads: Vec<thread::JoinHandle<()>>,
    seq: u64,
}

/// A configuration for tests: loopback, any port, writes on.
pub(crate) fn config() -> Config {
    Config { bind: "127.0.0.1:0".parse().unwrap(), writes: true, ..Config::default() }
}

impl TestServer {
    pub(crate) fn start(config: Config) -> Self {
        let server = ModbusServer::start(config).unwrap();
        let (address, counters) = (server.address(), server.counters());
        let (events, from_line) = channel();
        let (to_line, asks) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let well = Arc::new(AtomicBool::new(true));
        let stopped = Arc::clone(&stop);
        let role = thread::spawn(move || server.run(&mut Events(from_line), &mut Told(to_line), &stopped));
        let (stopped, is_well, line) = (Arc::clone(&stop), Arc::clone(&well), events.clone());
        let health = thread::spawn(move || {
            while !stopped.load(Ordering::Relaxed) {
                let state = match is_well.load(Ordering::Relaxed) {
                    true => Line::Ready,
                    false => Line::Fault { fault: Fault::Camera, detail: 104 },
                };
                let _ = line.send(Event::Line(state));
                thread::sleep(Duration::from_millis(10));
            }
        });
        Self { address, counters, asks, events, stop, well, threads: vec![role, health], seq: 0 }
    }

    /// The camera is there, or not.
    pub(crate) fn camera(&self, there: bool) {
        self.well.store(there, Ordering::Relaxed);
    }

    /// A verdict comes, and the journal has it.
    pub(crate) fn say(&mut self, kind: VerdictKind) {
        self.seq += 1;
        let mut verdict = sample(self.seq, kind);
        verdict.stamp.seq = self.seq;
        self.events.send(Event::Verdict(verdict)).unwrap();
        self.events.send(Event::Confirmed { epoch: 1, seq: self.seq }).unwrap();
    }

    pub(crate) fn client(&self) -> Client {
        Client::connect(self.address)
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Every field follows from the number, so that a mix of two shows.
pub(crate) fn sample(number: u64, kind: VerdictKind) -> Verdict {
    let mut verdict = Verdict {
        kind: kind.code(),
        job_id: 7,
        model_hash: number.wrapping_mul(0x9E37_79B9_7F4A_7C15),
        distance: number as f32,
        threshold: 2.5,
        decided_utc_ns: 1_700_000_000_250_000_000,
        nearest: NO_INDEX,
        activity: 1,
        iu: 2,
        ..Default::default()
    };
    (verdict.stamp.epoch, verdict.stamp.seq) = (1, number);
    verdict
}

/// Bytes over TCP, written after the specification and sharing nothing with the server.
pub(crate) struct Client(TcpStream);

impl Client {
    pub(crate) fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_nodelay(true).unwrap();
        Self(stream)
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).unwrap();
    }

    /// Sends; a server that has closed already is no fault here.
    pub(crate) fn send_if_open(&mut self, bytes: &[u8]) {
        let _ = self.0.write_all(bytes);
    }

    /// The next answer: function and what follows. `None`: the server closed.
    pub(crate) fn answer(&mut self) -> Option<Vec<u8>> {
        let mut header = [0; 7];
        self.0.read_exact(&mut header).ok()?;
        let length = usize::from(u16::from_be_bytes([header[4], header[5]]));
        let mut pdu = vec![0; length - 1];
        self.0.read_exact(&mut pdu).ok()?;
        Some(pdu)
    }

    pub(crate) fn ask(&mut self, pdu: &[u8]) -> Vec<u8> {
        let mut frame = vec![0, 1, 0, 0, 0, u8::try_from(pdu.len() + 1).unwrap(), 1];
        frame.extend_from_slice(pdu);
        self.send(&frame);
        self.answer().unwrap()
    }

    pub(crate) fn read(&mut self, address: u16, count: u16) -> Vec<u16> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), count.to_be_bytes());
        let answer = self.ask(&[3, a, b, c, d]);
        assert_eq!(answer[0], 3, "exception {}", answer[1]);
        answer[2..].chunks(2).map(|two| u16::from_be_bytes([two[0], two[1]])).collect()
    }

    pub(crate) fn write(&mut self, address: u16, value: u16) -> Vec<u8> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), value.to_be_bytes());
        self.ask(&[6, a, b, c, d])
    }

    /// Reads until the status word has all these bits set and those cleared.
    pub(crate) fn wait_for(&mut self, set: u16, cleared: u16) {
        let until = Instant::now() + PATIENCE;
        loop {
            let status = self.read(0, 1)[0];
            if status & set == set && status & cleared == 0 {
                return;
            }
            assert!(Instant::now() < until, "status {status:#b}, wanted {set:#b} and not {cleared:#b}");
            thread::sleep(Duration::from_millis(2));
        }
    }
}

pub(crate) fn count(counter: &AtomicU64) -> u64 {
    counter.load(Ordering::Relaxed)
}
