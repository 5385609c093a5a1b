#!/usr/bin/env python3
"""What fails without a condition: each function, closure and name in the method that is a bool says true all the time, then false.

    ablation.py FOLDER [--wide] [WORD...]

Copies the tracked files into FOLDER and gives every condition there a switch, so that one build serves them all: ANDON_ABLATED=17=true
makes condition 17 true. Each row goes to FOLDER/ablation.tsv as soon as it is tried, and what is in the table is not tried again. With
words, only conditions whose path or name contains one of them. With --wide, what breaks no more than its own in the tests of the core
and of learning is also tried with the simulated people: what is deleted, two hands, work by feel (FOLDER/wide.tsv).

The columns: condition, constant, what breaks, number of tests that fail, their names. What breaks is "nothing", "its own" if
only tests of its module fail or a single one, or "others". Where a constant breaks no more than "its own", the condition is a
candidate to go: what is measured has not spoken yet. Fifteen of the judge that broke nothing, one by one and together, accused four right
jobs when observations were deleted (three seeds of 600 cases): a condition goes only if deletions do not miss it, either.
"""

import collections
import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PLACES = ["daemon/core/src/couple/scene", "daemon/core/src/segment", "daemon/core/src/anomaly", "daemon/learn/src/teach"]
FUNCTION = re.compile(r"\bfn (\w+)(?:<[^>]*>)?\([^{;]*\)\s*->\s*bool\s*\{")
NAME = re.compile(r"\blet (?:mut )?((?:is|has|have|may|can|must|was|were|are|do|does|needs)_\w+) =\s*((?:move )?\|[^|]*\|)?\s*")
# Without a condition something may never end. Twice what all programs take with all conditions is long enough for one of them.
PATIENCE = 2
SWITCH = """
#[cfg(not(test))]
extern crate std;
/// Whether the condition with this number is made true or false by `ANDON_ABLATED`.
pub fn ablated(number: u32) -> Option<bool> {
    static CHOSEN: std::sync::LazyLock<Option<(u32, bool)>> = std::sync::LazyLock::new(|| {
        let chosen = std::env::var("ANDON_ABLATED").ok()?;
        let (number, constant) = chosen.split_once('=')?;
        Some((number.parse().ok()?, constant == "true"))
    });
    CHOSEN.filter(|(chosen, _)| *chosen == number).map(|(_, constant)| constant)
}
"""
NARROW = ["andon_core", "andon_learn"]
WIDE = ["learn_doubt", "learn_two_hands", "learn_people", "learn_vmci"]


def copied(folder):
    """The tracked files in a folder of their own. A file that has not changed keeps its time, so that nothing is built in vain."""
    tree = folder / "tree"
    listed = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=True)
    for name in listed.stdout.split("\0"):
        source, target = Path(name), tree / name
        if source.is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(source.read_bytes())
    return tree


def end_of_statement(text, begins):
    """Where the statement that begins here ends: at its semicolon, outside of all brackets."""
    depth = 0
    for index in range(begins, len(text)):
        depth += (text[index] in "([{") - (text[index] in ")]}")
        if text[index] == ";" and depth == 0 or depth < 0:
            return index
    return len(text)


def with_switches(path, place, number, left_out):
    """The text of a file with a switch in each condition, and the names of these, which begin with this number."""
    product, mark, tests = path.read_text().partition("#[cfg(test)]\nmod ")
    switch = "crate::ablated" if "daemon/core" in place else "andon_core::ablated"
    found = [(it.start(), it[1], it.end(), None) for it in FUNCTION.finditer(product)]
    found += [(it.start(), it[1], it.end(), end_of_statement(product, it.end())) for it in NAME.finditer(product)]
    module = place.split("/src/")[1].removesuffix(".rs").removesuffix("/mod").replace("/", "::")
    inserted, names, counts = [], {}, collections.Counter()
    for _, name, begins, ends in sorted(found):
        counts[name] += 1
        full = f"{module}::{name}" + (f"#{counts[name]}" if counts[name] > 1 else "")
        names[number] = full
        if full not in left_out:
            said = f"{switch}({number})"
            if ends is None:
                inserted.append((begins, f" if let Some(it) = {said} {{ return it; }} "))
            else:
                inserted += [(begins, f"match {said} {{ Some(it) => it, None => {{ "), (ends, " } }")]
        number += 1
    for at, text in sorted(inserted, key=lambda it: it[0], reverse=True):
        product = product[:at] + text + product[at:]
    return product + mark + tests, {n: name for n, name in names.items() if name not in left_out}


def cargo(folder, *arguments):
    env = dict(os.environ, CARGO_TARGET_DIR=str(folder / "target"))
    command = ["cargo", "test", "--locked", "-p", "andon-core", "-p", "andon-learn", "-p", "andon-tests", "--lib", "--tests", "--no-run", *arguments]
    return subprocess.run(command, cwd=folder / "tree", env=env, capture_output=True, text=True)


def built(folder):
    """Builds the tree with switches. What is no bool, as the compiler says, has none. The conditions by their numbers, and the programs."""
    tree, left_out = copied(folder), set()
    core = tree / "daemon/core/src/lib.rs"
    core.write_text(core.read_text() + SWITCH)
    files = {str(path.relative_to(tree)): path for place in PLACES for path in sorted((tree / place).rglob("*.rs")) if path.name != "tests.rs"}
    whole = {place: path.read_text() for place, path in files.items()}
    while True:
        conditions, where = {}, {}
        for place, path in files.items():
            path.write_text(whole[place])
            text, names = with_switches(path, place, len(conditions) + len(left_out) + 1 + max([0, *conditions]), left_out)
            path.write_text(text)
            conditions.update(names)
            for number in names:
                line = text[: text.index(f"ablated({number})")].count("\n") + 1
                where.setdefault(place, []).append((line, names[number]))
        said = cargo(folder, "--message-format=json")
        messages = [json.loads(line) for line in said.stdout.splitlines() if line.startswith("{")]
        if said.returncode == 0:
            programs = {message["target"]["name"]: [] for message in messages if message.get("executable")}
            for message in messages:
                if message.get("executable"):
                    package = Path(message["manifest_path"]).parent
                    programs[message["target"]["name"]].append((message["executable"], str(package)))
            return conditions, programs
        before = len(left_out)
        for message in messages:
            if message.get("reason") == "compiler-message" and message["message"]["level"] == "error":
                for span in message["message"]["spans"]:
                    near = [it for it in where.get(span["file_name"], []) if it[0] <= span["line_start"]]
                    left_out |= {max(near)[1]} if near else set()
        if len(left_out) == before:
            sys.exit(said.stderr[-3000:])
        print(f"left out, no bool: {len(left_out)}", flush=True)


def failing(programs, choice=None, seconds=None):
    """The tests of these programs that fail, each with its program."""
    env = dict(os.environ, PROPTEST_FAILURE_PERSISTENCE="off", RUST_BACKTRACE="0", **({"ANDON_ABLATED": choice} if choice else {}))
    failed = []
    for name, program, package in programs:
        try:
            said = subprocess.run([program], cwd=package, env=env, capture_output=True, text=True, timeout=seconds).stdout
        except subprocess.TimeoutExpired:
            return [*failed, f"{name}::(does not end)"]
        failed += [f"{name}::{test}" for test in re.findall(r"^test (\S+)(?: - should panic)? \.\.\. FAILED", said, re.M)]
    return failed


def broken(failed, module):
    """What breaks, in one word or two."""
    if not failed:
        return "nothing"
    is_own = all(f"::{module}::" in name for name in failed)
    return "its own" if is_own or len(failed) == 1 and not failed[0].endswith("(does not end)") else "others"


def tried(table, programs, chosen, conditions):
    """Tries each of these choices that is not in the table yet, and adds it."""
    began = time.monotonic()
    if failed := failing(programs):
        sys.exit(f"with all conditions: {failed}")
    seconds = PATIENCE * (time.monotonic() - began)
    known = {tuple(line.split("\t")[:2]) for line in table.read_text().splitlines()} if table.exists() else set()

    def row(choice):
        number, constant = choice
        failed = failing(programs, f"{number}={constant}", seconds)
        module = conditions[number].rpartition("::")[0]
        row = [conditions[number], constant, broken(failed, module), str(len(failed)), " ".join(failed)]
        with table.open("a") as file:
            file.write("\t".join(row) + "\n")
        print(*row[:4], flush=True)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(row, [choice for choice in chosen if (conditions[choice[0]], choice[1]) not in known]))


def main():
    words = [word for word in sys.argv[1:] if word != "--wide"]
    if not words or words[0].startswith("-"):
        sys.exit(__doc__)
    folder, words = Path(words[0]).resolve(), words[1:]
    folder.mkdir(parents=True, exist_ok=True)
    conditions, programs = built(folder)
    of = lambda is_wanted: [(name, *each) for name, all_of in programs.items() for each in all_of if is_wanted(name, *each)]
    narrow = of(lambda name, _, package: "/tree/daemon/" in package)
    chosen = [(number, constant) for number, name in conditions.items() for constant in ("true", "false")
              if not words or any(word in name for word in words)]
    tried(folder / "ablation.tsv", narrow, chosen, conditions)
    if "--wide" in sys.argv:
        rows = [line.split("\t") for line in (folder / "ablation.tsv").read_text().splitlines()]
        weak = {(name, constant) for name, constant, breaks, *_ in rows if breaks in ("nothing", "its own")}
        wide = [choice for choice in chosen if (conditions[choice[0]], choice[1]) in weak]
        tried(folder / "wide.tsv", of(lambda name, *_: name in WIDE), wide, conditions)


if __name__ == "__main__":
    main()
