//! A folder as it is after a loss of power: what was synchronised is there, and of the rest whatever chance leaves.
//!
//! The model is that of POSIX, with the sectors of a disk. After `fsync` of a file its content is on disk, after `fsync` of the folder its names are.
//! Of every later change each sector of 512 bytes may be on disk or not, in any order. Names are made and removed in their order. That is what SQLite
//! asks of a disk, and no more. A disk that says that it has written what it has not is another fault.

use andon_tests::shim;
use andon_tests::simulator::Random;
use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

const SECTOR: usize = 512;

/// The library that notes what a program does to the folder.
pub(crate) struct Disk {
    folder: PathBuf,
    notes: PathBuf,
    library: OsString,
}

/// What the chance of one cut has taken.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Lost {
    /// Sectors that were not synchronised, and how many of them are gone.
    pub(crate) sectors: usize,
    pub(crate) gone: usize,
    /// Names that were made or removed, and how many of these changes are gone.
    pub(crate) names: usize,
    pub(crate) names_gone: usize,
}

impl Lost {
    pub(crate) fn add(&mut self, more: &Self) {
        self.sectors += more.sectors;
        self.gone += more.gone;
        self.names += more.names;
        self.names_gone += more.names_gone;
    }
}

impl Disk {
    /// Compiles the library. The folder must exist and is empty.
    pub(crate) fn new(folder: PathBuf, work: &Path) -> Self {
        let library = shim::compiled(work, include_str!("disk.c"));
        Self { folder, notes: work.join("disk.log"), library }
    }

    /// The environment of a program that loses its power when it does something to the folder for the time `cut`.
    pub(crate) fn environment(&self, cut: usize) -> Vec<(&'static str, OsString)> {
        vec![
            ("LD_PRELOAD", self.library.clone()),
            ("DISK_FOLDER", self.folder.clone().into()),
            ("DISK_LOG", self.notes.clone().into()),
            ("DISK_CUT", cut.to_string().into()),
        ]
    }

    /// What is in the folder now is on disk: to be called before a program is started with [`Disk::environment`].
    pub(crate) fn mount(&self) -> Mounted {
        let _ = fs::remove_file(&self.notes);
        let mut mounted = Mounted::default();
        for entry in fs::read_dir(&self.folder).unwrap().flatten() {
            let number = entry.metadata().unwrap().ino();
            let content = Content { durable: fs::read(entry.path()).unwrap(), pending: Vec::new() };
            mounted.contents.insert(number, content);
            mounted.names.insert(entry.file_name().into_string().unwrap(), number);
        }
        mounted
    }

    /// Leaves in the folder what a loss of power leaves.
    pub(crate) fn cut(&self, mut mounted: Mounted, random: &mut Random) -> Lost {
        mounted.follow(&fs::read(&self.notes).unwrap_or_default());
        let index: Vec<(PathBuf, Vec<u8>)> = fs::read_dir(&self.folder)
            .unwrap()
            .flatten()
            .filter(|entry| entry.file_name().to_string_lossy().ends_with("-shm"))
            .map(|entry| (entry.path(), fs::read(entry.path()).unwrap()))
            .collect();
        let (files, lost) = mounted.after_loss(random);
        fs::remove_dir_all(&self.folder).unwrap();
        fs::create_dir(&self.folder).unwrap();
        for (name, bytes) in files {
            fs::write(self.folder.join(name), bytes).unwrap();
        }
        // The index of the log is memory that is shared through a file: it may have been written out at any time, or never.
        for (path, bytes) in index.into_iter().filter(|_| random.uniform() < 0.5) {
            fs::write(path, bytes).unwrap();
        }
        lost
    }
}

/// A folder while a program works on it.
#[derive(Default)]
pub(crate) struct Mounted {
    /// By the number that the file system gives a file.
    contents: HashMap<u64, Content>,
    names: BTreeMap<String, u64>,
    /// Names that were made or removed since the folder was synchronised.
    pending: Vec<Naming>,
}

#[derive(Default)]
struct Content {
    durable: Vec<u8>,
    pending: Vec<Change>,
}

enum Change {
    Write { offset: usize, bytes: Vec<u8> },
    Truncate { length: usize },
}

enum Naming {
    Made { name: String, number: u64 },
    Removed { name: String },
}

impl Mounted {
    /// Follows the notes of the library.
    fn follow(&mut self, mut notes: &[u8]) {
        while let Some((head, rest)) = notes.split_at_checked(32) {
            let word = |index: usize| u64::from_le_bytes(head[8 * index..8 * index + 8].try_into().unwrap());
            let (kind, number, offset, length) = (word(0) as u8, word(1), word(2) as usize, word(3) as usize);
            let (bytes, rest) = rest.split_at(if kind == b'T' { 0 } else { length });
            notes = rest;
            let name = || String::from_utf8(bytes.to_vec()).unwrap();
            match kind {
                b'C' => {
                    // The number may be that of a file that is gone.
                    self.contents.insert(number, Content::default());
                    self.pending.push(Naming::Made { name: name(), number });
                }
                b'U' => self.pending.push(Naming::Removed { name: name() }),
                b'W' => self.change(number, Change::Write { offset, bytes: bytes.to_vec() }),
                b'T' => self.change(number, Change::Truncate { length }),
                b'S' => self.contents.entry(number).or_default().synchronise(),
                b'D' => {
                    let pending = std::mem::take(&mut self.pending);
                    pending.iter().for_each(|naming| naming.apply(&mut self.names));
                }
                other => panic!("a note of the kind {other}"),
            }
        }
    }

    fn change(&mut self, number: u64, change: Change) {
        self.contents.entry(number).or_default().pending.push(change);
    }

    fn after_loss(mut self, random: &mut Random) -> (Vec<(String, Vec<u8>)>, Lost) {
        let mut lost = Lost { names: self.pending.len(), ..Lost::default() };
        let kept = random.index(self.pending.len() + 1);
        lost.names_gone = lost.names - kept;
        self.pending.iter().take(kept).for_each(|naming| naming.apply(&mut self.names));
        // Everything may have come to the disk, nothing, or any part.
        let share = [0.0, 1.0, random.uniform()][random.index(3)];
        let files = self.names.iter().map(|(name, number)| {
            let content = self.contents.remove(number).unwrap_or_default();
            (name.clone(), content.after_loss(share, random, &mut lost))
        });
        let files = files.collect();
        (files, lost)
    }
}

impl Naming {
    fn apply(&self, names: &mut BTreeMap<String, u64>) {
        match self {
            Self::Made { name, number } => names.insert(name.clone(), *number),
            Self::Removed { name } => names.remove(name),
        };
    }
}

impl Content {
    fn synchronise(&mut self) {
        for change in std::mem::take(&mut self.pending) {
            match change {
                Change::Write { offset, bytes } => put(&mut self.durable, offset, &bytes),
                Change::Truncate { length } => self.durable.resize(length, 0),
            }
        }
    }

    fn after_loss(mut self, share: f64, random: &mut Random, lost: &mut Lost) -> Vec<u8> {
        let mut comes = |sectors: usize| {
            let comes = random.uniform() < share;
            lost.sectors += sectors;
            lost.gone += if comes { 0 } else { sectors };
            comes
        };
        for change in self.pending {
            match change {
                Change::Write { offset, bytes } => {
                    for (offset, sector) in sectors(offset, &bytes) {
                        if comes(1) {
                            put(&mut self.durable, offset, sector);
                        }
                    }
                }
                Change::Truncate { length } if comes(1) => self.durable.resize(length, 0),
                Change::Truncate { .. } => {}
            }
        }
        self.durable
    }
}

/// Cuts a write at the borders of the disk's sectors.
fn sectors(offset: usize, bytes: &[u8]) -> Vec<(usize, &[u8])> {
    let (mut at, mut rest, mut found) = (offset, bytes, Vec::new());
    while !rest.is_empty() {
        let (sector, more) = rest.split_at(rest.len().min(SECTOR - at % SECTOR));
        found.push((at, sector));
        (at, rest) = (at + sector.len(), more);
    }
    found
}

fn put(content: &mut Vec<u8>, offset: usize, bytes: &[u8]) {
    content.resize(content.len().max(offset + bytes.len()), 0);
    content[offset..offset + bytes.len()].copy_from_slice(bytes);
}
