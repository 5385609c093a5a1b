#!/usr/bin/env python3
"""Writes vectors.json: distances and warping paths as dtaidistance 2.5.1 computes them.

    python3 -m venv VENV && VENV/bin/pip install dtaidistance==2.5.1 numpy && VENV/bin/python make.py

The inputs come from a fixed seed, so running this again changes nothing.
"""

import json
import math
import random
from pathlib import Path

import numpy
from dtaidistance import dtw, dtw_ndim

LENGTHS = [(1, 1), (1, 7), (9, 4), (31, 33), (32, 32), (64, 65), (150, 150), (97, 180)]
BINS = [4, 8, 12, 16, 36]
# Indices of the features of `Motion` that are directions: θ_hj, φ_hj, θ_jl, φ_jl.
DIRECTIONS = (1, 2, 4, 5)


def motions(rng, frames, bins, elevated):
    """A sequence as the method produces it, in which each motion lasts for some frames."""
    sequence = []
    while len(sequence) < frames:
        theta = [rng.randint(0, bins) if elevated else 0 for _ in range(2)]
        motion = [rng.randint(-1, 1), theta[0], rng.randint(0, bins), rng.randint(0, 1)]
        motion += [theta[1], rng.randint(0, bins), rng.randint(0, 1)]
        sequence += [motion] * rng.randint(1, 6)
    return sequence[:frames]


def on_circle(motion, bins):
    """The motion with directions as points on the unit circle and rest as its centre; the other features are unchanged."""
    point = [float(motion[index]) for index in range(7) if index not in DIRECTIONS]
    for index in DIRECTIONS:
        angle = math.tau * motion[index] / bins
        point += [math.cos(angle), math.sin(angle)] if motion[index] else [0.0, 0.0]
    return point


def distance(a, b):
    return dtw_ndim.distance(numpy.array(a, dtype=float), numpy.array(b, dtype=float))


def main():
    rng = random.Random(2026)
    vectors = {"ordinal": [], "circular": []}
    for n, m in LENGTHS:
        for elevated in (False, True):
            a, b = motions(rng, n, 8, elevated), motions(rng, m, 8, elevated)
            _, paths = dtw_ndim.warping_paths(numpy.array(a, dtype=float), numpy.array(b, dtype=float))
            path = [[int(i), int(j)] for i, j in dtw.best_path(paths)]
            vectors["ordinal"].append({"a": a, "b": b, "distance": distance(a, b), "path": path})
    for bins in BINS:
        for n, m in LENGTHS[-5:]:
            a, b = motions(rng, n, bins, True), motions(rng, m, bins, True)
            d = distance(*([on_circle(motion, bins) for motion in s] for s in (a, b)))
            vectors["circular"].append({"bins": bins, "a": a, "b": b, "distance": d})
    text = json.dumps(vectors, separators=(",", ":"))
    Path(__file__).with_name("vectors.json").write_text(text.replace('{"', '\n{"') + "\n")


main()
