#!/usr/bin/env python3
"""Plays a clip at 30 Hz through a line, by turns without and with a recorder of everything, and says by how much the line is later.

    recording.py [--programs FOLDER] [--clip FILE] [--size WIDTHxHEIGHT] [--rounds N] [--seconds S] [--later-ms MS] [--core SHARE] [--seed N]

Each frame is measured, from its capture to the couples that the judge gets of it: a film gives thousands of frames and some ten verdicts a minute, and of
so few the 99th percentile is the largest. By how much the 99th percentile of the frames is later with the recorder is the median of the pairs of runs. Its
interval of 95 % is drawn from pairs, and in each run from whole seconds, because frames that follow each other are alike. Verdicts are told beside it.

Exits with 0 where the whole interval is at most `--later-ms`, with 1 where it is above that or the recorder takes more than `--core`, and with 2 where
more rounds must decide.
"""

import argparse
import random
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

from playing import RATE_HZ, ROOT, TARGET, frames_ms, percentile, processor_s, running, station

ROLES = ["steward", "record", "capture", "perceive", "encode", "judge", "journal"]
# How often the interval draws.
DRAWS = 2000


def peak_mb(pid):
    """The most memory that a process has had, in MB."""
    line = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def verdicts_ms(folder):
    """From frame to verdict, of every verdict in the journal."""
    with sqlite3.connect(folder / "journal.sqlite") as journal:
        rows = journal.execute("SELECT (sent_ns - captured_ns) / 1e6 FROM verdict WHERE captured_ns > 0")
        return [ms for (ms,) in rows]


def play(programs, film, mode, seconds):
    """A line for some seconds: the latencies of its frames and of its verdicts, and the share of a core and the memory of its recorder."""
    with tempfile.TemporaryDirectory(prefix="andon-", dir="/tmp") as name:
        folder = Path(name)
        config = station(folder, film, f'[record]\nmode = "{mode}"\npath = "{folder}/recordings"')
        with running(programs, folder, config, ROLES) as roles:
            before = processor_s(roles["record"].pid)
            frames = frames_ms(programs, config, seconds)
            share = (processor_s(roles["record"].pid) - before) / seconds
            memory = peak_mb(roles["record"].pid)
        return frames, verdicts_ms(folder), share, memory


def seconds_of(frames):
    """A run as its seconds."""
    return [frames[begin:begin + RATE_HZ] for begin in range(0, len(frames), RATE_HZ)]


def later_ms(pairs):
    """By how much the 99th percentile is later in the second run of each pair: the median of the pairs."""
    later = sorted(percentile(always, 99) - percentile(off, 99) for off, always in pairs)
    middle = len(later) // 2
    return later[middle] if len(later) % 2 else (later[middle - 1] + later[middle]) / 2


def interval_ms(pairs, random_):
    """The interval of 95 % of that, by drawing pairs and seconds again."""
    runs = [(seconds_of(off), seconds_of(always)) for off, always in pairs]

    def again(run):
        return [ms for second in random_.choices(run, k=len(run)) for ms in second]

    drawn = sorted(later_ms([tuple(map(again, pair)) for pair in random_.choices(runs, k=len(runs))]) for _ in range(DRAWS))
    return drawn[int(0.025 * DRAWS)], drawn[int(0.975 * DRAWS) - 1]


parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
parser.add_argument("--programs", metavar="FOLDER", type=Path, default=TARGET / "release", help="where andond and andond-video are")
parser.add_argument("--clip", metavar="FILE", type=Path, default=ROOT / "tests/footage/p1_none_r1.mp4", help="the film to be played")
parser.add_argument("--size", metavar="WIDTHxHEIGHT", help="enlarge the film to this size, as 1280x720; needs ffmpeg")
parser.add_argument("--rounds", type=int, default=5, help="how often each is played [default: 5]")
parser.add_argument("--seconds", type=int, default=60, help="for how long [default: 60]")
parser.add_argument("--later-ms", metavar="MS", type=float, default=1, help="by how much frames may be later [default: 1]")
parser.add_argument("--core", metavar="SHARE", type=float, default=0.1, help="how much of a core the recorder may take [default: 0.1]")
parser.add_argument("--seed", type=int, default=random.randrange(1, 100_000), help="what the interval is drawn from [default: drawn]")
arguments = parser.parse_args()
film = arguments.clip.absolute()
with tempfile.TemporaryDirectory() as folder:
    if arguments.size:
        larger = Path(folder) / "film.mkv"
        scale = f"scale={arguments.size.replace('x', ':')}"
        subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-vf", scale, "-qp", "0", larger], check=True)
        film = larger
    runs, verdicts, shares, memories = {"off": [], "always": []}, {"off": [], "always": []}, [], []
    for number in range(arguments.rounds):
        # By turns, and each of them first as often as the other: what else the machine does falls on both.
        for mode in sorted(runs, reverse=number % 2 == 0):
            frames, judged, share, memory = play(arguments.programs.absolute(), film, mode, arguments.seconds)
            if not frames or not judged:
                sys.exit("the line has judged nothing")
            runs[mode].append(frames)
            verdicts[mode] += judged
            if mode == "always":
                shares.append(share)
                memories.append(memory)
            print(f"{mode:6}: {len(frames)} frames, p50 {percentile(frames, 50):.2f} ms, p99 {percentile(frames, 99):.2f} ms; "
                  f"{len(judged)} verdicts, p50 {percentile(judged, 50):.2f} ms", flush=True)
pairs = list(zip(runs["off"], runs["always"]))
count = min(sum(map(len, runs[mode])) for mode in runs)
later, (low, high) = later_ms(pairs), interval_ms(pairs, random.Random(arguments.seed))
print(f"seed {arguments.seed}\n| {len(pairs)} pairs of {arguments.seconds} s | {count:,} frames each | p99 {later:+.2f} ms in the median of the pairs, "
      f"{low:+.2f} to {high:+.2f} (95 %); {100 * max(shares):.1f} % of a core, {max(memories):.0f} MB |")
for mode in runs:
    judged = verdicts[mode]
    print(f"verdicts, {mode}: {len(judged)}, p50 {percentile(judged, 50):.2f} ms, the latest {max(judged):.2f} ms")
if low > arguments.later_ms or max(shares) > arguments.core:
    sys.exit(f"more than {arguments.later_ms:g} ms later, or more than {100 * arguments.core:g} % of a core")
if high > arguments.later_ms:
    print(f"whether that is more than {arguments.later_ms:g} ms, more rounds must decide")
    sys.exit(2)
