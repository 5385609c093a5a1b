//! What cannot be checked key by key: whether values fit each other, and whether the files that they name exist.

use super::document::Document;
use super::fault::Fault;
use super::read::Origin;
use super::{Camera, Config, Source};
use andon_core::capacity::OBJECTS;
use andon_core::config::Contact;
use andon_core::input::Space;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The station's directory must be shorter than this, in characters. iceoryx2 appends the names of its services to it, and the path of a Unix socket
/// has at most 108 (unix(7)).
pub(super) const ROOT_CHARACTERS: usize = 60;

/// Whether the files that the tools make, the job and the calibration, must exist, and with them the recording that the station plays.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Learned {
    /// They must exist.
    Needed,
    /// They are about to be made.
    Awaited,
}

/// All faults between keys. A key that was refused already is not reported again.
pub(super) fn check(
    config: &Config,
    documents: &[Document<'_>],
    origins: &HashMap<String, Origin>,
    learned: Learned,
) -> Vec<Fault> {
    let mut checks = Checks { documents, origins, faults: Vec::new() };
    checks.station(config);
    if learned == Learned::Needed {
        checks.learned(config);
    }
    checks.camera(config, learned);
    checks.objects(config);
    checks.method(config);
    checks.plc(config);
    checks.ports(config);
    checks.board(config);
    checks.executor(config);
    checks.record(config);
    checks.faults
}

struct Checks<'d> {
    documents: &'d [Document<'d>],
    origins: &'d HashMap<String, Origin>,
    faults: Vec<Fault>,
}

impl Checks<'_> {
    /// Reports `problem` at `key`, unless the key, or one of the keys that it was compared with, was refused before.
    fn fault(&mut self, key: &str, against: &[&str], problem: String) {
        let refused = |key: &&str| self.origins.get(*key).is_some_and(|origin| origin.refused);
        if refused(&key) || against.iter().any(refused) {
            return;
        }
        // A default has no line: the fault lies in the key that was changed and that it was compared with.
        let location = |key: &&str| self.origins.get(*key).and_then(|origin| origin.location.as_ref());
        let at = location(&key).or_else(|| against.iter().find_map(location));
        let number = at.map_or(self.documents.len().saturating_sub(1), |(number, _)| *number);
        let Some(document) = self.documents.get(number) else { return };
        let fault = Fault {
            file: document.path.to_owned(),
            line: at.map(|(_, span)| document.line(span.start)),
            key: Some(without_index(key)),
            value: self.origins.get(key).and_then(|origin| origin.shown.clone()),
            problem,
            likely: None,
        };
        self.faults.push(fault);
    }

    /// The line of a key, for the message of another key.
    fn line(&self, key: &str) -> String {
        let location = self.origins.get(key).and_then(|origin| origin.location.as_ref());
        location.map_or("its default".into(), |(number, span)| {
            format!("line {}", self.documents[*number].line(span.start))
        })
    }

    fn exists(&mut self, key: &str, path: &Path, folder: bool) {
        let kind = if folder { "folder" } else { "file" };
        match std::fs::metadata(path) {
            Err(error) => self.fault(key, &[], format!("{} cannot be opened: {error}", path.display())),
            // Neither is a pipe, whose writer would be waited for.
            Ok(found) if !(if folder { found.is_dir() } else { found.is_file() }) => {
                self.fault(key, &[], format!("{} is not a {kind}", path.display()));
            }
            Ok(_) => {}
        }
    }

    fn station(&mut self, config: &Config) {
        let root = config.root();
        let length = root.as_os_str().len();
        if length >= ROOT_CHARACTERS {
            let problem = format!(
                "the station's directory {} has {length} characters; must be fewer than {ROOT_CHARACTERS}",
                root.display()
            );
            self.fault("station.root", &["station.name"], problem);
        }
    }

    fn learned(&mut self, config: &Config) {
        if let Some(job) = &config.station.job {
            self.exists("station.job", job, false);
        }
        if let Some(calibration) = &config.bench.calibration {
            self.exists("bench.calibration", calibration, false);
        }
    }

    fn camera(&mut self, config: &Config, learned: Learned) {
        let Camera { source, speed, repeat, depth, .. } = config.camera;
        match &config.camera.path {
            Some(path) if !source.is_live() && learned == Learned::Needed => {
                self.exists("camera.path", path, source == Source::Images);
            }
            None if !source.is_live() => {
                self.fault("camera.path", &["camera.source"], "is missing; this source needs one".into());
            }
            _ => {}
        }
        if source.is_live() && speed != super::Speed::File {
            let problem = "a live camera sets its own pace; must be \"file\"".into();
            self.fault("camera.speed", &["camera.source"], problem);
        }
        if source.is_live() && repeat {
            self.fault("camera.loop", &["camera.source"], "a live camera has no end; must be false".into());
        }
        let has_depth = match source {
            Source::Realsense | Source::Bag => depth,
            Source::Tracks => true,
            Source::Video | Source::Images | Source::V4l2 => false,
        };
        if config.method.space == Space::Metric && !has_depth {
            let problem = "this needs depth; must be \"plane\" unless camera.source is \"realsense\" or \"bag\" \
                           with camera.depth = true, or \"tracks\"";
            self.fault("bench.space", &["camera.source", "camera.depth"], problem.into());
        }
    }

    fn objects(&mut self, config: &Config) {
        let objects = &config.objects;
        if objects.is_empty() && config.camera.source != Source::Tracks {
            let problem = "are missing; a station needs at least one [[objects]]".into();
            self.fault("objects", &["camera.source"], problem);
        }
        if objects.len() > OBJECTS {
            self.fault("objects", &[], format!("there are {}; must be at most {OBJECTS}", objects.len()));
        }
        // Those that are too many are no station's: what else is wrong with them helps nobody.
        for (index, object) in objects.iter().take(OBJECTS).enumerate() {
            let [id, name] = ["id", "name"].map(|key| format!("objects[{index}].{key}"));
            self.marker(config, index);
            let earlier = &objects[..index];
            if let Some(first) = earlier.iter().position(|other| other.id == object.id && object.id != 0) {
                let first = format!("objects[{first}].id");
                let problem = format!("another object has this id already ({})", self.line(&first));
                self.fault(&id, &[&first], problem);
            }
            let same_name = |other: &super::Object| other.name == object.name && !object.name.is_empty();
            if let Some(first) = earlier.iter().position(same_name) {
                let first = format!("objects[{first}].name");
                let problem = format!("another object has this name already ({})", self.line(&first));
                self.fault(&name, &[&first], problem);
            }
        }
        if let [first, second] = config.perception.hands[..]
            && first == second
        {
            self.fault("perception.hands", &[], "must not name a hand twice".into());
        }
    }

    /// What an object is found by.
    fn marker(&mut self, config: &Config, index: usize) {
        let object = &config.objects[index];
        let of = |key: &str| format!("objects[{index}].{key}");
        let Some(marker) = object.marker_id() else {
            if config.camera.source != Source::Tracks {
                let problem =
                    "is missing; only a station whose camera.source is \"tracks\" needs none".into();
                self.fault(&of("marker_side_m"), &[&format!("objects[{index}]"), "camera.source"], problem);
            } else if object.marker.is_some() {
                let problem = "needs marker_side_m beside it".into();
                self.fault(&of("marker"), &[&of("marker_side_m")], problem);
            }
            return;
        };
        let key = of_marker(index, object);
        let markers = config.perception.dictionary.markers();
        if usize::from(marker) >= markers {
            let problem = format!("must be below {markers}, the number of markers in perception.dictionary");
            self.fault(&key, &["perception.dictionary"], problem);
        }
        let same_marker = |other: &super::Object| other.marker_id() == Some(marker);
        let earlier = config.objects[..index].iter().position(same_marker);
        // Of two with one id that has been said.
        if let Some(first) = earlier.filter(|first| config.objects[*first].id != object.id) {
            let first = of_marker(first, &config.objects[first]);
            let problem = format!("another object has this marker already ({})", self.line(&first));
            self.fault(&key, &[&first], problem);
        }
    }

    fn method(&mut self, config: &Config) {
        let method = &config.method;
        self.contact(method.hand_contact, "hand");
        self.contact(method.object_contact, "object");
        if method.filter_frames.is_multiple_of(2) {
            let problem = "must be odd: the window has a frame in its middle".into();
            self.fault("method.filter_frames", &[], problem);
        }
        if config.camera.source.is_live() && method.rate_hz > config.camera.rate_hz {
            let problem = format!("must not be over camera.rate_hz = {:?}", config.camera.rate_hz);
            self.fault("method.rate_hz", &["camera.rate_hz", "camera.source"], problem);
        }
        let persist_ms = f32::from(method.persist_frames) * 1000.0 / method.rate_hz;
        if (method.blind_ms as f32) < persist_ms {
            let problem = format!("must be at least {persist_ms:.0} ms, which is persist_frames at rate_hz");
            self.fault("method.blind_ms", &["method.persist_frames", "method.rate_hz"], problem);
        }
        if method.idle_end_ms <= method.blind_ms {
            let problem = format!("must be over blind_ms = {}", method.blind_ms);
            self.fault("method.idle_end_ms", &["method.blind_ms"], problem);
        }
    }

    fn contact(&mut self, contact: Contact, what: &str) {
        if contact.off_m < contact.on_m {
            let problem = format!("must be at least {what}_contact_on_m = {:?}", contact.on_m);
            let [on, off] = ["on", "off"].map(|end| format!("method.{what}_contact_{end}_m"));
            self.fault(&off, &[&on], problem);
        }
    }

    fn plc(&mut self, config: &Config) {
        let plc = &config.plc;
        if plc.enable && plc.allow.is_empty() {
            let problem = "must name at least one client, or nobody can connect".into();
            self.fault("plc.allow", &["plc.enable"], problem);
        }
        let stranger = plc.allow.iter().find(|client| !client.is_loopback());
        if let Some(client) = stranger
            && plc.bind.is_loopback()
        {
            let problem =
                format!("{client} cannot reach plc.bind = {}, which is this machine only", plc.bind);
            self.fault("plc.allow", &["plc.bind"], problem);
        }
        if plc.writes && plc.commanders.is_empty() && plc.allow.len() > 1 {
            let problem =
                "must name the client that may write, because plc.writes is true and plc.allow has several"
                    .into();
            self.fault("plc.commanders", &["plc.allow", "plc.writes"], problem);
        }
        if let Some(client) = plc.commanders.iter().find(|client| !plc.allow.contains(client)) {
            let problem = format!("{client} cannot write, because it is not in plc.allow and cannot connect");
            self.fault("plc.commanders", &["plc.allow"], problem);
        }
    }

    /// Each server that is enabled has a port of its own.
    fn ports(&mut self, config: &Config) {
        let servers = [
            (config.plc.enable, config.plc.port, ["plc.port", "plc.enable"]),
            (config.metrics.enable, config.metrics.port, ["metrics.port", "metrics.enable"]),
            (config.board.enable, config.board.port, ["board.port", "board.enable"]),
        ];
        for (index, (enable, port, [key, enables])) in servers.iter().enumerate() {
            let same = |(enable_other, other, _): &&(bool, u16, _)| *enable && *enable_other && other == port;
            if let Some((_, _, [other, enables_other])) = servers[..index].iter().find(same) {
                let problem = format!("is {other} as well; must be another one");
                self.fault(key, &[other, enables_other, enables], problem);
            }
        }
    }

    fn board(&mut self, config: &Config) {
        let board = &config.board;
        let named = |path: &Option<PathBuf>| path.is_some();
        if named(&board.certificate) != named(&board.key) {
            let [there, missing] = match named(&board.certificate) {
                true => ["board.certificate", "board.key"],
                false => ["board.key", "board.certificate"],
            };
            self.fault(there, &[missing], format!("needs {missing} beside it"));
        } else if board.enable && !board.bind.is_loopback() && !named(&board.certificate) {
            let problem = "other machines reach it, so it needs TLS: name files in board.certificate and board.key, and let \
                           `andond board certificate` make them; or must be a loopback address, as 127.0.0.1"
                .into();
            self.fault("board.bind", &["board.enable", "board.certificate", "board.key"], problem);
        }
        if config.board.enable
            && let Some(words) = &config.board.words
        {
            self.exists("board.words", words, true);
        }
    }

    fn executor(&mut self, config: &Config) {
        if config.executor.enable && !config.board.enable {
            let problem = "needs board.enable = true: orders come from its pages".into();
            self.fault("executor.enable", &["board.enable"], problem);
        }
    }

    fn record(&mut self, config: &Config) {
        let record = &config.record;
        if (1..3).contains(&record.bench.len()) {
            let problem = "must have at least 3 corners, or none".into();
            self.fault("record.bench", &[], problem);
        }
        let polygons =
            [("record.bench", std::slice::from_ref(&record.bench)), ("record.masks", &record.masks)];
        for (key, polygons) in polygons {
            for (number, _) in (1..).zip(polygons).filter(|(_, corners)| crosses_itself(corners)) {
                let which = if polygons.len() > 1 { format!("polygon {number} ") } else { String::new() };
                let problem = format!(
                    "{which}must not cross itself: what lies in it is not clear; name its corners in their order"
                );
                self.fault(key, &[], problem);
            }
            let mut corners = polygons.iter().flatten();
            let without = "needs record.size: the size of the picture that it was drawn on";
            let problem = match record.size {
                None => corners.next().map(|_| without.to_owned()),
                // What was drawn on a larger picture would hide something else, or nothing.
                Some([width, height]) => corners.find(|[x, y]| *x > width || *y > height).map(|[x, y]| {
                    format!("the corner [{x}, {y}] lies outside of record.size = [{width}, {height}]")
                }),
            };
            if let Some(problem) = problem {
                self.fault(key, &["record.size"], problem);
            }
        }
        // A recording ends at its size, and a clip must hold what is in memory.
        if record.file_mb < record.memory_mb {
            let problem = format!("must not be under record.memory_mb = {}", record.memory_mb);
            self.fault("record.file_mb", &["record.memory_mb"], problem);
        }
        // Else the one that is being written would leave no room for those before it.
        if record.file_mb > record.keep_mb / 2 {
            let problem = format!("must not be over half of record.keep_mb = {}", record.keep_mb);
            self.fault("record.file_mb", &["record.keep_mb"], problem);
        }
    }
}

/// A side of a polygon: its two ends.
type Side = [[i64; 2]; 2];

/// Whether two sides of a polygon meet that are not neighbours: what lies in it is not clear then.
fn crosses_itself(corners: &[[u32; 2]]) -> bool {
    let count = corners.len();
    let side = |index: usize| [corners[index], corners[(index + 1) % count]].map(|at| at.map(i64::from));
    let others = |one: usize| (one + 2..count).filter(move |other| (other + 1) % count != one);
    (0..count).any(|one| others(one).any(|other| meet(side(one), side(other))))
}

/// Whether two sides have a point in common.
fn meet(one: Side, other: Side) -> bool {
    // On which side of a line a point lies.
    let turn = |[from, to]: Side, at: [i64; 2]| {
        ((to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])).signum()
    };
    let is_between = |line: Side, ends: Side| turn(line, ends[0]) * turn(line, ends[1]) <= 0;
    let overlaps = |axis: usize| {
        let [one, other] = [one, other].map(|side| side.map(|end| end[axis]));
        one[0].min(one[1]) <= other[0].max(other[1]) && other[0].min(other[1]) <= one[0].max(one[1])
    };
    is_between(one, other) && is_between(other, one) && overlaps(0) && overlaps(1)
}

/// The key that says which marker an object has.
fn of_marker(index: usize, object: &super::Object) -> String {
    format!("objects[{index}].{}", if object.marker.is_some() { "marker" } else { "id" })
}

/// `objects[2].id` as a message calls it: `objects.id`.
fn without_index(key: &str) -> String {
    match (key.find('['), key.find(']')) {
        (Some(begin), Some(end)) => format!("{}{}", &key[..begin], &key[end + 1..]),
        _ => key.to_owned(),
    }
}
