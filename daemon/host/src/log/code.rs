//! The table of all codes. A number is never used again for something else; a new code takes a free number of its group.
//! The hundreds are the groups: the places where a technician looks first.

use super::Code;
use std::fmt::Write as _;
use tracing::Level;

/// A group of codes: the first number and where to look.
const GROUPS: [(u32, &str); 8] = [
    (100, "Camera"),
    (200, "What is seen"),
    (300, "Judging and jobs"),
    (400, "Journal and recordings"),
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
    INFO 101 CAMERA_READY: "the camera or the recording delivers frames", "";
    INFO 102 RECORDING_ENDED: "the recording has ended", "";
    INFO 103 CAMERA_BACK: "the camera delivers frames again", "";
    ERROR 104 CAMERA_GONE: "the camera does not answer; Andon tries again until it does",
        "Check its plug, its cable and its power; the line continues by itself when the camera is back";
    ERROR 105 CAMERA_REFUSED: "the camera does not offer the configured size, format, rate or exposure",
        "List what it offers with `v4l2-ctl --list-formats-ext --list-ctrls`, for a RealSense camera with `rs-enumerate-devices`, and correct the section [camera]";
    WARN 106 CAMERA_SLOW: "the camera delivers fewer frames than it was asked for",
        "Give it more light or a fixed camera.exposure_us, and a USB port of its own";
    ERROR 107 CAMERA_NOT_ALLOWED: "this user may not open the camera",
        "Add the unit's user to the group `video`; in a terminal run `sudo usermod -aG video $USER` and log in again";
    ERROR 108 RECORDING_DAMAGED: "the recording cannot be read any further",
        "Copy it again from where it was recorded, or cut it off before the damaged part";
    ERROR 109 REALSENSE_UNFIT: "the RealSense camera is on a slow USB port, or its library or udev rule is missing",
        "Use a USB 3 port and a cable of its own; the package installs the library and the udev rule";

    WARN 201 MARKER_COVERED: "an object's marker has not been seen for longer than method.blind_ms while a hand worked with it, or for 10 s",
        "Clean the marker, remove what covers it, do not grip it in the middle, and light the bench evenly";
    INFO 202 MARKER_BACK: "the object's marker is seen again", "";
    WARN 203 HAND_OUT_OF_VIEW: "a hand was out of the picture for longer than method.blind_ms while it touched something",
        "Move the work or the camera so that the hand stays in view";
    INFO 204 HAND_BACK: "the hand is seen again", "";
    ERROR 205 MODEL_MISSING: "a hand model is missing or damaged",
        "Install the package again, or run `make setup`, and check perception.models";
    ERROR 206 ONNXRUNTIME_MISSING: "the ONNX Runtime library is missing or does not fit",
        "Install the package again, or run `make setup`, and check perception.models";
    ERROR 208 CALIBRATION_REFUSED: "the calibration cannot be used",
        "Make a new one with `andond calibrate`";
    WARN 210 TRACK_CUT_SHORT: "the track file ends in the middle of a line",
        "The tracker was stopped while it wrote, so nothing is said of the end. Copy the file again, or remove that line if no more is missing";
    WARN 211 BENCH_NOT_FOUND: "the depth picture does not show the bench; until it does, nothing has a position",
        "Clear the bench and let the camera look down on it, or calibrate with `andond calibrate`";
    ERROR 212 PICTURE_FROZEN: "the picture has stopped: the camera sends the same one again and again",
        "Unplug the camera and plug it in again. If that helps only for a while, give it a USB port and a cable of its own";
    ERROR 213 PICTURE_BLACK: "the picture is black",
        "Switch on the light, take the cap off the lens, and look at camera.exposure_us";
    ERROR 214 PICTURE_WHITE: "the picture is white",
        "Turn away whatever shines into the lens, or lower camera.exposure_us";
    ERROR 215 LENS_COVERED: "something lies over the lens: the picture shows nothing of the bench",
        "Clear the camera's view";
    ERROR 216 PICTURE_BLURRED: "the picture is blurred, and markers are lost because of it",
        "Clean the lens, let it dry, and focus it on the bench";
    ERROR 217 PICTURE_NOISY: "the picture is so noisy that nothing is found",
        "Light the bench better, or give the camera a longer camera.exposure_us";
    WARN 218 TOO_FEW_FRAMES: "too few pictures are processed to judge by them",
        "Stop what else runs on the machine, or choose perception.hand_model = \"lite\" or a lower camera.rate_hz. A camera in the dark gives fewer by itself: light the bench better";
    ERROR 219 MARKERS_FOREIGN: "none of the station's markers has been seen, although there are others or hands at work",
        "Compare the printed markers with perception.dictionary and with the ids under [[objects]]; they must lie flat, whole and in the light";
    ERROR 220 HANDS_NOT_FOUND: "parts move, and no hand is found",
        "Light the hands, take off gloves in the colour of the bench, and let the camera see the whole hand";
    INFO 221 SIGHT_BACK: "the line sees its bench again", "";
    ERROR 222 CAMERA_MOVED: "the camera has been moved",
        "Put the camera back; or, if bench.calibration is set, calibrate again with `andond calibrate` and restart perceive. Without a calibration the new view counts after ten seconds";
    WARN 224 MARKER_TWICE: "a marker's id is in view twice, so its part counts as not seen",
        "Take the other print away, or give it an id of its own; `andond markers --spare` prints ids that no part has";

    INFO 301 JOB_LOADED: "a job is loaded and watched", "";
    ERROR 302 JOB_REFUSED: "a job file cannot be read, or the job does not fit this station",
        "Select a job that fits, or make one with `andond teach`";
    INFO 303 JOB_STARTED: "a job has begun", "";
    INFO 304 JOB_OK: "the job was done right", "";
    WARN 305 JOB_ANOMALY: "the job was not done right",
        "Look at the product; `andond history --nok` shows the steps";
    WARN 306 ACTIVITY_ANOMALY: "a step can no longer be right",
        "Stop and look at the step that the message names";
    WARN 307 NOT_JUDGED: "a step could not be judged",
        "Look at the product; the reason names what was missing";
    WARN 308 OVERLOAD: "too few frames came, none for a while, or a step lasted longer than can be compared: it could not be judged",
        "Where frames are missing, stop what else runs on the machine, or choose perception.hand_model = \"lite\". A step of more than 2048 frames, about a minute at 30 Hz, must be taught as shorter activities";
    INFO 309 COMMAND: "the PLC or a person gave a command", "";
    WARN 310 COMMAND_REFUSED: "a command is malformed or does not fit the state",
        "Check the order of the commands against the register map";
    WARN 311 NO_JOB: "no job is selected: nothing is judged",
        "Set station.job, let the PLC select a job, or teach and load one on the engineer's page of the board";
    WARN 312 FRAME_OUT_OF_ORDER: "a frame came late, twice or out of order and was refused",
        "If it happens again and again, look at the camera's driver and at the load of the machine";
    WARN 313 NOTE: "a step was done in a way that nobody has shown, but it breaks no rule of the order",
        "Check whether it was right; if it was, teach the job again with such a run as well";

    INFO 401 JOURNAL_OPENED: "the journal is open", "";
    ERROR 402 DISK_FULL: "the journal cannot be written",
        "Make room on the disk or lower journal.keep_mb; until then the PLC reads `error`";
    ERROR 403 JOURNAL_LOCKED: "another program holds the journal's lock",
        "Close that program: `fuser -v FILE` names it; `andond history` needs no lock and may run";
    ERROR 404 JOURNAL_DAMAGED: "the journal's database is damaged or of a newer version",
        "A damaged one was put aside under the name that the message gives, and `sqlite3 .recover` may repair it. A newer one opens in the version of Andon that wrote it";
    WARN 405 JOURNAL_GAP: "verdicts were lost before they could be written; the gap is recorded",
        "Look at the messages before this one for the reason";
    INFO 406 JOURNAL_TRIMMED: "old verdicts were removed by age or size", "";
    ERROR 407 JOURNAL_REMOVED: "the journal's database was removed or replaced while it was in use; a new one has begun",
        "Find out who removed it: what was in it is gone, unless it was moved. `andond backup` makes a copy while the line runs";
    ERROR 408 JOURNAL_NOT_OPENED: "the journal's database cannot be opened; Andon tries again until it can",
        "Check that the folder of journal.path exists, that journal.path is not a folder itself, and that the role's user may write there";
    WARN 409 JOURNAL_UNACKNOWLEDGED: "verdicts were removed that a consumer of the journal had not acknowledged; the database has reached journal.keep_mb",
        "Find out why the PLC, or another consumer, does not acknowledge; or raise journal.keep_mb";
    INFO 410 RECORDING_BEGAN: "a recording has begun", "";
    INFO 411 RECORDING_KEPT: "a recording is complete", "";
    ERROR 412 RECORDINGS_UNWRITTEN: "recordings cannot be written; verdicts are not affected, and Andon tries again until it can",
        "Make room on the disk, lower record.keep_mb, or let the unit's user write in the folder of the recordings. If that is not below /var/lib/andon, name it as ReadWritePaths with `systemctl edit andon-record@NAME`";
    WARN 413 RECORDING_SLOW: "the disk is too slow for the recording: some of it is missing, and verdicts are not affected",
        "Record less (record.mode, record.quality), or give the recordings another disk by record.path, and name its folder as ReadWritePaths with `systemctl edit andon-record@NAME`";
    INFO 414 RECORDINGS_TRIMMED: "old recordings were removed by age, by size, or for the journal's room", "";
    WARN 415 RECORDING_REPAIRED: "a recording was not written to its end; what is whole in it was saved",
        "Nothing has to be done: its recorder was killed, or the power failed";
    INFO 416 RECORDING_OFF: "the configuration records nothing; earlier recordings stay until they are too old", "";
    WARN 417 RECORDING_UNREPAIRED: "a recording was not written to its end and cannot be completed; it stays as it is",
        "Let the unit's user write in the folder of the recordings. If the file itself is damaged, remove it: nothing in it can be saved";
    WARN 418 STILL_MISSING: "an anomaly has no picture beside its recording: it was not in memory any more, or could not be drawn",
        "Raise record.memory_mb; what was detected is in the recording all the same";
    WARN 419 RECORDING_UNREMOVED: "a recording is older than it may be, or one too many, and cannot be removed; its pictures stay",
        "Let the unit's user write in the folder of the recordings, or remove the file by hand";

    INFO 501 PLC_LISTENING: "the Modbus server listens", "";
    INFO 502 PLC_CONNECTED: "a PLC has connected", "";
    WARN 503 PLC_DISCONNECTED: "no PLC is connected any more: it closed the connection or fell silent",
        "Check the PLC and the network between it and this machine";
    WARN 504 PLC_CLIENT_REFUSED: "a client was refused: it is not in plc.allow, or too many are connected",
        "If it should connect, add its address to plc.allow and to the unit's IPAddressAllow=";
    WARN 505 PLC_WRITE_REFUSED: "a client that may only read tried to write",
        "Set plc.writes = true and name it in plc.commanders if it should write";
    ERROR 506 PLC_PORT_TAKEN: "the Modbus port cannot be opened",
        "Another program has it, perhaps another station of this machine: each needs a plc.port of its own. Or plc.bind is not an address of this machine. For a port below 1024 andon-plc@.service says what is needed";
    WARN 507 PLC_OVERRUN: "results are lost to the PLC: the journal could not take them or, without plc.writes, more came than can wait",
        "`andond history` shows what the journal has, and a gap for what it has not. Where no result may be missed set plc.writes = true: then each waits until it is acknowledged";
    WARN 508 PLC_BAD_REQUEST: "a Modbus request was malformed or outside the register map",
        "Check the addresses in the PLC program against the register map";
    INFO 509 PLC_READY: "ready is raised", "";
    WARN 510 PLC_NOT_READY: "ready has dropped; the message says why",
        "`andond status` shows how every role is doing";
    INFO 511 PLC_OFF: "the configuration has no PLC", "";

    INFO 601 ROLE_READY: "the role's first step has succeeded", "";
    INFO 602 ROLE_STOPPING: "the role was asked to stop", "";
    ERROR 603 SHM_FULL: "there is not enough room in /dev/shm",
        "Enlarge it (`mount -o remount,size=512M /dev/shm`) or remove other files from it";
    ERROR 604 STEWARD_TWICE: "another steward runs for this station",
        "Stop it: `systemctl status andon-steward@NAME` shows it; it may also be a demo that is still running";
    ERROR 605 STEWARD_MISSING: "no steward runs for this station",
        "Start it with `systemctl start andon-steward@NAME` and look at its log; systemd starts this role again until it is there";
    ERROR 606 ROOT_DELETED: "the station's directory was removed while it was in use",
        "Keep cleaners of temporary files away from station.root, and restart the target: `systemctl restart andon@NAME.target`";
    ERROR 607 OTHER_VERSION: "a process of another version of Andon is on the same station",
        "Stop all processes of the station and start them again from one version";
    WARN 608 ROLE_DIED: "a process has died and was cleaned up",
        "systemd starts it again; look at that role's own messages for the reason";
    WARN 609 LOSSES: "messages or frames were lost between two roles, or between the camera and Andon",
        "The machine is too slow or too busy for this rate: look at `andond status`";
    ERROR 610 DEADLINE_MISSED: "no message came within the deadline",
        "Look at `andond status` for the first role that is not healthy";
    INFO 611 DEADLINE_MET: "messages come again", "";
    ERROR 612 NO_PROGRESS: "the role made no progress and ends itself",
        "systemd starts it again; if it happens again, report it with this log";
    ERROR 613 SERVICE_UNUSABLE: "a service of the station cannot be opened",
        "Restart the station's target; if that does not help, stop it and remove the station's directory";
    ERROR 614 PANIC: "the program has a defect",
        "systemd starts it again; report it with this log";
    ERROR 615 ROLE_FAILED: "the role cannot continue",
        "systemd starts it again; the message says what failed";
    WARN 616 CHANNEL_DEAF: "a role does not receive what the role before it sends; it reconnects until it does",
        "If it happens again and again, restart the station's target and report it with this log";

    INFO 617 METRICS_LISTENING: "the metrics can be fetched", "";
    INFO 618 METRICS_OFF: "the configuration has no metrics", "";
    ERROR 619 METRICS_PORT_TAKEN: "the port of the metrics cannot be opened",
        "Another program has it, perhaps another station: choose another metrics.port; or metrics.bind is not an address of this machine";
    INFO 620 BOARD_LISTENING: "the pages of the board can be looked at", "";
    INFO 621 BOARD_OFF: "the configuration has no board", "";
    ERROR 622 BOARD_PORT_TAKEN: "the port of the board cannot be opened",
        "Another program has it, perhaps another station: choose another board.port; or board.bind is not an address of this machine";
    ERROR 623 BOARD_WORDS_REFUSED: "the board has no words: a table of board.words has a fault, or there is none for board.language",
        "Correct what is named, or remove board.words";
    ERROR 624 BOARD_UNSAFE: "the board may not be reached from a network: its certificate, its key or its logins cannot be used",
        "Make what is missing with `andond board certificate` or `andond board login`, as the user of the station's units; or set board.bind to 127.0.0.1";
    INFO 625 BOARD_LOGIN: "somebody has logged in to the board", "";
    WARN 626 BOARD_LOGIN_REFUSED: "a login to the board was refused: the name or the password is wrong",
        "If nobody has mistyped, look for who does this at the address that is named; `andond board remove` removes a login";
    WARN 627 BOARD_LOGINS_UNREADABLE: "the file of logins cannot be read, so nobody can log in to the board",
        "Correct what is named: the user of the station's units must be able to read it";
    INFO 628 EXECUTOR_OFF: "the configuration lets nobody order commands on the board", "";
    INFO 629 EXECUTOR_READY: "what an engineer orders on the board is done", "";
    WARN 630 EXECUTOR_CANNOT_WRITE: "a folder in which an engineer's commands write cannot be written",
        "Set station.jobs and executor.path to folders below /var/lib/andon, where the user of the station's units may write";
    INFO 631 TASK_BEGUN: "a command that was ordered on the board has begun", "";
    INFO 632 TASK_ENDED: "a command that was ordered on the board has ended", "";
    INFO 633 TASK_REFUSED: "a command that was ordered on the board was not begun", "";

    WARN 701 CLOCK_STEPPED: "the machine's clock was stepped: verdicts keep their order, and their UTC times jump",
        "Let one time service set the clock, slowly";

    ERROR 801 CONFIGURATION_REFUSED: "the configuration has faults",
        "Correct what is listed; `andond check -c FILE` checks a file without starting anything";
    WARN 802 CONFIGURATION_CHANGED: "the configuration files have changed since the line started, and the changes are not in force yet",
        "Check them with `andond check -c FILE`, then restart the station's target when no job is running: `systemctl restart andon@NAME.target`";
    WARN 803 CONFIGURATION_NOT_KEPT: "the line's configuration, or the job that a command has loaded, cannot be saved. A role that restarts will begin with what the files say at that time",
        "Make room in the file system of station.root, and restart the station's target";
}

/// The code with this number.
#[must_use]
pub fn of_number(number: u32) -> Option<&'static Code> {
    ALL.iter().copied().find(|code| code.number == number)
}

/// The group of a number: the place where a technician looks first.
#[must_use]
pub fn group(number: u32) -> &'static str {
    let group = GROUPS.iter().find(|(first, _)| (*first..first + 100).contains(&number));
    group.map_or("", |(_, title)| title)
}

/// The index page, `daemon/andond/CODES.md`. The test that holds the page against the table is its only caller.
#[must_use]
pub fn index() -> String {
    let mut page = String::from(
        "# Codes\n\nEvery message for a technician has one of these codes. If there is something to do, the message ends with it. It is\n\
         the remedy of this page, or a narrower one where the cause is known. A code never changes its meaning. This page is\n\
         generated from `src/log/code.rs`.\n",
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
