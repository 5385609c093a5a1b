#!/usr/bin/env python3
"""Puts axe-core, which says what is wrong with a page for people who see little, where the tests of the pages look for it.

    axe.py FOLDER        such as target/axe

Debian has no package of it. The Python package axe-playwright-python has the script as Deque publishes it, under the MPL 2.0. Only
the tests load it into a browser: nothing of it is in the tree or in a package. Running this again is harmless.
"""
import hashlib
import pathlib
import subprocess
import sys
import tempfile
import zipfile

WHEEL = (
    "axe-playwright-python==0.1.8"
    " --hash=sha256:fdd263c998388f1a8e67cad02677e612d946248bd44d163be5e8650ea31f95f8"
)
SCRIPT = "axe_playwright_python/axe.min.js"
SCRIPT_SHA256 = "84494fec757e4710dc751c8d7a636e457f4532f08f85c86dc9070133fbff53bc"


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    target = pathlib.Path(sys.argv[1]) / "axe.min.js"
    if not (target.exists() and digest(target.read_bytes()) == SCRIPT_SHA256):
        provide(target)
    print(f"{target} is there")


def provide(target) -> None:
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        listed = scratch / "requirements.txt"
        listed.write_text(WHEEL + "\n")
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        command += ["--only-binary=:all:", "--require-hashes", "--requirement", str(listed), "--dest", folder]
        if subprocess.run(command).returncode != 0:
            sys.exit("axe-core could not be downloaded (see above): check the network and run again")
        script = zipfile.ZipFile(next(scratch.glob("*.whl"))).read(SCRIPT)
    if digest(script) != SCRIPT_SHA256:
        sys.exit(f"{SCRIPT} in the wheel is not the pinned one: nothing was installed")
    target.parent.mkdir(parents=True, exist_ok=True)
    # Renamed into place, so that a half-written script is never taken for a whole one.
    part = target.with_suffix(".part")
    part.write_bytes(script)
    part.rename(target)


def digest(content) -> str:
    return hashlib.sha256(content).hexdigest()


if __name__ == "__main__":
    main()
