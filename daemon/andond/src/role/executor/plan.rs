//! From a task to command lines of `andond`: a fixed list of arguments for each kind.
//!
//! Nothing in a task becomes a path. A job has a name of few characters and lies in the station's folder of jobs. A recording is one of those in the
//! folder of films. Whatever else is said is one argument, which no shell reads.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;

use andon_host::atomic::folder_of;
use andon_host::config::Config;
use andon_ipc::is_station_name;
use rustix::fs::{Access, access};
use shm_schemas::{Task, TaskKind, task_flag};

use super::super::jobs;
use super::change::Change;
use crate::made::{Made, hash_of, is_hash, is_name};
use crate::step_pictures;

/// Exit codes of a command that has done what was asked for.
const DONE: &[i32] = &[0];

/// Those of a command that has judged, whatever it has found.
const JUDGED: &[i32] = &[0, 1, 2];

/// Runs of a job that are shown at once, at most.
const MOST_RUNS: u16 = 50;

/// How long a running job is waited for, in seconds.
const IDLE_S: u32 = 300;

/// One command.
#[derive(Debug)]
pub(super) struct Step {
    pub(super) arguments: Vec<OsString>,
    /// The exit codes with which it has done what was asked for.
    pub(super) good: &'static [i32],
}

impl Step {
    /// Whether a command that has ended so has done what was asked for.
    pub(super) fn is_done(&self, status: ExitStatus) -> bool {
        status.code().is_some_and(|code| self.good.contains(&code))
    }
}

/// What a task is.
#[derive(Debug)]
pub(super) struct Plan {
    /// What it changes by itself.
    pub(super) changes: Vec<Change>,
    pub(super) steps: VecDeque<Step>,
}

/// The commands of a task, and what it changes before them. Nothing is done yet.
///
/// # Errors
/// Why it is not done, in words for whoever has ordered it.
pub(super) fn of(kind: TaskKind, task: &Task, config: &Config) -> Result<Plan, String> {
    if [task.name(), task.text()].concat().chars().any(|one| one.is_control() && one != '\n') {
        return Err("a name or text has a character that is none".into());
    }
    let mut desk = Desk { config, made: Made::new(config), task, changes: Vec::new() };
    let steps = match kind {
        TaskKind::TeachLive => {
            let count: u16 = task.text().parse().unwrap_or(0);
            if !(1..=MOST_RUNS).contains(&count) {
                return Err(format!("a job is shown 1 to {MOST_RUNS} times"));
            }
            if desk.has(task_flag::ADD) {
                return Err("only recordings are added to a job: take that tick away, or call pieces right on the technician's page and \
                            teach the job again with them"
                    .into());
            }
            let mut teach = desk.teach_anew()?;
            teach.extend(["--live".into(), format!("--count={count}").into()]);
            vec![desk.step("teach", teach)]
        }
        TaskKind::TeachFilms => {
            let films = desk.films()?;
            let teach = if desk.has(task_flag::ADD) {
                let added = films.into_iter().flat_map(|film| [OsString::from("--add"), film.into()]);
                [desk.teach_again()?, added.collect()].concat()
            } else {
                [desk.teach_anew()?, films.into_iter().map(Into::into).collect()].concat()
            };
            vec![desk.step("teach", teach)]
        }
        TaskKind::TeachAgain => {
            let mut teach = desk.teach_again()?;
            teach.push("--from-history".into());
            vec![desk.step("teach", teach)]
        }
        TaskKind::Without => {
            let run = task.text();
            if !is_name(run) {
                return Err("a run has a name of letters, digits, dots, dashes and underscores".into());
            }
            let mut teach = desk.teach_again()?;
            teach.extend(["--without".into(), run.into()]);
            vec![desk.step("teach", teach)]
        }
        TaskKind::Load => vec![desk.load(desk.known_job()?)],
        TaskKind::RollBack => {
            let job = desk.put_back()?;
            let mut load = desk.load(job);
            // Once it is in force, nothing is put back.
            load.arguments.extend(["--forget".into(), desk.made.unfinished().into()]);
            vec![load]
        }
        TaskKind::Name => {
            let names = task.text().lines().map(OsString::from);
            let job = desk.known_job()?;
            vec![desk.step("name", [job.into(), OsString::from("--")].into_iter().chain(names).collect())]
        }
        TaskKind::Whatif => {
            let job = desk.known_job()?;
            let whatif = desk.step("whatif", vec!["--job".into(), job.into(), "--since=7d".into()]);
            vec![Step { good: JUDGED, ..whatif }]
        }
        TaskKind::Markers => {
            vec![desk.step("markers", vec!["--out".into(), desk.made.markers().into(), "--force".into()])]
        }
        TaskKind::Look => vec![desk.look()],
        TaskKind::Calibrate => vec![desk.look(), desk.calibrate()?],
        TaskKind::New => vec![desk.new_station()?],
        TaskKind::Answer | TaskKind::Stop | TaskKind::Film => return Err("this is no command".into()),
    };
    Ok(Plan { changes: desk.changes, steps: steps.into() })
}

struct Desk<'a> {
    config: &'a Config,
    made: Made,
    task: &'a Task,
    changes: Vec<Change>,
}

impl Desk<'_> {
    /// A command on this station.
    fn step(&self, command: &str, arguments: Vec<OsString>) -> Step {
        // It runs in another folder than this role.
        let absolute = |file: &PathBuf| std::path::absolute(file).unwrap_or_else(|_| file.clone());
        let files =
            self.config.files.iter().flat_map(|file| [OsString::from("--config"), absolute(file).into()]);
        let arguments = std::iter::once(OsString::from(command)).chain(files).chain(arguments).collect();
        Step { arguments, good: DONE }
    }

    fn has(&self, flag: u8) -> bool {
        self.task.flags & flag != 0
    }

    /// The file of the job, which may not be there yet.
    fn job(&self) -> Result<PathBuf, String> {
        let name = self.task.name();
        // The name of a version has a dot.
        if !is_name(name) || name.contains('.') {
            return Err("a job has a name of letters, digits, dashes and underscores, and begins with a letter or digit".into());
        }
        Ok(self.made.job(name))
    }

    fn known_job(&self) -> Result<PathBuf, String> {
        let job = self.job()?;
        if job.is_file() { Ok(job) } else { Err(format!("there is no job {}", self.task.name())) }
    }

    /// The arguments that teach a new job, or one in the place of another.
    fn teach_anew(&mut self) -> Result<Vec<OsString>, String> {
        let job = self.job()?;
        if !self.has(task_flag::FORCE) {
            if job.exists() {
                return Err(format!(
                    "there is a job {} already: choose another name, or say that it is to be replaced",
                    self.task.name()
                ));
            }
            // That of a teaching which has left no job would be in the way.
            self.changes.push(Change::Remove { file: self.made.report(self.task.name()) });
        }
        Ok(self.teach(&job, false))
    }

    /// The arguments that teach a job again. One that has pictures of its steps goes on having them.
    fn teach_again(&mut self) -> Result<Vec<OsString>, String> {
        let job = self.known_job()?;
        let hash = jobs::read(&job).map(|file| file.model_hash()).ok();
        let has_pictures = step_pictures::beside(&job).iter().any(|picture| Some(picture.model_hash) == hash);
        Ok(self.teach(&job, has_pictures))
    }

    /// What every teaching has. The version that there is now is kept.
    fn teach(&mut self, job: &Path, has_pictures: bool) -> Vec<OsString> {
        self.keep_version(job);
        let report = self.made.report(self.task.name());
        let mut arguments: Vec<OsString> = vec!["--out".into(), job.into(), "--report".into(), report.into()];
        if has_pictures || self.has(task_flag::PICTURES) {
            arguments.push("--pictures".into());
        }
        if self.has(task_flag::FORCE) {
            arguments.push("--force".into());
        }
        arguments
    }

    fn films(&self) -> Result<Vec<PathBuf>, String> {
        let find = |name: &str| self.made.film(name).ok_or_else(|| format!("there is no recording {name:?}"));
        let films: Vec<PathBuf> = self.task.text().lines().map(find).collect::<Result<_, _>>()?;
        if films.is_empty() { Err("no recording was chosen".into()) } else { Ok(films) }
    }

    /// Keeps the version of a job that there is, if there is one. A file with a fault is kept as well.
    fn keep_version(&mut self, job: &Path) {
        if job.exists() {
            let copy = match jobs::read(job) {
                Ok(file) => self.made.version(self.task.name(), &hash_of(&file)),
                // What cannot be read at all cannot be kept either, and the change says so.
                Err(_) => self.made.faulty(self.task.name(), &fs::read(job).unwrap_or_default()),
            };
            self.changes.push(Change::Keep { file: job.into(), copy });
        }
    }

    /// Puts an earlier version of the job in its place.
    fn put_back(&mut self) -> Result<PathBuf, String> {
        let job = self.job()?;
        let hash = self.task.text();
        let version = self.made.version(self.task.name(), hash);
        if !is_hash(hash) || !version.is_file() {
            return Err(format!("there is no such version of the job {}", self.task.name()));
        }
        // What nobody could load is not put back.
        jobs::load(&version, self.config).map_err(|error| error.to_string())?;
        let bytes = fs::read(&version).map_err(|error| format!("{}: {error}", version.display()))?;
        self.keep_version(&job);
        self.changes.push(Change::Put { file: job.clone(), bytes });
        Ok(job)
    }

    /// Loads the job once none is running.
    fn load(&self, job: PathBuf) -> Step {
        self.step("use", vec![format!("--when-idle={IDLE_S}").into(), job.into()])
    }

    /// The file of a new station, for whoever may install it.
    fn new_station(&self) -> Result<Step, String> {
        let name = self.task.name();
        if !is_station_name(name) {
            return Err("a station has a name of 1 to 16 of the characters a-z, 0-9 and '-'".into());
        }
        let mut lines = self.task.text().lines();
        let camera = lines.next().unwrap_or_default();
        let device = camera.strip_prefix("/dev/video").unwrap_or_default();
        let is_device = !device.is_empty() && device.bytes().all(|byte| byte.is_ascii_digit());
        if !(camera.is_empty() || camera == "realsense" || is_device) {
            return Err("a camera is /dev/video0, or another number, or realsense".into());
        }
        let language = lines.next().unwrap_or_default();
        let parts: Vec<&str> = lines.filter(|part| !part.is_empty()).collect();
        if parts.is_empty() {
            return Err("a station has a part".into());
        }
        let file = self.made.station(name);
        // Its board is on the same machine, and has no other's port.
        let others = self.made.stations().iter().filter(|other| **other != file).count();
        let port = usize::from(self.config.board.port) + 1 + others;
        let mut arguments: Vec<OsString> =
            vec!["new".into(), "--force".into(), format!("--board={port}").into()];
        arguments.extend([format!("--language={language}").into(), "--out".into(), file.into()]);
        arguments.extend(parts.iter().map(|part| format!("--part={part}").into()));
        if !camera.is_empty() {
            arguments.push(format!("--camera={camera}").into());
        }
        // A name may begin like an option.
        arguments.extend(["--".into(), name.into()]);
        Ok(Step { arguments, good: DONE })
    }

    fn look(&self) -> Step {
        let [picture, seen] = [self.made.picture(), self.made.seen()];
        self.step("look", vec!["--save".into(), picture.into(), "--annotated".into(), seen.into()])
    }

    /// The calibration that there is is kept.
    fn calibrate(&mut self) -> Result<Step, String> {
        let is_number = |text: &str| {
            !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit() || b"=,.-".contains(&byte))
        };
        let lines: Vec<&str> = self.task.text().lines().collect();
        let Some((side, markers)) = lines.split_first().filter(|_| lines.iter().all(|line| is_number(line)))
        else {
            return Err("give the side of the markers and four markers, as in 46=0.00,0.00".into());
        };
        let mut arguments: Vec<OsString> = vec![self.made.picture().into(), format!("--side={side}").into()];
        arguments.extend(markers.iter().map(|marker| format!("--marker={marker}").into()));
        let out = self.config.bench.calibration.clone().unwrap_or_else(|| self.made.calibration());
        // The unit lets this role write in few folders, and all that is asked for takes a while.
        if let Err(error) = access(folder_of(&out), Access::WRITE_OK) {
            return Err(format!(
                "the calibration {} cannot be written here ({error}): set bench.calibration in the station's file to a file below \
                 /var/lib/andon, and restart the station",
                out.display()
            ));
        }
        if out.exists() {
            let bytes = fs::read(&out).map_err(|error| format!("{}: {error}", out.display()))?;
            let copy = self.made.calibration_before(&bytes);
            self.changes.push(Change::Keep { file: out.clone(), copy });
        }
        arguments.extend(["--plot".into(), self.made.calibrated().into(), "--out".into(), out.into()]);
        Ok(self.step("calibrate", arguments))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::change::{Before, and_begin};
    use super::*;
    use tempfile::TempDir;

    const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");

    /// A station with the shipped job under this name, and with one film.
    fn station(folder: &Path) -> Config {
        let mut config =
            Config::load(&[concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/stations/demo.toml")]).unwrap();
        config.files = vec!["/etc/station.toml".into()];
        config.station.jobs = folder.join("jobs");
        config.executor.path = Some(folder.into());
        Made::new(&config).folders().iter().for_each(|folder| fs::create_dir_all(folder).unwrap());
        fs::create_dir(folder.join("films")).unwrap();
        fs::write(folder.join("films/one.mp4"), "").unwrap();
        fs::copy(SHIPPED, folder.join("jobs/polish.toml")).unwrap();
        config
    }

    fn planned(
        config: &Config,
        kind: TaskKind,
        name: &str,
        text: &str,
        flags: u8,
    ) -> Result<Vec<String>, String> {
        let mut task = Task { flags, ..Task::default() };
        assert!(task.say("maria", name, text));
        let line = |step: Step| {
            let words: Vec<_> =
                step.arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
            words.join(" ")
        };
        Ok(of(kind, &task, config)?.steps.into_iter().map(line).collect())
    }

    /// Plans a task, and makes what it changes.
    fn changed(config: &Config, kind: TaskKind, text: &str, flags: u8) -> Before {
        let mut task = Task { flags, ..Task::default() };
        assert!(task.say("maria", "polish", text));
        let plan = of(kind, &task, config).unwrap();
        and_begin(plan.changes, Made::new(config).unfinished(), || Ok(())).unwrap().1
    }

    /// A station whose job has an earlier version that is the same: it was about to be taught again.
    fn taught_again() -> (TempDir, Config, Made, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let config = station(folder.path());
        changed(&config, TaskKind::TeachAgain, "", 0).keep();
        let made = Made::new(&config);
        let job = made.job("polish");
        (folder, config, made, job)
    }

    /// All files of a station with their bytes.
    fn all(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut all: Vec<_> =
            entries
                .flat_map(|path| {
                    if path.is_dir() { all(&path) } else { vec![(path.clone(), fs::read(path).unwrap())] }
                })
                .collect();
        all.sort();
        all
    }

    #[test]
    fn each_task_is_the_command_that_a_person_would_type() {
        let folder = tempfile::tempdir().unwrap();
        let config = station(folder.path());
        let at = |name: &str| folder.path().join(name).display().to_string();
        let station = "--config /etc/station.toml";
        let (job, report) = (at("jobs/new.toml"), at("reports/new.html"));
        let plan = |kind, name, text, flags| planned(&config, kind, name, text, flags).unwrap();
        assert_eq!(
            plan(TaskKind::TeachLive, "new", "5", 0),
            [format!("teach {station} --out {job} --report {report} --live --count=5")]
        );
        assert_eq!(
            plan(TaskKind::TeachFilms, "new", "one.mp4", task_flag::PICTURES),
            [format!("teach {station} --out {job} --report {report} --pictures {}", at("films/one.mp4"))]
        );
        let (job, report) = (at("jobs/polish.toml"), at("reports/polish.html"));
        let teach = format!("teach {station} --out {job} --report {report}");
        assert_eq!(
            plan(TaskKind::TeachFilms, "polish", "one.mp4", task_flag::ADD),
            [format!("{teach} --add {}", at("films/one.mp4"))]
        );
        assert_eq!(plan(TaskKind::TeachAgain, "polish", "", 0), [format!("{teach} --from-history")]);
        assert_eq!(
            plan(TaskKind::Without, "polish", "run-2.mp4", 0),
            [format!("{teach} --without run-2.mp4")]
        );
        // It goes on having pictures of its steps; one of another job is none.
        let hash = jobs::read(&folder.path().join("jobs/polish.toml")).unwrap().model_hash();
        for (hash, more) in [(hash ^ 1, ""), (hash, " --pictures")] {
            fs::write(at(&format!("jobs/polish.{hash:016x}.step-1.jpg")), "jpeg").unwrap();
            assert_eq!(
                plan(TaskKind::TeachAgain, "polish", "", 0),
                [format!("{teach}{more} --from-history")]
            );
        }
        assert_eq!(
            plan(TaskKind::Name, "polish", "-x\n$(rm)", 0),
            [format!("name {station} {job} -- -x $(rm)")]
        );
        assert_eq!(plan(TaskKind::Load, "polish", "", 0), [format!("use {station} --when-idle=300 {job}")]);
        // A name is none of its options.
        assert!(plan(TaskKind::New, "-h", "\nde\nbrick=0.033", 0)[0].ends_with(" -- -h"));
        assert_eq!(
            plan(TaskKind::New, "bench2", "/dev/video1\nzh\nbrick=0.033\n\nsaw blade", 0),
            [format!(
                "new --force --board=9466 --language=zh --out {} --part=brick=0.033 --part=saw blade --camera=/dev/video1 -- bench2",
                at("stations/bench2.toml")
            )]
        );
        assert_eq!(
            plan(TaskKind::Calibrate, "", "0.04\n46=0,0\n47=0.5,0\n48=0.5,0.3\n49=0,-0.3", 0)[1],
            format!(
                "calibrate {station} {} --side=0.04 --marker=46=0,0 --marker=47=0.5,0 --marker=48=0.5,0.3 --marker=49=0,-0.3 --plot {} --out {}",
                at("look.png"),
                at("calibrated.jpg"),
                at("calibration.toml")
            )
        );
    }

    #[test]
    fn what_is_no_name_of_a_file_that_there_is_or_no_number_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let config = station(folder.path());
        let before = fs::read(folder.path().join("jobs/polish.toml")).unwrap();
        for name in ["", "..", "../polish", "a/b", "polish.toml", "a b", "-rf", "$(id)", "a;b", "none"] {
            for kind in [TaskKind::Load, TaskKind::TeachAgain, TaskKind::Name, TaskKind::Whatif] {
                assert!(planned(&config, kind, name, "", 0).is_err(), "{name}");
            }
        }
        for name in ["../polish", "a/b", "a b", "-rf", "a.b"] {
            assert!(planned(&config, TaskKind::TeachLive, name, "5", 0).is_err(), "{name}");
        }
        for text in ["", "0", "51", "-1", "5; rm"] {
            assert!(planned(&config, TaskKind::TeachLive, "new", text, 0).is_err(), "{text}");
        }
        for text in ["", "two.mp4", "../jobs/polish.toml", "one.mp4\n/etc/passwd", "--out"] {
            assert!(planned(&config, TaskKind::TeachFilms, "new", text, 0).is_err(), "{text}");
        }
        for text in ["", "0.04\n--out=x", "0.04\n46=0,0;x", "a\n46=0,0"] {
            assert!(planned(&config, TaskKind::Calibrate, "", text, 0).is_err(), "{text}");
        }
        let mut read_only = config.clone();
        read_only.bench.calibration = Some("/proc/none/bench.toml".into());
        let text = "0.04\n46=0,0\n47=0.5,0\n48=0.5,0.3\n49=0,-0.3";
        let refused = planned(&read_only, TaskKind::Calibrate, "", text, 0).unwrap_err();
        assert!(refused.contains("set bench.calibration") && refused.contains("/proc/none"), "{refused}");
        for (name, text) in [
            ("../bench", "\nen\nbrick"),
            ("Bench", "\nen\nbrick"),
            ("bench", ""),
            ("bench", "/etc/passwd\nen\nbrick"),
            ("bench", "/dev/video0;x\nen\nbrick"),
        ] {
            assert!(planned(&config, TaskKind::New, name, text, 0).is_err(), "{name} {text}");
        }
        for text in ["", "../../x", "0123456789abcdef", "0123456789abcde/"] {
            assert!(planned(&config, TaskKind::RollBack, "polish", text, 0).is_err(), "{text}");
        }
        let added = planned(&config, TaskKind::TeachLive, "polish", "5", task_flag::ADD | task_flag::FORCE);
        assert!(added.unwrap_err().contains("only recordings are added"));
        let exists = planned(&config, TaskKind::TeachLive, "polish", "5", 0).unwrap_err();
        assert!(exists.contains("choose another name"), "{exists}");
        assert_eq!(fs::read(folder.path().join("jobs/polish.toml")).unwrap(), before);
    }

    #[test]
    fn teaching_keeps_the_version_before_it_and_rolling_back_puts_it_in_its_place_and_keeps_the_other() {
        let (_folder, config, made, job) = taught_again();
        let first = jobs::read(&job).unwrap();
        let mut second = first.clone();
        second.name = "another".into();
        fs::write(&job, second.to_toml()).unwrap();
        changed(&config, TaskKind::RollBack, &hash_of(&first), 0).keep();
        assert_eq!(jobs::read(&job).unwrap().name, first.name);
        assert_eq!(made.versions("polish").len(), 2);
        // It was not loaded.
        changed(&config, TaskKind::RollBack, &hash_of(&second), 0).put_back(false);
        assert_eq!(jobs::read(&job).unwrap().name, first.name);
        changed(&config, TaskKind::RollBack, &hash_of(&second), 0).keep();
        assert_eq!(jobs::read(&job).unwrap().name, "another");
    }

    #[test]
    fn a_plan_changes_nothing_and_a_report_goes_only_where_it_would_be_in_the_way() {
        let folder = tempfile::tempdir().unwrap();
        let config = station(folder.path());
        let made = Made::new(&config);
        let first = jobs::read(&made.job("polish")).unwrap();
        fs::copy(made.job("polish"), made.version("polish", &hash_of(&first))).unwrap();
        for report in [made.report("polish"), made.report("new")] {
            fs::write(report, "page").unwrap();
        }
        let (before, hash) = (all(folder.path()), hash_of(&first));
        for (kind, name, text, flags) in [
            (TaskKind::TeachLive, "new", "5", 0),
            (TaskKind::TeachFilms, "polish", "one.mp4", task_flag::FORCE),
            (TaskKind::TeachFilms, "polish", "one.mp4", task_flag::ADD),
            (TaskKind::TeachAgain, "polish", "", 0),
            (TaskKind::Without, "polish", "run-2.mp4", 0),
            (TaskKind::RollBack, "polish", hash.as_str(), 0),
        ] {
            planned(&config, kind, name, text, flags).unwrap();
            assert_eq!(all(folder.path()), before, "{kind:?}");
        }
        changed(&config, TaskKind::TeachFilms, "one.mp4", task_flag::FORCE).keep();
        assert!(made.report("polish").exists());
        fs::remove_file(made.job("polish")).unwrap();
        changed(&config, TaskKind::TeachFilms, "one.mp4", 0).keep();
        assert!(!made.report("polish").exists());
    }

    #[test]
    fn a_job_file_with_a_fault_is_replaced_and_rolled_back_and_its_bytes_are_kept() {
        let (_folder, config, made, job) = taught_again();
        let first = jobs::read(&job).unwrap();
        for damaged in ["no job", "no job either"] {
            fs::write(&job, damaged).unwrap();
            changed(&config, TaskKind::TeachFilms, "one.mp4", task_flag::FORCE).keep();
        }
        changed(&config, TaskKind::RollBack, &hash_of(&first), 0).keep();
        assert_eq!(jobs::read(&job).unwrap().model_hash(), first.model_hash());
        for damaged in ["no job", "no job either"] {
            assert_eq!(fs::read_to_string(made.faulty("polish", damaged.as_bytes())).unwrap(), damaged);
        }
        assert_eq!(made.versions("polish").len(), 1, "it is no version");
    }

    #[test]
    fn each_calibration_that_another_one_replaces_is_kept_and_is_a_version_of_no_job() {
        let folder = tempfile::tempdir().unwrap();
        let config = station(folder.path());
        let made = Made::new(&config);
        let text = "0.04\n46=0,0\n47=0.5,0\n48=0.5,0.3\n49=0,-0.3";
        for calibration in ["first", "second", "third"] {
            changed(&config, TaskKind::Calibrate, text, 0).keep();
            fs::write(made.calibration(), calibration).unwrap();
        }
        for calibration in ["first", "second"] {
            let kept = made.calibration_before(calibration.as_bytes());
            assert_eq!(fs::read_to_string(&kept).unwrap(), calibration);
            assert!(made.kept().contains(&kept), "a backup has it");
        }
        assert!(made.versions("bench").is_empty());
    }
}
