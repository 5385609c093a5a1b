//! Whether a job fits what it is to judge: distances and thresholds mean nothing under other constants or objects.

use andon_core::config::Method;
use andon_learn::job_file::JobFile;
use andon_learn::recording::Header;

use crate::config::Config;

/// A live station: same constants of the method, and the job's objects with the same interaction points.
///
/// # Errors
/// What differs, and what to do.
pub fn station(job: &JobFile, config: &Config) -> Result<(), String> {
    if let Some(key) = differing_constant(&job.method, &config.method()) {
        return Err(format!(
            "it was taught with another method.{key} than this station has: set it as in the job file, or teach the job again"
        ));
    }
    let shapes = config.shapes();
    for object in &job.objects {
        let (id, name) = (object.shape.id, &object.name);
        match shapes.iter().find(|shape| shape.id == id) {
            None => return Err(format!("this station has no object {id} ({name}): add it to [[objects]]")),
            Some(shape) if *shape != object.shape => {
                return Err(format!(
                    "object {id} ({name}) has other interaction points here: correct [[objects]], or teach the job again"
                ));
            }
            Some(_) => (),
        }
    }
    Ok(())
}

/// A recording: the job's space, and all of its objects.
///
/// # Errors
/// What is missing, and what to do.
pub fn recording(job: &JobFile, header: &Header) -> Result<(), String> {
    if header.space != job.method.space {
        return Err(format!(
            "the job was taught in {:?} coordinates and the recording has {:?} ones: record it as the job was recorded",
            job.method.space, header.space
        ));
    }
    for object in &job.objects {
        let (id, name) = (object.shape.id, &object.name);
        if !header.objects.iter().any(|seen| seen.shape.id == id) {
            return Err(format!(
                "the recording knows no object {id} ({name}), which the job needs: name the station that has it with --config FILE"
            ));
        }
    }
    Ok(())
}

/// The first constant of the method that is not the same.
fn differing_constant(one: &Method, other: &Method) -> Option<&'static str> {
    let same = [
        ("space", one.space == other.space),
        ("rate_hz", one.rate_hz == other.rate_hz),
        ("bins", one.bins == other.bins),
        ("hand_contact", one.hand_contact == other.hand_contact),
        ("object_contact", one.object_contact == other.object_contact),
        ("persist_frames", one.persist_frames == other.persist_frames),
        ("rest_speed_m_s", one.rest_speed_m_s == other.rest_speed_m_s),
        ("dead_band_m_s2", one.dead_band_m_s2 == other.dead_band_m_s2),
        ("filter_frames", one.filter_frames == other.filter_frames),
        ("blind_ms", one.blind_ms == other.blind_ms),
        ("idle_end_ms", one.idle_end_ms == other.idle_end_ms),
    ];
    same.into_iter().find(|(_, same)| !same).map(|(key, _)| key)
}
