"""A machine that boots systemd in a container of its own: an overlay of the base, without a network."""

import json
import os
import shutil
import subprocess
import time
from pathlib import Path

from base import Unusable

# A bare system boots in 2 to 5 s; a busy machine takes longer.
BOOT_S = 90
# Roles get 5 s to stop, the rest of the system less.
POWER_OFF_S = 60


class Machine:
    """Boots on entry, is gone without a trace on exit."""

    def __init__(self, base, folder):
        self.base, self.folder = base, folder
        self.root = folder / "root"
        self.nspawn = self.leader = None

    def __enter__(self):
        # One that was killed with its machine up could not clean up.
        self.unmount()
        shutil.rmtree(self.folder, ignore_errors=True)
        layers = [self.folder / name for name in ("upper", "work")]
        for folder in (self.root, *layers):
            folder.mkdir(parents=True)
        options = f"lowerdir={self.base},upperdir={layers[0]},workdir={layers[1]}"
        mounted = subprocess.run(["mount", "-t", "overlay", "overlay", "-o", options, self.root], capture_output=True, text=True)
        if mounted.returncode != 0:
            raise Unusable(f"an overlay cannot be mounted: {mounted.stderr.strip()}")
        try:
            self.boot()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.nspawn:
            self.power_off()
        self.unmount()
        if not os.path.ismount(self.root):
            shutil.rmtree(self.folder, ignore_errors=True)

    def unmount(self):
        subprocess.run(["umount", "--lazy", self.root], capture_output=True)

    def boot(self):
        """Starts systemd and waits for it; returns the seconds that it took."""
        began = time.monotonic()
        command = ["systemd-nspawn", "--boot", "--quiet", "--register=no", "--keep-unit", "--private-network"]
        command += ["--link-journal=no", "--resolv-conf=off", "--timezone=off", "--console=pipe"]
        command += [f"--machine=andon-test-{os.getpid()}", f"--directory={self.root}"]
        console = self.folder / "console.log"
        with open(console, "a") as log:
            self.nspawn = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        while time.monotonic() - began < BOOT_S:
            if self.nspawn.poll() is not None:
                break
            self.leader = first_child(self.nspawn.pid)
            if self.leader and self.run("systemctl", "is-system-running").stdout.strip() in ("running", "degraded"):
                return time.monotonic() - began
            time.sleep(0.2)
        words = console.read_text(errors="replace").strip().splitlines()
        raise Unusable(f"systemd does not boot in systemd-nspawn: {words[-1] if words else 'it says nothing'}")

    def power_off(self):
        """Ends as a machine does whose power button is pressed; returns whether all went down in time."""
        self.nspawn.terminate()
        try:
            self.nspawn.wait(POWER_OFF_S)
            return True
        except subprocess.TimeoutExpired:
            self.nspawn.kill()
            self.nspawn.wait()
            return False
        finally:
            self.nspawn = self.leader = None

    def run(self, *command, user=None, timeout=120, stdin=None):
        """Runs a command inside; its output is text."""
        inside = ["nsenter", f"--target={self.leader}", "--all"]
        if user:
            inside += ["runuser", "-u", user, "--"]
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8"}
        environment |= {"DEBIAN_FRONTEND": "noninteractive", "SYSTEMD_COLORS": "0"}
        return subprocess.run([*inside, *command], capture_output=True, text=True, timeout=timeout, env=environment, input=stdin)

    def must(self, *command, **options):
        """As `run`; a command that fails is an error with its own words."""
        done = self.run(*command, **options)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.strip() or done.stdout.strip()}")
        return done.stdout

    def unit(self, name):
        """The properties of a unit."""
        shown = self.must("systemctl", "show", name)
        return dict(line.split("=", 1) for line in shown.splitlines() if "=" in line)

    def journal(self, *matches):
        """The entries of the journal that match."""
        shown = self.must("journalctl", "--output=json", "--no-pager", "--quiet", *matches)
        return [json.loads(line) for line in shown.splitlines()]


def first_child(pid):
    children = Path(f"/proc/{pid}/task/{pid}/children")
    listed = children.read_text().split() if children.exists() else []
    return int(listed[0]) if listed else None
