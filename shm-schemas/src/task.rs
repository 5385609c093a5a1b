//! Channels `task` and `printed`: which command of `andond` an engineer lets run by a page of the board, and what it prints.

use crate::code::codes;
use crate::layout::wire;
use crate::stamp::{Stamp, message};
use crate::text::{read_text, write_text};

/// Longest name of a task's job or file, in bytes.
pub const TASK_NAME_BYTES: usize = 64;

/// Longest text of a task, in bytes: 70 recordings with names of 56 bytes, or 20 steps with names of 60 letters of which each has three bytes.
pub const TASK_TEXT_BYTES: usize = 4096;

/// Longest line that a task prints in one message, in bytes.
pub const PRINTED_TEXT_BYTES: usize = 512;

/// A task that is older than this when it comes is not done, in nanoseconds: whoever has ordered it is told soon that nobody does it.
pub const TASK_LATE_NS: u64 = 3_000_000_000;

/// Bits of [`Task::flags`].
pub mod task_flag {
    /// Write the job in spite of doubts, and over one of its name.
    pub const FORCE: u8 = 1;
    /// Add the recordings to those that the job was taught from.
    pub const ADD: u8 = 1 << 1;
    /// Keep a picture of each step.
    pub const PICTURES: u8 = 1 << 2;
}

codes! {
    /// What is to be done. `name` is the job, where there is one.
    enum TaskKind: u8 {
        /// Teach the job from runs at the bench; `text` is how many.
        TeachLive = 1 as "teach-live",
        /// Teach the job from recordings, whose names are the lines of `text`.
        TeachFilms = 2 as "teach-films",
        /// Teach the job again with the runs that people have called right.
        TeachAgain = 3 as "teach-again",
        /// Teach the job again without the run that `text` names.
        Without = 4 as "without",
        /// Answer what the running task asks; `text` is the word.
        Answer = 5 as "answer",
        /// Stop the running task.
        Stop = 6 as "stop",
        /// Wait until no job runs, and load the job.
        Load = 7 as "load",
        /// Put back the version of the job whose hash is `text`, and load it.
        RollBack = 8 as "roll-back",
        /// Name the steps of the job: one line of `text` for each.
        Name = 9 as "name",
        /// Say what the job would have said of the recordings of the last week.
        Whatif = 10 as "whatif",
        /// Draw the markers of the station.
        Markers = 11 as "markers",
        /// Look at what the camera sees, and say what to improve.
        Look = 12 as "look",
        /// Find the bench: the lines of `text` are the side of the markers and four of them with their places.
        Calibrate = 13 as "calibrate",
        /// Write the file of a new station, which `name` names. The lines of `text` are its camera, which may be empty, the language of its
        /// board, and its parts.
        New = 14 as "new",
        /// Keep a piece of a recording: it comes over the channel `film`, and this is what is printed of it.
        Film = 15 as "film",
    }
}

codes! {
    /// What a message on the channel `printed` says of its task.
    enum PrintedState: u8 {
        /// It has begun.
        Begun = 1 as "begun",
        /// It has printed a line.
        Line = 2 as "line",
        /// It has ended well.
        Done = 3 as "done",
        /// It has ended, and has not done what was asked for: its last lines say why.
        Failed = 4 as "failed",
        /// It was stopped.
        Stopped = 5 as "stopped",
        /// It was not begun: the text says why.
        Refused = 6 as "refused",
    }
}

codes! {
    /// How far a job is that is shown at the bench.
    enum Showing: u8 {
        /// A run is being shown.
        Run = 1 as "run",
        /// A run was shown, and it is asked whether to keep it.
        Keep = 2 as "keep",
    }
}

wire! { "andon.Task", 4280;
    /// One task.
    struct Task {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// A number that no other task has.
        number: u64,
        /// A [`TaskKind`]. Zero is none: an empty message is no task.
        kind: u8,
        /// Bits of [`task_flag`].
        flags: u8,
        /// Of an answer: the [`Showing`] that it answers.
        showing: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 5],
        /// The login that orders it, in UTF-8, with zeros behind it; in pieces, because only short arrays have a default.
        who: [[u8; 16]; 4],
        /// The job, in UTF-8, with zeros behind it.
        name: [[u8; 16]; 4],
        /// What else is to be said, in UTF-8, with zeros behind it.
        text: [[[u8; 16]; 16]; 16],
    }
}
message!(Task);

impl Task {
    /// The login that orders it.
    pub fn who(&self) -> &str {
        read_text(self.who.as_flattened())
    }

    /// The job.
    pub fn name(&self) -> &str {
        read_text(self.name.as_flattened())
    }

    /// What else is to be said.
    pub fn text(&self) -> &str {
        read_text(self.text.as_flattened().as_flattened())
    }

    /// Says who orders it, for which job, and what else. False where one of the texts is too long: half of it would be another order.
    #[must_use]
    pub fn say(&mut self, who: &str, name: &str, text: &str) -> bool {
        write_text(who, self.who.as_flattened_mut());
        write_text(name, self.name.as_flattened_mut());
        write_text(text, self.text.as_flattened_mut().as_flattened_mut());
        (self.who(), self.name(), self.text()) == (who, name, text)
    }
}

wire! { "andon.Printed", 696;
    /// A line that a task has printed, or how it stands.
    struct Printed {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// The number of the task.
        task: u64,
        /// Its [`TaskKind`].
        kind: u8,
        /// A [`PrintedState`].
        state: u8,
        /// The [`Showing`] after this line; 0 where nothing is shown at the bench.
        showing: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 5],
        /// The login that has ordered it, in UTF-8, with zeros behind it; in pieces, because only short arrays have a default.
        who: [[u8; 16]; 4],
        /// The job, in UTF-8, with zeros behind it.
        name: [[u8; 16]; 4],
        /// The line, in UTF-8, with zeros behind it.
        text: [[u8; 16]; 32],
    }
}
message!(Printed);

impl Printed {
    /// The login that has ordered it.
    pub fn who(&self) -> &str {
        read_text(self.who.as_flattened())
    }

    /// The job.
    pub fn name(&self) -> &str {
        read_text(self.name.as_flattened())
    }

    /// The line.
    pub fn text(&self) -> &str {
        read_text(self.text.as_flattened())
    }

    /// Says of which task it is.
    pub fn of(&mut self, task: &Task) {
        (self.task, self.kind, self.who, self.name) = (task.number, task.kind, task.who, task.name);
    }

    /// Says as much of a line as fits.
    pub fn say(&mut self, line: &str) {
        write_text(line, self.text.as_flattened_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_says_what_it_was_given_or_that_it_is_too_long() {
        let mut task = Task::default();
        assert!(task.say("maria", "polish", "a.mp4\nb.mp4"));
        assert_eq!((task.who(), task.name(), task.text()), ("maria", "polish", "a.mp4\nb.mp4"));
        let long = core::str::from_utf8(&[b'x'; TASK_NAME_BYTES + 1]).unwrap_or_default();
        assert!(!task.say("maria", long, ""));
        assert!(!task.say(long, "polish", ""));
        let text = [b'x'; TASK_TEXT_BYTES + 1];
        let text =
            |bytes: usize| core::str::from_utf8(text.get(..bytes).unwrap_or_default()).unwrap_or_default();
        assert!(task.say("maria", "polish", text(TASK_TEXT_BYTES)));
        assert_eq!(task.text().len(), TASK_TEXT_BYTES);
        assert!(!task.say("maria", "polish", text(TASK_TEXT_BYTES + 1)));
    }

    #[test]
    fn a_task_has_room_for_fifty_recordings_and_for_twenty_names_of_steps_in_any_letters() {
        // A recording has a name of at most 56 bytes, and a name of a step has at most 60 letters, here of three bytes each.
        let [recordings, steps] = [50 * (56 + 1), 20 * (3 * 60 + 1)];
        assert!(recordings.max(steps) <= TASK_TEXT_BYTES);
    }
}
