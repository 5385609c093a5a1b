//! From a job to its text. The text is written here and not by a serialiser, so that it has comments for the people who read it.

use super::{FORMAT, JobFile, Relation, TaughtActivity, TaughtIu, VERSION, checksum, names, runs};
use crate::recording::NamedObject;
use crate::rule::{BoundsRule, ThresholdRule};
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::config::Contact;
use andon_core::couple::Context;
use andon_core::input::{Point, Side};
use andon_core::job::{MeasureBounds, Shown};
use andon_core::object::{ContactRegion, ObjectShape};
use std::fmt::Write as _;

/// Appends a line. Writing to a `String` cannot fail, so the result is ignored here, once.
macro_rules! line {
    ($text:expr, $($arguments:tt)*) => {{ let _ = writeln!($text, $($arguments)*); }};
}

impl JobFile {
    /// The text of the job file. The same job gives the same bytes; one that was read has those that were read. [`JobFile::model_hash`] covers all of
    /// it but the names of the steps.
    pub fn to_toml(&self) -> String {
        let now = self.without_names();
        let older = self.older.as_ref().filter(|older| older.now == now);
        let mut text = older.map_or(now, |older| older.read.clone());
        names::append(&mut text, &self.step_names);
        text
    }

    /// The text as this build writes it, without the names of the steps.
    pub(super) fn without_names(&self) -> String {
        let mut text = String::new();
        line!(
            text,
            "# A job that was taught to Andon. The checksum covers all other characters of this file:"
        );
        line!(text, "# do not edit the file, teach the job again.");
        line!(text, "format = {FORMAT:?}\nversion = {VERSION}\n{}\"", checksum::KEY);
        line!(text, "# The number by which a PLC selects the job.\nid = {}", self.id);
        line!(text, "name = {}", quoted(&self.name));
        // Without it, an older file has its own text again, and its own hash.
        if self.min_rate_hz > 0.0 {
            line!(
                text,
                "# With fewer frames per second than this, an IU is not judged: the runs that were shown would not be"
            );
            line!(text, "# recognised any more.");
            line!(text, "min_rate_hz = {:?}", self.min_rate_hz);
        }
        line!(
            text,
            "# The objects that a hand rests on or steadies in the runs: such a touch is not a step."
        );
        line!(text, "rests = {:?}", self.passive_contacts);
        self.provenance_text(&mut text);
        self.method_text(&mut text);
        self.objects.iter().for_each(|object| self.object_text(&mut text, object));
        self.steps_text(&mut text);
        text.push_str(
            "
# An activity is a sequence of IUs. In each IU, `threshold` is the maximum DTW distance to the reference.
# `frames` is the minimum and maximum duration in frames. `reversals` is the minimum and maximum number of
# times that the motion comes back. `stroke_m` is the mean length of a stroke, and `path_m` that of the whole way.
# The way is no more than `max_detour_m` longer than the straight one. `max_lateral_deviation_m` is how far off the
# straight line the hand may go on its way on the bench. The line begins where the hand took the part, or came to
# the part before, and ends where it is. `axis` and `place_m` are each a centre and the maximum distance from it,
# in the frame of the other part. The centre of `axis` is cos 2a and sin 2a for a way along the angle a; `place_m`
# is in metres. `shown` is the minimum and maximum that the runs measured, and their maximum distance from the two
# centres. Verdicts name it, and it decides nothing. A row of the reference has a number of frames, and the motion
# in these frames: a_h theta_hj phi_hj jm_hj theta_jl phi_jl jm_jl.
",
        );
        // Without them, an older file has its own text again.
        if self.activities.iter().flat_map(|activity| &activity.ius).any(|iu| iu.shown.is_some()) {
            text.push_str(
                "\
# `runs` is what the runs measured, each measure sorted, in the units of the bounds, and `distance` their DTW distances from
# each other. It takes the place of `shown`: people see by it where an execution lies.
",
            );
        }
        self.activities.iter().for_each(|activity| self.activity_text(&mut text, activity));
        checksum::seal(&text)
    }

    fn provenance_text(&self, text: &mut String) {
        let from = &self.provenance;
        line!(text, "\n[provenance]\nprogram = {}", quoted(&from.program));
        line!(text, "date = {}", quoted(&from.date));
        line!(text, "rule = {{ {} }}", rule_text(from.rule));
        line!(text, "bounds = {{ {} }}", bounds_rule_text(from.bounds));
        if let Some(strictness) = from.strictness {
            line!(text, "strictness = {}", strictness.number());
        }
        if let Some(order) = from.order {
            line!(text, "order = {order}");
        }
        for source in &from.sources {
            line!(text, "\n[[provenance.source]]\nname = {}", quoted(&source.name));
            line!(text, "sha256 = {}", quoted(&source.sha256));
            line!(text, "left_out = {}", source.left_out);
        }
    }

    fn method_text(&self, text: &mut String) {
        let method = &self.method;
        let space = method.space.name();
        let cost = self.cost.name();
        line!(text, "\n# The constants that the job was taught with and is judged with.\n[method]");
        line!(text, "space = {space:?}\ncost = {cost:?}");
        line!(
            text,
            "# A threshold grows with the duration of the IU, up to this many times the duration of the reference."
        );
        line!(text, "max_slowdown = {:?}", self.max_slowdown);
        if self.has_free_ends {
            line!(text, "# A rest is put before and after each motion, as it is in the references.");
            line!(text, "free_ends = true");
        }
        line!(text, "rate_hz = {:?}\nbins = {}", method.rate_hz, method.bins);
        for (name, contact) in [("hand", method.hand_contact), ("object", method.object_contact)] {
            line!(text, "{name}_contact = {{ on_m = {:?}, off_m = {:?} }}", contact.on_m, contact.off_m);
        }
        line!(text, "persist_frames = {}", method.persist_frames);
        line!(text, "rest_speed_m_s = {:?}", method.rest_speed_m_s);
        line!(text, "dead_band_m_s2 = {:?}", method.dead_band_m_s2);
        line!(text, "filter_frames = {}", method.filter_frames);
        line!(text, "blind_ms = {}\nidle_end_ms = {}", method.blind_ms, method.idle_end_ms);
    }

    fn steps_text(&self, text: &mut String) {
        text.push_str(
            "
# A step is an activity of the job, by its number, and what the order asks of it. `required`: all runs have it.
# `once`: it must not be repeated. `after`: the activities that come before it, each with the number of `runs` that
# have both and the mean time between the two beginnings. `law`: the other one must have begun (begin), must have
# ended (end), or came first without enough evidence for a law (usual).
",
        );
        for (number, step) in self.steps.iter().enumerate() {
            let words = sequence_words(&self.step_contexts(number), |id| self.object_name(id));
            line!(text, "\n[[step]]\n# {number}: {}", words.replace(char::is_control, " "));
            line!(text, "required = {}\nonce = {}\nruns = {}", step.is_required, step.is_once, step.runs);
            if step.allows_insertions {
                line!(text, "# The runs have only these IUs in common: others may come between them.");
                line!(text, "insertions = true");
            }
            if !step.completes.is_empty() {
                line!(
                    text,
                    "# Required after these sequences, counted from 0: they do only a part of what others do in one."
                );
                line!(text, "completes = {:?}", step.completes);
            }
            let after: Vec<String> = step.after.iter().map(relation_text).collect();
            line!(text, "after = [{}]", after.join(", "));
        }
    }

    fn object_text(&self, text: &mut String, object: &NamedObject) {
        let ObjectShape { id, interaction_points, contact_regions, incidental, is_position_only, start } =
            &object.shape;
        line!(text, "\n[[object]]\nid = {id}\nname = {}", quoted(&object.name));
        line!(text, "# Where it can be touched, in metres in its own frame.");
        line!(text, "interaction_points = {}", points_text(interaction_points));
        if *is_position_only {
            line!(
                text,
                "# Its orientation differed from run to run where its way did not: only its position counts."
            );
            line!(text, "position_only = true");
        }
        if !incidental.is_empty() {
            line!(
                text,
                "# It comes near the objects with these ids by chance only, so that there is no contact between them."
            );
            line!(text, "incidental = {incidental:?}");
        }
        if let Some(place) = start {
            line!(
                text,
                "# Where it lies until the activities with these numbers have moved it for good: a centre on the bench, and the"
            );
            line!(text, "# maximum distance from it, in metres.");
            let [x, y, z] = place.centre;
            let moved_by: Vec<usize> = self.use_of(*id).moved_by.iter().collect();
            line!(
                text,
                "start = {{ place_m = [{x:?}, {y:?}, {z:?}, {:?}], moved_by = {moved_by:?} }}",
                place.max
            );
        }
        if !contact_regions.is_empty() {
            line!(
                text,
                "# Where and how near the runs show it to be met, by a hand (0) or by another object: by the finger tips or"
            );
            line!(
                text,
                "# the position of that, in metres in the frame of this object; without points at the interaction points."
            );
            line!(text, "meetings = [");
            for ContactRegion { with, points, contact: Contact { on_m, off_m } } in contact_regions {
                let points = points_text(points);
                line!(text, "  {{ with = {with}, points = {points}, on_m = {on_m:?}, off_m = {off_m:?} }},");
            }
            line!(text, "]");
        }
    }

    fn activity_text(&self, text: &mut String, activity: &TaughtActivity) {
        line!(text, "\n[[activity]]\n# The number of the activity of the job that this sequence fulfils.");
        line!(text, "activity = {}", activity.activity);
        activity.ius.iter().for_each(|iu| self.iu_text(text, iu));
    }

    fn iu_text(&self, text: &mut String, iu: &TaughtIu) {
        line!(text, "\n[[activity.iu]]\n# {}", self.sentence(iu.context));
        line!(text, "context = {:?}", iu.context.0);
        line!(text, "demonstrations = {}", iu.demonstrations);
        line!(text, "threshold = {:?}", iu.threshold);
        line!(text, "frames = {}", bounds_text(iu.frames));
        line!(text, "reversals = {}", bounds_text(iu.reversals));
        measures_text(text, &iu.measures);
        // The values have the ranges in them.
        if iu.shown.is_none() {
            iu.measures.shown.iter().for_each(|shown| shown_text(text, shown));
        }
        line!(text, "reference = [");
        for row in runs::rows(&iu.reference) {
            line!(text, "  {row:?},");
        }
        line!(text, "]");
        iu.shown.iter().for_each(|shown| shown.write(text));
    }

    /// A context in words, on one line.
    fn sentence(&self, context: Context) -> String {
        // A name may contain a line break, and a comment must not.
        context_words(context, |id| self.object_name(id)).replace(char::is_control, " ")
    }
}

fn relation_text(relation: &Relation) -> String {
    let Relation { activity, kind, runs, gap_s } = relation;
    format!("{{ activity = {activity}, law = {:?}, runs = {runs}, gap_s = {gap_s:?} }}", kind.name())
}

fn points_text(points: &[Point]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y, z]| format!("[{x:?}, {y:?}, {z:?}]")).collect();
    format!("[{}]", points.join(", "))
}

fn rule_text(rule: ThresholdRule) -> String {
    match rule {
        ThresholdRule::Paper { sigmas } => format!("name = \"paper\", sigmas = {sigmas:?}"),
        ThresholdRule::LeaveOneOut { sigmas, border_s } => {
            format!("name = \"leave_one_out\", sigmas = {sigmas:?}, border_s = {border_s:?}")
        }
        ThresholdRule::Conformal { false_alarms } => {
            format!("name = \"conformal\", false_alarms = {false_alarms:?}")
        }
    }
}

fn bounds_rule_text(rule: BoundsRule) -> String {
    let BoundsRule { max_duration, pause_s, false_alarms } = rule;
    format!("max_duration = {max_duration:?}, pause_s = {pause_s:?}, false_alarms = {false_alarms:?}")
}

/// What is right whatever it measures is left out.
fn measures_text(text: &mut String, bounds: &MeasureBounds) {
    for (name, Range { min, max }) in [("stroke_m", bounds.stroke_m), ("path_m", bounds.path_m)] {
        if max.is_finite() {
            line!(text, "{name} = [{min:?}, {max:?}]");
        }
    }
    for (name, max) in
        [("max_detour_m", bounds.max_detour_m), ("max_lateral_deviation_m", bounds.max_lateral_m)]
    {
        if max.is_finite() {
            line!(text, "{name} = {max:?}");
        }
    }
    let Around { centre: [x, y], max } = bounds.axis;
    if max.is_finite() {
        line!(text, "axis = [{x:?}, {y:?}, {max:?}]");
    }
    let Around { centre: [x, y, z], max } = bounds.place_m;
    if max.is_finite() {
        line!(text, "place_m = [{x:?}, {y:?}, {z:?}, {max:?}]");
    }
}

fn shown_text(text: &mut String, shown: &Shown) {
    let Shown { frames, reversals, stroke_m, path_m, detour_m, lateral_m, axis, place_m } = shown;
    let range = |Range { min, max }: &Range| format!("[{min:?}, {max:?}]");
    line!(
        text,
        "shown = {{ frames = {}, reversals = {}, stroke_m = {}, path_m = {}, detour_m = {detour_m:?}, lateral_deviation_m = {lateral_m:?}, axis = {axis:?}, place_m = {place_m:?} }}",
        bounds_text(*frames),
        bounds_text(*reversals),
        range(stroke_m),
        range(path_m)
    );
}

fn bounds_text(Bounds { min, max }: Bounds) -> String {
    match max {
        u32::MAX => format!("[{min}, \"unbounded\"]"),
        max => format!("[{min}, {max}]"),
    }
}

/// A context in words, with the names that `name` gives to objects.
pub fn context_words(context: Context, name: impl Fn(u16) -> String) -> String {
    match context.0 {
        [0, 0, 0, 0] => "nothing is touched".to_owned(),
        [0, _, j, l] => format!("{} rests at {}, no hand", name(j), name(l)),
        [hand, j, 0, 0] => format!("{} hand with {}", side_of(hand).name(), name(j)),
        [hand, j, _, l] => format!("{} hand with {} at {}", side_of(hand).name(), name(j), name(l)),
    }
}

/// A sequence of contexts in words: which hand has which part, and which others it comes to.
pub(crate) fn sequence_words(contexts: &[Context], name: impl Fn(u16) -> String) -> String {
    let mut words = match contexts.first() {
        Some(Context([hand, j, _, _])) => format!("{} hand: {}", side_of(*hand).name(), name(*j)),
        None => return String::new(),
    };
    for (index, name) in others(contexts, name).iter().enumerate() {
        words += if index == 0 { " at " } else { ", " };
        words += name;
    }
    words
}

/// The names of the objects that others come to, each once.
pub(super) fn others(contexts: &[Context], name: impl Fn(u16) -> String) -> Vec<String> {
    let mut others: Vec<String> = Vec::new();
    for other in contexts.iter().filter(|context| context.is_pair()).map(|context| name(context.0[3])) {
        if !others.contains(&other) {
            others.push(other);
        }
    }
    others
}

/// The hand of a context, which holds its number (`ID_h` in the paper).
pub(crate) fn side_of(hand: u16) -> Side {
    if hand == Side::Left as u16 { Side::Left } else { Side::Right }
}

pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
