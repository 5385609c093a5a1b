#!/usr/bin/env python3
"""Measures the core and compares DTW with its peers on this machine, then how fast the line sees. Prints a table and writes
target/bench/report.json.

Needs cargo, ffmpeg and python3 with venv; the Python peers are installed once, into target/bench. All figures are medians on one core, unless
they are named otherwise.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import perception

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
BENCH = ROOT / "target" / "bench"
PEERS = ["dtaidistance==2.5.1", "tslearn==0.10.0", "numpy==2.4.6"]
CELLS = 150 * 150

# Maximum of each figure, in the unit of its row, and the minimum ratio of the matrix.
MAX = {"batch": 3.0, "append": 0.5, "step": 50.0}
MIN_MATRIX_RATIO = 3


def own_figures():
    """The median ns of every function of benches/dtw.rs. benches/step.rs writes its own figures into step.json."""
    for bench in ("step", "dtw"):
        subprocess.run(["cargo", "bench", "--locked", "-p", "andon-tests", "--bench", bench], cwd=ROOT, check=True, stdout=sys.stderr)
    names = [f"batch_{cost}_{d}" for cost in ("ordinal", "circular") for d in (5, 7)]
    names += ["dtw_rs_5", "dtw_rs_7", "append_7", "multiplications_1000", "matrix/240"]
    estimates = TARGET / "criterion"
    return {name: json.loads((estimates / name / "new" / "estimates.json").read_text())["median"]["point_estimate"]
            for name in names}


def peer_figures():
    """The median ns of the Python peers on the same pairs, measured in the virtual environment."""
    python = BENCH / "venv" / "bin" / "python"
    wanted, installed = "\n".join(PEERS), BENCH / "venv" / "installed"
    if not (installed.exists() and installed.read_text() == wanted):
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(BENCH / "venv")], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "-q", *PEERS], check=True)
        installed.write_text(wanted)
    run = subprocess.run([str(python), __file__, "--peers"], check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(run.stdout.splitlines()[-1])


def measure_peers():
    import numpy
    from dtaidistance import dtw_ndim
    from tslearn.metrics import dtw as tslearn_dtw

    def median(function):
        function()
        times = []
        for _ in range(301):
            began = time.perf_counter_ns()
            function()
            times.append(time.perf_counter_ns() - began)
        return sorted(times)[150]

    figures = {}
    golden = json.loads((ROOT / "tests/golden/dtw/vectors.json").read_text())["ordinal"]
    for pair in golden:
        a, b = (numpy.array(pair[key], dtype=float) for key in "ab")
        if a.shape[0] != 150 or b.shape[0] != 150:
            continue
        features = [0, 1, 2, 3, 4, 5, 6] if a[:, 1].any() else [0, 2, 3, 5, 6]
        a, b = (numpy.ascontiguousarray(s[:, features]) for s in (a, b))
        for name, function in (("dtaidistance", dtw_ndim.distance_fast), ("tslearn", tslearn_dtw)):
            assert abs(function(a, b) - pair["distance"]) < 1e-9, name
            figures[f"{name}_{len(features)}"] = median(lambda: function(a, b))
    left = json.loads((BENCH / "matrix.json").read_text())
    ius = [numpy.ascontiguousarray(numpy.array(iu, dtype=float)[:, [0, 2, 3, 5, 6]]) for iu in left["ius"]]
    times = []
    for _ in range(3):
        began = time.perf_counter_ns()
        matrix = dtw_ndim.distance_matrix_fast(ius, parallel=False, compact=True)
        times.append(time.perf_counter_ns() - began)
    assert abs(sum(matrix) / left["sum"] - 1) < 1e-9, "the peer computes a different matrix"
    figures["matrix_dtaidistance"] = sorted(times)[1]
    print(json.dumps(figures))


def main():
    if "--peers" in sys.argv:
        measure_peers()
        return
    BENCH.mkdir(parents=True, exist_ok=True)
    own, peers = own_figures(), peer_figures()
    ghz = 3000 / own["multiplications_1000"]
    report = {"clock_ghz": ghz, "batch_ns_cell": {}, "peers_ns_cell": {}, "ratio_to_peer": {}}
    rows = []
    for dimensions in (5, 7):
        for cost in ("ordinal", "circular"):
            name = f"{cost}_{dimensions}"
            report["batch_ns_cell"][name] = own[f"batch_{name}"] / CELLS
            rows.append((f"batch, {cost}, {dimensions} dimensions", own[f"batch_{name}"] / CELLS, "ns per cell", MAX["batch"]))
        fastest = report["batch_ns_cell"][f"ordinal_{dimensions}"]
        for peer in ("dtw_rs", "dtaidistance", "tslearn"):
            name = f"{peer}_{dimensions}"
            figure = {**own, **peers}[name] / CELLS
            report["peers_ns_cell"][name] = figure
            report["ratio_to_peer"][name] = figure / fastest
            rows.append((f"{peer}, {dimensions} dimensions ({figure / fastest:.1f} times ours)", figure, "ns per cell", None))
    report["append_us"] = own["append_7"] / 1e3
    rows.append(("append, one reference of 150 x 7", report["append_us"], "us", MAX["append"]))
    ratio = peers["matrix_dtaidistance"] / own["matrix/240"]
    report["matrix_240_ms"] = {"own": own["matrix/240"] / 1e6, "dtaidistance": peers["matrix_dtaidistance"] / 1e6, "ratio": ratio}
    rows.append(("matrix of 240 IUs of 60 to 180 frames, 5 dimensions", own["matrix/240"] / 1e6, "ms", None))
    verdict = "met" if ratio >= MIN_MATRIX_RATIO else "MISSED"
    rows.append((f"dtaidistance, the same ({ratio:.1f} times ours; at least {MIN_MATRIX_RATIO}: {verdict})",
                 peers["matrix_dtaidistance"] / 1e6, "ms", None))
    report["step"] = json.loads((BENCH / "step.json").read_text())
    for name, label in (("job", "20 nominal activities"), ("alike", "20 that remain candidates")):
        rows.append((f"core step, {label}, p50", report["step"][name]["p50_us"], "us", None))
        rows.append((f"core step, {label}, p99", report["step"][name]["p99_us"], "us", MAX["step"]))
    report["perception"], seen = perception.measure()
    (BENCH / "report.json").write_text(json.dumps(report, indent=2) + "\n")
    rows = [(name, figure, unit, maximum and ("at most", maximum)) for name, figure, unit, maximum in rows] + seen
    width = max(len(row[0]) for row in rows)
    for name, figure, unit, wanted in rows:
        goal = ""
        if wanted:
            is_met = figure <= wanted[1] if wanted[0] == "at most" else figure >= wanted[1]
            goal = f"{wanted[0]} {wanted[1]:g}: {'met' if is_met else 'MISSED'}"
        print(f"{name:<{width}}  {figure:9.3f} {unit:<11} {goal}".rstrip())
    print(f"clock {ghz:.2f} GHz; all in {BENCH / 'report.json'}, and what each thread does in a frame in {BENCH / 'frame.svg'}")


main()
