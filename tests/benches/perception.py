"""Measures how fast the line sees: beside a pipeline of Python's mediapipe and OpenCV on the same films, and beside the bare models.

The films are the shipped clip in several sizes, with one hand and with two. The second one is the first one mirrored, beside it. `andond demo`
plays them through every role, once as fast as possible and once at the rate of a camera.
"""

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RELEASE = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
BENCH = ROOT / "target" / "bench"
CLIP = ROOT / "tests/footage/p1_none_r1.mp4"
SIZES = [(640, 480), (1280, 720), (1920, 1080)]
# The default first.
MODELS = ["quantised", "full"]
RATE_HZ = 30
# The hand works all the time in this stretch of the clip.
FROM_S, LENGTH_S = "3", "8"
# It is shown so many times over at full speed, so that the start of the programs hardly counts. At the rate of a camera once is enough.
ROUNDS = {"max": 6, "file": 1}
# The environment of the peer, apart from the others: it needs an older numpy. ONNX Runtime is the one that the line has.
PEERS = ["mediapipe==0.10.21", "onnxruntime==1.31.1"]

# Minimum frames per second by size and hands, and minimum ratio to the peer with one hand in the smallest size.
MIN_RATE_HZ = {("640x480", 1): 110, ("1280x720", 1): 80, ("640x480", 2): 70}
MIN_RATIO = 2.5
# The line and the peer take turns so many times where a ratio must be reached, and once elsewhere. A shared machine gives its cores more or less from
# one run to the next, which moves a single ratio by a tenth. The pair in the middle counts.
PAIRS = 5
RATIO_OF = ("640x480", 1)
# Maxima for the same at the rate of a camera.
MAX = {"core_share": 0.25, "p50_ms": 8.0, "p99_ms": 12.0, "memory_mib": 110.0}


def film(size, hands, speed):
    """The clip in this size and with so many hands, alone in its folder, for this speed of `andond demo`."""
    folder = BENCH / "films" / f"{size[0]}x{size[1]}_{hands}_{speed}"
    path = folder / "film.mp4"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        doubled = "split[a][b];[b]hflip[c];[a][c]hstack," if hands == 2 else ""
        fit = "%d:%d:force_original_aspect_ratio=decrease,pad=%d:%d:-1:-1" % (*size, *size)
        rounds = f"loop={ROUNDS[speed] - 1}:size={int(LENGTH_S) * RATE_HZ}:start=0,setpts=N/({RATE_HZ}*TB)"
        command = ["ffmpeg", "-v", "error", "-y", "-ss", FROM_S, "-t", LENGTH_S, "-i", str(CLIP), "-vf", f"{doubled}scale={fit},{rounds}"]
        subprocess.run([*command, "-pix_fmt", "yuv420p", "-preset", "veryfast", "-crf", "18", str(path)], check=True)
    return path


def covered_film():
    """Two hands and the parts of both halves of the picture, which somebody covers every other second, at the rate of a camera."""
    source = film(SIZES[0], 2, "file")
    path = BENCH / "films" / "covered" / "film.mp4"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        cover = "drawbox=t=fill:color=gray:enable='gte(mod(t,2),1)'"
        command = ["ffmpeg", "-v", "error", "-y", "-i", str(source), "-vf", cover, "-preset", "veryfast", "-crf", "18", str(path)]
        subprocess.run(command, check=True)
    return path


def line(path, hands, model, speed):
    """What `andond demo` says of the film: frames per second, latency, and what perceive used."""
    config = path.with_name(f"{model}.toml")
    sides = ["right", "left"][:hands]
    config.write_text(f"[perception]\nhand_model = {json.dumps(model)}\nhands = {json.dumps(sides)}\n[camera]\nwidth = 1920\nheight = 1080\n")
    command = [RELEASE / "andond", "demo", "--speed", speed, "--clips", path.parent]
    command += ["--config", ROOT / "config/stations/demo.toml", "--config", config]
    text = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True).stdout
    frames = re.search(r"\(([\d.]+) per second\), (\d+) lost or skipped; frame to verdict ([\d.]+) ms \(median\), ([\d.]+) ms", text)
    used = re.search(r"^perceive +([\d.]+) % +([\d.]+) MiB", text, re.MULTILINE)
    names = ["frames_per_s", "lost", "p50_ms", "p99_ms", "core_percent", "memory_mib"]
    row = dict(zip(names, map(float, frames.groups() + used.groups())))
    row["core_share"] = row.pop("core_percent") / 100
    return row


def in_peers_environment(*arguments):
    """What a run of this file in the environment of the peer prints as JSON."""
    folder = BENCH / "venv-perception"
    python, wanted, installed = folder / "bin" / "python", "\n".join(PEERS), folder / "installed"
    if not (installed.exists() and installed.read_text() == wanted):
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(folder)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "-q", *PEERS], check=True)
        installed.write_text(wanted)
    run = subprocess.run([str(python), __file__, *map(str, arguments)], check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return json.loads(run.stdout.splitlines()[-1])


def peer(path, hands):
    """The film through mediapipe's hands and OpenCV's markers, with their defaults for films, in the environment of the peer."""
    import cv2
    import mediapipe

    capture = cv2.VideoCapture(path)
    tracker = mediapipe.solutions.hands.Hands(max_num_hands=hands, model_complexity=1)
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    frames, seen, cpu, began = 0, 0, 0.0, 0.0
    while True:
        # The first frame loads the models.
        if frames == 1:
            began, cpu = time.perf_counter(), time.process_time()
        is_read, picture = capture.read()
        if not is_read:
            break
        found = tracker.process(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
        detector.detectMarkers(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
        seen += len(found.multi_hand_landmarks or [])
        frames += 1
    took, cpu = time.perf_counter() - began, time.process_time() - cpu
    print(json.dumps({"frames_per_s": (frames - 1) / took, "cpu_ms": 1e3 * cpu / (frames - 1), "hands_per_frame": seen / frames}))


def bare():
    """The median time of each landmark model alone on one core, in milliseconds, in the environment of the peer."""
    import numpy
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    figures = {}
    for model in MODELS:
        path = str(ROOT / f"target/runtime/hand_landmark_{model}.onnx")
        session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
        shown = {session.get_inputs()[0].name: numpy.random.default_rng(1).random((1, 224, 224, 3), numpy.float32)}
        times = []
        for _ in range(101):
            began = time.perf_counter()
            session.run(None, shown)
            times.append(1e3 * (time.perf_counter() - began))
        figures[model] = sorted(times)[50]
    print(json.dumps(figures))


def measure():
    """All figures, and the rows that are printed of them. `make line` has built the programs."""
    bare_ms = in_peers_environment("--bare")
    report, rows = {"bare_landmark_model_ms": bare_ms, "films": []}, []
    for size in SIZES:
        for hands in (1, 2):
            figures, printed = measure_films(size, hands, bare_ms)
            report["films"] += figures
            rows += printed
    report["covered"], printed = measure_covered()
    draw_frame()
    return report, rows + printed


def draw_frame():
    """Which thread does what when while a frame of median length is looked at: target/bench/frame.svg."""
    command = [RELEASE / "perception_accuracy", "profile", "--out", BENCH / "frame.svg", CLIP]
    subprocess.run(command, cwd=ROOT, check=True, stdout=sys.stderr)


def measure_films(size, hands, bare_ms):
    """The films of a size with so many hands, with each model, and the peer with its own."""
    name, films = f"{size[0]}x{size[1]}", {speed: film(size, hands, speed) for speed in ROUNDS}
    figures, rows = [], []
    for model in MODELS:
        # The default has goals.
        bar = (name, hands) if model == MODELS[0] else None
        pairs = paired(films["max"], hands, model, PAIRS if bar == RATIO_OF else 1)
        ratio, fast, python = pairs[len(pairs) // 2]
        camera = line(films["file"], hands, model, "file")
        # Each hand costs a run of its model; a palm is looked for only now and then.
        bare_hz = 1e3 / (hands * bare_ms[model])
        figures.append({"size": name, "hands": hands, "model": model, "max_speed": fast, "camera_rate": camera, "python": python,
                        "ratio_to_python": ratio, "ratios": [pair[0] for pair in pairs], "bare_models_one_core_hz": bare_hz})
        rows += rows_of(f"{name}, {hands} hand{'s' * (hands - 1)}, {model}", fast, camera, python, ratio, bare_hz, bar)
    return figures, rows


def paired(path, hands, model, times):
    """The film through the line and through the peer by turns: ratio, line and peer, in order of the ratio."""
    pairs = []
    for _ in range(times):
        fast, python = line(path, hands, model, "max"), in_peers_environment("--peer", path, hands)
        pairs.append((fast["frames_per_s"] / python["frames_per_s"], fast, python))
    return sorted(pairs, key=lambda pair: pair[0])


def measure_covered():
    """What the line loses where both hands and all markers are lost again and again."""
    lost = line(covered_film(), 2, MODELS[0], "file")
    label = "640x480, both hands and all markers lost every other second, at 30 Hz"
    return lost, [
        (f"{label}: frames lost", lost["lost"], "frames", ("at most", 0)),
        (f"{label}: frame to verdict, p99", lost["p99_ms"], "ms", None),
    ]


def rows_of(label, fast, camera, python, ratio, bare_hz, bar):
    """Rows of name, figure, unit and goal; `bar` is the key of what must be reached, if anything must."""
    is_first = bar == RATIO_OF
    goal = lambda key: ("at most", MAX[key]) if is_first else None
    minimum = MIN_RATE_HZ.get(bar)
    return [
        (f"{label}: line", fast["frames_per_s"], "frames/s", minimum and ("at least", minimum)),
        (f"{label}: models alone on one core", bare_hz, "frames/s", None),
        (f"{label}: Python mediapipe and OpenCV", python["frames_per_s"], "frames/s", None),
        (f"{label}: line / Python", ratio, "times", ("at least", MIN_RATIO) if is_first else None),
        (f"{label}: perceive at 30 Hz", camera["core_share"], "cores", goal("core_share")),
        (f"{label}: frame to verdict at 30 Hz, p50", camera["p50_ms"], "ms", goal("p50_ms")),
        (f"{label}: frame to verdict at 30 Hz, p99", camera["p99_ms"], "ms", goal("p99_ms")),
        (f"{label}: memory of perceive", camera["memory_mib"], "MiB", goal("memory_mib")),
    ]


if __name__ == "__main__":
    if sys.argv[1] == "--bare":
        bare()
    else:
        peer(sys.argv[2], int(sys.argv[3]))
