//! README.md and the guide are tried as they are written: each command line is one, and each link leads somewhere.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use clap::error::ErrorKind;

use super::command;

const PAGES: [&str; 2] = ["README.md", "config/GUIDE.md"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn pages() -> impl Iterator<Item = (&'static str, String)> {
    PAGES.into_iter().map(|page| (page, std::fs::read_to_string(root().join(page)).unwrap()))
}

/// What stands between backquotes.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
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
        let lines: Vec<&str> = code(&text).filter(|line| line.starts_with("andond ")).collect();
        assert!(lines.len() > 10, "{page}: {lines:?}");
        for line in lines {
            let words = one_of(line);
            let Err(error) = command().try_get_matches_from(&words) else { continue };
            let is_short = words.iter().skip(2).any(|word| is_placeholder(word));
            match error.kind() {
                ErrorKind::DisplayHelp => (),
                // What is shown in short leaves out what else must be said, and the value of a list.
                ErrorKind::MissingRequiredArgument if is_short || words.len() == 2 => (),
                ErrorKind::InvalidValue if is_short => (),
                _ => unreachable!("{page}: {line}: {error}"),
            }
        }
    }
}

#[test]
fn each_command_is_on_the_first_page() {
    let (_, text) = pages().next().unwrap();
    for subcommand in command().get_subcommands().filter(|command| !command.is_hide_set()) {
        let line = format!("andond {}", subcommand.get_name());
        assert!(code(&text).any(|shown| shown.starts_with(&line)), "{line}");
    }
}

#[test]
fn each_link_of_a_page_leads_to_a_file() {
    for (page, text) in pages() {
        let folder = root().join(page).parent().unwrap().to_path_buf();
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
        let targets: Vec<&str> = targets.filter(|target| !target.is_empty()).collect();
        assert!(targets.len() > 3, "{page}: {targets:?}");
        for target in targets {
            assert!(folder.join(target).exists(), "{page}: {target}");
        }
    }
}

/// A newcomer read "IU", "ERU" and "the paper" and found them nowhere.
#[test]
fn the_first_page_says_what_its_words_mean_and_what_is_needed() {
    let (_, text) = pages().next().unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let at = |words: &str| text.find(words).unwrap_or_else(|| unreachable!("{words} is not on the page"));
    assert!(at("*Interaction Units* (IU)") < at("## Commands"), "first what the words mean");
    assert!(at("*Elementary Reaction Units* (ERU)") < at("## Commands"), "first what the words mean");
    assert!(at("## What it needs") < at("## Two commands"), "first what is needed");
    for words in
        ["ArUco marker", "even light", "glossary, and the paper", "CODES.md", "REGISTERS.md", "limits"]
    {
        at(words);
    }
}
