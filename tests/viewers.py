#!/usr/bin/env python3
"""Opens recordings as other programs do: with the Python package `mcap`, and with Rerun's own loader where it is installed.

    viewers.py RECORDING.mcap... [--expect TOPIC...] [--rerun]

Needs `pip install mcap mcap-protobuf-support`, and `pip install rerun-sdk` for the second, which `--rerun` insists on. Exits with 1 where something
is not as it should be, or a topic that is expected has no message that can be decoded.
"""

import argparse
import collections
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

SCHEMAS = {"/camera": "foxglove.CompressedImage", "/log": "foxglove.Log",
           "/distance_over_threshold": "andon.Number", "/measure": "andon.Number"}


def check_mcap(path, expected):
    """What the package `mcap` finds in a recording: messages by topic, attachments. Everything that viewers show is decoded."""
    counts, shown = collections.Counter(), collections.Counter()
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        summary = reader.get_summary()
        assert summary and summary.statistics, f"{path} has no index"
        attachments = [attachment.name for attachment in reader.iter_attachments()]
        for schema, channel, message in reader.iter_messages():
            counts[channel.topic] += 1
            assert SCHEMAS.get(channel.topic, schema.name) == schema.name, (channel.topic, schema.name)
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=list(SCHEMAS)):
            assert decoded.timestamp.ToNanoseconds() > 0, channel.topic
            shown[channel.topic] += 1
            if SCHEMAS[channel.topic] == "andon.Number":
                assert decoded.name and math.isfinite(decoded.value), f"{channel.topic}: no number"
            if channel.topic == "/camera":
                assert decoded.format == "jpeg" and decoded.data.startswith(b"\xff\xd8"), "no JPEG"
                # The picture's own time is that of the message.
                assert abs(decoded.timestamp.ToNanoseconds() - message.log_time) < 100_000_000
            if channel.topic == "/log":
                assert decoded.message, "a sentence without words"
    assert "configuration.toml" in attachments, attachments
    assert counts["/raw/detections"] > 0, counts
    assert summary.statistics.message_count == sum(counts.values())
    missing = [topic for topic in expected if shown[topic] == 0]
    assert not missing, f"nothing on {', '.join(missing)}"
    print(f"{path.name}: {sum(counts.values())} messages, {shown['/camera']} pictures, attachments {', '.join(attachments)}")


def check_rerun(path, is_needed):
    """Whether Rerun's own loader takes a recording, and how much comes out of it."""
    # Also where this Python has it, and the shell does not know.
    rerun = shutil.which("rerun") or shutil.which("rerun", path=Path(sys.executable).parent)
    if rerun is None:
        assert not is_needed, "Rerun is not installed (pip install rerun-sdk)"
        print(f"{path.name}: Rerun is not installed (pip install rerun-sdk); left out")
        return
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.rrd"
        done = subprocess.run([rerun, "mcap", "convert", path, "-o", out], capture_output=True, text=True, timeout=600)
        assert done.returncode == 0 and out.stat().st_size > 0, done.stderr
        print(f"{path.name}: Rerun's loader makes {out.stat().st_size / 1e6:.1f} MB of it")


parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
parser.add_argument("recordings", metavar="RECORDING", nargs="+", type=Path)
parser.add_argument("--expect", metavar="TOPIC", nargs="+", default=[], choices=SCHEMAS, help="topics that must have messages")
parser.add_argument("--rerun", action="store_true", help="it is a fault that Rerun is not installed")
arguments = parser.parse_args()
for recording in arguments.recordings:
    try:
        check_mcap(recording, arguments.expect)
        check_rerun(recording, arguments.rerun)
    except AssertionError as error:
        sys.exit(f"{recording}: {error}")
