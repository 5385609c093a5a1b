#!/usr/bin/env python3
"""Puts librealsense2 where Andon loads it from: RUNTIME/realsense/.

No Debian package and no crate contains the library, but the Python package pyrealsense2 exports its whole C interface. Only
that one file is kept. It refers to symbols of the Python interpreter that its C interface never uses; a stub library with
their names satisfies the loader, so that no Python is needed at run time.

With --recorder the Python package itself is unpacked as well (for tests/realsense/make_bag.py).
Running it again is harmless: intact files are kept.
"""
import argparse
import hashlib
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

LIBRARY = "librealsense2.so.2.56"
STUB = "libpystub.so"
# The wheel for CPython 3.11: all wheels have the same library, and this one also runs on the Python of Debian 12.
EXTENSION = "pyrealsense2/pyrealsense2.cpython-311-x86_64-linux-gnu.so"
EXTENSION_SHA256 = "17fc5408a4cd81a94446649c3d96d74b0b3d16ac83800fed316cbdccbac7b314"
LICENSE = "pyrealsense2-2.56.5.9235.dist-info/licenses/LICENSE"
WHEELS = {
    "pyrealsense2": "pyrealsense2==2.56.5.9235"
    " --hash=sha256:76d384ea99f257b4697a82cb3581b05cc69fadfd0701021ad76da098a3e240f0",
    "numpy": "numpy==2.4.6 --hash=sha256:89cd468399cfd2504718f0ba50e410dca55a170b61a02ad92bb18c8a65186e93",
}
PLATFORMS = ["manylinux1_x86_64", "manylinux_2_28_x86_64"]
RECORDER_PYTHON = (3, 11)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("runtime", type=pathlib.Path, help="the folder for the library, such as target/runtime")
    arguments.add_argument("--recorder", action="store_true", help="unpack the Python packages that make_bag.py needs too")
    options = arguments.parse_args()
    target = options.runtime / "realsense"
    packages = target / "python"
    wanted = []
    if not is_whole(target):
        wanted.append("pyrealsense2")
    if options.recorder and not (packages / "complete").exists():
        if sys.version_info[:2] != RECORDER_PYTHON:
            sys.exit("make_bag.py needs Python 3.11 (its packages are built for it): run provision.py with python3.11")
        wanted = ["pyrealsense2", "numpy"]
    if wanted:
        with tempfile.TemporaryDirectory() as folder:
            provide(wanted, pathlib.Path(folder), target, packages if options.recorder else None)
    print(f"{target / LIBRARY} is there")


def is_whole(target: pathlib.Path) -> bool:
    library = target / LIBRARY
    return (target / STUB).exists() and library.exists() and sha256(library) == EXTENSION_SHA256


def provide(wanted, scratch, target, packages) -> None:
    download([WHEELS[name] for name in wanted], scratch)
    target.mkdir(parents=True, exist_ok=True)
    unpacked = scratch / "unpacked"
    for wheel in scratch.glob("*.whl"):
        zipfile.ZipFile(wheel).extractall(unpacked)
    extension = unpacked / EXTENSION
    if sha256(extension) != EXTENSION_SHA256:
        sys.exit(f"{EXTENSION} in the wheel is not the pinned one: nothing was installed")
    build_stub(extension, scratch / "stub.c", target / STUB)
    shutil.copyfile(unpacked / LICENSE, target / "LICENSE")
    # Renamed into place, so that a half-copied library is never taken for a whole one.
    part = target / (LIBRARY + ".part")
    shutil.copyfile(extension, part)
    part.rename(target / LIBRARY)
    if packages:
        shutil.rmtree(packages, ignore_errors=True)
        shutil.copytree(unpacked, packages)
        (packages / "complete").touch()


def download(requirements, scratch) -> None:
    listed = scratch / "requirements.txt"
    listed.write_text("\n".join(requirements) + "\n")
    command = [pip_python(scratch), "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    command += ["--only-binary=:all:", "--python-version=3.11", "--implementation=cp", "--abi=cp311"]
    command += [f"--platform={platform}" for platform in PLATFORMS]
    command += ["--require-hashes", "--requirement", str(listed), "--dest", str(scratch)]
    if subprocess.run(command).returncode != 0:
        sys.exit("the Python package pyrealsense2 could not be downloaded (see above): check the network and run again")


def pip_python(scratch) -> str:
    """A Python that has pip: this one, or a throw-away environment."""
    if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode == 0:
        return sys.executable
    made = subprocess.run([sys.executable, "-m", "venv", str(scratch / "venv")], capture_output=True)
    if made.returncode != 0:
        sys.exit("Python has neither pip nor venv: apt-get install python3-venv")
    return str(scratch / "venv/bin/python")


def build_stub(extension, source, stub) -> None:
    listing = subprocess.run(["nm", "-D", "--undefined-only", extension], capture_output=True, text=True, check=True).stdout
    names = {line.split()[-1].split("@")[0] for line in listing.splitlines()}
    python = sorted(name for name in names if name.startswith(("Py", "_Py")))
    # 512 bytes are more than any of the type objects among them occupies.
    source.write_text("".join(f"char {name}[512] __attribute__((aligned(16)));\n" for name in python))
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", f"-Wl,-soname,{STUB}", "-o", stub, source], check=True)


def sha256(path: pathlib.Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


if __name__ == "__main__":
    main()
