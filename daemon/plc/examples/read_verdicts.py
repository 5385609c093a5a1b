#!/usr/bin/env python3
"""Reads Andon's verdicts in Python, on the same machine: pip install iceoryx2==0.10.0

    read_verdicts.py STATION [--root DIR] [--count N]

Prints one JSON object per line. Run it as the user that Andon runs as: shared memory belongs to one user.
The wheel must have this version, and Andon must be the build that this file belongs to (LAYOUT).
"""

import argparse
import ctypes
import fcntl
import json
import sys
import time

import iceoryx2 as iox2

# The layout of `Verdict` and of the events in this build of Andon; a test compares it.
LAYOUT = "7058ec88565c1b7e/2"
# The longest time for a station to start, in seconds.
PATIENCE_S = 20
# The longest wait for an event, in ms. The queue is read after it in any case.
WAIT_MS = 250
# Event numbers of a writer that has left or died.
GONE, DEAD = 2, 3

LEVELS = {1: "iu", 2: "activity", 3: "job"}
OUTCOMES = {1: "ok", 2: "anomaly", 3: "not_judged"}
REASONS = ["None", "WrongObject", "WrongOrder", "Motion", "TooShort", "TooLong", "NotCompleted", "Unknown", "Blind",
           "Overload", "HandNotSeen", "ObjectNotSeen", "BeginningNotSeen", "BrokenOff", "FramesMissing", "TooFewFrames", "Passing",
           "MarkerTwice"]
NOTES = [None, "Order", "Again", "OtherHand", "Step"]
MEASURES = [None, ("Duration", "s"), ("Strokes", "strokes"), ("StrokeLength", "m"), ("Path", "m"), ("Direction", "degrees"),
            ("Place", "m"), ("LateralDeviation", "m")]


class Verdict(ctypes.Structure):
    """`shm_schemas::Verdict`, 192 bytes."""

    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("epoch", ctypes.c_uint64),
        ("frame_seq", ctypes.c_uint64),
        ("captured_ns", ctypes.c_uint64),
        ("sent_ns", ctypes.c_uint64),
        ("model_hash", ctypes.c_uint64),
        ("began_ns", ctypes.c_uint64),
        ("ended_ns", ctypes.c_uint64),
        ("decided_ns", ctypes.c_uint64),
        ("decided_utc_ns", ctypes.c_uint64),
        ("job_id", ctypes.c_uint32),
        ("distance", ctypes.c_float),
        ("threshold", ctypes.c_float),
        ("measured", ctypes.c_float),
        ("shown_min", ctypes.c_float),
        ("shown_max", ctypes.c_float),
        ("missing_s", ctypes.c_float),
        ("x_c", ctypes.c_uint16 * 4),
        ("activity", ctypes.c_uint16),
        ("iu", ctypes.c_uint16),
        ("nearest", ctypes.c_uint16),
        ("broken_activity", ctypes.c_uint16),
        ("broken_runs", ctypes.c_uint16),
        ("missing_object", ctypes.c_uint16),
        ("level", ctypes.c_uint8),
        ("outcome", ctypes.c_uint8),
        ("reason", ctypes.c_uint8),
        ("hand", ctypes.c_uint8),
        ("early", ctypes.c_uint8),
        ("station", ctypes.c_char * 16),
        ("part", ctypes.c_char * 32),
        ("captured_percent", ctypes.c_uint8),
        ("seen_percent", ctypes.c_uint8),
        ("missing_percent", ctypes.c_uint8),
        ("needed_percent", ctypes.c_uint8),
        ("missing_hand", ctypes.c_uint8),
        ("note", ctypes.c_uint8),
        ("broken", ctypes.c_uint8),
        ("measure", ctypes.c_uint8),
        ("reserved", ctypes.c_uint8 * 3),
    ]

    @staticmethod
    def type_name():
        return "andon.Verdict"


def shm_prefix(station, root):
    """The prefix of the names of the station's shared memory; it contains FNV-1a of the root."""
    folded = 0x811C9DC5
    for byte in root.encode():
        folded = (folded ^ byte) * 0x01000193 & 0xFFFFFFFF
    return f"andon_{station}_{folded:08x}_"


def open_station(station, root):
    """Opens the verdict channel, and waits for a steward that is still starting. Creates no service."""
    config = iox2.config.default()
    config.global_cfg.root_path = iox2.Path.new(root)
    config.global_cfg.prefix = iox2.FileName.new(shm_prefix(station, root))
    # Only the steward cleans up.
    config.global_cfg.service.cleanup_dead_nodes_on_open = False
    config.global_cfg.node.cleanup_dead_nodes_on_creation = False
    config.global_cfg.node.cleanup_dead_nodes_on_destruction = False
    node = iox2.NodeBuilder.new().name(iox2.NodeName.new("python")).config(config).create(iox2.ServiceType.Ipc)
    build = iox2.AttributeVerifier.new().require(iox2.AttributeKey.new("andon.layout"), iox2.AttributeValue.new(LAYOUT))
    name = f"andon/{station}/verdict"
    until = time.monotonic() + PATIENCE_S
    while True:
        try:
            verdicts = node.service_builder(iox2.ServiceName.new(name)).publish_subscribe(Verdict)
            verdicts = verdicts.open_with_attributes(build)
            forward = node.service_builder(iox2.ServiceName.new(name)).event().open()
            back = node.service_builder(iox2.ServiceName.new(name + "/back")).event().open()
            return node, verdicts, forward, back
        except (iox2.PublishSubscribeOpenError, iox2.EventOpenError) as error:
            if time.monotonic() > until:
                sys.exit(f"cannot read verdicts of {station}: {error}; does its steward run, and is it of this build?")
            time.sleep(0.05)


def measures(verdict):
    """The measure that is out of its bounds, beside what was shown; None where none is."""
    known = MEASURES[verdict.measure] if verdict.measure < len(MEASURES) else None
    if known is None:
        return None
    shown = [verdict.shown_min, verdict.shown_max]
    return {"measure": known[0], "unit": known[1], "value": verdict.measured, "shown": shown}


def as_dict(verdict):
    number = lambda value: None if value != value else value  # NaN
    index = lambda value: None if value == 0xFFFF else value
    return {
        "seq": verdict.seq,
        "level": LEVELS.get(verdict.level),
        "outcome": OUTCOMES.get(verdict.outcome, "not_judged"),
        "reason": REASONS[verdict.reason] if verdict.reason < len(REASONS) else "Unknown",
        "hand": {1: "right", 2: "left"}.get(verdict.hand),
        "activity": index(verdict.activity),
        "iu": index(verdict.iu),
        "context": list(verdict.x_c),
        "distance": number(verdict.distance),
        "threshold": number(verdict.threshold),
        "nearest": index(verdict.nearest),
        "measures": measures(verdict),
        "note": NOTES[verdict.note] if verdict.note < len(NOTES) else None,
        "early": bool(verdict.early),
        "part": verdict.part.decode("ascii") or None,
        "latency_us": (time.clock_gettime_ns(time.CLOCK_MONOTONIC) - verdict.sent_ns) / 1000,
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("station")
    arguments.add_argument("--root", help="the station's directory (default /run/andon/STATION)")
    arguments.add_argument("--count", type=int, default=0, help="end after this many verdicts")
    arguments = arguments.parse_args()
    root = arguments.root or f"/run/andon/{arguments.station}"

    iox2.set_log_level(iox2.LogLevel.Error)
    # While this lock is held, nobody takes the station for an abandoned one.
    members = open(f"{root}/members.lock", "a")
    fcntl.flock(members, fcntl.LOCK_SH)
    node, verdicts, forward, back = open_station(arguments.station, root)
    # The listener comes first, so that it hears of everything that is sent from now on. The notifier comes last, because it
    # announces this reader to the writer.
    listener = forward.listener_builder().create()
    subscriber = verdicts.subscriber_builder().create()
    notifier = back.notifier_builder().create()
    print("open", flush=True)

    received, newest = 0, {}
    while not arguments.count or received < arguments.count:
        for event in listener.timed_wait(iox2.Duration.from_millis(WAIT_MS)) or []:
            if event.id.as_value in (GONE, DEAD):
                print("judge gone", file=sys.stderr, flush=True)
        while (sample := subscriber.receive()) is not None:
            verdict = sample.payload().contents
            # A reader that starts while the writer sends may get the same message from the history and from the queue.
            if verdict.seq > newest.get(verdict.epoch, 0):
                newest[verdict.epoch] = verdict.seq
                received += 1
                print(json.dumps(as_dict(verdict)), flush=True)
            sample.delete()


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
