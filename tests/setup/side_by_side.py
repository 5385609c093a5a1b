#!/usr/bin/env python3
"""Runs the test programs of `cargo test`, several side by side: most of them wait for longer than they compute, and Cargo
itself runs one after the other.

    side_by_side.py [--times PAGE] [ARGUMENT OF CARGO TEST...]

Tests that work by chance take their draw from ANDON_SEED and PROPTEST_RNG_SEED. Where these are not set, one number is drawn
for both, so that each run tries something new, and is printed, so that a run can be repeated.

Prints what a program that has failed said, and at the end which ones took longest; with --times it writes that to a page as
well. Exit codes: 0 all well, 1 a test has failed or does not compile.
"""

import json
import os
import platform
import random
import shlex
import subprocess
import sys
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path

PROCESSORS = os.cpu_count() or 1
# A line of programs waits for others in most of its time. But more of them would make a machine so busy that they wait in vain.
PROGRAMS = 2 + PROCESSORS
# The page that says what each program took. Those that took longest begin first: at the end nothing else is left to run beside them. What computes
# begins beside what waits: three that compute on two processors take more than twice as long as one after the other.
TIMES = Path(__file__).parents[1] / "TIMES.md"
# The camera's library plays a recording by the clock and pairs pictures by when they come: beside others it loses some. Nothing waits for the role
# `record`: beside others it loses pictures, and its tests are about what is in them.
ALONE = ["recording", "line_record_tools"]
# What tests that work by chance take their draw from, and the first number that is not drawn: people can type those below it.
SEEDS = ["ANDON_SEED", "PROPTEST_RNG_SEED"]
MAX_SEED = 100_000
# Programs that take less than this, in seconds, share one row of the page.
SHORT_S = 2.0


def draw_seed():
    """Draws a seed for all programs unless there is one. The words that repeat the run."""
    drawn = str(random.randrange(MAX_SEED))
    for name in SEEDS:
        os.environ.setdefault(name, drawn)
    return " ".join(f"{name}={os.environ[name]}" for name in SEEDS)


def programs(arguments):
    """Builds the tests. Name, folder and path of each program that `cargo test` with these arguments would run."""
    cargo = ["cargo", "test", *arguments, "--no-run", "--message-format=json-render-diagnostics"]
    built = subprocess.run(cargo, stdout=subprocess.PIPE, text=True)
    if built.returncode:
        sys.exit(1)
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    tests = [said for said in messages if said.get("executable") and said["profile"]["test"]]
    return [(said["target"]["name"], Path(said["manifest_path"]).parent, said["executable"]) for said in tests]


def known_times():
    """What each program took, by the page: seconds by the clock, and of a processor."""
    rows = (line.split("|") for line in TIMES.read_text().splitlines() if line.startswith("| "))
    known = ((name.strip(), took, computed) for _, name, took, computed, *_ in rows if took.strip().isdigit())
    return {name: (float(took), float(computed)) for name, took, computed in known}


def side_by_side(found):
    """Runs the programs, as many at a time as the processors bear. What each took, in the order in which they ended."""
    known = known_times()
    waiting = sorted(found, key=lambda program: (-known.get(program[0], (0, 0))[0], program))
    ran, running = [], {}
    with ThreadPoolExecutor(PROGRAMS) as beside:
        while waiting or running:
            for program in list(waiting):
                took, computed = known.get(program[0], (0, 0))
                # What is not known takes a moment.
                load = computed / took if took else 0
                if len(running) < PROGRAMS and (not running or sum(running.values()) + load <= PROCESSORS):
                    waiting.remove(program)
                    running[beside.submit(run, program)] = load
            for ended in wait(running, return_when=FIRST_COMPLETED).done:
                del running[ended]
                ran.append(ended.result())
    return ran


def run(program):
    """What a program took, in seconds by the clock and of a processor; its name; and whether all is well."""
    name, folder, path = program
    began = time.monotonic()
    started = subprocess.Popen([path], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = started.stdout.read()
    # With what its own processes took, as those of a line, as far as it waited for them.
    _, status, used = os.wait4(started.pid, 0)
    started.returncode = os.waitstatus_to_exitcode(status)
    took, computed = time.monotonic() - began, used.ru_utime + used.ru_stime
    is_well = started.returncode == 0
    print(f"{'ok    ' if is_well else 'FAILED'} {took:6.1f} s  {name}", flush=True)
    if not is_well:
        print(said, flush=True)
    return took, computed, name, is_well


def times(ran, total_s):
    """The page of what each program took: no promise, but a place to look for what has become slow."""
    longest = sorted(ran, reverse=True)
    rows = [(name, took, computed) for took, computed, name, _ in longest if took >= SHORT_S]
    others = [(took, computed) for took, computed, _, _ in longest if took < SHORT_S]
    if others:
        rows.append((f"{len(others)} others", sum(took for took, _ in others), sum(computed for _, computed in others)))
    lines = [f"| {name} | {took:.0f} | {computed:.0f} |" for name, took, computed in rows]
    head = f"""# What each test program takes

`make test-times` writes this page. It is from one run on one machine ({PROCESSORS} processors, {platform.machine()}), with up to
{PROGRAMS} programs side by side. Compare rows of one page with each other, or two pages of one machine. *Seconds* are by the clock,
beside the others; *processor* is what the program and the processes that it waited for computed. All together: {total_s:.0f} s.

| program | seconds | processor |
|---|---|---|
"""
    return head + "\n".join(lines) + "\n"


def main():
    arguments, page = sys.argv[1:], None
    if arguments[:1] == ["--times"]:
        page, arguments = Path(arguments[1]), arguments[2:]
    seeds = draw_seed()
    repeat = f"{seeds} {shlex.join([sys.argv[0], *arguments])}"
    print(f"the draw of this run: {seeds}", flush=True)
    began = time.monotonic()
    found = programs(arguments)
    ran = [run(program) for program in found if program[0] in ALONE]
    ran += side_by_side([program for program in found if program[0] not in ALONE])
    total_s = time.monotonic() - began
    longest = ", ".join(f"{name} {took:.0f} s" for took, _, name, _ in sorted(ran, reverse=True)[:15])
    failed = [name for _, _, name, is_well in ran if not is_well]
    print(f"{len(ran)} programs in {total_s:.0f} s; longest: {longest}")
    print(f"to repeat this draw: {repeat}")
    # What a failed program takes is how long it waited in vain.
    if page and not failed:
        page.write_text(times(ran, total_s))
    sys.exit(f"failed: {', '.join(failed)}; the draw was {seeds}" if failed else 0)


if __name__ == "__main__":
    main()
