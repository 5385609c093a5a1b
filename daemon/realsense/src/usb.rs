//! Why the SDK sees no camera: what the kernel tells about the USB bus.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Error;

/// The device files of every camera on the bus that the SDK opens: its USB device, then its video devices. Empty where the kernel lists
/// no camera. `root` is `/`, or a folder that a test has made.
pub fn device_files(root: &Path) -> Vec<PathBuf> {
    let Ok(devices) = fs::read_dir(root.join("sys/bus/usb/devices")) else { return Vec::new() };
    let mut cameras: Vec<PathBuf> =
        devices.flatten().map(|entry| entry.path()).filter(|path| is_realsense(path)).collect();
    cameras.sort();
    cameras.iter().filter_map(|device| files_of(root, device)).flatten().collect()
}

/// The error for the user when the SDK sees no camera at all. `may_open` tells whether a device file can be opened.
pub fn explain(device_files: &[PathBuf], may_open: impl Fn(&Path) -> bool) -> Error {
    if device_files.is_empty() {
        return Error::NoCamera;
    }
    let closed = device_files.iter().find(|file| !may_open(file));
    closed.map_or(Error::Unresponsive, |file| Error::Permission { node: file.clone() })
}

/// Whether this process may open the device file for reading and writing.
pub fn may_open(file: &Path) -> bool {
    fs::OpenOptions::new().read(true).write(true).open(file).is_ok()
}

fn is_realsense(device: &Path) -> bool {
    // Intel makes other USB devices too; the name of the product distinguishes them.
    attribute(device, "idVendor").as_deref() == Some("8086")
        && attribute(device, "product").is_some_and(|product| product.contains("RealSense"))
}

fn files_of(root: &Path, device: &Path) -> Option<Vec<PathBuf>> {
    let number = |name| attribute(device, name)?.parse::<u32>().ok();
    let usb = root.join(format!("dev/bus/usb/{:03}/{:03}", number("busnum")?, number("devnum")?));
    let video = video_devices(device).into_iter().map(|name| root.join("dev").join(name));
    Some(std::iter::once(usb).chain(video).collect())
}

/// Names of the video devices of the camera's interfaces, such as `video0`.
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
    fn the_kernel_tells_the_device_files_of_a_camera() {
        let root = computer();
        let dev = root.path().join("dev");
        let files = [dev.join("bus/usb/002/007"), dev.join("video0"), dev.join("video2")];
        assert_eq!(device_files(root.path()), files);
    }

    #[test]
    fn an_empty_bus_asks_for_a_camera() {
        let root = tempfile::tempdir().unwrap();
        assert_eq!(explain(&device_files(root.path()), |_| true), Error::NoCamera);
    }

    #[test]
    fn a_closed_device_file_asks_for_the_udev_rule() {
        let root = computer();
        let closed = root.path().join("dev/video2");
        let why = explain(&device_files(root.path()), |node| node != closed);
        assert_eq!(why, Error::Permission { node: closed });
        assert!(why.to_string().contains("60-andon-realsense.rules"), "{why}");
    }

    #[test]
    fn a_camera_that_may_be_opened_but_does_not_answer_asks_to_be_plugged_in_again() {
        let root = computer();
        assert_eq!(explain(&device_files(root.path()), |_| true), Error::Unresponsive);
    }
}
