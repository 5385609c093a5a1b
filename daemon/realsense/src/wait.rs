//! How long a source may send nothing.

use std::time::Duration;

use crate::Error;

/// One wait of the SDK, short enough that the end of a recording and a lost camera are noticed at once.
pub const STEP: Duration = Duration::from_millis(200);

/// A camera that sends nothing for this many steps is silent. 2 s are 60 frames at 30 Hz: no exposure, no stall of USB and no
/// adjustment of the exposure takes that long.
const MAX_SILENT_STEPS: u32 = 10;

/// What a wait ended with.
#[derive(Clone, Debug, PartialEq)]
pub enum Wait<F> {
    /// A frame.
    Frame(F),
    /// No frame came in time.
    Nothing,
    /// The recording is at its end.
    Ended,
}

/// Repeats a wait of one [`STEP`] until it ends with something; `Nothing` means that the source has been silent for 2 s.
///
/// # Errors
/// The error of a step, at once.
pub fn for_frame<F>(mut step: impl FnMut() -> Result<Wait<F>, Error>) -> Result<Wait<F>, Error> {
    for _ in 0..MAX_SILENT_STEPS {
        match step()? {
            Wait::Nothing => {}
            came => return Ok(came),
        }
    }
    Ok(Wait::Nothing)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of a source that does this step by step and is silent afterwards, and how many steps were waited.
    fn wait(script: Vec<Result<Wait<u32>, Error>>) -> (Result<Wait<u32>, Error>, u32) {
        let (mut script, mut steps) = (script.into_iter(), 0);
        let came = for_frame(|| {
            steps += 1;
            script.next().unwrap_or(Ok(Wait::Nothing))
        });
        (came, steps)
    }

    #[test]
    fn a_short_silence_is_waited_out() {
        let mut script = vec![Ok(Wait::Nothing); 9];
        script.push(Ok(Wait::Frame(1)));
        assert_eq!(wait(script), (Ok(Wait::Frame(1)), 10));
    }

    #[test]
    fn a_silence_of_two_seconds_ends_the_wait() {
        let (came, steps) = wait(Vec::new());
        assert_eq!((came, STEP * steps), (Ok(Wait::Nothing), Duration::from_secs(2)));
    }

    #[test]
    fn an_end_and_a_lost_camera_are_told_at_once() {
        assert_eq!(wait(vec![Ok(Wait::Ended)]), (Ok(Wait::Ended), 1));
        let lost = Error::Unplugged { serial: "1".into() };
        assert_eq!(wait(vec![Ok(Wait::Nothing), Err(lost.clone())]), (Err(lost), 2));
    }
}
