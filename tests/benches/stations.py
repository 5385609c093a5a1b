#!/usr/bin/env python3
"""Plays the shipped clips at the rate of a camera through so many stations at once, says which share of their frames was looked at, and
prints the row of tests/MEASUREMENTS.md.

    stations.py [--programs FOLDER] [--clips FOLDER] [COUNT]...
"""

import argparse
import os
import re
import subprocess
import sys
from math import sqrt
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FIGURES = re.compile(r"^ *(\d+) frames in .* per second\), (\d+) lost or skipped", re.MULTILINE)

# A station that looks at this share of its frames is carried. It is far above what a step of the shipped job needs.
CARRIED = 0.98


def seen_and_all(demo, count):
    """How many frames the stations have looked at, and how many there were. Each station has a folder and a port of its own."""
    stations = [subprocess.Popen(demo, cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(count)]
    outputs = [station.communicate()[0] for station in stations]
    clips = [clip for output in outputs for clip in FIGURES.findall(output)]
    if any(station.returncode for station in stations) or not clips:
        sys.exit("a station has failed; its last words are above")
    seen, missed = (sum(int(clip[of]) for clip in clips) for of in (0, 1))
    return seen, seen + missed


def interval(seen, of):
    """The Wilson interval of a share at 95 %, in percent."""
    square, share = 1.96**2, seen / of
    middle = share + square / (2 * of)
    half = sqrt(square * (share * (1 - share) / of + square / (4 * of * of)))
    return [100 * bound / (1 + square / of) for bound in (middle - half, middle + half)]


def row(results):
    """The row of the largest number of stations that this machine carries; those beyond it are named with it."""
    carried = [count for count, (seen, of) in results.items() if seen >= CARRIED * of]
    most = max(carried, default=min(results))
    seen, of = results[most]
    result = f"{100 * seen / of:.1f} % looked at"
    result += "".join(f"; {count} keep {100 * s / o:.1f} %" for count, (s, o) in results.items() if count > most)
    low, high = interval(seen, of)
    cells = [f"One PC carries {most} stations at 30 Hz" if carried else f"Limit: one PC does not carry {most} stations at 30 Hz",
             f"the shipped clips in each, {os.cpu_count()} cores", f"{of:,} frames", result, f"{low:.1f} to {high:.1f} %", "`make stations`"]
    return f"| {' | '.join(cells)} |"


parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
parser.add_argument("counts", metavar="COUNT", nargs="*", type=int, help="numbers of stations [default: 4 6 8 10]")
parser.add_argument("--programs", metavar="FOLDER", type=Path, default=TARGET / "release", help="where andond and andond-video are")
parser.add_argument("--clips", metavar="FOLDER", type=Path, default=ROOT / "tests" / "footage", help="the films to be played")
arguments = parser.parse_args()
demo = [arguments.programs.absolute() / "andond", "demo", "--speed", "file", "--clips", arguments.clips.absolute()]
results = {}
for count in arguments.counts or [4, 6, 8, 10]:
    seen, of = results[count] = seen_and_all(demo, count)
    print(f"{count} stations: {100 * seen / of:.1f} % of {of:,} frames", flush=True)
print(row(results))
