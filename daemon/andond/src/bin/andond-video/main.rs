//! The part of the daemon that links OpenCV's `videoio`: films and cameras in, films out.
//!
//! `andond-video decode FILE RATE_HZ` (the rate is that of a folder of pictures) and `andond-video encode FILE` serve the tools over a pipe (see [`andond::video`]);
//! `andond-video run capture` is that role, into which `andond run capture` turns itself.
#![forbid(unsafe_code)]

mod device;
#[cfg(feature = "realsense")]
mod realsense;
mod sources;

use std::ffi::OsStr;
use std::io::{BufReader, BufWriter, stdin, stdout};
use std::path::Path;
use std::process::ExitCode;

use andond::cli::{self, Cli, Command, Role};
use andond::config::{Config, Source as Configured};
use andond::role;
use andond::video::pipe::{PipeReader, PipeWriter};
use andond::video::source::{OpenError, Source};
use clap::Parser as _;
use opencv::core::{Mat, Size, Vec3b};
use opencv::videoio::{self, VideoWriter, VideoWriterTrait, VideoWriterTraitConst};

fn main() -> ExitCode {
    andond::exit::exit_on_panic();
    if let Ok(Cli { command: Command::Run(run), .. }) = Cli::try_parse() {
        return capture(&run);
    }
    let arguments: Vec<std::ffi::OsString> = std::env::args_os().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [verb, file, rate_hz] if verb == "decode" => decode(Path::new(file), rate_hz),
        [verb, file] if verb == "encode" => encode(Path::new(file)),
        _ => Err("usage: andond-video decode FILE RATE_HZ | encode FILE; people want `andond`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(64)
        }
    }
}

/// The role `capture`.
fn capture(run: &cli::Run) -> ExitCode {
    match andond::tool::load_config(&run.config) {
        Ok(config) if run.role == Role::Capture => {
            role::start_log(run.role, &config);
            role::run_with(&config, shm_schemas::RoleId::Capture, |node| {
                role::capture::run(node, &config, open)
            })
            .into()
        }
        Ok(_) => andond::exit::Code::Usage.into(),
        Err(failure) => {
            eprintln!("{failure}");
            failure.code().into()
        }
    }
}

/// Opens the source that the configuration names.
fn open(config: &Config) -> Result<Box<dyn Source>, OpenError> {
    let camera = &config.camera;
    let path = camera.path.clone().unwrap_or_default();
    match camera.source {
        Configured::Video | Configured::Images => sources::open(&path, camera.rate_hz.into())
            .map_err(|message| OpenError::Gone(format!("{}: {message}", path.display()))),
        Configured::V4l2 => Ok(Box::new(device::Device::open(camera)?)),
        Configured::Tracks => Err(OpenError::Refused(
            "a track file has no pictures: the role perceive plays it, capture is not needed".into(),
        )),
        #[cfg(feature = "realsense")]
        Configured::Realsense | Configured::Bag => Ok(Box::new(realsense::RealSense::open(config)?)),
        #[cfg(not(feature = "realsense"))]
        Configured::Realsense | Configured::Bag => Err(OpenError::Unsupported(
            "this build has no RealSense support: build with --features realsense".into(),
        )),
    }
}

/// Pictures of a film to standard output.
fn decode(file: &Path, rate_hz: &OsStr) -> Result<(), String> {
    let rate_hz = rate_hz.to_str().and_then(|text| text.parse().ok()).ok_or("the rate is no number")?;
    let mut source = sources::open(file, rate_hz)?;
    let format = source.format();
    let mut picture = vec![0; format.bytes()];
    // A reader that is gone has seen enough: a broken pipe is a clean end.
    let Ok(mut pipe) = PipeWriter::new(BufWriter::new(stdout().lock()), format) else { return Ok(()) };
    while let Some(pts_ns) = source.next_picture(&mut picture)? {
        if pipe.write_picture(pts_ns, &picture).is_err() {
            return Ok(());
        }
    }
    let _ = pipe.finish();
    Ok(())
}

/// A film from the pictures on standard input.
fn encode(file: &Path) -> Result<(), String> {
    let mut pipe = PipeReader::new(BufReader::new(stdin().lock())).map_err(|error| error.to_string())?;
    let format = pipe.format();
    let size = Size::new(format.width as i32, format.height as i32);
    let said = |error: opencv::Error| error.to_string();
    let codec = VideoWriter::fourcc('a', 'v', 'c', '1').map_err(said)?;
    let mut film =
        VideoWriter::new_with_backend(file, videoio::CAP_FFMPEG, codec, format.rate_hz, size, true)
            .map_err(said)?;
    if !film.is_opened().map_err(said)? {
        return Err("cannot be written: does the folder exist, and does the name end in .mp4?".into());
    }
    while pipe.advance().map_err(|error| error.to_string())?.is_some() {
        let mat =
            Mat::new_rows_cols_with_bytes::<Vec3b>(size.height, size.width, pipe.picture()).map_err(said)?;
        film.write(&mat).map_err(said)?;
    }
    film.release().map_err(said)
}
