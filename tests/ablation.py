#!/usr/bin/env python3
"""Which tests of the core fail without a condition: each function that returns a bool and changes nothing says true
all the time, then false.

    ablation.py FOLDER [WORD...]

Copies the tracked files into FOLDER, builds there, and adds each condition to FOLDER/ablation.tsv as soon as it is tried. What
is in the table already is not tried again. With words, only conditions whose path or name contains one of them.

The columns: condition, constant, what breaks, number of tests that fail, their names. What breaks is "nothing", "its own" if
only tests of its module fail or a single one, "others", or "does not build". Where a constant breaks no more than "its own",
the condition is a candidate to go: the tests of other crates and what is measured have not spoken yet.
"""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

PLACES = ["daemon/core/src/couple/scene", "daemon/core/src/anomaly"]
CONDITION = re.compile(r"\bfn (\w+)(?:<[^>]*>)?\((?!&mut self)[^{;]*\)\s*->\s*bool\s*\{")
# Without a condition something may never end. Ten times what it takes with all of them is long enough, on a machine that others use as well.
PATIENCE = 10


def copied(folder):
    """The tracked files in a folder of their own. A file that has not changed keeps its time, so that nothing is built in vain."""
    tree = folder / "tree"
    listed = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=True)
    for name in listed.stdout.split("\0"):
        source, target = Path(name), tree / name
        if source.is_file() and not (target.is_file() and target.read_bytes() == source.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(source.read_bytes())
    return tree


def conditions(tree):
    """File, name, and where its body begins, of each condition outside of tests. The second one of a name in a file is name#2."""
    for path in sorted(path for place in PLACES for path in (tree / place).rglob("*.rs")):
        if path.name != "tests.rs":
            product, names = path.read_text().split("#[cfg(test)]\nmod ")[0], []
            for found in CONDITION.finditer(product):
                names.append(found[1])
                count = names.count(found[1])
                yield path, found[1] if count == 1 else f"{found[1]}#{count}", found.end()


def cargo_test(tree, folder, *arguments):
    """How the tests of the core alone are built and run there."""
    env = dict(os.environ, CARGO_TARGET_DIR=str(folder / "target"), PROPTEST_FAILURE_PERSISTENCE="off")
    command = ["cargo", "test", "--locked", "-p", "andon-core", "--lib", "--tests", *arguments]
    return subprocess.Popen(command, cwd=tree, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            start_new_session=True)


def failing(tree, folder, seconds=None):
    """The tests that fail, each with its file or module; None if it does not build. They may take so many seconds."""
    building = cargo_test(tree, folder, "--no-run")
    building.communicate()
    if building.returncode:
        return None
    tests, ends = cargo_test(tree, folder, "--no-fail-fast"), True
    try:
        said = tests.communicate(timeout=seconds)[0]
    except subprocess.TimeoutExpired:
        os.killpg(tests.pid, signal.SIGKILL)
        said, ends = tests.communicate()[0], False
    failed, program = [] if ends else ["(does not end)"], ""
    for line in said.splitlines():
        if running := re.match(r"\s+Running (?:unittests src/lib.rs|tests/(\w+)\.rs)", line):
            program = running[1] or ""
        elif test := re.match(r"test (\S+)(?: - should panic)? \.\.\. FAILED", line):
            failed.append(f"{program}::{test[1]}".removeprefix("::"))
    return failed


def broken(failed, module):
    """What breaks, in one word or two."""
    if failed is None:
        return "does not build"
    if not failed:
        return "nothing"
    is_own = all(name.startswith(f"{module}::") for name in failed)
    return "its own" if is_own or len(failed) == 1 and failed[0] != "(does not end)" else "others"


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder, words = Path(sys.argv[1]).resolve(), sys.argv[2:]
    tree, table = copied(folder), folder / "ablation.tsv"
    if (failed := failing(tree, folder)) != []:
        sys.exit(f"with all conditions: {broken(failed, '')} {failed}")
    began = time.monotonic()
    failing(tree, folder)
    seconds = PATIENCE * (time.monotonic() - began)
    tried = {tuple(line.split("\t")[:2]) for line in table.read_text().splitlines()} if table.exists() else set()
    for path, name, begins in list(conditions(tree)):
        place = str(path.relative_to(tree / "daemon/core/src"))
        module = place.removesuffix(".rs").removesuffix("/mod").replace("/", "::")
        for constant in ("true", "false"):
            condition = f"{module}::{name}"
            if (condition, constant) in tried or words and not any(word in condition for word in words):
                continue
            whole = path.read_text()
            path.write_text(f"{whole[:begins]} if true {{ return {constant}; }} {whole[begins:]}")
            try:
                failed = failing(tree, folder, seconds)
            finally:
                path.write_text(whole)
            row = [condition, constant, broken(failed, module), str(len(failed or [])), " ".join(failed or [])]
            with table.open("a") as file:
                file.write("\t".join(row) + "\n")
            print(*row[:4], flush=True)


if __name__ == "__main__":
    main()
