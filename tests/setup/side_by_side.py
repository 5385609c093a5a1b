#!/usr/bin/env python3
"""Runs the test programs of `cargo test`, several side by side: most of them wait for longer than they compute, and Cargo
itself runs one after the other.

    side_by_side.py [ARGUMENT OF CARGO TEST...]

Prints what a program that has failed said, and at the end which ones took longest. Exit codes: 0 all well, 1 a test has
failed or does not compile.
"""

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Twice as many as there are processors would make a machine of two so busy that more is waited for than gained.
PROGRAMS = 1 + (os.cpu_count() or 1)
# These take longest, so they begin first: at the end nothing else is left to run beside them.
FIRST = ["perception_accuracy", "line_sight", "line_restart", "line_realsense", "line_shift"]
# The camera's library plays a recording by the clock and pairs pictures by when they come: beside others it loses some.
ALONE = ["recording"]


def programs(arguments):
    """Builds the tests. Name, folder and path of each program that `cargo test` with these arguments would run."""
    cargo = ["cargo", "test", *arguments, "--no-run", "--message-format=json-render-diagnostics"]
    built = subprocess.run(cargo, stdout=subprocess.PIPE, text=True)
    if built.returncode:
        sys.exit(1)
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    tests = [said for said in messages if said.get("executable") and said["profile"]["test"]]
    found = [(said["target"]["name"], Path(said["manifest_path"]).parent, said["executable"]) for said in tests]
    return sorted(found, key=lambda one: (FIRST.index(one[0]) if one[0] in FIRST else len(FIRST), one))


def run(program):
    """What a program took, in seconds, and whether all is well."""
    name, folder, path = program
    began = time.monotonic()
    ended = subprocess.run([path], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    took = time.monotonic() - began
    print(f"{'ok    ' if ended.returncode == 0 else 'FAILED'} {took:6.1f} s  {name}", flush=True)
    if ended.returncode:
        print(ended.stdout, flush=True)
    return took, name, ended.returncode == 0


def main():
    began = time.monotonic()
    found = programs(sys.argv[1:])
    ran = [run(program) for program in found if program[0] in ALONE]
    with ThreadPoolExecutor(PROGRAMS) as beside:
        ran += beside.map(run, [program for program in found if program[0] not in ALONE])
    longest = ", ".join(f"{name} {took:.0f} s" for took, name, _ in sorted(ran, reverse=True)[:15])
    failed = [name for _, name, is_well in ran if not is_well]
    print(f"{len(ran)} programs in {time.monotonic() - began:.0f} s; longest: {longest}")
    sys.exit(f"failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
