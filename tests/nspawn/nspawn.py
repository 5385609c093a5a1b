#!/usr/bin/env python3
"""Installs the package on a bare Debian, boots it, and checks there what the units and the README promise.

    nspawn.py PACKAGE FOLDER [--short] [--release NAME]     FOLDER takes the base, the machine and report.json

The machine is a container (systemd-nspawn) with a systemd and a kernel's view of its own and no network. `--short` stops
one role instead of all seven, and ends after 20 minutes at the latest. Where containers cannot be used it says SKIPPED
and why. Exit codes: 0 all well or skipped, 1 a check has failed, 64 usage.
"""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import base
from base import Unusable
from checks import CHECKS, ROLES
from machine import Machine

# Minutes in which everything must be through: a download of 200 MB, and a minute for each role that is stopped. On a machine with
# nothing else to do the short form takes four.
LIMIT_MIN = {"long": 40, "short": 20}

# What the checks need on the machine beside the package.
TOOLS = ["needrestart"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("package", type=Path)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--release", help="of Debian, such as trixie; that of this machine if none is named")
    options = arguments.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    form = "short" if options.short else "long"
    signal.signal(signal.SIGALRM, lambda *_: sys.exit(f"FAILED: not through after {LIMIT_MIN[form]} minutes"))
    signal.alarm(60 * LIMIT_MIN[form])
    # A stop that is asked for takes the machine down too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    report = {"package": options.package.name, "form": form}
    try:
        need_tools()
        root = base.make(options.folder, base.needs(options.package) + TOOLS, options.release)
        with Machine(root, options.folder / "machine") as machine:
            well = check(machine, options, report)
    except Unusable as reason:
        report["skipped"], well = str(reason), True
        print(f"\nSKIPPED, nothing was checked: {reason}\n", flush=True)
    finally:
        (options.folder / "report.json").write_text(json.dumps(report, indent=2) + "\n")
    return 0 if well else 1


def need_tools():
    if os.geteuid() != 0:
        raise Unusable("it needs root, to mount and to boot")
    for tool in ("debootstrap", "systemd-nspawn", "nsenter", "dpkg-deb", "cc"):
        if not shutil.which(tool):
            raise Unusable(f"{tool} is missing: `make nspawn` installs it")


def check(machine, options, report):
    """Runs the checks in their order up to the first that fails: each depends on those before it."""
    shutil.copy(options.package, machine.root / "mnt/andon.deb")
    seen = {"newer": newer(options.package, machine.root / "mnt/newer.deb")}
    seen["stopped_roles"] = ["judge"] if options.short else ROLES
    report["checks"] = {}
    for one in CHECKS:
        name, began = one.__name__.replace("_", " "), time.monotonic()
        try:
            one(machine, seen)
            failure = None
        except (AssertionError, Unusable, subprocess.SubprocessError, KeyError, ValueError, OSError) as error:
            failure = f"{type(error).__name__}: {error}"
        took = round(time.monotonic() - began, 1)
        report["checks"][name] = {"passed": failure is None, "seconds": took}
        print(f"{'ok    ' if failure is None else 'FAILED'} {took:6.1f} s  {name}", flush=True)
        if failure:
            report["checks"][name]["failure"] = failure
            print(failure, words(machine), sep="\n")
            break
    figures = {name: value for name, value in seen.items() if name != "files_before"}
    report.update(figures)
    for name, value in figures.items():
        print(f"{name}: {value}")
    passed = sum(one["passed"] for one in report["checks"].values())
    print(f"{passed} passed, {len(report['checks']) - passed} failed of {len(CHECKS)} checks")
    return passed == len(CHECKS)


def newer(package, target):
    """The same package under a higher version and with a changed configuration file, as an upgrade brings it."""
    folder = target.with_suffix("")
    subprocess.run(["dpkg-deb", "--raw-extract", package, folder], check=True)
    control = folder / "DEBIAN/control"
    lines = control.read_text().splitlines()
    version = next(line.split(": ")[1] for line in lines if line.startswith("Version: ")) + "+upgrade"
    control.write_text("\n".join(f"Version: {version}" if line.startswith("Version: ") else line for line in lines) + "\n")
    with open(folder / "etc/andon/andon.toml", "a") as config:
        config.write("\n# as the newer version ships it\n")
    subprocess.run(["dpkg-deb", "--build", "-Zgzip", "-z1", folder, target], check=True, stdout=subprocess.DEVNULL)
    shutil.rmtree(folder)
    return version


def words(machine):
    """The newest lines of the machine's journal, for whoever looks for the reason."""
    shown = machine.run("journalctl", "--no-pager", "--lines=60", "--output=short-monotonic")
    return shown.stdout or shown.stderr


if __name__ == "__main__":
    sys.exit(main())
