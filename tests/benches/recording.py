#!/usr/bin/env python3
"""Plays a clip at 30 Hz through a line, by turns without and with a recorder of everything, and says by how much verdicts are later.

    recording.py [--programs FOLDER] [--clip FILE] [--size WIDTHxHEIGHT] [--rounds N] [--seconds S] [--later-ms MS] [--core SHARE]

Prints the 99th percentile of the time from a frame to its verdict in both, and what the recorder takes. Exits with 1 where verdicts are later by more
than a millisecond, or the recorder takes more than a tenth of a core.
"""

import argparse
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
ROLES = ["steward", "record", "capture", "perceive", "encode", "judge", "journal"]
TICKS = os.sysconf("SC_CLK_TCK")


def station(folder, film, mode):
    """The configuration of a station that plays a film for ever."""
    shipped = (ROOT / "config/stations/film.toml").read_text()
    objects = shipped.split("[[objects]]", 1)[1].split("[plc]", 1)[0]
    path = folder / "station.toml"
    path.write_text(f"""[station]
name = "bench"
root = "{folder}"
job = "{ROOT}/config/jobs/polish-and-measure.toml"
[camera]
source = "video"
path = "{film}"
loop = true
[perception]
hands = ["right"]
models = "{ROOT}/target/runtime"
[journal]
path = "{folder}/journal.sqlite"
[record]
mode = "{mode}"
path = "{folder}/recordings"
[[objects]]{objects}""")
    return path


def processor_s(pid):
    """The time of the processor that a process has taken, in seconds."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def peak_mb(pid):
    """The most memory that a process has had, in MB."""
    line = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def latencies_ms(folder):
    """From frame to verdict, of every verdict in the journal."""
    with sqlite3.connect(folder / "journal.sqlite") as journal:
        rows = journal.execute("SELECT (sent_ns - captured_ns) / 1e6 FROM verdict WHERE captured_ns > 0")
        return [ms for (ms,) in rows]


def play(programs, film, mode, seconds):
    """A line for some seconds: the latencies of its verdicts, and the share of a core and the memory of its recorder."""
    with tempfile.TemporaryDirectory(prefix="andon-", dir="/tmp") as name:
        folder = Path(name)
        config = station(folder, film, mode)
        running = {}
        try:
            for role in ROLES:
                log = (folder / f"{role}.log").open("w")
                # As its unit has it.
                idle = ["chrt", "--idle", "0"] if role == "record" else []
                running[role] = subprocess.Popen([*idle, programs / "andond", "run", role, "-c", config], stderr=log)
                if role == "steward":
                    time.sleep(1)
            time.sleep(5)
            before = processor_s(running["record"].pid)
            time.sleep(seconds)
            share = (processor_s(running["record"].pid) - before) / seconds
            memory = peak_mb(running["record"].pid)
        finally:
            for role in [*ROLES[1:], ROLES[0]]:
                if role in running:
                    running[role].send_signal(signal.SIGTERM)
                    running[role].wait(20)
        return latencies_ms(folder), share, memory


def percentile(values, percent):
    """The value that so many percent are not above."""
    return sorted(values)[min(len(values) - 1, int(len(values) * percent / 100))]


parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
parser.add_argument("--programs", metavar="FOLDER", type=Path, default=TARGET / "release", help="where andond and andond-video are")
parser.add_argument("--clip", metavar="FILE", type=Path, default=ROOT / "tests/footage/p1_none_r1.mp4", help="the film to be played")
parser.add_argument("--size", metavar="WIDTHxHEIGHT", help="enlarge the film to this size, as 1280x720; needs ffmpeg")
parser.add_argument("--rounds", type=int, default=5, help="how often each is played [default: 5]")
parser.add_argument("--seconds", type=int, default=60, help="for how long [default: 60]")
parser.add_argument("--later-ms", metavar="MS", type=float, default=1, help="by how much verdicts may be later [default: 1]")
parser.add_argument("--core", metavar="SHARE", type=float, default=0.1, help="how much of a core the recorder may take [default: 0.1]")
arguments = parser.parse_args()
film = arguments.clip.absolute()
with tempfile.TemporaryDirectory() as folder:
    if arguments.size:
        larger = Path(folder) / "film.mkv"
        scale = f"scale={arguments.size.replace('x', ':')}"
        subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-vf", scale, "-qp", "0", larger], check=True)
        film = larger
    found = {"off": [], "always": []}
    tails, shares, memories = {"off": [], "always": []}, [], []
    for number in range(arguments.rounds):
        # By turns, and each of them first as often as the other: what else the machine does falls on both.
        for mode in sorted(found, reverse=number % 2 == 0):
            latencies, share, memory = play(arguments.programs.absolute(), film, mode, arguments.seconds)
            if not latencies:
                sys.exit("the line has judged nothing")
            found[mode] += latencies
            tails[mode].append(percentile(latencies, 99))
            if mode == "always":
                shares.append(share)
                memories.append(memory)
            print(f"{mode:6}: {len(latencies)} verdicts, p50 {percentile(latencies, 50):.2f} ms, p99 {tails[mode][-1]:.2f} ms", flush=True)
off, always = (percentile(found[mode], 99) for mode in ("off", "always"))
pairs = sorted(one - other for one, other in zip(tails["always"], tails["off"]))
print(f"| p99 from frame to verdict {off:.2f} ms without, {always:.2f} ms with; median of the pairs {pairs[len(pairs) // 2]:+.2f} ms | "
      f"the recorder takes {100 * max(shares):.1f} % of a core and {max(memories):.0f} MB at most |")
if pairs[len(pairs) // 2] > arguments.later_ms or max(shares) > arguments.core:
    sys.exit(f"more than {arguments.later_ms:g} ms later, or more than {100 * arguments.core:g} % of a core")
