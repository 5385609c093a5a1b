use super::*;
use std::collections::VecDeque;

const TICK: Duration = Duration::from_millis(100);

fn unplugged() -> Error {
    Error::Unplugged { serial: "1".into() }
}

/// A camera whose fate is written beforehand. Its clock moves only when it waits or pauses.
#[derive(Default)]
struct Fake {
    now: Duration,
    opens: VecDeque<Result<(), Error>>,
    frames: VecDeque<Next<u32>>,
    log: Vec<(&'static str, u128)>,
}

impl Fake {
    fn note(&mut self, what: &'static str) {
        self.log.push((what, self.now.as_millis()));
    }
}

impl Driver for Fake {
    type Camera = ();
    type Frame = u32;

    fn open(&mut self) -> Result<(), Error> {
        self.note("open");
        self.opens.pop_front().unwrap_or(Ok(()))
    }

    fn reset(&mut self) {
        self.note("reset");
    }

    fn wait(&mut self, (): &mut (), timeout: Duration) -> Next<u32> {
        self.now += timeout;
        self.frames.pop_front().unwrap_or(Next::Nothing)
    }

    fn patience(&self) -> Option<Duration> {
        Some(Duration::from_secs(2))
    }

    fn silent(&self, (): &(), silence: Duration) -> Error {
        Error::Silent { serial: "1".into(), seconds: silence.as_secs() }
    }

    fn now(&self) -> Duration {
        self.now
    }

    fn pause(&mut self, time: Duration) {
        self.now += time;
    }
}

fn run(fake: Fake, calls: usize) -> (Vec<Next<u32>>, Vec<(&'static str, u128)>) {
    let mut source = Supervised::open(fake).map_err(|_| ()).expect("the first open of these tests works");
    let came = (0..calls).map(|_| source.next(TICK)).collect();
    (came, source.driver.log)
}

#[test]
fn an_error_at_the_first_opening_goes_to_the_person_who_starts_it() {
    let fake = Fake { opens: [Err(Error::NoCamera)].into(), ..Fake::default() };
    assert_eq!(Supervised::open(fake).err(), Some(Error::NoCamera));
}

#[test]
fn frames_come_again_after_unplug_and_replug() {
    let fake = Fake {
        opens: [Ok(()), Err(Error::NoCamera), Err(Error::NoCamera), Ok(())].into(),
        frames: [Next::Frame(1), Next::Lost(unplugged()), Next::Frame(2), Next::Frame(3)].into(),
        ..Fake::default()
    };
    let (came, log) = run(fake, 60);
    let frames: Vec<&Next<u32>> = came.iter().filter(|next| matches!(next, Next::Frame(_))).collect();
    assert_eq!(frames, [&Next::Frame(1), &Next::Frame(2), &Next::Frame(3)]);
    assert_eq!(came[1], Next::Lost(unplugged()));
    assert!(came.contains(&Next::Lost(Error::NoCamera)), "the newest reason is told");
    // Gone at 200 ms; the pauses are 0.5, 1 and 2 s.
    assert_eq!(log, [("open", 0), ("open", 700), ("open", 1700), ("open", 3700)]);
}

#[test]
fn the_pause_grows_to_four_seconds_and_no_further() {
    let opens = std::iter::once(Ok(())).chain((0..20).map(|_| Err(Error::NoCamera))).collect();
    let (_, log) = run(Fake { opens, frames: [Next::Lost(unplugged())].into(), ..Fake::default() }, 205);
    let pauses: Vec<u128> = log.windows(2).skip(1).map(|pair| pair[1].1 - pair[0].1).collect();
    assert_eq!(pauses, [1000, 2000, 4000, 4000, 4000, 4000]);
}

#[test]
fn a_frame_makes_the_next_pause_short_again() {
    let fake = Fake {
        opens: [Ok(()), Err(Error::NoCamera), Ok(()), Ok(())].into(),
        frames: [Next::Lost(unplugged()), Next::Frame(1), Next::Lost(unplugged())].into(),
        ..Fake::default()
    };
    let (_, log) = run(fake, 40);
    // Gone at 100: tried at 600 and 1600. Gone again at 1800: tried at 2300.
    assert_eq!(log, [("open", 0), ("open", 600), ("open", 1600), ("open", 2300)]);
}

#[test]
fn a_short_silence_is_waited_out() {
    let mut frames: VecDeque<_> = (0..19).map(|_| Next::Nothing).collect();
    frames.push_back(Next::Frame(1));
    let (came, log) = run(Fake { frames, ..Fake::default() }, 20);
    assert_eq!(came.last(), Some(&Next::Frame(1)));
    assert_eq!(log, [("open", 0)]);
}

#[test]
fn a_camera_that_falls_silent_is_opened_again() {
    let fake = Fake { frames: [Next::Frame(1)].into(), ..Fake::default() };
    let (came, log) = run(fake, 27);
    assert!(came.contains(&Next::Lost(Error::Silent { serial: "1".into(), seconds: 2 })));
    assert_eq!(log, [("open", 0), ("open", 2600)]);
}

#[test]
fn a_camera_that_stays_silent_after_two_starts_is_reset_before_the_third() {
    let (_, log) = run(Fake::default(), 60);
    assert_eq!(log, [("open", 0), ("open", 2500), ("reset", 5500), ("open", 5500)]);
}

#[test]
fn the_end_of_a_recording_is_not_a_loss() {
    let fake = Fake { frames: [Next::Frame(1), Next::Ended, Next::Ended].into(), ..Fake::default() };
    let (came, log) = run(fake, 3);
    assert_eq!(came[1..], [Next::Ended, Next::Ended]);
    assert_eq!(log, [("open", 0)]);
}
