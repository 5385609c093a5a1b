//! Whether a job fits what it is to judge: distances and thresholds mean nothing under other constants or objects.

use andon_core::config::Method;
use andon_core::input::Space;
use andon_host::config::Config;
use andon_learn::job_file::JobFile;
use andon_learn::recording::{Header, NamedObject};

/// What of a job does not fit, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// The station has another constant of the method.
    #[error("it was taught with another method.{0} than this station has: set it as in the job file")]
    Constant(&'static str),
    /// The station does not have an object of the job.
    #[error("this station has no object {id} ({name}): add it to [[objects]]")]
    NoObject {
        /// The object.
        id: u16,
        /// What the job calls it.
        name: String,
    },
    /// An object of the job has other interaction points at the station.
    #[error("object {id} ({name}) has other interaction points here: correct [[objects]]")]
    OtherObject {
        /// The object.
        id: u16,
        /// What the job calls it.
        name: String,
    },
    /// The recording has other coordinates.
    #[error(
        "the job was taught in {} coordinates and the recording has {} ones: record it as the job was recorded",
        job.name(), recording.name()
    )]
    Space {
        /// The job's.
        job: Space,
        /// The recording's.
        recording: Space,
    },
    /// The recording has objects, and none of the job.
    #[error(
        "the recording has other objects than the job: name the station that has them with --config FILE"
    )]
    OthersRecorded,
}

/// Holds a job against a live station: it needs the same constants of the method, and the job's objects with the same
/// interaction points.
///
/// # Errors
/// What differs first, and what to do.
pub fn station(job: &JobFile, config: &Config) -> Result<(), Misfit> {
    if let Some(key) = differing_constant(&job.method, &config.method()) {
        return Err(Misfit::Constant(key));
    }
    let shapes = config.shapes();
    let of_station = |object: &NamedObject| shapes.iter().find(|shape| shape.id == object.shape.id);
    let names = |object: &NamedObject| (object.shape.id, object.name.clone());
    // What is missing is said before what is only otherwise.
    if let Some(object) = job.objects.iter().find(|object| of_station(object).is_none()) {
        let (id, name) = names(object);
        return Err(Misfit::NoObject { id, name });
    }
    let is_other = |object: &&NamedObject| {
        of_station(object).is_some_and(|shape| shape.interaction_points != object.shape.interaction_points)
    };
    if let Some(object) = job.objects.iter().find(is_other) {
        let (id, name) = names(object);
        return Err(Misfit::OtherObject { id, name });
    }
    Ok(())
}

/// Holds a job against a recording: it needs the job's space, and must not have other objects only. Returns the job's objects that it does not know,
/// as where it begins late: what they are used for is not judged.
///
/// # Errors
/// What does not fit, and what to do.
pub fn recording<'a>(job: &'a JobFile, header: &Header) -> Result<Vec<&'a NamedObject>, Misfit> {
    if header.space != job.method.space {
        return Err(Misfit::Space { job: job.method.space, recording: header.space });
    }
    let is_recorded = |id| header.objects.iter().any(|recorded| recorded.shape.id == id);
    let unknown: Vec<_> = job.objects.iter().filter(|object| !is_recorded(object.shape.id)).collect();
    let has_others_only = unknown.len() == job.objects.len() && !header.objects.is_empty();
    if has_others_only { Err(Misfit::OthersRecorded) } else { Ok(unknown) }
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
