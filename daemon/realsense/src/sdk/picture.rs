//! A frameset of the SDK as a [`FrameInfo`] and bytes.

use realsense_rust::base::Rs2Intrinsics;
use realsense_rust::frame::{ColorFrame, DepthFrame, FrameEx, ImageFrame};
use realsense_rust::kind::{Rs2DistortionModel, Rs2Format, Rs2StreamKind, Rs2TimestampDomain};
use realsense_rust::stream_profile::StreamProfile;

use super::player;
use crate::Error;
use crate::clock::{Domain, SensorTime};
use crate::frame::{
    DepthPlane, Distortion, Extrinsics, FrameInfo, Intrinsics, PixelFormat, Plane, write_planes,
};

/// Colour and depth of one moment, still in the memory of the SDK.
#[derive(Debug)]
pub struct Frame {
    info: FrameInfo,
    colour: ColorFrame,
    depth: Option<DepthFrame>,
}

impl Frame {
    pub(super) fn new(pictures: Pictures, optics: &Optics, dropped: u32) -> Result<Self, Error> {
        let Pictures { colour, depth, times } = pictures;
        let format = pixel_format(colour.stream_profile().format())?;
        let depth = depth.map(player::with_unit).transpose();
        let depth = depth.map_err(|error| super::sdk("reading the depth unit", error))?;
        let depth_plane = match (&depth, &optics.depth) {
            (Some((depth, unit_m)), Some((intrinsics, colour_from_depth))) => Some(DepthPlane {
                plane: plane(depth, PixelFormat::Z16, *intrinsics),
                unit_m: *unit_m,
                colour_from_depth: *colour_from_depth,
            }),
            _ => None,
        };
        let info = FrameInfo {
            number: colour.frame_number(),
            dropped,
            captured_ns: times.captured_ns,
            source_ns: times.source_ns,
            colour: plane(&colour, format, optics.colour),
            depth: depth_plane,
        };
        Ok(Self { info, colour, depth: depth.map(|(depth, _)| depth).filter(|_| depth_plane.is_some()) })
    }

    /// What is known of the frame besides its pixels.
    pub fn info(&self) -> &FrameInfo {
        &self.info
    }

    /// Writes the colour plane, then the depth plane, as the sensor gave them: [`FrameInfo::bytes`] bytes.
    ///
    /// # Errors
    /// [`Error::Room`] when `target` is too short; nothing is written then.
    pub fn write_to(&self, target: &mut [u8]) -> Result<usize, Error> {
        write_planes([bytes(&self.colour), self.depth.as_ref().map_or(&[], bytes)], target)
    }
}

/// The pictures of one moment.
#[derive(Debug)]
pub(super) struct Pictures {
    pub(super) colour: ColorFrame,
    pub(super) depth: Option<DepthFrame>,
    pub(super) times: Times,
}

/// When a frame was taken; see [`FrameInfo`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    pub(super) captured_ns: u64,
    pub(super) source_ns: u64,
}

/// The optics of a camera, which are the same for all frames from one start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Optics {
    colour: Intrinsics,
    depth: Option<(Intrinsics, Extrinsics)>,
}

impl Optics {
    /// Asks the SDK. `depth` is `None` where no depth stream is among those that are on.
    pub(super) fn read(streams: &[StreamProfile]) -> Result<Self, Error> {
        let failed = |error| super::sdk("reading the calibration", error);
        let stream = |kind| streams.iter().find(|stream| stream.kind() == kind);
        let colour = stream(Rs2StreamKind::Color)
            .ok_or_else(|| super::sdk("reading the calibration", "there is no colour stream"))?;
        let depth = match stream(Rs2StreamKind::Depth) {
            None => None,
            Some(depth) => {
                let raw = depth.extrinsics(colour).map_err(failed)?;
                // The SDK's rotation is stored column by column.
                let r = raw.rotation();
                let rotation = [0, 1, 2].map(|row| [r[row], r[row + 3], r[row + 6]]);
                let extrinsics = Extrinsics { rotation, translation_m: raw.translation() };
                Some((intrinsics(&depth.intrinsics().map_err(failed)?), extrinsics))
            }
        };
        Ok(Self { colour: intrinsics(&colour.intrinsics().map_err(failed)?), depth })
    }
}

pub(super) fn sensor_time(frame: &impl FrameEx) -> SensorTime {
    let domain = match frame.timestamp_domain() {
        Rs2TimestampDomain::HardwareClock => Domain::Hardware,
        Rs2TimestampDomain::SystemTime => Domain::System,
        Rs2TimestampDomain::GlobalTime => Domain::Global,
    };
    SensorTime { ms: frame.timestamp(), domain }
}

fn pixel_format(format: Rs2Format) -> Result<PixelFormat, Error> {
    match format {
        Rs2Format::Rgb8 => Ok(PixelFormat::Rgb8),
        Rs2Format::Bgr8 => Ok(PixelFormat::Bgr8),
        Rs2Format::Yuyv => Ok(PixelFormat::Yuyv),
        Rs2Format::Y8 => Ok(PixelFormat::Grey8),
        other => Err(Error::Format { format: format!("{other:?}").to_lowercase() }),
    }
}

fn plane<K>(frame: &ImageFrame<K>, format: PixelFormat, intrinsics: Intrinsics) -> Plane {
    // The SDK's sizes are C ints that are not negative.
    let [width, height, stride] =
        [frame.width(), frame.height(), frame.stride()].map(|size| u32::try_from(size).unwrap_or(0));
    Plane { width, height, stride, format, intrinsics }
}

/// The picture's bytes, row by row with the stride.
fn bytes<K>(frame: &ImageFrame<K>) -> &[u8] {
    let length = (frame.stride() * frame.height()).min(frame.get_data_size());
    // SAFETY: the SDK guarantees `get_data_size` bytes at this address for as long as the frame lives. `get_pixel` is avoided because realsense-rust
    // takes the bytes of RGB8 for BGR8.
    unsafe { std::slice::from_raw_parts(std::ptr::from_ref(frame.get_data()).cast::<u8>(), length) }
}

fn intrinsics(raw: &Rs2Intrinsics) -> Intrinsics {
    let lens = raw.distortion();
    let distortion = match lens.model {
        Rs2DistortionModel::None => Distortion::None,
        Rs2DistortionModel::BrownConrady => Distortion::BrownConrady,
        Rs2DistortionModel::BrownConradyInverse => Distortion::InverseBrownConrady,
        Rs2DistortionModel::BrownConradyModified => Distortion::ModifiedBrownConrady,
        Rs2DistortionModel::FThetaFisheye | Rs2DistortionModel::KannalaBrandt => Distortion::Other,
    };
    Intrinsics {
        focal: [raw.fx(), raw.fy()],
        centre: [raw.ppx(), raw.ppy()],
        distortion,
        coefficients: lens.coeffs,
    }
}
