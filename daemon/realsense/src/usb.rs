//! Why the SDK sees no camera: what the kernel says of the USB bus.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Error;

/// A RealSense camera on the USB bus, as the kernel sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbCamera {
    /// Speed of the link in Mbit/s: 480 is USB 2, 5000 and more is USB 3.
    pub speed_mbit: u32,
    /// The device files that the SDK opens: the USB device, then the video devices.
    pub nodes: Vec<PathBuf>,
}

/// The cameras on the bus. `root` is `/`, or a folder that a test has made.
pub fn cameras(root: &Path) -> Vec<UsbCamera> {
    let Ok(devices) = fs::read_dir(root.join("sys/bus/usb/devices")) else { return Vec::new() };
    let mut found: Vec<PathBuf> =
        devices.flatten().map(|entry| entry.path()).filter(|path| is_realsense(path)).collect();
    found.sort();
    found.iter().filter_map(|device| camera(root, device)).collect()
}

/// What to tell the user when the SDK sees no camera at all. `may_open` says whether a device file can be opened.
pub fn explain(cameras: &[UsbCamera], may_open: impl Fn(&Path) -> bool) -> Error {
    if cameras.is_empty() {
        return Error::NoCamera;
    }
    let closed = cameras.iter().flat_map(|camera| &camera.nodes).find(|node| !may_open(node));
    closed.map_or(Error::Unresponsive, |node| Error::Permission { node: node.clone() })
}

/// Whether this process may open the device file for reading and writing.
pub fn may_open(node: &Path) -> bool {
    fs::OpenOptions::new().read(true).write(true).open(node).is_ok()
}

fn is_realsense(device: &Path) -> bool {
    // Intel makes other USB devices too; the product name tells them apart.
    attribute(device, "idVendor").as_deref() == Some("8086")
        && attribute(device, "product").is_some_and(|product| product.contains("RealSense"))
}

fn camera(root: &Path, device: &Path) -> Option<UsbCamera> {
    let number = |name| attribute(device, name)?.parse::<u32>().ok();
    let usb = root.join(format!("dev/bus/usb/{:03}/{:03}", number("busnum")?, number("devnum")?));
    let mut nodes = vec![usb];
    nodes.extend(video_devices(device).into_iter().map(|name| root.join("dev").join(name)));
    Some(UsbCamera { speed_mbit: number("speed")?, nodes })
}

/// Names of the video devices of the camera's interfaces, as `video0`.
fn video_devices(device: &Path) -> Vec<String> {
    let folders = |path: &Path| fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut names: Vec<String> = folders(device)
        .flat_map(|interface| folders(&interface.join("video4linux")))
        .filter_map(|video| Some(video.file_name()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

fn attribute(device: &Path, name: &str) -> Option<String> {
    Some(fs::read_to_string(device.join(name)).ok()?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A computer with a D435i at bus 2, device 7, and an Intel Bluetooth adapter.
    fn computer() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let device = root.path().join("sys/bus/usb/devices/2-1");
        fs::create_dir_all(device.join("2-1:1.0/video4linux/video0")).unwrap();
        fs::create_dir_all(device.join("2-1:1.3/video4linux/video2")).unwrap();
        for (name, value) in [
            ("idVendor", "8086"),
            ("product", "Intel(R) RealSense(TM) Depth Camera 435i "),
            ("busnum", "2"),
            ("devnum", "7"),
            ("speed", "480"),
        ] {
            fs::write(device.join(name), format!("{value}\n")).unwrap();
        }
        let other = root.path().join("sys/bus/usb/devices/1-4");
        fs::create_dir_all(&other).unwrap();
        fs::write(other.join("idVendor"), "8086\n").unwrap();
        fs::write(other.join("product"), "Wireless Bluetooth\n").unwrap();
        root
    }

    #[test]
    fn the_kernel_tells_speed_and_device_files_of_a_camera() {
        let root = computer();
        let dev = root.path().join("dev");
        let nodes = vec![dev.join("bus/usb/002/007"), dev.join("video0"), dev.join("video2")];
        assert_eq!(cameras(root.path()), [UsbCamera { speed_mbit: 480, nodes }]);
    }

    #[test]
    fn an_empty_bus_asks_for_a_camera() {
        let root = tempfile::tempdir().unwrap();
        assert_eq!(explain(&cameras(root.path()), |_| true), Error::NoCamera);
    }

    #[test]
    fn a_closed_device_file_asks_for_the_udev_rule() {
        let root = computer();
        let closed = root.path().join("dev/video2");
        let why = explain(&cameras(root.path()), |node| node != closed);
        assert_eq!(why, Error::Permission { node: closed });
        assert!(why.to_string().contains("60-andon-realsense.rules"), "{why}");
    }

    #[test]
    fn a_camera_that_could_be_opened_asks_to_be_plugged_in_again() {
        let root = computer();
        assert_eq!(explain(&cameras(root.path()), |_| true), Error::Unresponsive);
    }
}
