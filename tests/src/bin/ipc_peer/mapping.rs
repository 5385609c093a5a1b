//! Which byte of which file lies at an address. Two processes that find the same byte look at the same memory.

use std::fs;
use std::io;

/// A byte of a mapped file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) inode: u64,
    pub(crate) offset: u64,
}

/// The mapping of this process that was looked up last.
#[derive(Default)]
pub(crate) struct Mapping {
    begin: u64,
    end: u64,
    inode: u64,
    offset: u64,
}

impl Mapping {
    /// The place of some bytes. It reads `/proc/self/maps` only when they lie in another mapping than the last ones.
    pub(crate) fn place_of(&mut self, bytes: &[u8]) -> io::Result<Place> {
        let address = bytes.as_ptr().addr() as u64;
        if !(self.begin..self.end).contains(&address) {
            *self = find(address)?;
        }
        Ok(Place { inode: self.inode, offset: self.offset + (address - self.begin) })
    }
}

fn find(address: u64) -> io::Result<Mapping> {
    // "7f0e5c000000-7f0e5c800000 rw-s 00000000 00:19 42    /dev/shm/andon_..."
    let hex = |text: &str| u64::from_str_radix(text, 16).ok();
    let maps = fs::read_to_string("/proc/self/maps")?;
    let parsed = maps.lines().filter(|line| line.contains("/dev/shm/")).filter_map(|line| {
        let mut fields = line.split_ascii_whitespace();
        let (begin, end) = fields.next()?.split_once('-')?;
        let offset = hex(fields.nth(1)?)?;
        let inode = fields.nth(1)?.parse().ok()?;
        Some(Mapping { begin: hex(begin)?, end: hex(end)?, inode, offset })
    });
    let mut at = parsed.filter(|mapping| (mapping.begin..mapping.end).contains(&address));
    at.next().ok_or_else(|| io::Error::other("the bytes lie in no file of /dev/shm"))
}
