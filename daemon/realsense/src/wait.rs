//! How long a camera may send nothing.

use std::time::Duration;

use crate::Error;

/// One wait of the SDK, short enough that the end of a recording and a lost camera are noticed at once.
pub const STEP: Duration = Duration::from_millis(200);

/// A camera that sends nothing for this many steps is silent. 2 s are 60 frames at 30 Hz. No exposure, no stall of USB and no adjustment of the
/// exposure takes that long.
const MAX_SILENT_STEPS: u32 = 10;

/// Repeats a wait of one [`STEP`] until it ends with a frame; `None` means that the camera has been silent for 2 s.
///
/// # Errors
/// The error of a step, at once.
pub fn for_frame<F>(mut step: impl FnMut() -> Result<Option<F>, Error>) -> Result<Option<F>, Error> {
    for _ in 0..MAX_SILENT_STEPS {
        if let Some(frame) = step()? {
            return Ok(Some(frame));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of a source that does this step by step and is silent afterwards, and how many steps were waited.
    fn wait(script: Vec<Result<Option<u32>, Error>>) -> (Result<Option<u32>, Error>, u32) {
        let (mut script, mut steps) = (script.into_iter(), 0);
        let came = for_frame(|| {
            steps += 1;
            script.next().unwrap_or(Ok(None))
        });
        (came, steps)
    }

    #[test]
    fn a_short_silence_is_waited_out() {
        let mut script = vec![Ok(None); 9];
        script.push(Ok(Some(1)));
        assert_eq!(wait(script), (Ok(Some(1)), 10));
    }

    #[test]
    fn a_silence_of_two_seconds_ends_the_wait() {
        let (came, steps) = wait(Vec::new());
        assert_eq!((came, STEP * steps), (Ok(None), Duration::from_secs(2)));
    }

    #[test]
    fn a_lost_camera_is_told_at_once() {
        let lost = Error::Unplugged { serial: "1".into() };
        assert_eq!(wait(vec![Ok(None), Err(lost.clone())]), (Err(lost), 2));
    }
}
