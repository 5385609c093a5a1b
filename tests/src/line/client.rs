//! A Modbus client of plain bytes. It shares no code with the server.

use super::PATIENCE;
use shm_schemas::Refusal;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Addresses of registers, as `REGISTERS.md` lists them.
const STATUS: u16 = 0;
const LOST: u16 = 9;
const SEQUENCE: u16 = 11;
const EPOCH: u16 = 38;
const CARRIED_OUT: u16 = 1;
const BOOT: u16 = 48;
const REFUSAL: u16 = 51;
const JOB_IN_FORCE: u16 = 52;
const NEXT_PART: u16 = 78;
const CONTROL: u16 = 100;
const PART: u16 = 107;

/// Bits of the status word, as `REGISTERS.md` numbers them.
#[allow(missing_docs)] // their names are their meaning
pub mod status {
    pub const ONLINE: u16 = 1;
    pub const READY: u16 = 2;
    pub const DONE: u16 = 8;
    pub const ERROR: u16 = 128;
}

/// Bits of the control word, as `REGISTERS.md` numbers them.
#[allow(missing_docs)] // their names are their meaning
pub mod control {
    pub const ENABLE: u16 = 1;
    pub const LOAD_JOB: u16 = 2;
    pub const START: u16 = 4;
    pub const ABORT: u16 = 8;
    pub const RESET_ERROR: u16 = 32;
    pub const ACKNOWLEDGE: u16 = 16;
    pub const SET_PART: u16 = 64;
}

/// A connection to the line's PLC side.
pub struct Modbus(TcpStream);

impl Modbus {
    /// Tries to connect once.
    ///
    /// # Errors
    /// Nobody listens.
    pub fn connect(port: u16) -> io::Result<Self> {
        let stream = TcpStream::connect(("127.0.0.1", port))?;
        // On loopback a connection to a port where nobody listens can be made from that very port.
        if stream.local_addr()? == stream.peer_addr()? {
            return Err(io::ErrorKind::ConnectionRefused.into());
        }
        stream.set_read_timeout(Some(Duration::from_secs(5)))?;
        stream.set_nodelay(true)?;
        Ok(Self(stream))
    }

    /// Connects as soon as somebody listens; panics after a minute.
    pub fn connect_when_up(port: u16) -> Self {
        let until = Instant::now() + PATIENCE;
        loop {
            match Self::connect(port) {
                Ok(client) => return client,
                Err(error) => assert!(Instant::now() < until, "nobody listens on {port}: {error}"),
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Reads registers.
    ///
    /// # Errors
    /// The connection broke, or the request was refused.
    pub fn read(&mut self, address: u16, count: u16) -> io::Result<Vec<u16>> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), count.to_be_bytes());
        let answer = self.request(&[3, a, b, c, d])?;
        if answer.first() != Some(&3) {
            return Err(io::Error::other(format!("exception {answer:?}")));
        }
        Ok(answer[2..].chunks(2).map(|two| u16::from_be_bytes([two[0], two[1]])).collect())
    }

    /// Writes the control word.
    ///
    /// # Errors
    /// The connection broke, or the write was refused.
    pub fn control(&mut self, word: u16) -> io::Result<()> {
        let ([a, b], [c, d]) = (CONTROL.to_be_bytes(), word.to_be_bytes());
        let answer = self.request(&[6, a, b, c, d])?;
        if answer.first() == Some(&6) { Ok(()) } else { Err(io::Error::other(format!("refused {answer:?}"))) }
    }

    /// Sets `enable`, and nothing else. Panics where that is refused.
    pub fn enable(&mut self) {
        self.control(control::ENABLE).unwrap();
    }

    /// Loads a job and waits for the answer: `None` when it was carried out, otherwise the reason. Panics after a minute.
    pub fn load_job(&mut self, job_id: u32) -> Option<u16> {
        let word = control::ENABLE | control::LOAD_JOB;
        let words = [word, (job_id >> 16) as u16, job_id as u16, 0, 0, 0, 0];
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
        let [a, b] = CONTROL.to_be_bytes();
        let pdu = [&[16, a, b, 0, words.len() as u8, bytes.len() as u8][..], &bytes].concat();
        assert_eq!(self.request(&pdu).unwrap()[0], 16);
        let until = Instant::now() + PATIENCE;
        loop {
            let [carried_out, refused] = self.read(CARRIED_OUT, 2).unwrap()[..] else {
                panic!("two registers")
            };
            let refusal = self.read(REFUSAL, 1).unwrap()[0];
            if (carried_out | refused) & control::LOAD_JOB != 0 {
                self.enable();
                return (refused & control::LOAD_JOB != 0).then_some(refusal);
            }
            assert!(Instant::now() < until, "load_job {job_id} is not answered");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Aborts what is running and loads a job. A worker who goes on may have begun the next piece before that: then once more. Panics after a minute,
    /// and where it is refused for another reason.
    pub fn abort_and_load_job(&mut self, job_id: u32) {
        let until = Instant::now() + PATIENCE;
        loop {
            self.control(control::ENABLE | control::ABORT).unwrap();
            self.enable();
            let Some(refusal) = self.load_job(job_id) else { return };
            // On a busy machine the command before may still be under way.
            let may_pass = [Refusal::Busy, Refusal::TooMany].map(|one| u16::from(one.code()));
            assert!(may_pass.contains(&refusal), "load_job {job_id}: {refusal}");
            assert!(Instant::now() < until, "the worker is never between two pieces");
        }
    }

    /// Gives the part id of the next job, and waits until the judge has it. Panics after a minute, and where it is refused.
    pub fn set_part(&mut self, id: &str) {
        let mut bytes = [0; 32];
        bytes[..id.len()].copy_from_slice(id.as_bytes());
        let [a, b] = PART.to_be_bytes();
        let pdu = [&[16, a, b, 0, 16, 32][..], &bytes].concat();
        assert_eq!(self.request(&pdu).unwrap()[0], 16);
        self.control(control::ENABLE | control::SET_PART).unwrap();
        let until = Instant::now() + PATIENCE;
        while self.read(CARRIED_OUT, 1).unwrap()[0] & control::SET_PART == 0 {
            assert_eq!(self.read(CARRIED_OUT + 1, 1).unwrap()[0] & control::SET_PART, 0, "{id} is refused");
            assert!(Instant::now() < until, "set_part {id} is not answered");
            std::thread::sleep(Duration::from_millis(5));
        }
        self.enable();
    }

    /// The part id that the judge gives to the next job.
    pub fn next_part(&mut self) -> String {
        let words = self.read(NEXT_PART, 16).unwrap();
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
        String::from_utf8(bytes).unwrap().trim_end_matches('\0').to_owned()
    }

    /// The job that the judge has.
    pub fn job_in_force(&mut self) -> u32 {
        self.long(JOB_IN_FORCE)
    }

    /// Takes over the offered result: sets `acknowledge`, waits until that counts, and clears it. Panics where it is refused.
    pub fn acknowledge(&mut self) {
        self.control(control::ENABLE | control::ACKNOWLEDGE).unwrap();
        self.wait_until(|word| word & status::DONE == 0, "an acknowledgement");
        self.enable();
    }

    /// The status word.
    ///
    /// # Errors
    /// As [`Modbus::read`].
    pub fn status(&mut self) -> io::Result<u16> {
        Ok(self.read(STATUS, 1)?[0])
    }

    /// Number of the result on the registers, for the word order "big".
    pub fn sequence(&mut self) -> u32 {
        self.long(SEQUENCE)
    }

    /// Number of results that were lost to the PLC.
    pub fn lost(&mut self) -> u32 {
        self.long(LOST)
    }

    /// Number of this start of the role `plc`.
    pub fn boot(&mut self) -> u32 {
        self.long(BOOT)
    }

    fn long(&mut self, address: u16) -> u32 {
        let words = self.read(address, 2).unwrap();
        u32::from(words[0]) << 16 | u32::from(words[1])
    }

    /// Epoch and `seq` of the verdict on the registers, for the word order "big".
    pub fn result(&mut self) -> (u64, u64) {
        let words = self.read(EPOCH, 8).unwrap();
        let number = |words: &[u16]| words.iter().fold(0, |number, word| number << 16 | u64::from(*word));
        (number(&words[..4]), number(&words[4..]))
    }

    /// Reads until the status word has all these bits; panics after a minute.
    pub fn wait_for(&mut self, bits: u16) {
        self.wait_until(|word| word & bits == bits, &format!("{bits:#b}"));
    }

    fn wait_until(&mut self, holds: impl Fn(u16) -> bool, what: &str) {
        let until = Instant::now() + PATIENCE;
        loop {
            let word = self.status().unwrap();
            if holds(word) {
                return;
            }
            assert!(Instant::now() < until, "status {word:#b}, expected {what}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn request(&mut self, pdu: &[u8]) -> io::Result<Vec<u8>> {
        let mut frame = vec![0, 1, 0, 0, 0, u8::try_from(pdu.len() + 1).unwrap(), 1];
        frame.extend_from_slice(pdu);
        self.0.write_all(&frame)?;
        let mut header = [0; 7];
        self.0.read_exact(&mut header)?;
        let length = usize::from(u16::from_be_bytes([header[4], header[5]]));
        let mut answer = vec![0; length - 1];
        self.0.read_exact(&mut answer)?;
        Ok(answer)
    }
}
