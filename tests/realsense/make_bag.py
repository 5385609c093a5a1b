#!/usr/bin/env python3
"""Makes a RealSense recording without a camera: a clip of tests/footage with depth computed from its ground truth.

    provision.py target/runtime --recorder
    make_bag.py CLIP.mp4 CLIP.truth.jsonl OUT.bag [--first 100] [--frames 30] [--bag-only]

The SDK's software device plays a D435i, the SDK's recorder writes the file. Beside it, OUT.colour (RGB8) and OUT.depth
(Z16) have the pixels of all frames one after the other, and OUT.json the calibration: what a reader of the recording must
get. Needs the programs ffmpeg and Python 3.11.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import time

RUNTIME = pathlib.Path(__file__).resolve().parents[2] / "target/runtime/realsense/python"
sys.path.insert(0, str(RUNTIME))
try:
    import numpy as np
    import pyrealsense2 as rs
except ImportError as error:
    sys.exit(f"{error}: run `python3.11 daemon/realsense/provision.py target/runtime --recorder` first")

import synthetic_depth

RATE_HZ = 30
# The first stamp of the camera's own clock, and how much earlier depth is taken than colour, in milliseconds.
CLOCK_BEGAN_MS, DEPTH_LAG_MS = 5000.0, -4.0


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("clip", type=pathlib.Path)
    arguments.add_argument("truth", type=pathlib.Path)
    arguments.add_argument("bag", type=pathlib.Path)
    arguments.add_argument("--first", type=int, default=100, help="first frame of the clip")
    arguments.add_argument("--frames", type=int, default=30, help="how many")
    arguments.add_argument("--bag-only", action="store_true", help="without OUT.colour and OUT.depth")
    options = arguments.parse_args()
    header, *lines = (json.loads(line) for line in options.truth.open())
    lines = lines[options.first : options.first + options.frames]
    colour = decode(options.clip, header, options.first, len(lines))
    camera = synthetic_depth.d435i()
    depth = list(synthetic_depth.pictures(header, lines, camera))
    record(options.bag, header["camera"], camera, colour, depth)
    if not options.bag_only:
        colour.tofile(options.bag.with_suffix(".colour"))
        np.stack(depth).tofile(options.bag.with_suffix(".depth"))
    options.bag.with_suffix(".json").write_text(json.dumps(synthetic_depth.calibration(header, camera)))


def decode(clip, header, first, count):
    command = ["ffmpeg", "-v", "error", "-i", clip, "-vf", f"select=between(n\\,{first}\\,{first + count - 1})"]
    command += ["-vsync", "0", "-pix_fmt", "rgb24", "-f", "rawvideo", "-"]
    pixels = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    return np.frombuffer(pixels, np.uint8).reshape(count, header["height"], header["width"], 3)


def record(bag, eye, camera, colour, depth):
    device = rs.software_device()
    for key, value in [
        (rs.camera_info.name, "Synthetic D435I"),
        (rs.camera_info.serial_number, "000000000001"),
        (rs.camera_info.firmware_version, "5.16.0.1"),
        (rs.camera_info.product_line, "D400"),
    ]:
        device.register_info(key, value)
    stereo, rgb = device.add_sensor("Stereo Module"), device.add_sensor("RGB Camera")
    height, width = colour.shape[1:3]
    colour_lens = lens(width, height, (eye["fx"], eye["fy"]), (eye["cx"], eye["cy"]))
    depth_lens = lens(camera.width, camera.height, [camera.focal] * 2, camera.centre)
    colour_stream = rgb.add_video_stream(stream(rs.stream.color, 1, colour_lens, 3, rs.format.rgb8))
    depth_stream = stereo.add_video_stream(stream(rs.stream.depth, 0, depth_lens, 2, rs.format.z16))
    stereo.add_read_only_option(rs.option.depth_units, synthetic_depth.UNIT_M)
    stereo.add_read_only_option(rs.option.stereo_baseline, synthetic_depth.BASELINE_M * 1000)
    between = rs.extrinsics()
    # The SDK stores the matrix column by column.
    between.rotation, between.translation = camera.rotation.T.flatten().tolist(), camera.translation_m.tolist()
    depth_stream.register_extrinsics_to(colour_stream, between)
    recorder = rs.recorder(str(bag), device)
    queue = rs.frame_queue(2 * len(depth) + 8)
    sensors = list(zip(recorder.query_sensors(), (depth_stream, colour_stream)))
    for sensor, profile in sensors:
        sensor.open(profile)
        sensor.start(queue)
    for number, (picture, z) in enumerate(zip(colour, depth)):
        stamp = CLOCK_BEGAN_MS + number * 1000.0 / RATE_HZ
        stereo.on_video_frame(frame(number, stamp + DEPTH_LAG_MS, depth_stream, np.ascontiguousarray(z), 2))
        rgb.on_video_frame(frame(number, stamp, colour_stream, np.ascontiguousarray(picture), 3))
        # The recorder writes in a thread of its own and drops what it cannot keep up with.
        time.sleep(0.5 / RATE_HZ)
    time.sleep(0.5)
    for sensor, _ in sensors:
        sensor.stop()
        sensor.close()


def lens(width, height, focal, centre):
    made = rs.intrinsics()
    made.width, made.height = width, height
    (made.fx, made.fy), (made.ppx, made.ppy) = focal, centre
    made.model, made.coeffs = rs.distortion.brown_conrady, [0.0] * 5
    return made


def stream(kind, uid, optics, bytes_per_pixel, pixels):
    made = rs.video_stream()
    made.type, made.index, made.uid, made.fps, made.bpp, made.fmt = kind, 0, uid, RATE_HZ, bytes_per_pixel, pixels
    made.width, made.height, made.intrinsics = optics.width, optics.height, optics
    return made


def frame(number, stamp_ms, profile, pixels, bytes_per_pixel):
    made = rs.software_video_frame()
    made.stride, made.bpp = pixels.shape[1] * bytes_per_pixel, bytes_per_pixel
    made.timestamp, made.domain, made.frame_number = stamp_ms, rs.timestamp_domain.hardware_clock, number
    made.profile, made.pixels = profile.as_video_stream_profile(), pixels
    if bytes_per_pixel == 2:
        made.depth_units = synthetic_depth.UNIT_M
    return made


if __name__ == "__main__":
    main()
