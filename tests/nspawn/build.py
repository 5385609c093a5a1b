#!/usr/bin/env python3
"""Builds the package for another release of Debian, in a container of its own.

    build.py RELEASE FOLDER [--short]     FOLDER takes the container and, in target/deb, the package

The container is a Debian of that release with what `make setup` asks for; `make deb` runs in it, on this source and with the
Rust toolchain of this machine, and compiles into FOLDER/target. `--short` packs unoptimised programs, as `make deb FORM=--short`.
"""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

import base

SOURCE = Path(__file__).resolve().parents[2]
# `make deb` installs the rest.
TOOLS = ["ca-certificates", "git", "make"]
# The container trusts whom this machine trusts, which may have a proxy with a certificate of its own.
CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("release")
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    folder = options.folder.resolve()
    target = folder / "target"
    target.mkdir(parents=True, exist_ok=True)
    # What does not depend on the release is not fetched again.
    if (SOURCE / "target/runtime").exists():
        shutil.copytree(SOURCE / "target/runtime", target / "runtime", symlinks=True, dirs_exist_ok=True)
    try:
        root = base.make(folder, TOOLS, options.release)
    except base.Unusable as reason:
        sys.exit(f"the package cannot be built: {reason}")
    command = ["systemd-nspawn", "--quiet", "--register=no", "--keep-unit", "--resolv-conf=bind-host", "--console=pipe"]
    command += [f"--directory={root}", f"--bind={SOURCE}:/source", f"--bind={target}:/source/target"]
    command += [f"--bind-ro={CERTIFICATES}", *toolchain(folder)]
    form = ["FORM=--short"] if options.short else []
    return subprocess.run([*command, "make", "-C", "/source", "deb", *form]).returncode


def toolchain(folder):
    """Options that put this machine's Rust and its fetched crates where the container looks for them. Programs that Cargo installs there
    are the container's own."""
    sysroot = subprocess.run(["rustc", "--print", "sysroot"], check=True, capture_output=True, text=True).stdout.strip()
    (folder / "cargo/registry").mkdir(parents=True, exist_ok=True)
    registry = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo")) / "registry"
    options = [f"--bind-ro={sysroot}", f"--bind={folder}/cargo:/cargo", f"--bind={registry}:/cargo/registry"]
    return [*options, f"--setenv=PATH={sysroot}/bin:/cargo/bin:/usr/sbin:/usr/bin:/sbin:/bin", "--setenv=CARGO_HOME=/cargo"]


if __name__ == "__main__":
    sys.exit(main())
