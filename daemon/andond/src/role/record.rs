//! `record`: what only `andond` knows, and not the crate of recordings: a verdict's words, the job in force, how a picture is drawn.

use andon_host::config::{Config, RecordMode, in_force};
use andon_host::log::{code, log};
use andon_host::video::pipe::PictureFormat;
use andon_ipc::Node;
use andon_learn::job_file::JobFile;
use andon_record::Attachment;
use andon_record::picture::{Decoded, encode};
use andon_record::role::Narrator;
use shm_schemas::{Detections, Judging, Verdict};

use super::{RoleError, jobs};
use crate::made_with::hashes;
use crate::picture::with_verdict;
use crate::report::{Names, verdict_sentence};
use crate::wire;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    if config.record.mode == RecordMode::Off {
        log!(code::RECORDING_OFF, "record.mode is \"off\"");
        return Ok(andon_record::retention::run(node, config)?);
    }
    let objects = config.objects.iter().map(|object| (object.id, object.name.clone()));
    let words = Words { config, names: Names::new(objects) };
    Ok(andon_record::role::run(node, config, attachments(config), words)?)
}

/// What verdicts depend on beside the messages. The job in force follows when the judge has said it.
fn attachments(config: &Config) -> Vec<Attachment> {
    let attachment = |name: &str, data: Vec<u8>| Attachment { name: name.into(), data: data.into() };
    let mut attachments = vec![
        attachment(CONFIGURATION, in_force(config).into_bytes()),
        attachment(HASHES, hashes(config).into_bytes()),
    ];
    if let Some(calibration) = config.bench.calibration.as_ref().and_then(|path| std::fs::read(path).ok()) {
        attachments.push(attachment(CALIBRATION, calibration));
    }
    attachments
}

/// The name of the configuration in a recording.
pub(crate) const CONFIGURATION: &str = "configuration.toml";

/// The name of what pictures were looked at with.
pub(crate) const HASHES: &str = "hashes.txt";

/// The name of the calibration in a recording.
pub(crate) const CALIBRATION: &str = "calibration.toml";

/// The name of a job in a recording.
pub(crate) fn job_name(model_hash: u64) -> String {
    format!("job-{model_hash:016x}.toml")
}

struct Words<'a> {
    config: &'a Config,
    /// Those of the job in force, as far as it is known.
    names: Names,
}

impl Narrator for Words<'_> {
    fn sentence(&mut self, verdict: &Verdict) -> String {
        let read = wire::verdict::read(verdict);
        read.map_or_else(String::new, |verdict| verdict_sentence(&verdict, &self.names).trim().to_owned())
    }

    fn job(&mut self, judging: &Judging) -> Option<Attachment> {
        let job: JobFile = jobs::in_force(self.config, judging).ok().flatten()?;
        self.names = Names::of_job(&job);
        Some(Attachment { name: job_name(job.model_hash()), data: job.to_toml().into_bytes().into() })
    }

    fn still(&mut self, picture: Decoded, seen: Option<&Detections>, verdict: &Verdict) -> Option<Vec<u8>> {
        let Decoded { width, height, pixels } = picture;
        let format = PictureFormat { width, height, rate_hz: 0.0, count: 0 };
        let words = self.sentence(verdict);
        let (drawn, pixels) = with_verdict(format, &pixels, seen, &self.names, &words).ok()?;
        let drawn = Decoded { width: drawn.width, height: drawn.height, pixels };
        encode(&drawn, self.config.record.quality).ok()
    }
}
