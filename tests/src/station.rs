//! What a station says of its parts.

use andon_learn::recording::Recording;

/// The recording as of a station that does not say where its parts are touched.
#[must_use]
pub fn without_points(mut recording: Recording) -> Recording {
    for object in &mut recording.header.objects {
        object.shape.interaction_points = [[0.0; 3]].into_iter().collect();
    }
    recording
}
