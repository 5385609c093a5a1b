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
        let options = if has(Rs2StreamKind::Color) {
            colour_options(wanted)
        } else if has(Rs2StreamKind::Depth) && depth {
            depth_options(wanted)
        } else {
            Vec::new()
        };
        for (option, name, value) in options {
            set_option(&mut sensor, serial, option, name, value)?;
        }
    }
    Ok(())
}

/// An option of a sensor, what people call it, and its value.
type SensorOption = (Rs2Option, &'static str, f32);

fn colour_options(wanted: &Camera) -> Vec<SensorOption> {
    // Auto exposure must not lower the frame rate in the dark.
    let mut options = vec![(Rs2Option::AutoExposurePriority, "auto exposure priority", 0.0)];
    // The colour sensor counts exposure in steps of 100 µs.
    options.extend(exposure(wanted.exposure_us.map(|us| us as f32 / 100.0)));
    options
}

fn depth_options(wanted: &Camera) -> Vec<SensorOption> {
    let is_on = wanted.laser_mw > 0;
    let mut options = exposure(None);
    options.push((Rs2Option::EmitterEnabled, "the projector", if is_on { 1.0 } else { 0.0 }));
    if is_on {
        options.push((Rs2Option::LaserPower, "laser power in mW", wanted.laser_mw as f32));
    }
    options
}

/// Fixes the exposure, or returns it to the camera, which keeps what an earlier program has set.
fn exposure(fixed: Option<f32>) -> Vec<SensorOption> {
    let automatic = if fixed.is_some() { 0.0 } else { 1.0 };
    let mut options = vec![(Rs2Option::EnableAutoExposure, "auto exposure", automatic)];
    options.extend(fixed.map(|value| (Rs2Option::Exposure, "exposure", value)));
    options
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

    fn camera(exposure_us: Option<u32>, laser_mw: u32) -> Camera {
        let size = [640, 480];
        Camera { serial: None, colour_size: size, depth_size: size, rate_hz: 30, exposure_us, laser_mw }
    }

    fn value_of(option: Rs2Option, options: Vec<SensorOption>) -> Option<f32> {
        options.into_iter().find(|(set, ..)| *set == option).map(|(.., value)| value)
    }

    #[test]
    fn an_exposure_is_fixed_in_steps_of_100_us_or_returned_to_the_camera() {
        let set = |exposure_us| {
            [Rs2Option::EnableAutoExposure, Rs2Option::Exposure]
                .map(|option| value_of(option, colour_options(&camera(exposure_us, 150))))
        };
        assert_eq!(set(Some(8300)), [Some(0.0), Some(83.0)]);
        assert_eq!(set(None), [Some(1.0), None]);
    }

    #[test]
    fn the_projector_has_the_power_that_is_asked_for_and_none_is_off() {
        let set = |laser_mw| {
            [Rs2Option::EmitterEnabled, Rs2Option::LaserPower]
                .map(|option| value_of(option, depth_options(&camera(None, laser_mw))))
        };
        assert_eq!(set(90), [Some(1.0), Some(90.0)]);
        assert_eq!(set(0), [Some(0.0), None]);
    }

    #[test]
    fn a_busy_camera_asks_to_stop_the_other_program() {
        let why =
            not_started("xioctl(VIDIOC_S_FMT) failed, errno=16 Last Error: Device or resource busy", "7");
        assert_eq!(why, Error::Busy { serial: "7".into() });
    }
}
