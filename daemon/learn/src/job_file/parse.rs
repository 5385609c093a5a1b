//! From text to a job: first the version, then the checksum, then every key.

use super::{
    FORMAT, JobFault, JobFile, JobFileError, OlderText, Provenance, ShownValues, TaughtActivity, TaughtIu,
    TaughtStep, VERSION, checksum, names, runs, validate,
};
use crate::file::{self, typographic};
use crate::recording::{NamedObject, SpaceName};
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::config::{Contact, Method};
use andon_core::couple::Context;
use andon_core::input::{Point, Space};
use andon_core::job::{LocalCost, MeasureBounds, Shown};
use andon_core::object::{ContactRegion, ObjectShape};
use serde::Deserialize;

#[derive(Deserialize)]
struct Magic {
    #[serde(default)]
    format: String,
    #[serde(default)]
    version: i64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JobText {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: i64,
    #[serde(rename = "checksum")]
    _checksum: String,
    id: u32,
    name: String,
    /// A file without this key was taught before it was measured.
    #[serde(default)]
    min_rate_hz: f32,
    provenance: Provenance,
    method: MethodText,
    #[serde(default)]
    object: Vec<ObjectText>,
    rests: Vec<u16>,
    step: Vec<TaughtStep>,
    activity: Vec<ActivityText>,
    /// A file without this section was taught before steps had names.
    #[serde(default)]
    names: NamesText,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct NamesText {
    steps: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum CostText {
    Normalised,
    Ordinal,
    Circular,
}

#[derive(Deserialize)]
#[serde(remote = "Contact", deny_unknown_fields)]
struct ContactText {
    on_m: f32,
    off_m: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodText {
    #[serde(with = "SpaceName")]
    space: Space,
    cost: CostText,
    /// A file without this key was taught without it.
    #[serde(default = "no_slowdown")]
    max_slowdown: f32,
    /// A file without this key was taught without it.
    #[serde(default)]
    free_ends: bool,
    rate_hz: f32,
    bins: u8,
    #[serde(with = "ContactText")]
    hand_contact: Contact,
    #[serde(with = "ContactText")]
    object_contact: Contact,
    persist_frames: u8,
    rest_speed_m_s: f32,
    dead_band_m_s2: f32,
    filter_frames: u8,
    blind_ms: u32,
    idle_end_ms: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectText {
    id: u16,
    name: String,
    interaction_points: Vec<Point>,
    #[serde(default)]
    position_only: bool,
    #[serde(default)]
    meetings: Vec<ContactRegionText>,
    #[serde(default)]
    incidental: Vec<u16>,
    start: Option<StartText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StartText {
    place_m: [f32; 4],
    moved_by: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactRegionText {
    with: u16,
    points: Vec<Point>,
    on_m: f32,
    off_m: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ActivityText {
    activity: u16,
    iu: Vec<IuText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct IuText {
    context: [u16; 4],
    demonstrations: u32,
    threshold: f32,
    frames: BoundsText,
    reversals: BoundsText,
    stroke_m: Option<[f32; 2]>,
    path_m: Option<[f32; 2]>,
    max_detour_m: Option<f32>,
    #[serde(rename = "max_lateral_deviation_m", alias = "max_bow_m")]
    max_lateral_m: Option<f32>,
    axis: Option<[f32; 3]>,
    place_m: Option<[f32; 4]>,
    /// A file with this key was taught before the values of the runs were kept, and one without it before verdicts named it.
    shown: Option<ShownText>,
    runs: Option<ShownValues>,
    reference: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShownText {
    frames: [u32; 2],
    reversals: [u32; 2],
    stroke_m: [f32; 2],
    path_m: [f32; 2],
    /// A file without this key was taught before it was measured.
    #[serde(default)]
    detour_m: f32,
    /// The same.
    #[serde(default, rename = "lateral_deviation_m", alias = "bow_m")]
    lateral_m: f32,
    axis: f32,
    place_m: f32,
}

#[derive(Deserialize)]
struct BoundsText(u32, MaxText);

#[derive(Deserialize)]
#[serde(untagged, expecting = "a maximum is a count from 0 to 4294967295, or \"unbounded\"")]
enum MaxText {
    Count(u32),
    Word(Unbounded),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Unbounded {
    Unbounded,
}

fn no_slowdown() -> f32 {
    1.0
}

impl JobFile {
    /// Reads a job file. `file` is its name in error messages.
    ///
    /// # Errors
    /// If format, version or checksum is wrong, a key is unknown or missing, or a value breaks a rule of the method.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, JobFileError> {
        parse(bytes).map_err(|fault| JobFileError { file: file.to_owned(), fault })
    }
}

fn parse(bytes: &[u8]) -> Result<JobFile, JobFault> {
    // The checksum is that of the text as it was written, whichever editor has changed its names since.
    let text = file::text(bytes)?;
    let text = text.as_ref();
    if text.trim().is_empty() {
        return Err(JobFault::Empty);
    }
    let no_toml = |error: toml::de::Error| {
        let at = error.span().map_or(0, |span| span.start);
        let remedy = typographic(text, at).map(|remedy| format!("; {remedy}")).unwrap_or_default();
        JobFault::Toml(error.to_string().trim_end().to_owned() + &remedy)
    };
    let magic: Magic = toml::from_str(text).map_err(no_toml)?;
    if magic.format != FORMAT {
        return Err(JobFault::Format(magic.format));
    }
    if magic.version != VERSION {
        return Err(JobFault::Version(magic.version));
    }
    let (computed, stated) = checksum::check(text).unwrap_or_default();
    if computed != stated || stated.is_empty() {
        return Err(JobFault::Checksum {
            stated: format!("sha256:{stated}"),
            computed: format!("sha256:{computed}"),
        });
    }
    let mut job = job_of(toml::from_str(text).map_err(no_toml)?)?;
    validate::validate(&job)?;
    job.older = older(text, &job);
    Ok(job)
}

/// The text of a job that is written in other words now. It must have all of the job but the names of the steps, as those are appended to it.
fn older(text: &str, job: &JobFile) -> Option<OlderText> {
    let (read, now) = (names::before(text), job.without_names());
    if read == now {
        return None;
    }
    let nameless = JobFile { step_names: Vec::new(), ..job.clone() };
    let of_read = toml::from_str(read).ok().and_then(|text| job_of(text).ok());
    (of_read == Some(nameless)).then(|| OlderText { read: read.to_owned(), now })
}

fn job_of(text: JobText) -> Result<JobFile, JobFault> {
    let bins = text.method.bins;
    let cost = match text.method.cost {
        CostText::Normalised => LocalCost::Normalised { bins },
        CostText::Ordinal => LocalCost::Ordinal,
        CostText::Circular => LocalCost::Circular { bins },
    };
    let moves = |number: usize| -> Vec<u16> {
        let is_moved =
            |object: &&ObjectText| object.start.iter().any(|start| start.moved_by.contains(&number));
        text.object.iter().filter(is_moved).map(|object| object.id).collect()
    };
    let steps = text.step.into_iter().enumerate();
    let steps = steps.map(|(number, step)| TaughtStep { moves: moves(number), ..step }).collect();
    let objects = text.object.into_iter().enumerate().map(|(index, object)| object_of(index, object));
    let activities =
        text.activity.into_iter().enumerate().map(|(index, activity)| activity_of(index, activity));
    Ok(JobFile {
        id: text.id,
        name: text.name,
        passive_contacts: text.rests,
        steps,
        cost,
        max_slowdown: text.method.max_slowdown,
        has_free_ends: text.method.free_ends,
        min_rate_hz: text.min_rate_hz,
        objects: objects.collect::<Result<_, _>>()?,
        activities: activities.collect::<Result<_, _>>()?,
        method: method_of(text.method),
        provenance: text.provenance,
        step_names: text.names.steps,
        older: None,
    })
}

fn method_of(text: MethodText) -> Method {
    Method {
        space: text.space,
        rate_hz: text.rate_hz,
        bins: text.bins,
        hand_contact: text.hand_contact,
        object_contact: text.object_contact,
        persist_frames: text.persist_frames,
        rest_speed_m_s: text.rest_speed_m_s,
        dead_band_m_s2: text.dead_band_m_s2,
        filter_frames: text.filter_frames,
        blind_ms: text.blind_ms,
        idle_end_ms: text.idle_end_ms,
    }
}

fn object_of(index: usize, text: ObjectText) -> Result<NamedObject, JobFault> {
    let key = format!("object[{index}]");
    let region = |ContactRegionText { with, points, on_m, off_m }| {
        let points = fitting(&points, &format!("{key}.meetings.points"))?;
        Ok::<_, JobFault>(ContactRegion { with, points, contact: Contact { on_m, off_m } })
    };
    let regions: Vec<ContactRegion> = text.meetings.into_iter().map(region).collect::<Result<_, _>>()?;
    Ok(NamedObject {
        name: text.name,
        shape: ObjectShape {
            id: text.id,
            interaction_points: fitting(&text.interaction_points, &format!("{key}.interaction_points"))?,
            contact_regions: fitting(&regions, &format!("{key}.meetings"))?,
            incidental: fitting(&text.incidental, &format!("{key}.incidental"))?,
            is_position_only: text.position_only,
            start: text
                .start
                .map(|StartText { place_m: [x, y, z, max], .. }| Around { centre: [x, y, z], max }),
        },
    })
}

/// As many items as there may be.
fn fitting<T: Clone, const MAX: usize>(items: &[T], key: &str) -> Result<heapless::Vec<T, MAX>, JobFault> {
    heapless::Vec::from_slice(items).map_err(|_| JobFault::Invalid {
        key: key.to_owned(),
        problem: format!("there are {}; at most {MAX} can be followed", items.len()),
    })
}

fn activity_of(index: usize, text: ActivityText) -> Result<TaughtActivity, JobFault> {
    let iu = |(number, iu): (usize, IuText)| {
        let reference = runs::motions(&iu.reference).map_err(|problem| JobFault::Invalid {
            key: format!("activity[{index}].iu[{number}].reference"),
            problem,
        })?;
        let measures = measures_of(&iu);
        Ok(TaughtIu {
            context: Context(iu.context),
            threshold: iu.threshold,
            frames: bounds_of(iu.frames),
            reversals: bounds_of(iu.reversals),
            measures,
            shown: iu.runs,
            reference,
            demonstrations: iu.demonstrations,
        })
    };
    let ius = text.iu.into_iter().enumerate().map(iu).collect::<Result<_, JobFault>>()?;
    Ok(TaughtActivity { activity: text.activity, ius })
}

fn measures_of(iu: &IuText) -> MeasureBounds {
    let any = MeasureBounds::ANY;
    let range = |given: Option<[f32; 2]>, any| given.map_or(any, range_of);
    MeasureBounds {
        stroke_m: range(iu.stroke_m, any.stroke_m),
        path_m: range(iu.path_m, any.path_m),
        max_detour_m: iu.max_detour_m.unwrap_or(any.max_detour_m),
        max_lateral_m: iu.max_lateral_m.unwrap_or(any.max_lateral_m),
        axis: iu.axis.map_or(any.axis, |[x, y, max]| Around { centre: [x, y], max }),
        place_m: iu.place_m.map_or(any.place_m, |[x, y, z, max]| Around { centre: [x, y, z], max }),
        shown: iu.runs.as_ref().map(ShownValues::ranges).or(iu.shown.as_ref().map(shown_of)),
    }
}

fn shown_of(text: &ShownText) -> Shown {
    let bounds = |[min, max]: [u32; 2]| Bounds { min, max };
    Shown {
        frames: bounds(text.frames),
        reversals: bounds(text.reversals),
        stroke_m: range_of(text.stroke_m),
        path_m: range_of(text.path_m),
        detour_m: text.detour_m,
        lateral_m: text.lateral_m,
        axis: text.axis,
        place_m: text.place_m,
    }
}

fn range_of([min, max]: [f32; 2]) -> Range {
    Range { min, max }
}

fn bounds_of(BoundsText(min, max): BoundsText) -> Bounds {
    let max = match max {
        MaxText::Count(count) => count,
        MaxText::Word(Unbounded::Unbounded) => u32::MAX,
    };
    Bounds { min, max }
}
