#!/usr/bin/env python3
"""Put the hand models and ONNX Runtime where `perceive` looks for them.

    provision.py [FOLDER]        FOLDER defaults to target/runtime of this workspace

The models come as TensorFlow Lite files inside the mediapipe wheel and are converted to ONNX here; ONNX Runtime comes
from its own wheel. pip downloads both wheels and does not install them. Versions are pinned, every file is checked
against its SHA-256, and a file appears under its name only when it is complete. Files that are already right stay.

Needs Python 3.9 with pip. Needs no root. Exit codes: 0 all files are there, 1 failure, explained in one sentence.
"""

import hashlib
import os
import platform
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from tflite_to_onnx import ConversionError, convert, quantise

HERE = Path(__file__).resolve().parent
# The crate compiles in the same list, so that it accepts what is provisioned here.
CHECKSUMS = {name: digest for digest, name in (line.split() for line in (HERE / "SHA256SUMS").read_text().splitlines())}
LIBRARY = "libonnxruntime.so"


class ProvisionError(Exception):
    """Why the files cannot be provided, in one sentence for the user."""


class Wheel:
    """A wheel that is downloaded for the files inside it."""

    def __init__(self, requirement, sha256):
        self.requirement = requirement
        self.sha256 = sha256

    def download(self, folder):
        """Downloads the wheel with pip, checks it and returns its path."""
        # The interpreter's version is pinned with the wheel; nothing in it is run.
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        command += ["--only-binary=:all:", "--python-version=3.11", "--implementation=cp", "--abi=cp311"]
        command += ["--platform=manylinux_2_28_x86_64", "--dest=%s" % folder, self.requirement]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            if "No module named pip" in done.stderr:
                raise ProvisionError("pip is missing: install the package python3-pip and run this again.")
            reason = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()[-1]
            raise ProvisionError("pip could not download %s (%s): check the network and run this again." % (self.requirement, reason))
        (wheel,) = Path(folder).glob(self.requirement.split("==")[0] + "-*.whl")
        if sha256_of(wheel.read_bytes()) != self.sha256:
            raise ProvisionError(
                "the downloaded %s does not have the pinned SHA-256: the package index serves another file." % wheel.name
            )
        return wheel


MEDIAPIPE = Wheel("mediapipe==0.10.21", "05dc4a9e593655a79558d05d6227d31018c2537a4bd3362b51e230cf22aecfe3")
ONNX_RUNTIME = Wheel("onnxruntime==1.31.1", "5752bd508126ae7c49894d3b9d2e83f0c3d487319246d04c444b393308d7ad7f")

# File -> (wheel, member of the wheel).
SOURCES = {
    "palm_detection_full.onnx": (MEDIAPIPE, "mediapipe/modules/palm_detection/palm_detection_full.tflite"),
    "palm_detection_lite.onnx": (MEDIAPIPE, "mediapipe/modules/palm_detection/palm_detection_lite.tflite"),
    "hand_landmark_full.onnx": (MEDIAPIPE, "mediapipe/modules/hand_landmark/hand_landmark_full.tflite"),
    "hand_landmark_lite.onnx": (MEDIAPIPE, "mediapipe/modules/hand_landmark/hand_landmark_lite.tflite"),
    "hand_landmark_quantised.onnx": (MEDIAPIPE, "mediapipe/modules/hand_landmark/hand_landmark_full.tflite"),
    LIBRARY: (ONNX_RUNTIME, "onnxruntime/capi/libonnxruntime.so.1.31.1"),
}


def sha256_of(data):
    """The SHA-256 in the notation of SHA256SUMS."""
    return hashlib.sha256(data).hexdigest()


def is_right(path):
    """Whether the file exists and has its pinned checksum."""
    return path.is_file() and sha256_of(path.read_bytes()) == CHECKSUMS[path.name]


def made(name, member):
    """A model in ONNX, and any other member as it is."""
    if name == "hand_landmark_quantised.onnx":
        lines = (line.split() for line in (HERE / "hand_landmark.ranges").read_text().splitlines())
        return quantise(member, {picture: (float(least), float(greatest)) for picture, least, greatest in lines})
    return convert(member) if name.endswith(".onnx") else member


def build(name, member):
    """The bytes of a file, made from those of its member of the wheel."""
    data = made(name, member)
    if sha256_of(data) != CHECKSUMS[name]:
        raise ProvisionError("%s does not have its pinned SHA-256 after the conversion: SHA256SUMS and the converter disagree." % name)
    return data


def write_whole(path, data):
    """Writes a file that is never visible half written."""
    handle, unfinished = tempfile.mkstemp(prefix="." + path.name, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(unfinished, 0o644)
        os.replace(unfinished, path)
    except BaseException:
        os.unlink(unfinished)
        raise


def provision(folder):
    """Makes the files of SOURCES that the folder lacks, and returns their names."""
    missing = [name for name in SOURCES if not is_right(folder / name)]
    if not missing:
        return missing
    if platform.machine() != "x86_64":
        raise ProvisionError("only x86_64 machines can be provisioned, and this one is %s." % platform.machine())
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="andon-provision-") as downloads:
        for wheel in (MEDIAPIPE, ONNX_RUNTIME):
            wanted = [name for name in missing if SOURCES[name][0] is wheel]
            if not wanted:
                continue
            print("downloading %s" % wheel.requirement, flush=True)
            with zipfile.ZipFile(wheel.download(downloads)) as archive:
                for name in wanted:
                    write_whole(folder / name, build(name, archive.read(SOURCES[name][1])))
                    print("made %s" % (folder / name), flush=True)
    return missing


def main(arguments):
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print(__doc__.strip(), file=sys.stderr)
        return 0 if arguments in (["-h"], ["--help"]) else 64
    folder = Path(arguments[0]) if arguments else HERE.parents[2] / "target" / "runtime"
    try:
        if not provision(folder):
            print("the hand models and ONNX Runtime are already in %s" % folder)
    except (ProvisionError, ConversionError) as error:
        print("provision: %s" % error, file=sys.stderr)
        return 1
    except OSError as error:
        print("provision: %s cannot be filled: %s" % (folder, error), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
