//! How far a command has come: a bar on a terminal, and elsewhere a line every few seconds, so that nobody waits before silence.

use std::cell::Cell;
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// How long nothing is said.
const PERIOD: Duration = Duration::from_secs(5);

/// When this process has last shown how far it is, in whichever thread.
static SHOWN: Mutex<Option<Instant>> = Mutex::new(None);

/// Notes that something was shown now.
fn shown() {
    if let Ok(mut last) = SHOWN.lock() {
        *last = Some(Instant::now());
    }
}

/// Whether nothing was shown for a whole period; if so, it is now.
fn is_due() -> bool {
    let Ok(mut last) = SHOWN.lock() else { return false };
    let is_due = last.is_none_or(|last| last.elapsed() >= PERIOD);
    if is_due {
        *last = Some(Instant::now());
    }
    is_due
}

/// Counts the frames of a recording on standard error.
pub(super) struct Progress {
    bar: ProgressBar,
    name: String,
    count: Option<u64>,
    done: Cell<u64>,
    /// When the next line is due; `None` on a terminal, which has the bar.
    next: Cell<Option<Instant>>,
}

/// Begins to count the frames of a recording that has as many of them, if that is known.
pub(super) fn progress(count: Option<u64>, what: &Path) -> Progress {
    let name = what.file_name().unwrap_or(what.as_os_str()).to_string_lossy().into_owned();
    let (bar, template) = match count {
        Some(count) => {
            (ProgressBar::new(count), "{msg:28} [{bar:32}] {pos}/{len} frames, {rate}, {eta} left")
        }
        None => (ProgressBar::new_spinner(), "{msg:28} {spinner} {pos} frames, {rate}"),
    };
    // The templates above are constants that are well formed.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    // The library's own rate has four decimals.
    let style = style.with_key("rate", |state: &ProgressState, out: &mut dyn Write| {
        // Where it cannot be written, nothing of the bar can.
        let _ = write!(out, "{:.0} per second", state.per_sec());
    });
    let bar = bar.with_style(style.progress_chars("=> ")).with_message(name.clone());
    let next = (!std::io::stderr().is_terminal()).then(|| Instant::now() + PERIOD);
    Progress { bar, name, count, done: Cell::new(0), next: Cell::new(next) }
}

impl Progress {
    /// That many more frames are done.
    pub(super) fn inc(&self, frames: u64) {
        self.set_position(self.done.get() + frames);
    }

    /// So many frames are done.
    pub(super) fn set_position(&self, frames: u64) {
        self.done.set(frames);
        self.bar.set_position(frames);
        match self.next.get() {
            Some(next) if Instant::now() >= next => {
                self.next.set(Some(Instant::now() + PERIOD));
                shown();
                eprintln!("{}", line(&self.name, frames, self.count));
            }
            Some(_) => (),
            None => shown(),
        }
    }

    /// Prints something else without the bar in its way. Whoever reads that needs no line besides.
    pub(super) fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.next.set(self.next.get().map(|_| Instant::now() + PERIOD));
        shown();
        self.bar.suspend(print)
    }

    /// Takes the bar away.
    pub(super) fn finish_and_clear(&self) {
        self.bar.finish_and_clear();
    }
}

fn line(name: &str, frames: u64, count: Option<u64>) -> String {
    match count.filter(|count| *count > 0) {
        Some(count) => format!("{name}: {frames} of {count} frames, {} %", 100 * frames / count),
        None => format!("{name}: {frames} frames"),
    }
}

/// Does work that may take minutes, and says that it goes on whenever nothing else has said so for a while.
pub fn working<T>(name: &str, work: impl FnOnce() -> T) -> T {
    let (done, ended) = channel::<()>();
    let (name, began) = (name.to_owned(), Instant::now());
    shown();
    let teller = std::thread::spawn(move || {
        while ended.recv_timeout(Duration::from_secs(1)) == Err(RecvTimeoutError::Timeout) {
            if is_due() {
                eprintln!("{name}: still at work after {} s", began.elapsed().as_secs());
            }
        }
    });
    let result = work();
    drop(done);
    // It ends by itself, and has nothing to say.
    let _ = teller.join();
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_many_frames_of_how_many_are_done() {
        assert_eq!(line("run1.mp4", 150, Some(600)), "run1.mp4: 150 of 600 frames, 25 %");
        assert_eq!(line("run1.mp4", 150, None), "run1.mp4: 150 frames");
    }

    #[test]
    fn work_gives_what_it_gives_and_its_teller_ends_with_it() {
        assert_eq!(working("test", || 7), 7);
    }
}
