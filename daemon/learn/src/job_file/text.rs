//! From a job to its text. Written by hand, not by a serialiser: the comments are for the person who reads it.

use super::{FORMAT, JobFile, TaughtActivity, TaughtIu, VERSION, checksum, runs};
use crate::teach::ThresholdRule;
use andon_core::couple::Context;
use andon_core::input::Space;
use andon_core::job::LocalCost;
use std::fmt::Write as _;

/// Writing to a `String` cannot fail; the result is dropped here, once.
macro_rules! line {
    ($text:expr, $($arguments:tt)*) => {{ let _ = writeln!($text, $($arguments)*); }};
}

impl JobFile {
    /// The text of the job file. The same job gives the same bytes.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        line!(
            text,
            "# A job taught to Andon. The checksum covers every other character: teach again, do not edit."
        );
        line!(text, "format = {FORMAT:?}\nversion = {VERSION}\n{}\"", checksum::KEY);
        line!(text, "# The number that a PLC selects the job by.\nid = {}", self.id);
        line!(text, "name = {}", quoted(&self.name));
        line!(text, "# Whether the activities must come in the order of their numbers.");
        line!(text, "order_matters = {}", self.order_matters);
        self.provenance_text(&mut text);
        self.method_text(&mut text);
        for object in &self.objects {
            line!(text, "\n[[object]]\nid = {}\nname = {}", object.shape.id, quoted(&object.name));
            let points: Vec<String> = object
                .shape
                .interaction_points
                .iter()
                .map(|[x, y, z]| format!("[{x:?}, {y:?}, {z:?}]"))
                .collect();
            line!(text, "# Where it can be touched, in metres in its own frame.");
            line!(text, "interaction_points = [{}]", points.join(", "));
        }
        for activity in &self.activities {
            self.activity_text(&mut text, activity);
        }
        checksum::seal(&text)
    }

    fn provenance_text(&self, text: &mut String) {
        let from = &self.provenance;
        line!(text, "\n[provenance]\nprogram = {}", quoted(&from.program));
        line!(text, "date = {}", quoted(&from.date));
        match from.rule {
            ThresholdRule::Paper { sigmas } => {
                line!(text, "rule = {{ name = \"paper\", sigmas = {sigmas:?} }}")
            }
            ThresholdRule::LeaveOneOut { sigmas, border_s } => {
                line!(
                    text,
                    "rule = {{ name = \"leave_one_out\", sigmas = {sigmas:?}, border_s = {border_s:?} }}"
                );
            }
            ThresholdRule::Conformal { false_alarms } => {
                line!(text, "rule = {{ name = \"conformal\", false_alarms = {false_alarms:?} }}");
            }
        }
        let bounds = from.bounds;
        line!(
            text,
            "bounds = {{ shortest = {:?}, longest = {:?}, pause_s = {:?}, fewest = {:?}, most = {:?} }}",
            bounds.shortest,
            bounds.longest,
            bounds.pause_s,
            bounds.fewest,
            bounds.most
        );
        for source in &from.sources {
            line!(text, "\n[[provenance.source]]\nname = {}", quoted(&source.name));
            line!(text, "sha256 = {}", quoted(&source.sha256));
            line!(text, "left_out = {}", source.left_out);
        }
    }

    fn method_text(&self, text: &mut String) {
        let method = &self.method;
        line!(text, "\n# The constants it was taught with; it is judged with the same.\n[method]");
        line!(
            text,
            "space = {:?}",
            match method.space {
                Space::Plane => "plane",
                Space::Metric => "metric",
            }
        );
        line!(
            text,
            "cost = {:?}",
            match self.cost {
                LocalCost::Ordinal => "ordinal",
                LocalCost::Circular { .. } => "circular",
            }
        );
        line!(
            text,
            "# Up to how many times slower than shown is no anomaly of the motion.\nslowness = {:?}",
            self.slowness
        );
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

    fn activity_text(&self, text: &mut String, activity: &TaughtActivity) {
        line!(text, "\n[[activity]]\n# Which activity of the job this sequence fulfils.");
        line!(text, "activity = {}", activity.activity);
        for iu in &activity.ius {
            self.iu_text(text, iu);
        }
    }

    fn iu_text(&self, text: &mut String, iu: &TaughtIu) {
        line!(text, "\n[[activity.iu]]\n# {}", self.sentence(iu.context));
        line!(text, "context = {:?}", iu.context.0);
        line!(text, "demonstrations = {}", iu.demonstrations);
        line!(text, "threshold = {:?}", iu.threshold);
        line!(text, "frames = [{}, {}]", iu.frames.least, iu.frames.most);
        line!(text, "reversals = [{}, {}]", iu.reversals.least, iu.reversals.most);
        line!(text, "# frames: a_h theta_hj phi_hj jm_hj theta_jl phi_jl jm_jl");
        line!(text, "reference = [");
        for row in runs::rows(&iu.reference) {
            line!(text, "  {row:?},");
        }
        line!(text, "]");
    }

    /// A context in words, on one line.
    pub fn sentence(&self, context: Context) -> String {
        // A name may hold a line break, and a comment may not.
        context_words(context, |id| self.object_name(id)).replace(char::is_control, " ")
    }
}

/// A context in words.
pub(crate) fn context_words(context: Context, name: impl Fn(u16) -> String) -> String {
    match context.0 {
        [0, 0, 0, 0] => "nothing is touched".to_owned(),
        [0, _, j, l] => format!("{} rests at {}, no hand", name(j), name(l)),
        [hand, j, 0, 0] => format!("{} hand with {}", hand_word(hand), name(j)),
        [hand, j, _, l] => format!("{} hand with {} at {}", hand_word(hand), name(j), name(l)),
    }
}

const fn hand_word(hand: u16) -> &'static str {
    if hand == 2 { "left" } else { "right" }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
