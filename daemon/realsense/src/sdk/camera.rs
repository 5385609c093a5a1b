//! Opens an attached camera.

use std::collections::{BTreeSet, HashSet};
use std::ffi::CString;
use std::path::Path;

use realsense_rust::config::Config;
use realsense_rust::context::Context;
use realsense_rust::device::Device;
use realsense_rust::kind::{OptionSetError, Rs2CameraInfo, Rs2Format, Rs2Option, Rs2StreamKind};
use realsense_rust::pipeline::InactivePipeline;
use realsense_rust::sensor::Sensor;

use super::live::Live;
use super::picture::Optics;
use super::{Kind, Source};
use crate::settings::Camera;
use crate::{Error, usb};

pub(super) fn open(wanted: &Camera, depth: bool) -> Result<Source, Error> {
    let context = Context::new().map_err(|error| super::sdk("setting up", error))?;
    let device = choose(&context, wanted.serial.as_deref())?;
    let serial = info(&device, Rs2CameraInfo::SerialNumber);
    let mut streams = vec![Mode::new(Rs2StreamKind::Color, Rs2Format::Rgb8, wanted.colour_size, wanted)];
    if depth {
        streams.push(Mode::new(Rs2StreamKind::Depth, Rs2Format::Z16, wanted.depth_size, wanted));
    }
    let mut config = Config::new();
    let failed = |error: String| super::sdk("choosing the streams", error);
    // A serial number is printable ASCII without a zero byte.
    let named = CString::new(serial.as_str()).map_err(|error| failed(error.to_string()))?;
    config.enable_device_from_serial(&named).map_err(|error| failed(error.to_string()))?;
    for mode in &streams {
        mode.must_be_offered(&device, &serial)?;
        let [width, height] = mode.size.map(|size| size as usize);
        config
            .enable_stream(mode.stream, None, width, height, mode.format, mode.rate_hz as usize)
            .map_err(|error| failed(error.to_string()))?;
    }
    // Before the start, so that they apply to the first picture.
    set_options(&device, &serial, wanted, depth)?;
    let pipeline = InactivePipeline::try_from(&context).map_err(|error| failed(error.to_string()))?;
    let pipeline = pipeline.start(Some(config)).map_err(|error| not_started(&error.to_string(), &serial))?;
    let optics = Optics::read(pipeline.profile().streams())?;
    let live = Live::new(context, pipeline, serial, depth.then_some(wanted.rate_hz));
    Ok(Source { kind: Kind::Camera(live), optics, last_number: None })
}

fn choose(context: &Context, serial: Option<&str>) -> Result<Device, Error> {
    let mut devices = context.query_devices(HashSet::new());
    let serials: Vec<String> =
        devices.iter().map(|device| info(device, Rs2CameraInfo::SerialNumber)).collect();
    if devices.is_empty() {
        return Err(usb::explain(&usb::device_files(Path::new("/")), usb::may_open));
    }
    let index = pick(&serials, serial)?;
    Ok(devices.swap_remove(index))
}

/// The index of the requested camera among the attached ones, of which there is at least one.
fn pick(attached: &[String], serial: Option<&str>) -> Result<usize, Error> {
    match serial {
        Some(serial) => attached.iter().position(|each| each == serial).ok_or_else(|| {
            Error::SerialNotFound { serial: serial.to_owned(), attached: attached.join(", ") }
        }),
        None if attached.len() == 1 => Ok(0),
        None => Err(Error::Ambiguous { attached: attached.join(", ") }),
    }
}

fn info(device: &Device, what: Rs2CameraInfo) -> String {
    device.info(what).map(|text| text.to_string_lossy().into_owned()).unwrap_or_default()
}

/// One requested stream.
struct Mode {
    stream: Rs2StreamKind,
    format: Rs2Format,
    size: [u32; 2],
    rate_hz: u32,
}

impl Mode {
    fn new(stream: Rs2StreamKind, format: Rs2Format, size: [u32; 2], wanted: &Camera) -> Self {
        Self { stream, format, size, rate_hz: wanted.rate_hz }
    }

    fn must_be_offered(&self, device: &Device, serial: &str) -> Result<(), Error> {
        let offered: BTreeSet<([u32; 2], u32)> = device
            .sensors()
            .iter()
            .flat_map(Sensor::stream_profiles)
            .filter(|profile| profile.kind() == self.stream && profile.format() == self.format)
            .filter_map(|profile| {
                let size = profile.intrinsics().ok()?;
                let [width, height] =
                    [size.width(), size.height()].map(|size| u32::try_from(size).unwrap_or(0));
                Some(([width, height], u32::try_from(profile.framerate()).ok()?))
            })
            .collect();
        if offered.contains(&(self.size, self.rate_hz)) {
            return Ok(());
        }
        let mode = self.to_string();
        let usb = info(device, Rs2CameraInfo::UsbTypeDescriptor);
        let serial = serial.to_owned();
        Err(if usb.starts_with('2') || usb.starts_with('1') {
            Error::UsbSpeed { serial, usb, mode }
        } else {
            let list: Vec<String> =
                offered.iter().map(|([w, h], rate)| format!("{w}x{h} at {rate} Hz")).collect();
            Error::Mode { serial, mode, offered: list.join(", ") }
        })
    }
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let stream = if self.stream == Rs2StreamKind::Depth { "depth" } else { "colour" };
        write!(f, "{stream} {}x{} at {} Hz", self.size[0], self.size[1], self.rate_hz)
    }
}

fn set_options(device: &Device, serial: &str, wanted: &Camera, depth: bool) -> Result<(), Error> {
    for mut sensor in device.sensors() {
        let has = |kind| sensor.stream_profiles().iter().any(|profile| profile.kind() == kind);
        let (is_colour, is_depth) = (has(Rs2StreamKind::Color), has(Rs2StreamKind::Depth));
        let mut set = |option, name, value: f32| set_option(&mut sensor, serial, option, name, value);
        if is_colour {
            // Auto exposure must not lower the frame rate in the dark.
            set(Rs2Option::AutoExposurePriority, "auto exposure priority", 0.0)?;
            // The colour sensor counts exposure in steps of 100 µs.
            let steps = wanted.exposure_us.map(|us| us as f32 / 100.0);
            expose(&mut set, steps)?;
        } else if is_depth && depth {
            expose(&mut set, None)?;
            let power = wanted.laser_mw;
            set(Rs2Option::EmitterEnabled, "the projector", if power == 0 { 0.0 } else { 1.0 })?;
            if power > 0 {
                set(Rs2Option::LaserPower, "laser power in mW", power as f32)?;
            }
        }
    }
    Ok(())
}

/// Fixes the exposure, or returns it to the camera, which keeps what an earlier program has set.
fn expose(
    set: &mut impl FnMut(Rs2Option, &'static str, f32) -> Result<(), Error>,
    exposure: Option<f32>,
) -> Result<(), Error> {
    set(Rs2Option::EnableAutoExposure, "auto exposure", if exposure.is_some() { 0.0 } else { 1.0 })?;
    exposure.map_or(Ok(()), |value| set(Rs2Option::Exposure, "exposure", value))
}

fn set_option(
    sensor: &mut Sensor,
    serial: &str,
    option: Rs2Option,
    name: &'static str,
    value: f32,
) -> Result<(), Error> {
    match sensor.set_option(option, value) {
        Ok(()) => Ok(()),
        Err(OptionSetError::OptionNotSupported) if value == 0.0 => Ok(()),
        Err(error) => {
            let allowed = match sensor.get_option_range(option) {
                Some(range) => {
                    format!("it accepts {} to {} in steps of {}", range.min, range.max, range.step)
                }
                None => format!("leave it out ({error})"),
            };
            Err(Error::Option { serial: serial.to_owned(), option: name, value, allowed })
        }
    }
}

fn not_started(detail: &str, serial: &str) -> Error {
    if detail.to_lowercase().contains("busy") {
        Error::Busy { serial: serial.to_owned() }
    } else {
        super::sdk("starting the camera", detail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attached(serials: &[&str]) -> Vec<String> {
        serials.iter().map(|&serial| serial.to_owned()).collect()
    }

    #[test]
    fn the_only_camera_needs_no_serial_number() {
        assert_eq!(pick(&attached(&["7"]), None), Ok(0));
    }

    #[test]
    fn of_several_cameras_one_must_be_chosen() {
        let both = attached(&["7", "8"]);
        assert_eq!(pick(&both, Some("8")), Ok(1));
        assert_eq!(pick(&both, None), Err(Error::Ambiguous { attached: "7, 8".into() }));
    }

    #[test]
    fn a_wrong_serial_number_is_told_with_the_right_ones() {
        let why = pick(&attached(&["7", "8"]), Some("9")).err().map(|why| why.to_string());
        let told = "camera 9 is not attached, only 7, 8; correct the serial number, or plug that camera in";
        assert_eq!(why.as_deref(), Some(told));
    }

    #[test]
    fn a_busy_camera_asks_to_stop_the_other_program() {
        let why =
            not_started("xioctl(VIDIOC_S_FMT) failed, errno=16 Last Error: Device or resource busy", "7");
        assert_eq!(why, Error::Busy { serial: "7".into() });
    }
}
