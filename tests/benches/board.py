#!/usr/bin/env python3
"""Plays a clip at 30 Hz through a line with a board, and says what the browsers that look at it cost, over TLS.

    board.py [--programs FOLDER] [--clip FILE] [--browsers N] [--seconds S] [--rounds N] [--core SHARE]

Each browser does what the scripts of the pages do: it watches its page, and on the technician's asks for the next picture 150 ms after it has had one,
each over a connection of its own. All of them run here as well, so the line has less of the machine than it would have: what it misses is the worst case.
Rows are nobody, workers' pages and technicians' pages, by turns.

Exits with 1 where the board takes more than `--core`, or the line looks at fewer frames than beside nobody.
"""

import argparse
import http.client
import ssl
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from playing import RATE_HZ, ROOT, TARGET, frames_ms, percentile, processor_s, running, station

ROLES = ["steward", "capture", "perceive", "encode", "judge", "journal", "board"]
PORT = 19_465
# As the script of the page has it.
PICTURE_S = 0.15
# Of a thousand frames one may be missed without any browser; and a time begins and ends between two frames.
LEEWAY = 0.001
ENDS = 2


def context():
    """A client of TLS that trusts the certificate that was made for this run, and none by name."""
    made = ssl.create_default_context()
    made.check_hostname, made.verify_mode = False, ssl.CERT_NONE
    return made


class Browser:
    """One that looks at a page until it is told to stop."""

    def __init__(self, page, number, is_over):
        self.page, self.number, self.is_over = page, number, is_over
        self.messages, self.pictures, self.bytes = 0, 0, 0
        self.tls = context()
        looks = [self.watch] + ([self.see] if page == "technician" else [])
        self.threads = [threading.Thread(target=self.until_over, args=[look], daemon=True) for look in looks]
        for thread in self.threads:
            thread.start()

    def until_over(self, look):
        try:
            look()
        except (http.client.HTTPException, OSError):
            # The board goes with its line.
            if not self.is_over.is_set():
                raise

    def get(self, target):
        client = http.client.HTTPSConnection("localhost", PORT, timeout=20, context=self.tls)
        client.request("GET", target)
        answer = client.getresponse()
        assert answer.status == 200, f"{target}: {answer.status} {answer.read()}"
        return client, answer

    def watch(self):
        client, answer = self.get(f"/events?view={self.page}&browser=b{self.number}")
        while not self.is_over.is_set():
            line = answer.readline()
            assert line or self.is_over.is_set(), "the board has ended the feed"
            self.bytes += len(line)
            self.messages += line.startswith(b"event: show")
        client.close()

    def see(self):
        while not self.is_over.is_set():
            client, answer = self.get(f"/picture.svg?lang=&picture={self.pictures}")
            picture = answer.read()
            client.close()
            # Where no frame comes there is none, and nothing stands for it.
            self.pictures += picture.endswith(b"</svg>")
            self.bytes += len(picture)
            time.sleep(PICTURE_S)


def play(programs, film, page, count, seconds):
    """A line for some seconds beside these browsers: its frames, the share of a core of its board, and what each browser got in a second."""
    with tempfile.TemporaryDirectory(prefix="andon-", dir="/tmp") as name:
        folder = Path(name)
        board = f"""[board]
enable = true
port = {PORT}
certificate = "{folder}/board.pem"
key = "{folder}/board.key"
logins = "{folder}/logins.toml\""""
        config = station(folder, film, board)
        subprocess.run([programs / "andond", "board", "certificate", "-c", config], check=True, stdout=subprocess.DEVNULL)
        with running(programs, folder, config, ROLES) as roles:
            is_over = threading.Event()
            browsers = [Browser(page, number, is_over) for number in range(count)]
            time.sleep(2)
            def so_far():
                return [time.monotonic(), processor_s(roles["board"].pid), sum(browser.pictures for browser in browsers),
                        sum(browser.bytes for browser in browsers)]
            before = so_far()
            frames = frames_ms(programs, config, seconds)
            lasted, processor, pictures, size = (after - then for after, then in zip(so_far(), before))
            assert all(thread.is_alive() for browser in browsers for thread in browser.threads), "a browser has ended"
            is_over.set()
    return frames, processor / lasted, pictures / lasted / max(1, count), size / lasted / max(1, count)


parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
parser.add_argument("--programs", metavar="FOLDER", type=Path, default=TARGET / "release", help="where andond and andond-video are")
parser.add_argument("--clip", metavar="FILE", type=Path, default=ROOT / "tests/footage/p1_J1_r1.mp4", help="the film to be played")
parser.add_argument("--browsers", type=int, default=20, help="how many look at once [default: 20]")
parser.add_argument("--rounds", type=int, default=3, help="how often each is played [default: 3]")
parser.add_argument("--seconds", type=int, default=30, help="for how long [default: 30]")
parser.add_argument("--core", metavar="SHARE", type=float, default=0.15, help="how much of a core the board may take [default: 0.15]")
arguments = parser.parse_args()
rows = {"nobody": ("worker", 0), "workers": ("worker", arguments.browsers), "technicians": ("technician", arguments.browsers)}
seen, shares = {row: [] for row in rows}, {row: [] for row in rows}
for _ in range(arguments.rounds):
    for row, (page, count) in rows.items():
        frames, share, pictures, size = play(arguments.programs.absolute(), arguments.clip.absolute(), page, count, arguments.seconds)
        if not frames:
            sys.exit("the line has looked at nothing")
        seen[row].append(len(frames) / (RATE_HZ * arguments.seconds))
        shares[row].append(share)
        print(f"{count:2} {row:11}: board {100 * share:5.1f} % of a core; {len(frames)} of {RATE_HZ * arguments.seconds} frames, p50 "
              f"{percentile(frames, 50):.2f} ms, p99 {percentile(frames, 99):.2f} ms; each browser {pictures:.1f} pictures/s, {size / 1e3:.0f} kB/s",
              flush=True)
most = max(shares["technicians"])
print(f"| {arguments.browsers} browsers with pictures | {arguments.rounds} runs of {arguments.seconds} s | board {100 * statistics.median(shares['technicians']):.1f} % "
      f"of a core in the median, {100 * most:.1f} % at most; {100 * statistics.median(seen['technicians']):.1f} % of the frames looked at, "
      f"{100 * statistics.median(seen['nobody']):.1f} % beside nobody |")
if most > arguments.core:
    sys.exit(f"more than {100 * arguments.core:g} % of a core")
if statistics.median(seen["technicians"]) < statistics.median(seen["nobody"]) - max(LEEWAY, ENDS / (RATE_HZ * arguments.seconds)):
    sys.exit("frames were missed")
