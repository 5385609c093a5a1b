"""A bare Debian with systemd and what the package depends on, made once: machines are overlays of it."""

import os
import shutil
import subprocess
from pathlib import Path

# What the smallest variant lacks to boot.
BOOT = "systemd,systemd-sysv,dbus"


class Unusable(Exception):
    """systemd-nspawn cannot be used here, and why."""


def needs(package):
    """The packages that this one depends on."""
    fields = subprocess.run(["dpkg-deb", "--field", package, "Depends"], check=True, capture_output=True, text=True)
    return sorted({alternatives.split("|")[0].split("(")[0].strip() for alternatives in fields.stdout.split(",")})


def make(folder, names, codename=None):
    """The root of a Debian with these packages, of this machine's release if none is named; it is made again for other packages."""
    root, made_for = folder / "base", folder / "base.packages"
    if made_for.exists() and made_for.read_text().split() == names:
        return root
    print(f"making a bare Debian with {len(names)} packages in {root}", flush=True)
    made_for.unlink(missing_ok=True)
    shutil.rmtree(root, ignore_errors=True)
    sources = debian_sources(codename)
    site, codename = sources[0][:2]
    step("debootstrap", "--variant=minbase", f"--include={BOOT}", codename, root, site)
    lines = [f"deb {site} {release} {component}\n" for site, release, component in sources]
    (root / "etc/apt/sources.list").write_text("".join(lines))
    step("chroot", root, "apt-get", "update", "-qq")
    step("chroot", root, "apt-get", "install", "-y", "-qq", "--no-install-recommends", *names)
    step("chroot", root, "apt-get", "clean")
    made_for.write_text("\n".join(names))
    return root


def debian_sources(wanted_codename):
    """Where this machine's own apt gets its Debian from, of another release if one is named: site, release and component; the release
    itself comes first."""
    wanted = ["apt-get", "indextargets", "--format", "$(REPO_URI) $(RELEASE) $(COMPONENT)"]
    wanted += ["Created-By: Packages", "Origin: Debian"]
    listed = subprocess.run(wanted, check=True, capture_output=True, text=True).stdout.split("\n")
    codename = codename_of(Path("/etc/os-release").read_text())
    sources = [line.split() for line in listed if codename in line]
    if not any(release == codename for _, release, _ in sources):
        raise Unusable(f"apt knows no mirror of Debian {codename}: run apt-get update")
    sources = sorted(sources, key=lambda source: source[1] != codename)
    other = wanted_codename or codename
    return [(site, release.replace(codename, other), component) for site, release, component in sources]


def codename_of(os_release):
    values = dict(line.split("=", 1) for line in os_release.splitlines() if "=" in line)
    return values.get("VERSION_CODENAME", "")


def step(*command):
    """Runs a command that makes a part of the base; its last words are the reason when it cannot."""
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C"}
    done = subprocess.run(command, capture_output=True, text=True, env=quiet)
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()[-1]
        raise Unusable(f"{command[0]} failed: {words}")
