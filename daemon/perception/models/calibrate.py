#!/usr/bin/env python3
"""Find the ranges that the rounded hand landmark model is made with.

    calibrate.py MODEL.tflite CLIP.mp4...        writes hand_landmark.ranges beside this file

MODEL.tflite is `mediapipe/modules/hand_landmark/hand_landmark_full.tflite` of the wheel that provision.py names. Each clip has its truth beside
it: the hand is cut out where the model would be shown it, a little beside that place, in turn as it is, with noise, in the dark and blurred.
The least and the greatest value that each picture inside the model takes are its range.

Needs the packages onnxruntime, numpy and opencv-python-headless. The same clips give the same ranges on the same machine.
"""

import json
import sys
from pathlib import Path

import cv2
import numpy
import onnxruntime
from tflite_to_onnx import observe

HERE = Path(__file__).resolve().parent
INPUT = 224
# One frame in this many: neighbours show the same.
EVERY = 12
# Landmarks that do not move while fingers bend, as in src/hands/region.rs.
STEADY = [0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18]
CHANGES = [
    lambda picture, _: picture,
    lambda picture, random: picture + random.uniform(-20, 20, picture.shape),
    lambda picture, _: picture - 64,
    lambda picture, _: 255 * (picture / 255) ** 2.5,
    lambda picture, _: cv2.GaussianBlur(picture, (0, 0), 2),
]


def region(landmarks):
    """Centre, side and rotation of the square in which the model is shown a hand, as in src/hands/region.rs."""
    wrist, (index, middle, ring) = landmarks[0], landmarks[[5, 9, 13]]
    to = ((index + ring) / 2 + middle) / 2 - wrist
    rotation = numpy.pi / 2 - numpy.arctan2(-to[1], to[0])
    sin, cos = numpy.sin(rotation), numpy.cos(rotation)
    upright = landmarks[STEADY] @ numpy.array([[cos, -sin], [sin, cos]])
    size, (x, y) = numpy.ptp(upright, axis=0), (upright.min(axis=0) + upright.max(axis=0)) / 2
    centre = numpy.array([x * cos - y * sin + 0.1 * size[1] * sin, x * sin + y * cos - 0.1 * size[1] * cos])
    return centre, 2 * size.max(), rotation


def cut(picture, centre, side, rotation):
    """The input of the model."""
    sin, cos = side / INPUT * numpy.sin(rotation), side / INPUT * numpy.cos(rotation)
    first = centre - INPUT / 2 * numpy.array([cos - sin, sin + cos])
    to_picture = numpy.array([[cos, -sin, first[0]], [sin, cos, first[1]]])
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    return cv2.warpAffine(picture, to_picture, (INPUT, INPUT), flags=flags, borderMode=cv2.BORDER_REPLICATE)


def inputs(clip, random):
    """What the model is shown of a clip."""
    truth = [json.loads(line) for line in clip.with_suffix(".truth.jsonl").read_text().splitlines()][1:]
    film = cv2.VideoCapture(str(clip))
    for number, frame in enumerate(truth):
        is_read, picture = film.read()
        if not is_read or number % EVERY or not frame["hands"]:
            continue
        centre, side, rotation = region(numpy.array(frame["hands"][0]["px"]))
        beside = centre + random.normal(0, 0.03, 2) * side, side * random.normal(1, 0.05), rotation + random.normal(0, 0.1)
        changed = CHANGES[number // EVERY % len(CHANGES)](picture.astype(numpy.float32), random)
        shown = cut(numpy.clip(changed, 0, 255).astype(numpy.uint8), *beside)
        yield shown[None, :, :, ::-1].astype(numpy.float32) / 255


def main(model, *clips):
    session = onnxruntime.InferenceSession(observe(Path(model).read_bytes()), providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    random, ranges = numpy.random.default_rng(1), {}
    for clip in clips:
        for shown in inputs(Path(clip), random):
            for name, values in zip(names, session.run(None, {session.get_inputs()[0].name: shown})):
                least, greatest = ranges.get(name, (0.0, 0.0))
                ranges[name] = min(least, float(values.min())), max(greatest, float(values.max()))
    lines = ["%s %.6g %.6g" % (name, *ranges[name]) for name in names if name.startswith("t")]
    (HERE / "hand_landmark.ranges").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    main(*sys.argv[1:])
