#!/usr/bin/env python3
"""What is taught otherwise with half or twice a constant: each number of teaching and of the core by itself, on sets of runs.

    constants.py FOLDER SETS [WORD...]

SETS is a folder with a folder for each set: the track files that teach one job. `simulate people SEED SETS` writes some. Copies the tracked files
into FOLDER and gives every constant there a switch, so that one build serves them all: ANDON_CONSTANT=17=0.02. With words, only constants whose
path or name contains one of them. Each row goes to FOLDER/constants.tsv as soon as it is tried, and what is in the table is not tried again.

The columns: constant, value, number of sets of which the job file differs, their names. A count is also tried with the next whole numbers. Where no
set differs, the constant is a candidate to go with its rule; `ablation.py` says what the tests miss then.

A constant that must be known when it is compiled, or that stands in a text, has no switch: these are printed as left out.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

from ablation import copied

PLACES = ["daemon/core/src", "daemon/learn/src/teach"]
DECLARED = re.compile(r"^(pub(?:\([a-z ]+\))? )?const ([A-Z]\w*): ([fui]\w+) = ([-+*/(). \d_e]+);", re.M)
# What is no code: imports, comments and strings.
OTHER = re.compile(r"\buse [^;]*;|//[^\n]*|\"(?:[^\"\\]|\\.)*\"", re.S)
SWITCH = """
extern crate std;
/// The constant with this number, or what `ANDON_CONSTANT` says instead.
pub fn constant(number: u32, value: f64) -> f64 {
    static CHOSEN: std::sync::LazyLock<Option<(u32, f64)>> = std::sync::LazyLock::new(|| {
        let chosen = std::env::var("ANDON_CONSTANT").ok()?;
        let (number, value) = chosen.split_once('=')?;
        Some((number.parse().ok()?, value.parse().ok()?))
    });
    CHOSEN.filter(|(chosen, _)| *chosen == number).map_or(value, |(_, value)| value)
}
"""
# Prints a line for each folder: the job that its runs teach, or why they teach none.
TAUGHT = """
use andon_core::config::Method;
use andon_learn::{recording, run::Run, teach::{TeachOptions, teach}};
fn main() {
    for folder in std::env::args().skip(1) {
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
        files.sort();
        let read = |path| recording::read("", &std::fs::read(path).unwrap()).unwrap();
        let recordings: Vec<_> = files.into_iter().map(read).collect();
        let method = Method { space: recordings[0].header.space, ..Method::default() };
        let runs: Vec<_> = recordings.iter().map(|it| Run::new("run", "", it, &method).unwrap()).collect();
        let taught = teach(&runs, &TeachOptions::new("", "", method));
        println!("{:?}", taught.map(|(job, _)| job.to_toml()).map_err(|error| error.to_string()));
    }
}
"""


def called(text, declared):
    """The text of a file in which those of these constants that it declares or imports are functions, and those that it names by their module."""
    near = {it[2] for it in DECLARED.finditer(text)} | set(re.findall(r"\w+", " ".join(re.findall(r"\buse [^;]*;", text))))

    def call(it):
        module, name = it[1], it[2]
        is_known = name in declared and (module.rpartition("::")[0].split("::")[-1].islower() if module else name in near)
        return f"{it[0]}()" if is_known else it[0]

    use = re.compile(r"(?<!const )\b((?:\w+::)*)([A-Z][A-Z0-9_]+)\b")
    parts, end = [], 0
    for other in OTHER.finditer(text):
        parts += [use.sub(call, text[end : other.start()]), other[0]]
        end = other.end()
    return "".join(parts) + use.sub(call, text[end:])


def built(folder):
    """Builds the copy with switches. What must be known when it is compiled has none. The constants by their numbers, and the program."""
    tree, left_out = copied(folder), set()
    core = tree / "daemon/core/src/lib.rs"
    paths = [path for place in PLACES for path in sorted((tree / place).rglob("*.rs"))]
    whole = {path: path.read_text().partition("#[cfg(test)]\nmod tests")[0] + (SWITCH if path == core else "") for path in paths}
    (tree / "daemon/learn/examples").mkdir(exist_ok=True)
    (tree / "daemon/learn/examples/taught.rs").write_text(TAUGHT)
    command = ["cargo", "build", "--locked", "-p", "andon-learn", "--example", "taught", "--message-format=json"]
    while True:
        constants, declared = {}, {it[2] for text in whole.values() for it in DECLARED.finditer(text)} - left_out
        for path, text in whole.items():
            crate = "crate" if core.parent in path.parents else "andon_core"

            def function(it):
                if it[2] not in declared:
                    return it[0]
                constants[len(constants)] = (f"{path.relative_to(tree)}: {it[2]}", it[3], eval(it[4]))
                return f"{it[1] or ''}fn {it[2]}() -> {it[3]} {{ {crate}::constant({len(constants) - 1}, ({it[4]}) as f64) as {it[3]} }}"

            path.write_text(DECLARED.sub(function, called(text, declared)))
        said = subprocess.run(command, cwd=tree, env=dict(os.environ, CARGO_TARGET_DIR=str(folder / "target")), capture_output=True, text=True)
        if said.returncode == 0:
            return constants, folder / "target/debug/examples/taught"
        messages = [json.loads(line) for line in said.stdout.splitlines() if line.startswith("{")]
        errors = [it["message"] for it in messages if it.get("reason") == "compiler-message" and it["message"]["level"] == "error"]
        marked = [line["text"][line["highlight_start"] - 1 : line["highlight_end"] - 1] for error in errors for span in error["spans"]
                  if span["is_primary"] for line in span["text"]]
        wrong = declared & set(re.findall(r"\w+", " ".join([error["message"] for error in errors] + marked)))
        if not wrong:
            sys.exit(said.stderr[-3000:])
        left_out |= wrong
        print("left out:", *sorted(wrong), flush=True)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    folder, sets, words = Path(sys.argv[1]).resolve(), sorted(Path(sys.argv[2]).resolve().iterdir()), sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    constants, program = built(folder)
    table = folder / "constants.tsv"
    known = {tuple(line.split("\t")[:2]) for line in table.read_text().splitlines()} if table.exists() else set()

    def taught(choice=""):
        said = subprocess.run([program, *sets], env=dict(os.environ, ANDON_CONSTANT=choice), capture_output=True, text=True)
        lines = said.stdout.splitlines()
        return lines + [said.stderr] * (len(sets) - len(lines))

    default = taught()
    for number, (name, kind, value) in constants.items():
        values = [value / 2, value * 2] if kind[0] == "f" else sorted({value // 2, value - 1, value + 1, value * 2} - {value, -1})
        for other in values if not words or any(word in name for word in words) else []:
            if (name, str(other)) not in known:
                differ = [one.name for one, line, usual in zip(sets, taught(f"{number}={other}"), default) if line != usual]
                row = "\t".join([name, str(other), str(len(differ)), " ".join(differ)])
                with table.open("a") as file:
                    file.write(row + "\n")
                print(row, flush=True)


if __name__ == "__main__":
    main()
