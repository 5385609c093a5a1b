//! The pictures around events, out of the recordings, for browsers that wait for them.
//!
//! Threads read them, because a disk may be slow. One finds films and their pictures, one after the other; each download has one of its own, and there
//! are few at once. A film is found once and remembered: where its pictures lie, and what was seen in each. A picture is read when it is asked for. So
//! what is kept has a fixed size, however long a recording is.
//!
//! Which file it is, the folder of the recordings says: nothing that a browser sends becomes a path.

use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, TrySendError, channel, sync_channel};
use std::thread::Builder;
use std::time::Duration;

use andon_board::{Ask, Board, Film, NoFilm, Picture, Thing, Wanted};
use andon_host::config::Config;
use andon_http::{Feed, Response};
use andon_ipc::Channel;
use andon_record::Topic;
use andon_record::picture::jpeg_in;
use andon_record::places::{Place, places};
use andon_record::store;
use shm_schemas::{Couples, Detections, MessageId, Verdict, from_bytes};

use super::seen::Seen;
use crate::mark::{Mark, mark};

/// Browsers that wait for the thread. Those that come when there are more are told so.
const WAITING: usize = 32;

/// A film begins so long before its event, in nanoseconds: a clip has no more.
const BEFORE_NS: u64 = 60_000_000_000;
/// And it ends so long after it.
const AFTER_NS: u64 = 60_000_000_000;
/// Messages of which a film is made: pictures of two minutes at 60 Hz, each with what was seen in it and what follows from that.
const MESSAGES: usize = 22_000;
/// Films that are remembered, each with some megabytes at most.
const FILMS: usize = 2;

/// Downloads at once.
const DOWNLOADS: usize = 2;
/// A client that reads nothing of a download for so long is gone.
const PATIENCE: Duration = Duration::from_secs(10);
/// What is read at once.
const PIECE: usize = 1 << 16;

/// What a film is made of.
const TOPICS: [Topic; 4] = [
    Topic::Picture,
    Topic::Raw(Channel::Detections),
    Topic::Raw(Channel::Couple),
    Topic::Raw(Channel::Verdict),
];

/// What the board draws for the browser that has asked.
enum Answer {
    Film(Result<Film, NoFilm>),
    Frame(Picture),
}

/// What goes to the thread, and what comes from it.
type Thread = (SyncSender<Ask>, Receiver<(Ask, Answer)>);

/// The near end of the thread.
pub(super) struct Films {
    folder: PathBuf,
    /// What is seen before anything has come.
    nothing: Seen,
    thread: Option<Thread>,
}

impl Films {
    pub(super) fn new(config: &Config) -> Self {
        Self { folder: config.recordings(), nothing: Seen::new(config), thread: None }
    }

    /// Takes what browsers have asked of the board, and gives it what was found.
    pub(super) fn turn(&mut self, board: &mut Board) {
        for ask in board.asks() {
            self.ask(ask);
        }
        let answers = self.thread.iter().flat_map(|(_, answers)| answers.try_iter());
        for (ask, answer) in answers {
            match answer {
                Answer::Film(film) => board.film(ask, &film),
                Answer::Frame(picture) => board.frame(ask, &picture),
            }
        }
    }

    fn ask(&mut self, ask: Ask) {
        if self.thread.is_none() {
            self.thread = self.start();
        }
        let unsent = match &self.thread {
            Some((asks, _)) => match asks.try_send(ask) {
                Ok(()) => return,
                Err(TrySendError::Full(ask) | TrySendError::Disconnected(ask)) => ask,
            },
            None => ask,
        };
        unsent.answer(Response::text(503, "more wait for clips than can be served now\n"));
    }

    /// `None` where there is no thread: then it is tried again at the next request.
    fn start(&self) -> Option<Thread> {
        let (send, asks) = sync_channel(WAITING);
        let (answers, receive) = channel();
        let (folder, nothing) = (self.folder.clone(), self.nothing.clone());
        let shelf = Shelf { folder, nothing, reels: Vec::new(), answers, downloads: Arc::default() };
        Builder::new().name("films".into()).spawn(move || shelf.run(&asks)).ok()?;
        Some((send, receive))
    }
}

/// What the thread works with.
struct Shelf {
    folder: PathBuf,
    nothing: Seen,
    /// The films that were asked for last, the newest last.
    reels: Vec<Reel>,
    answers: Sender<(Ask, Answer)>,
    downloads: Arc<AtomicUsize>,
}

/// A film, with where its pictures lie.
struct Reel {
    event: MessageId,
    path: PathBuf,
    /// Of the file: one that has changed is read anew.
    mark: Mark,
    film: Film,
    pictures: Vec<(Place, Vec<Thing>)>,
}

const NO_SUCH_PICTURE: &str = "there is no such picture: the clip was removed, or is damaged\n";

impl Shelf {
    /// Answers until the role has ended.
    fn run(mut self, asks: &Receiver<Ask>) {
        for ask in asks {
            if ask.is_over() {
                continue;
            }
            match &ask.wanted {
                Wanted::Film => {
                    let film = self.reel(&ask).map(|reel| reel.film.clone());
                    self.answer(ask, Answer::Film(film));
                }
                Wanted::Frame(number) => match self.reel(&ask).ok().and_then(|reel| reel.picture(*number)) {
                    Some(picture) => self.answer(ask, Answer::Frame(picture)),
                    None => ask.answer(Response::text(404, NO_SUCH_PICTURE)),
                },
                Wanted::Recording(name) => match self.recording(name) {
                    Some(path) => self.download(ask, path),
                    None => {
                        ask.answer(Response::text(404, "there is no such recording, or it was removed\n"))
                    }
                },
            }
        }
    }

    fn answer(&self, ask: Ask, answer: Answer) {
        // A role that has ended has no browsers.
        let _ = self.answers.send((ask, answer));
    }

    /// The film of an event as its recording is now.
    fn reel(&mut self, ask: &Ask) -> Result<&Reel, NoFilm> {
        let known = self.reels.iter().position(|reel| reel.event == ask.event);
        let reel = known.map(|place| self.reels.remove(place)).filter(Reel::is_current);
        let reel = match reel {
            Some(reel) => reel,
            None => Reel::find(&self.folder, self.nothing.clone(), ask.event, ask.decided_utc_ns)?,
        };
        if self.reels.len() == FILMS {
            self.reels.remove(0);
        }
        self.reels.push(reel);
        // It has just been put there.
        Ok(&self.reels[self.reels.len() - 1])
    }

    /// The recording of this name, if it is one of those there are.
    fn recording(&self, name: &str) -> Option<PathBuf> {
        let recordings = store::indexed(&self.folder).unwrap_or_default();
        let mut paths = recordings.into_iter().map(|recording| recording.path);
        paths.find(|path| path.file_name().is_some_and(|known| known == name))
    }

    /// Sends a recording in a thread of its own, as it is now.
    fn download(&self, ask: Ask, path: PathBuf) {
        let Some(slot) = Slot::take(&self.downloads) else {
            return ask.answer(Response::text(503, "as many recordings are downloaded as may be at once\n"));
        };
        // Without a thread nobody answers, and the browser is told so.
        let _ = Builder::new().name("download".into()).spawn(move || {
            send_to(ask, &path);
            drop(slot);
        });
    }
}

/// Sends a file to the browser that has asked for it.
fn send_to(ask: Ask, path: &Path) {
    match File::open(path) {
        Ok(file) => {
            let (response, feed) = Response::feed("application/octet-stream");
            ask.answer(response);
            send(file, feed);
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            ask.answer(Response::text(404, "the recording was removed\n"));
        }
        Err(_) => ask.answer(Response::text(500, "the recording cannot be read\n")),
    }
}

/// One of the downloads that may be at once.
struct Slot(Arc<AtomicUsize>);

impl Slot {
    fn take(taken: &Arc<AtomicUsize>) -> Option<Self> {
        let slot = Self(Arc::clone(taken));
        (taken.fetch_add(1, Ordering::Relaxed) < DOWNLOADS).then_some(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Sends what a file has now. One that is cut off by its end, or by an error, is one that the browser does not take for whole.
fn send(mut file: File, feed: Feed) {
    let mut left = file.metadata().map_or(0, |file| file.len());
    let mut piece = vec![0; PIECE];
    while left > 0 {
        match file.read(&mut piece) {
            Ok(count @ 1..) => {
                let count = count.min(usize::try_from(left).unwrap_or(usize::MAX));
                left -= count as u64;
                if !feed.send_within(PATIENCE, piece[..count].to_vec()) {
                    return;
                }
            }
            _ => return,
        }
    }
    feed.end_within(PATIENCE);
}

impl Reel {
    /// Finds the film of a verdict in the recordings of a folder.
    fn find(folder: &Path, nothing: Seen, event: MessageId, decided_utc_ns: u64) -> Result<Self, NoFilm> {
        let recordings = store::indexed(folder).unwrap_or_default();
        let path = store::by_verdict(&recordings).get(&event).map(|recording| recording.path.clone());
        let path = path.ok_or(NoFilm::NoClip)?;
        let mark = mark(&path);
        if mark.is_none() {
            return Err(NoFilm::NoClip);
        }
        let times = decided_utc_ns.saturating_sub(BEFORE_NS)..=decided_utc_ns.saturating_add(AFTER_NS);
        let mut found = places(&path, &TOPICS, &times, MESSAGES).map_err(|_| NoFilm::Unreadable)?;
        let file = File::open(&path).map_err(|_| NoFilm::NoClip)?;
        // The time of the picture that it was decided on.
        let is_event = |place: &&Place| {
            place.topic == Topic::Raw(Channel::Verdict)
                && message::<Verdict>(&file, place).is_some_and(|verdict| verdict.stamp.id() == event)
        };
        let zero_ns = found.iter().find(is_event).map_or(decided_utc_ns, |place| place.time_ns);
        // What was seen in a picture has its time, and comes after it.
        found.sort_by_key(|place| place.time_ns);
        let pictures = with_things(&file, &found, nothing);
        let since_ms = |(place, _): &(Place, _)| (place.time_ns as i64 - zero_ns as i64) / 1_000_000;
        let film = Film {
            clip: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            times_ms: pictures.iter().map(since_ms).collect(),
        };
        Ok(Self { event, path, mark, film, pictures })
    }

    fn is_current(&self) -> bool {
        mark(&self.path) == self.mark
    }

    /// The picture with this number and what was seen in it.
    fn picture(&self, number: usize) -> Option<Picture> {
        let (place, things) = self.pictures.get(number)?;
        let message = place.read(&File::open(&self.path).ok()?).ok()?;
        let (jpeg, size) = jpeg_in(&message).ok()?;
        Some(Picture { jpeg, size, things: things.clone() })
    }
}

fn message<T: shm_schemas::Layout>(file: &File, place: &Place) -> Option<T> {
    from_bytes(&place.read(file).ok()?)
}

/// The pictures, each with what was seen in it; all in the order of their times.
fn with_things(file: &File, places: &[Place], mut seen: Seen) -> Vec<(Place, Vec<Thing>)> {
    let mut pictures = Vec::new();
    for of_one_time in places.chunk_by(|one, other| one.time_ns == other.time_ns) {
        let mut is_known = false;
        for place in of_one_time {
            match place.topic {
                Topic::Raw(Channel::Detections) => {
                    if let Some(detections) = message::<Detections>(file, place) {
                        seen.take(&detections);
                        is_known = true;
                    }
                }
                Topic::Raw(Channel::Couple) => {
                    if let Some(couples) = message::<Couples>(file, place) {
                        seen.hold(&couples);
                    }
                }
                _ => (),
            }
        }
        for place in of_one_time.iter().filter(|place| place.topic == Topic::Picture) {
            if !is_known {
                seen.miss();
            }
            pictures.push((*place, seen.things()));
        }
    }
    pictures
}
