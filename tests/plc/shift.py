#!/usr/bin/env python3
"""A simulated PLC: runs `daemon/plc/andon.st` against a station, with pymodbus, and a cell around it.

    shift.py PORT MEMORY JOBS

MEMORY is the controller's retained memory, with the account of every result; the program may be killed at any time, and goes on
from it. JOBS are the numbers of the jobs that the parts take in turn, such as 1,2. It ends when a line comes on its standard
input, once the line watches no more and everything was acknowledged.
"""

import json
import os
import pathlib
import select
import sys
import time

from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ModbusException

from structured_text import FunctionBlock

PROGRAM = pathlib.Path(__file__).parent / "../../daemon/plc/andon.st"
CYCLE_S = 0.02
# The part lies there for a moment before the next one comes.
OUT_CYCLES = 3
# After the end of the shift nothing more has come for this long.
QUIET_CYCLES = 100


def words(text):
    padded = text.encode("ascii").ljust(32, b"\0")
    return [padded[at] << 8 | padded[at + 1] for at in range(0, 32, 2)]


def text(registers):
    both = b"".join(bytes((word >> 8, word & 255)) for word in registers)
    return both.rstrip(b"\0").decode("ascii")


def number(registers):
    value = 0
    for word in registers:
        value = value << 16 | word
    return value


class Memory:
    """Retained variables and the account, one JSON line a change: a line that was cut off by a kill never counted."""

    def __init__(self, path):
        self.newest = None
        lines = pathlib.Path(path).read_text().splitlines() if os.path.exists(path) else []
        for line in lines:
            try:
                self.newest = json.loads(line)["retained"]
            except ValueError:
                continue
        self.file = open(path, "a")
        if lines:
            self.file.write("\n")

    def keep(self, retained, result):
        if retained == self.newest and result is None:
            return
        line = {"at_ns": time.monotonic_ns(), "retained": retained, "result": result}
        self.file.write(json.dumps(line) + "\n")
        self.file.flush()
        os.fsync(self.file.fileno())
        self.newest = json.loads(json.dumps(retained))


class Line:
    """The two requests of every cycle."""

    def __init__(self, port):
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=1, retries=0)
        self.registers, self.works = [0] * 100, False

    def read(self):
        self.exchange(lambda: self.client.read_holding_registers(0, count=100))

    def write(self, control):
        self.exchange(lambda: self.client.write_registers(100, control))

    def exchange(self, request):
        try:
            if not self.client.connected and not self.client.connect():
                raise ModbusException("nobody listens")
            answer = request()
            if answer.isError():
                raise ModbusException(str(answer))
            self.registers = getattr(answer, "registers", None) or self.registers
            self.works = True
        except (ModbusException, OSError):
            self.client.close()
            self.works = False


def main():
    port, memory_path, jobs = int(sys.argv[1]), sys.argv[2], [int(job) for job in sys.argv[3].split(",")]
    block, memory, line = FunctionBlock(PROGRAM.read_text()), Memory(memory_path), Line(port)
    of, cell = block.of, {"part": 1, "out": 0}
    if memory.newest:
        cell = memory.newest["cell"]
        of.update({name: memory.newest[name] for name in block.retained})
    is_over, quiet, began = False, 0, time.monotonic()
    print("runs", flush=True)
    while quiet < QUIET_CYCLES:
        is_over = is_over or bool(select.select([sys.stdin], [], [], 0)[0])
        line.read()
        of["regs"] = list(line.registers)
        of["exchanged"] = line.works
        of["nowMs"] = int((time.monotonic() - began) * 1000) & 0xFFFFFFFF
        of["automatic"] = not is_over
        of["wantedJob"] = jobs[cell["part"] % len(jobs)]
        of["partIn"] = cell["out"] == 0
        of["partId"] = words(f"SHIFT-{cell['part']:04}")
        of["acceptError"] = of["lineError"] != 0
        block.call()

        # The cell: the part goes when it has its result, and the next one comes a moment later.
        if cell["out"] > 0:
            cell["out"] -= 1
            cell["part"] += cell["out"] == 0
        elif of["partDone"]:
            cell["out"] = OUT_CYCLES
        result = None
        if of["newResult"]:
            result = {
                "sequence": of["resultSequence"],
                "epoch": number(of["regs"][38:42]),
                "seq": number(of["regs"][42:46]),
                "level": {1: "iu", 2: "activity", 3: "job"}[of["resultLevel"]],
                "outcome": "ok" if of["resultOk"] else "anomaly" if of["resultNok"] else "not_judged",
                "part": text(of["resultPart"]),
            }
        memory.keep({"cell": cell, **{name: of[name] for name in block.retained}}, result)
        line.write(of["control"])
        status, queued = of["regs"][0], of["regs"][8]
        quiet = quiet + 1 if is_over and line.works and status & 0x0A == 0 and queued == 0 else 0
        time.sleep(CYCLE_S)
    print("over", json.dumps({name: of[name] for name in ("counted", "missed", "lastSequence")}), flush=True)


if __name__ == "__main__":
    main()
