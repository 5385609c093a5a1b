#!/usr/bin/env python3
"""Plays the shipped clips at the rate of a camera through so many stations at once, and says which share of their frames was looked at.

    stations.py [COUNT]...
"""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ANDOND = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "andond"
COUNTS = [4, 6, 8, 10]
FIGURES = re.compile(r"^ *(\d+) frames in .* per second\), (\d+) lost or skipped", re.MULTILINE)


def seen_and_missed(count):
    """How many frames the stations have looked at, and how many they have missed. Each has a folder and a port of its own."""
    demos = [subprocess.Popen([ANDOND, "demo", "--speed", "file"], cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(count)]
    clips = [FIGURES.findall(demo.communicate()[0]) for demo in demos]
    assert all(clips) and not any(demo.returncode for demo in demos), "a station has failed"
    return [sum(int(clip[of]) for station in clips for clip in station) for of in (0, 1)]


for count in map(int, sys.argv[1:] or COUNTS):
    seen, missed = seen_and_missed(count)
    print(f"{count} stations: {100 * seen / (seen + missed):.1f} % of {seen + missed} frames", flush=True)
