//! Writes recordings in a thread of its own: a slow or full disk costs recordings, and never holds up the role that receives.
//!
//! The thread is woken when the role says so, and then it gets all that came since. On a machine with few processors it takes the time of what judges,
//! and half a dozen messages come with each frame.

use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use andon_ipc::{Channel, UtcTime};
use mcap::McapError;
use shm_schemas::{MessageId, Verdict, from_bytes};

use crate::index::{Index, still_of};
use crate::repair::{Repaired, is_cut, repair};
use crate::store::{self, Budget, Enforced};
use crate::topic::Topic;
use crate::writer::{Attachment, Entry, RecordingWriter, shifted};

/// How often what was received is brought to the disk: a kill costs no more than this.
const FLUSH: Duration = Duration::from_secs(1);

/// What was received is given to the thread after this time at the latest: a kill costs so much more.
const LONGEST_HELD: Duration = Duration::from_millis(100);

/// How often what has become too old is looked for, whether anything is recorded or not.
const TRIM: Duration = Duration::from_secs(3600);

/// What an order takes in memory beside its bytes: its place in the queue and the heads of its allocations.
const HEAD: usize = 256;

/// What to do with the folder.
enum Order {
    Begin {
        utc_ns: u64,
        offset_ns: i128,
    },
    Attach(Attachment),
    Write(Entry),
    Still(MessageId, Vec<u8>),
    End,
    /// Whether something could be written now.
    Probe,
}

impl Order {
    /// The memory that it takes while it waits.
    fn bytes(&self) -> usize {
        HEAD + match self {
            Self::Attach(attachment) => attachment.data.len(),
            Self::Write(entry) => entry.data.len(),
            Self::Still(_, jpeg) => jpeg.len(),
            Self::Begin { .. } | Self::End | Self::Probe => 0,
        }
    }
}

/// What has become of it.
#[derive(Debug)]
pub enum Told {
    /// A recording has begun.
    Began(PathBuf),
    /// A recording is complete.
    Kept(PathBuf),
    /// One that was cut is complete now.
    Repaired(PathBuf),
    /// So many old ones were removed.
    Trimmed(u64),
    /// Nothing can be written: why, with the file.
    Unwritten(String),
    /// One that was cut could not be repaired: why.
    Unrepaired(String),
    /// One that is too old or too much could not be removed: why.
    Unremoved(String),
}

/// The near end of the thread.
pub struct Disk {
    orders: Option<Sender<Vec<Order>>>,
    /// What the thread was not given yet.
    held: Vec<Order>,
    /// When the first of it came.
    held_since: Instant,
    told: Receiver<Told>,
    state: Arc<State>,
    thread: Option<JoinHandle<()>>,
    limit: usize,
}

#[derive(Default)]
struct State {
    /// Bytes that wait.
    waiting: AtomicUsize,
    /// What comes cannot be written.
    is_failing: AtomicBool,
    /// It is being found out whether it can be by now.
    is_probing: AtomicBool,
}

impl Disk {
    /// Starts the thread, which first repairs what an earlier one has left. At most `limit` bytes wait for it.
    ///
    /// # Errors
    /// That no thread can be started.
    pub fn start(folder: PathBuf, budget: Budget, limit: usize) -> io::Result<Self> {
        let (orders, taken) = channel();
        let (tell, told) = channel();
        let state = Arc::new(State::default());
        let far = Arc::clone(&state);
        let trimmed = Instant::now();
        let said = HashSet::new();
        let ended = Vec::new();
        let work =
            move || Work { folder, budget, tell, state: far, open: None, trimmed, ended, said }.run(&taken);
        let thread = std::thread::Builder::new().name("recordings".into()).spawn(work)?;
        let (held, held_since) = (Vec::new(), Instant::now());
        Ok(Self { orders: Some(orders), held, held_since, told, state, thread: Some(thread), limit })
    }

    /// Begins a recording, in place of the one that is open. `offset_ns` is what UTC is ahead of the clock of its messages.
    pub fn begin(&mut self, utc_ns: u64, offset_ns: i128) {
        self.order(Order::Begin { utc_ns, offset_ns });
    }

    /// Adds a file.
    pub fn attach(&mut self, attachment: Attachment) {
        self.order(Order::Attach(attachment));
    }

    /// Adds a message. False where too much waits already: it is lost.
    pub fn write(&mut self, entry: Entry) -> bool {
        self.order_if_room(Order::Write(entry))
    }

    /// Puts the picture of a verdict beside the recording. False where too much waits already: it is lost.
    pub fn still(&mut self, verdict: MessageId, jpeg: Vec<u8>) -> bool {
        self.order_if_room(Order::Still(verdict, jpeg))
    }

    /// Finds out whether something can be written now; [`Disk::is_failing`] tells.
    pub fn probe(&mut self) {
        self.state.is_probing.store(true, Ordering::Relaxed);
        self.order(Order::Probe);
    }

    /// Whether a [`Disk::probe`] is still without its answer: what comes meanwhile waits for it.
    #[must_use]
    pub fn is_probing(&self) -> bool {
        self.state.is_probing.load(Ordering::Relaxed)
    }

    /// Completes the recording.
    pub fn end(&mut self) {
        self.order(Order::End);
    }

    /// Gives the thread what came since. While something is being judged that waits, but not for longer than [`LONGEST_HELD`].
    pub fn release(&mut self, is_judging: bool) {
        if self.held.is_empty() || is_judging && self.held_since.elapsed() < LONGEST_HELD {
            return;
        }
        let held = std::mem::take(&mut self.held);
        if let Some(orders) = &self.orders {
            // A thread that has panicked has ended the process.
            let _ = orders.send(held);
        }
    }

    /// Whether what comes cannot be written.
    #[must_use]
    pub fn is_failing(&self) -> bool {
        self.state.is_failing.load(Ordering::Relaxed)
    }

    /// What has happened since this was asked last.
    pub fn told(&self) -> impl Iterator<Item = Told> {
        self.told.try_iter()
    }

    /// Completes what is open, and waits for it.
    pub fn finish(&mut self) {
        self.release(false);
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            // A thread that has panicked has ended the process.
            let _ = thread.join();
        }
    }

    fn order_if_room(&mut self, order: Order) -> bool {
        let has_room = self.state.waiting.load(Ordering::Relaxed) + order.bytes() <= self.limit;
        if has_room {
            self.order(order);
        }
        has_room
    }

    fn order(&mut self, order: Order) {
        self.state.waiting.fetch_add(order.bytes(), Ordering::Relaxed);
        if self.held.is_empty() {
            self.held_since = Instant::now();
        }
        self.held.push(order);
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        self.finish();
    }
}

/// A recording that is being written.
struct Open {
    path: PathBuf,
    writer: RecordingWriter<BufWriter<File>>,
    offset_ns: i128,
    index: Index,
    is_index_new: bool,
    flushed: Instant,
}

/// Why a recording cannot be written.
type Unwritten = (PathBuf, McapError);

struct Work {
    folder: PathBuf,
    budget: Budget,
    tell: Sender<Told>,
    state: Arc<State>,
    open: Option<Open>,
    trimmed: Instant,
    /// What was recorded here, and when it ended, by a clock that nobody sets. A clock that is stepped forward makes it no older.
    ended: Vec<(PathBuf, Instant)>,
    /// What was said of recordings that cannot be repaired or removed: it is tried again and again, and says nothing new.
    said: HashSet<String>,
}

impl Work {
    fn run(mut self, orders: &Receiver<Vec<Order>>) {
        self.trim();
        self.repair_all();
        let probed = self.probe();
        self.settle(probed);
        loop {
            match orders.recv_timeout(FLUSH) {
                Ok(orders) => orders.into_iter().for_each(|order| {
                    self.obey(order);
                    self.flush();
                }),
                Err(RecvTimeoutError::Timeout) => self.flush(),
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if self.trimmed.elapsed() >= TRIM {
                self.trim();
            }
        }
        let ended = self.end();
        self.settle(ended);
    }

    /// After each order: a clip comes as hundreds of them at once, and the room on the disk is the journal's.
    fn flush(&mut self) {
        let flushed = self.flush_when_due();
        self.settle(flushed);
    }

    fn tell(&self, told: Told) {
        // Nobody may be there any more to hear it.
        let _ = self.tell.send(told);
    }

    /// A recording that cannot be written is given up: what is whole in it stays.
    fn settle(&mut self, done: Result<(), Unwritten>) {
        let Err((path, error)) = done else { return };
        self.open = None;
        if !self.state.is_failing.swap(true, Ordering::Relaxed) {
            let why = match &error {
                McapError::Io(source) => source.to_string(),
                other => other.to_string(),
            };
            self.tell(Told::Unwritten(format!("{}: {why}", path.display())));
        }
    }

    fn obey(&mut self, order: Order) {
        self.state.waiting.fetch_sub(order.bytes(), Ordering::Relaxed);
        let done = match order {
            Order::Begin { utc_ns, offset_ns } => self.begin(utc_ns, offset_ns),
            Order::Write(entry) => self.with_open(|open| open.write(&entry)),
            Order::Attach(attachment) => {
                self.with_open(|open| open.writer.attach(&attachment, UtcTime::now().nanoseconds()))
            }
            Order::Still(verdict, jpeg) => {
                self.with_open(|open| Ok(write_still(&still_of(&open.path, verdict), &jpeg)?))
            }
            Order::End => self.end(),
            Order::Probe => {
                let probed = self.probe();
                self.state.is_probing.store(false, Ordering::Relaxed);
                probed
            }
        };
        self.settle(done);
    }

    /// What comes while nothing is open is lost, and was said to be.
    fn with_open(&mut self, work: impl FnOnce(&mut Open) -> Result<(), McapError>) -> Result<(), Unwritten> {
        let Some(open) = &mut self.open else { return Ok(()) };
        work(open).map_err(|error| (open.path.clone(), error))
    }

    fn begin(&mut self, utc_ns: u64, offset_ns: i128) -> Result<(), Unwritten> {
        self.end()?;
        self.probe()?;
        let path =
            store::new_file(&self.folder, utc_ns).map_err(|error| (self.folder.clone(), error.into()))?;
        let open = Open::create(&path, offset_ns).map_err(|error| (path.clone(), error))?;
        self.open = Some(open);
        self.tell(Told::Began(path));
        Ok(())
    }

    /// Makes room, and finds out whether there is any and whether a file may be made. If so, what was given up meanwhile is completed.
    fn probe(&mut self) -> Result<(), Unwritten> {
        let folder = self.folder.clone();
        let failed = |error: io::Error| (folder.clone(), error.into());
        std::fs::create_dir_all(&folder).map_err(failed)?;
        tempfile::tempfile_in(&folder).map_err(failed)?;
        self.trim();
        if store::lacks_room(&folder, &self.budget) {
            return Err((folder, full()));
        }
        if self.state.is_failing.load(Ordering::Relaxed) {
            // Before anything counts on it: it may take long.
            self.repair_all();
            self.state.is_failing.store(false, Ordering::Relaxed);
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), Unwritten> {
        let Some(open) = self.open.take() else { return Ok(()) };
        let path = open.path.clone();
        open.finish().map_err(|error| (path.clone(), error))?;
        self.ended.push((path.clone(), Instant::now()));
        self.tell(Told::Kept(path));
        self.trim();
        Ok(())
    }

    /// Brings what was received to the disk, as long as there is more room than the journal may need.
    fn flush_when_due(&mut self) -> Result<(), Unwritten> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if !open.flush_when_due()? || !store::lacks_room(&self.folder, &self.budget) {
            return Ok(());
        }
        let path = open.path.clone();
        self.trim();
        if store::lacks_room(&self.folder, &self.budget) { Err((path, full())) } else { Ok(()) }
    }

    fn trim(&mut self) {
        self.trimmed = Instant::now();
        let age = self.budget.age;
        self.ended.retain(|(path, ended)| ended.elapsed() <= age && path.exists());
        let young: Vec<&Path> = self.ended.iter().map(|(path, _)| path.as_path()).collect();
        let done = store::enforce(&self.folder, &self.budget, &young).unwrap_or_else(|error| {
            let unremoved = vec![format!("{}: {error}", self.folder.display())];
            Enforced { removed: 0, unremoved }
        });
        if done.removed > 0 {
            self.tell(Told::Trimmed(done.removed));
        }
        for why in done.unremoved {
            self.tell_once(why, Told::Unremoved);
        }
    }

    /// Completes what a recorder that was killed has left.
    fn repair_all(&mut self) {
        store::sweep(&self.folder);
        for path in store::files(&self.folder).unwrap_or_default() {
            // A repair writes the file once more, and the room may be the journal's. Such a file stays as it is until there is some.
            let bytes = std::fs::metadata(&path).map_or(0, |file| file.len());
            if !store::has_room_for(&self.folder, &self.budget, bytes) {
                if is_cut(&path) {
                    let path = path.display();
                    let why =
                        format!("{path}: there is no room for a whole one beside it; make room on its disk");
                    self.tell_once(why, Told::Unrepaired);
                }
                continue;
            }
            match repair(&path) {
                Ok(Repaired::Completed) => self.tell(Told::Repaired(path)),
                Ok(Repaired::Whole | Repaired::InUse | Repaired::Removed) => (),
                Err(error) => self.tell_once(error.to_string(), Told::Unrepaired),
            }
        }
    }

    fn tell_once(&mut self, why: String, told: fn(String) -> Told) {
        if self.said.insert(why.clone()) {
            self.tell(told(why));
        }
    }
}

/// For a file that its owner alone may read, whatever the user's mask says: it shows people.
fn private() -> OpenOptions {
    let mut options = File::options();
    options.write(true).mode(0o600);
    options
}

fn write_still(path: &Path, jpeg: &[u8]) -> io::Result<()> {
    private().create(true).truncate(true).open(path)?.write_all(jpeg)
}

/// There is no more room, as far as recordings may know.
fn full() -> McapError {
    io::Error::new(io::ErrorKind::StorageFull, "the rest of this disk is the journal's").into()
}

impl Open {
    fn create(path: &Path, offset_ns: i128) -> Result<Self, McapError> {
        let file = private().create_new(true).open(path)?;
        // Who repairs sees by it that this one is not cut.
        let _ = store::lock(&file);
        let writer = RecordingWriter::new(BufWriter::new(file), offset_ns)?;
        Ok(Self {
            path: path.into(),
            writer,
            offset_ns,
            index: Index::default(),
            is_index_new: false,
            flushed: Instant::now(),
        })
    }

    fn write(&mut self, entry: &Entry) -> Result<(), McapError> {
        self.index.sent(shifted(entry.sent_ns, self.offset_ns));
        if entry.topic == Topic::Raw(Channel::Verdict)
            && let Some(verdict) = from_bytes::<Verdict>(&entry.data)
        {
            self.index.verdicts.push((&verdict).into());
            self.is_index_new = true;
        }
        self.writer.write(entry)
    }

    /// Whether it was due.
    fn flush_when_due(&mut self) -> Result<bool, Unwritten> {
        if self.flushed.elapsed() < FLUSH {
            return Ok(false);
        }
        self.flushed = Instant::now();
        let flushed = self.writer.flush().and_then(|()| self.write_index());
        flushed.map(|()| true).map_err(|error| (self.path.clone(), error))
    }

    fn write_index(&mut self) -> Result<(), McapError> {
        if std::mem::take(&mut self.is_index_new) {
            self.index.write_beside(&self.path)?;
        }
        Ok(())
    }

    fn finish(mut self) -> Result<(), McapError> {
        self.is_index_new = true;
        self.write_index()?;
        let out = self.writer.finish()?;
        let file = out.into_inner().map_err(|error| error.into_error())?;
        Ok(file.sync_all()?)
    }
}

#[cfg(test)]
mod tests;
