//! A RealSense camera or recording as a source.

use crate::OpenError;
use andon_host::config::{Config, Source as Configured};
use andon_host::video::pipe::PictureFormat;
use andon_realsense::frame::{self, FrameInfo, PixelFormat};
use andon_realsense::settings::{Camera, Origin, Settings};
use andon_realsense::{Error, Frame};
use shm_schemas::{ColourFormat, DepthFormat, Distortion, Extrinsics, FrameHeader, Intrinsics};

use crate::source::Source;

pub(crate) struct RealSense {
    source: andon_realsense::Source,
    format: PictureFormat,
    /// The newest frame. All frames have its layout.
    info: FrameInfo,
    /// The frame that revealed the layout, until it has been handed out.
    first: Option<Frame>,
    is_live: bool,
}

impl RealSense {
    pub(crate) fn open(config: &Config) -> Result<Self, OpenError> {
        let is_live = config.camera.source == Configured::Realsense;
        let opened = andon_realsense::Source::open(&settings(config)).and_then(|mut source| {
            let first = source.next_frame()?;
            Ok((source, first))
        });
        let (source, first) = opened.map_err(|error| open_error(&error))?;
        let first = first.ok_or_else(|| OpenError::Gone("the recording holds no picture".into()))?;
        let info = *first.info();
        let format = PictureFormat {
            width: info.colour.width,
            height: info.colour.height,
            rate_hz: f64::from(config.camera.rate_hz),
            count: 0,
        };
        Ok(Self { source, format, info, first: Some(first), is_live })
    }

    fn next(&mut self) -> Result<Option<Frame>, String> {
        match self.first.take() {
            Some(first) => Ok(Some(first)),
            None => self.source.next_frame().map_err(|error| error.to_string()),
        }
    }
}

impl Source for RealSense {
    fn format(&self) -> PictureFormat {
        self.format
    }

    fn frame_bytes(&self) -> usize {
        self.info.bytes()
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        let Some(frame) = self.next()? else { return Ok(None) };
        self.info = *frame.info();
        frame.write_to(picture).map_err(|error| error.to_string())?;
        Ok(Some(self.info.source_ns))
    }

    fn captured_ns(&self) -> Option<u64> {
        self.is_live.then_some(self.info.captured_ns)
    }

    fn describe(&self, header: &mut FrameHeader) {
        let FrameInfo { colour, depth, dropped, .. } = &self.info;
        header.dropped = *dropped;
        (header.width, header.height, header.stride) = (colour.width, colour.height, colour.stride);
        header.colour_format = match colour.format {
            PixelFormat::Rgb8 => ColourFormat::Rgb8.code(),
            PixelFormat::Bgr8 => ColourFormat::Bgr8.code(),
            PixelFormat::Yuyv => ColourFormat::Yuyv.code(),
            PixelFormat::Grey8 => ColourFormat::Grey8.code(),
            // No colour stream has this format. Readers refuse 0, which is no format.
            PixelFormat::Z16 => 0,
        };
        header.colour = intrinsics(&colour.intrinsics);
        let Some(depth) = depth else { return };
        let plane = &depth.plane;
        (header.depth_width, header.depth_height, header.depth_stride) =
            (plane.width, plane.height, plane.stride);
        header.depth_format = DepthFormat::Z16.code();
        header.depth_unit_m = depth.unit_m;
        header.depth = intrinsics(&plane.intrinsics);
        let frame::Extrinsics { rotation, translation_m } = depth.colour_from_depth;
        header.colour_from_depth = Extrinsics { rotation, translation_m };
    }
}

/// Tells apart what may pass by itself, what somebody must do at the camera, and what the configuration must not ask for.
fn open_error(error: &Error) -> OpenError {
    let message = error.to_string();
    match error {
        Error::Library { .. } => OpenError::Unsupported(message),
        Error::Permission { .. } | Error::UsbSpeed { .. } => OpenError::Unfit(message),
        Error::Ambiguous { .. } | Error::Mode { .. } | Error::Option { .. } | Error::Format { .. } => {
            OpenError::Refused(message)
        }
        _ => OpenError::Gone(message),
    }
}

fn settings(config: &Config) -> Settings {
    let camera = &config.camera;
    let origin = match camera.source {
        Configured::Realsense => Origin::Camera(Camera {
            serial: camera.serial.clone(),
            colour_size: [camera.width, camera.height],
            depth_size: [
                camera.depth_width.unwrap_or(camera.width),
                camera.depth_height.unwrap_or(camera.height),
            ],
            rate_hz: camera.rate_hz.round() as u32,
            exposure_us: camera.exposure_us,
            laser_mw: camera.laser_power_mw,
        }),
        // The role paces a recording and repeats it, as it does with a film.
        _ => Origin::Recording(camera.path.clone().unwrap_or_default()),
    };
    Settings { library: config.perception.models.join("realsense"), origin, depth: camera.depth }
}

/// All zero, which means unknown, where the coefficients belong to a model without a code.
fn intrinsics(of: &frame::Intrinsics) -> Intrinsics {
    let model = match of.distortion {
        frame::Distortion::None => Distortion::None,
        frame::Distortion::BrownConrady => Distortion::BrownConrady,
        // librealsense computes both in the same way.
        frame::Distortion::InverseBrownConrady | frame::Distortion::ModifiedBrownConrady => {
            Distortion::InverseBrownConrady
        }
        frame::Distortion::Other => return Intrinsics::default(),
    };
    let ([fx, fy], [cx, cy]) = (of.focal, of.centre);
    Intrinsics { fx, fy, cx, cy, distortion: of.coefficients, model: model.code() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    /// How the camera is opened with these keys of `[camera]`.
    fn camera(keys: &str) -> (Camera, bool) {
        let folder = tempfile::tempdir().unwrap();
        let station = folder.path().join("station.toml");
        std::fs::write(&station, format!("[camera]\nsource = 'realsense'\n{keys}\n")).unwrap();
        let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/stations/demo.toml").into();
        let settings = settings(&Config::load_to_learn(&[demo, station]).unwrap());
        let Origin::Camera(camera) = settings.origin else { panic!("{:?}", settings.origin) };
        (camera, settings.depth)
    }

    #[test]
    fn the_camera_is_opened_as_its_keys_say() {
        let as_it_is = Camera {
            serial: None,
            colour_size: [1280, 720],
            depth_size: [1280, 720],
            rate_hz: 30,
            exposure_us: None,
            laser_mw: 150,
        };
        assert_eq!(camera(""), (as_it_is.clone(), true));
        for (keys, changed) in [
            ("serial = '035422071234'", Camera { serial: Some("035422071234".into()), ..as_it_is.clone() }),
            ("depth_width = 848\ndepth_height = 480", Camera { depth_size: [848, 480], ..as_it_is.clone() }),
            ("exposure_us = 8300", Camera { exposure_us: Some(8300), ..as_it_is.clone() }),
            ("laser_power_mw = 0", Camera { laser_mw: 0, ..as_it_is.clone() }),
            ("rate_hz = 60", Camera { rate_hz: 60, ..as_it_is.clone() }),
        ] {
            assert_eq!(camera(keys), (changed, true), "{keys}");
        }
        assert_eq!(camera("depth = false"), (as_it_is, false));
    }
}
