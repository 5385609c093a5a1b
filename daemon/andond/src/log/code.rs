//! The table of all codes. A code is never used again for something else; a new one takes a free number of its
//! group: the hundreds are the places where a technician looks first.

use super::Code;
use std::fmt::Write as _;
use tracing::Level;

/// A group of codes: the first number and where to look.
const GROUPS: [(u32, &str); 8] = [
    (100, "Camera"),
    (200, "What is seen"),
    (300, "Judging and jobs"),
    (400, "Journal"),
    (500, "PLC"),
    (600, "Shared memory and processes"),
    (700, "The machine"),
    (800, "Set-up"),
];

macro_rules! table {
    ($($level:ident $number:literal $name:ident: $meaning:literal, $remedy:literal;)+) => {
        $(
            #[doc = concat!("AND-", $number, ": ", $meaning)]
            pub const $name: Code = Code {
                number: $number,
                name: concat!("AND-", $number),
                level: Level::$level,
                meaning: $meaning,
                remedy: $remedy,
            };
        )+
        /// Every code, in the order of the numbers.
        pub const ALL: &[&Code] = &[$(&$name),+];
    };
}

table! {
    INFO 101 CAMERA_READY: "the camera or the recording gives frames", "";
    INFO 102 RECORDING_ENDED: "the recording is at its end", "";
    INFO 103 CAMERA_BACK: "the camera gives frames again", "";
    ERROR 104 CAMERA_GONE: "the camera does not answer; it is tried again until it does",
        "Check its plug, its cable and its power; the line goes on by itself when it is back";
    ERROR 105 CAMERA_REFUSED: "the camera does not offer the configured size, format or rate",
        "List what it offers with `v4l2-ctl --list-formats-ext` and set camera.width, camera.height and camera.rate_hz";
    WARN 106 CAMERA_SLOW: "the camera gives fewer frames than it was asked for",
        "Give it more light or a fixed camera.exposure_us, and a USB port of its own";
    ERROR 107 CAMERA_NOT_ALLOWED: "the camera may not be opened by this user",
        "The unit's user needs the group `video`; on a terminal run `sudo usermod -aG video $USER` and log in again";
    ERROR 108 RECORDING_DAMAGED: "the recording cannot be read on from here",
        "Copy it again from where it was recorded, or cut it before the damaged place";
    ERROR 109 REALSENSE_UNFIT: "the RealSense camera is on a slow USB port, or its library or udev rule is missing",
        "Use a USB 3 port and its own cable, and install the package with its library and its udev rule";

    WARN 201 MARKER_COVERED: "an object's marker has not been seen for longer than method.blind_ms while a hand worked with it, or for 10 s",
        "Clean the marker, take away what covers it, see that it is not gripped in its middle and that the bench is lit evenly";
    INFO 202 MARKER_BACK: "the object's marker is seen again", "";
    WARN 203 HAND_OUT_OF_VIEW: "a hand left the picture, for longer than method.blind_ms, while it touched something",
        "Move the work or the camera so that the hand stays in view";
    INFO 204 HAND_BACK: "the hand is seen again", "";
    ERROR 205 MODEL_MISSING: "a hand model is missing or damaged",
        "Install the package again, or run `make setup`, and check perception.models";
    ERROR 206 ONNXRUNTIME_MISSING: "the ONNX Runtime library is missing or does not fit",
        "Install the package again, or run `make setup`, and check perception.models";
    ERROR 208 CALIBRATION_REFUSED: "the calibration cannot be used",
        "Calibrate again with `andond calibrate`";
    WARN 210 TRACK_CUT_SHORT: "the track file ends in the middle of a line",
        "The tracker was stopped while it wrote; everything up to there has been used";
    WARN 211 BENCH_NOT_FOUND: "the depth picture does not show the bench yet; nothing is placed until it does",
        "Clear the bench and let the camera look down on it, or calibrate with `andond calibrate`";

    INFO 301 JOB_LOADED: "a job is loaded and watched", "";
    ERROR 302 JOB_REFUSED: "the job file is damaged, of another version or does not fit this station",
        "Teach the job again with `andond teach`, or select one that fits";
    INFO 303 JOB_STARTED: "a job has begun", "";
    INFO 304 JOB_OK: "the job was done right", "";
    WARN 305 JOB_ANOMALY: "the job was not done right",
        "Look at the product; `andond history --nok` shows the steps";
    WARN 306 ACTIVITY_ANOMALY: "a step cannot be right any more",
        "Stop and look at the step that the message names";
    WARN 307 NOT_JUDGED: "a step could not be judged",
        "Look at the product; the reason names what was missing";
    WARN 308 OVERLOAD: "more came than there is room for, and a step could not be judged",
        "Fewer objects on the bench, or shorter steps in the job";
    INFO 309 COMMAND: "the PLC or a person gave a command", "";
    WARN 310 COMMAND_REFUSED: "a command does not fit the state or is malformed",
        "Check the order of the commands against the register map";
    WARN 311 NO_JOB: "no job is selected: nothing is judged",
        "Set station.job, or let the PLC select one";
    WARN 312 FRAME_OUT_OF_ORDER: "a frame came late, twice or out of order and was refused",
        "If it goes on, look at the camera's driver and the load of the machine";

    INFO 401 JOURNAL_OPENED: "the journal is open", "";
    ERROR 402 DISK_FULL: "the journal cannot be written",
        "Make room on the disk, or lower journal.keep_mb; until then the PLC is told `error`";
    ERROR 403 JOURNAL_LOCKED: "another program holds the journal's lock",
        "Close what has the database open: `fuser -v` on the file names it";
    ERROR 404 JOURNAL_DAMAGED: "the journal's database is damaged or of a newer version",
        "Move the file away, it is kept for repair with `sqlite3 .recover`; a new one is made at the next start";
    WARN 405 JOURNAL_GAP: "verdicts were lost before they could be written; the gap is recorded",
        "Look at the messages before this one for the reason";
    INFO 406 JOURNAL_TRIMMED: "old verdicts were removed by age or size", "";

    INFO 501 PLC_LISTENING: "the Modbus server listens", "";
    INFO 502 PLC_CONNECTED: "a PLC has connected", "";
    WARN 503 PLC_DISCONNECTED: "no PLC is connected any more: it has closed the connection or gone silent",
        "Check the PLC and the network between";
    WARN 504 PLC_CLIENT_REFUSED: "a client that is not in plc.allow tried to connect",
        "Add its address to plc.allow and to the unit's IPAddressAllow= if it should";
    WARN 505 PLC_WRITE_REFUSED: "a client tried to write while plc.writes is off",
        "Set plc.writes = true if it should";
    ERROR 506 PLC_PORT_TAKEN: "the Modbus port cannot be opened",
        "Another program has it, plc.bind is no address of this machine, or the port is under 1024: andon-plc@.service says what that needs";
    WARN 507 PLC_OVERRUN: "results were not acknowledged in time and the queue is full",
        "The PLC must acknowledge every result; see the register map";
    WARN 508 PLC_BAD_REQUEST: "a Modbus request was malformed or outside the register map",
        "Check the addresses in the PLC program against the register map";
    INFO 509 PLC_READY: "ready is raised", "";
    WARN 510 PLC_NOT_READY: "ready has dropped",
        "Look at the messages before this one for the reason";

    INFO 511 PLC_OFF: "the configuration has no PLC", "";

    INFO 601 ROLE_READY: "the role's first step has gone through", "";
    INFO 602 ROLE_STOPPING: "the role was asked to stop", "";
    ERROR 603 SHM_FULL: "there is not enough room in /dev/shm",
        "Enlarge it (`mount -o remount,size=512M /dev/shm`) or remove what else lies there";
    ERROR 604 STEWARD_TWICE: "another steward runs for this station",
        "Stop it: `systemctl status andon-steward@NAME`, or look for a demo that still runs";
    ERROR 605 STEWARD_MISSING: "no steward runs for this station",
        "Start it: `systemctl start andon-steward@NAME`; this role goes on when it is there";
    ERROR 606 ROOT_DELETED: "the station's directory was removed while it was in use",
        "Keep cleaners away from station.root, and restart the target: `systemctl restart andon@NAME.target`";
    ERROR 607 OTHER_VERSION: "a process of another version of Andon is on the same station",
        "Stop everything of the station and start it again from one version";
    WARN 608 ROLE_DIED: "a process has died and was cleaned up",
        "systemd starts it again; look at that role's own messages for the reason";
    WARN 609 LOSSES: "messages were lost between two roles",
        "The machine is too slow or too busy for this rate: look at `andond status`";
    ERROR 610 DEADLINE_MISSED: "nothing came for longer than the deadline",
        "Look at `andond status` for the first role that is not healthy";
    INFO 611 DEADLINE_MET: "messages come again", "";
    ERROR 612 NO_PROGRESS: "the role got no further and ends itself",
        "systemd starts it again; if it goes on, report it with this log";
    ERROR 613 SERVICE_UNUSABLE: "a service of the station cannot be opened",
        "Restart the station's target; if it goes on, stop it and remove the station's directory";
    ERROR 614 PANIC: "the program has an error",
        "systemd starts it again; report it with this log";
    ERROR 615 ROLE_FAILED: "the role cannot go on",
        "systemd starts it again; the message says what failed";

    WARN 701 CLOCK_STEPPED: "the machine's clock was stepped; verdicts keep their order, their UTC times jump",
        "Let one time service set the clock, slowly";

    ERROR 801 CONFIGURATION_REFUSED: "the configuration has faults",
        "Put right what is listed; `andond check FILE` checks it without starting anything";
}

/// The index page, `daemon/andond/CODES.md`.
#[must_use]
pub fn index() -> String {
    let mut page = String::from(
        "# Codes\n\nEvery message that a technician may see has one of these codes, and ends with what to do. A code never\n\
         changes its meaning. This page is generated from `src/log/code.rs`.\n",
    );
    for (first, title) in GROUPS {
        // Writing to a `String` cannot fail.
        let _ = write!(
            page,
            "\n## {title}\n\n| code | level | what it means | what to do |\n|---|---|---|---|\n"
        );
        for code in ALL.iter().filter(|code| (first..first + 100).contains(&code.number)) {
            let _ = writeln!(page, "| {} | {} | {} | {} |", code.name, code.level, code.meaning, code.remedy);
        }
    }
    page
}
