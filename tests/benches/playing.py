"""A line that plays a film for ever, for the measurements beside this file."""

import os
import signal
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
TICKS = os.sysconf("SC_CLK_TCK")
RATE_HZ = 30


def station(folder, film, more):
    """The configuration of a station that plays a film for ever, and has these sections as well."""
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
{more}
[[objects]]{objects}""")
    return path


@contextmanager
def running(programs, folder, config, roles):
    """The processes of these roles, by name. The first is the steward, which cleans up after the others."""
    processes = {}
    try:
        for role in roles:
            log = (folder / f"{role}.log").open("w")
            # As its unit has it.
            idle = ["chrt", "--idle", "0"] if role == "record" else []
            processes[role] = subprocess.Popen([*idle, programs / "andond", "run", role, "-c", config], stderr=log)
            if role == roles[0]:
                time.sleep(1)
        time.sleep(5)
        yield processes
    finally:
        for role in [*roles[1:], roles[0]]:
            if role in processes:
                processes[role].send_signal(signal.SIGTERM)
                processes[role].wait(20)


def frames_ms(programs, config, seconds):
    """How long each frame took that was looked at in so many seconds, in milliseconds."""
    listened = subprocess.run([programs / "latencies", config, str(seconds)], stdout=subprocess.PIPE, text=True, check=True)
    return [float(ms) for ms in listened.stdout.split()]


def processor_s(pid):
    """The time of the processor that a process has taken, in seconds."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def percentile(values, percent):
    """The value that so many percent are not above."""
    return sorted(values)[min(len(values) - 1, int(len(values) * percent / 100))]
