//! README.md, the guide and the page of commands are tried as they are written: each command line is one, and each link leads somewhere.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use clap::error::ErrorKind;

use super::command;

const FIRST: &str = "README.md";
const COMMANDS: &str = "config/COMMANDS.md";
const PAGES: [&str; 3] = [FIRST, "config/GUIDE.md", COMMANDS];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn text_of(page: &str) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}

fn pages() -> impl Iterator<Item = (&'static str, String)> {
    PAGES.into_iter().map(|page| (page, text_of(page)))
}

/// What stands between backquotes.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The command lines of a page: between backquotes, and in indented lines up to their comment.
fn command_lines(text: &str) -> Vec<&str> {
    let indented = text.lines().filter_map(|line| line.strip_prefix("    ")?.split('#').next());
    code(text).chain(indented).filter(|line| line.starts_with("andond ")).collect()
}

/// A command line that stands for several is the first of them, with all that is optional.
fn one_of(line: &str) -> Vec<String> {
    let first = |word: &str| word.split(r"\|").next().unwrap_or_default().replace("...", "");
    line.replace(['[', ']'], "").split_whitespace().map(first).filter(|word| !word.is_empty()).collect()
}

/// Whether a value only stands for one.
fn is_placeholder(word: &str) -> bool {
    word.chars().all(|letter| letter.is_ascii_uppercase())
}

#[test]
fn each_command_line_that_a_page_shows_is_one() {
    for (page, text) in pages() {
        let lines = command_lines(&text);
        assert!(lines.len() > 4, "{page}: {lines:?}");
        for line in lines {
            let words = one_of(line);
            let Err(error) = command().try_get_matches_from(&words) else { continue };
            let is_short = words.iter().skip(2).any(|word| is_placeholder(word));
            match error.kind() {
                ErrorKind::DisplayHelp => (),
                // What is shown in short leaves out what else must be said, and the value of a list.
                ErrorKind::MissingRequiredArgument if is_short || words.len() == 2 => (),
                ErrorKind::InvalidValue | ErrorKind::ValueValidation if is_short => (),
                _ => unreachable!("{page}: {line}: {error}"),
            }
        }
    }
}

#[test]
fn each_command_is_on_the_page_of_commands() {
    let text = text_of(COMMANDS);
    for subcommand in command().get_subcommands().filter(|command| !command.is_hide_set()) {
        let line = format!("andond {}", subcommand.get_name());
        assert!(code(&text).any(|shown| shown.starts_with(&line)), "{line}");
    }
}

/// The files of the repository that a page links to or shows, by their paths from its root.
fn links(page: &str, text: &str) -> Vec<String> {
    let folder = Path::new(page).parent().unwrap();
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let targets: Vec<&str> = targets.filter(|target| !target.is_empty()).collect();
    assert!(targets.len() > 3, "{page}: {targets:?}");
    // A page lies in a folder of the root, or in the root itself.
    let path = |target: &str| match target.strip_prefix("../") {
        Some(beside) => beside.to_owned(),
        None => folder.join(target).to_string_lossy().into_owned(),
    };
    targets.into_iter().map(path).collect()
}

#[test]
fn each_link_of_a_page_leads_to_a_file() {
    for (page, text) in pages() {
        for target in links(page, &text) {
            assert!(root().join(&target).exists(), "{page}: {target}");
        }
    }
}

/// The guide of the package showed no picture: it was in the repository alone.
#[test]
fn what_a_page_links_to_lies_in_the_package_where_the_page_looks_for_it() {
    // For who builds from the sources. The licences are in the file `copyright`.
    const SOURCES: [&str; 3] = [".github/CONTRIBUTING.md", "LICENSE-APACHE", "LICENSE-MIT"];
    let manifest = text_of("daemon/andond/Cargo.toml");
    for (page, text) in pages() {
        for target in links(page, &text).into_iter().filter(|target| !SOURCES.contains(&target.as_str())) {
            let (folder, name) = target.rsplit_once('/').unwrap_or(("", &target));
            let name = if name.ends_with(".jpg") { "*.jpg" } else { name };
            let place = Path::new("usr/share/doc/andon").join(folder).join("");
            let asset = format!("{name}\", \"{}\"", place.display());
            assert!(manifest.contains(&asset), "{page}: {target} is not in the package: {asset}");
        }
    }
}

/// A newcomer read "IU", "ERU" and "the paper" and found them nowhere; a longer page was not read to its end.
#[test]
fn the_first_page_is_short_and_says_what_is_needed_before_the_commands() {
    let text = text_of(FIRST);
    assert!(text.lines().count() < 70, "{FIRST}");
    for word in ["IU", "ERU"] {
        assert!(!text.split(|letter: char| !letter.is_alphanumeric()).any(|shown| shown == word), "{word}");
    }
    let at = |words: &str| text.find(words).unwrap_or_else(|| unreachable!("{words} is not on the page"));
    assert!(at("even light") < at("andond new"), "first what is needed");
    for words in
        ["ArUco marker", "glossary, and the paper", "CODES.md", "REGISTERS.md", "COMMANDS.md", "limits"]
    {
        at(words);
    }
}

#[test]
fn the_first_page_names_what_continuous_integration_runs() {
    let text = text_of(FIRST);
    let runs = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let parts: Vec<&str> = runs.lines().filter_map(|line| line.strip_prefix("part make ")).collect();
    assert!(parts.contains(&"test"), "{parts:?}");
    for part in parts {
        let command = format!("make {part}");
        assert!(code(&text).any(|shown| shown == command), "{command}");
    }
}

/// Every source file of the repository.
fn sources(folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        match entry.path() {
            path if path.is_dir() && !path.ends_with("target") => sources(&path, found),
            path => found.push(path.to_string_lossy().into_owned()),
        }
    }
}

/// The page of the architecture named a file that had got another name.
#[test]
fn each_source_file_that_a_page_names_is_there() {
    let mut found = Vec::new();
    ["daemon", "shm-schemas", "tests"].iter().for_each(|folder| sources(&root().join(folder), &mut found));
    for page in ["daemon/README.md", ".github/CONTRIBUTING.md"] {
        let text = text_of(page);
        let is_of_name = |letter: char| letter.is_ascii_alphanumeric() || "_-./".contains(letter);
        let words = text.split(|letter: char| !is_of_name(letter));
        // What is named in general, such as NAME.rs, and several at once, such as {one,other}.rs, is left out.
        let is_file = |word: &&str| word.ends_with(".rs") && !word.starts_with('.') && !word.contains("NAME");
        let named: Vec<&str> = words.filter(is_file).collect();
        assert!(named.len() > 9, "{page}: {named:?}");
        for file in named {
            let end = format!("/{file}");
            assert!(found.iter().any(|path| path.ends_with(&end)), "{page}: {file}");
        }
    }
}
