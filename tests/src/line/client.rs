//! A Modbus client of plain bytes: it shares no code with the server.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Bits of the status word, as `REGISTERS.md` numbers them.
#[allow(missing_docs)] // their names are their meaning
pub mod status {
    pub const ONLINE: u16 = 1;
    pub const READY: u16 = 2;
    pub const DONE: u16 = 8;
    pub const ERROR: u16 = 128;
}

/// A connection to the line's PLC side.
pub struct Modbus(TcpStream);

impl Modbus {
    /// Connects, once.
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
    pub fn wait(port: u16) -> Self {
        let until = Instant::now() + Duration::from_secs(60);
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
    /// The connection broke, or the answer is no list of registers.
    pub fn read(&mut self, address: u16, count: u16) -> io::Result<Vec<u16>> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), count.to_be_bytes());
        let answer = self.ask(&[3, a, b, c, d])?;
        if answer.first() != Some(&3) {
            return Err(io::Error::other(format!("exception {answer:?}")));
        }
        Ok(answer[2..].chunks(2).map(|two| u16::from_be_bytes([two[0], two[1]])).collect())
    }

    /// Writes one register.
    ///
    /// # Errors
    /// The connection broke, or the write was refused.
    pub fn write(&mut self, address: u16, value: u16) -> io::Result<()> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), value.to_be_bytes());
        let answer = self.ask(&[6, a, b, c, d])?;
        if answer.first() == Some(&6) { Ok(()) } else { Err(io::Error::other(format!("refused {answer:?}"))) }
    }

    /// The status word.
    ///
    /// # Errors
    /// As [`Modbus::read`].
    pub fn status(&mut self) -> io::Result<u16> {
        Ok(self.read(0, 1)?[0])
    }

    /// Reads until the status word has all these bits; panics after a minute.
    pub fn wait_for(&mut self, bits: u16) {
        let until = Instant::now() + Duration::from_secs(60);
        loop {
            let word = self.status().unwrap();
            if word & bits == bits {
                return;
            }
            assert!(Instant::now() < until, "status {word:#b}, wanted {bits:#b}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn ask(&mut self, pdu: &[u8]) -> io::Result<Vec<u8>> {
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
