//! `andond explain`: what the code of a message means, and what to do.

use std::fmt::Write as _;

use andon_host::exit::Code as Exit;
use andon_host::log::{Code, code};

use super::ToolError;
use crate::cli::Explain;

/// How many codes are named for one that does not exist.
const NEAR: usize = 3;

/// Runs the command: explains the codes, or lists all of them where none is given.
///
/// # Errors
/// A code that does not exist, with those that come near it and the list.
pub fn run(arguments: &Explain) -> Result<Exit, ToolError> {
    let found: Result<Vec<&Code>, String> = arguments.codes.iter().map(|word| find(word)).collect();
    match found {
        Ok(codes) if codes.is_empty() => print!("{}", list()),
        Ok(codes) => print!("{}", codes.into_iter().map(explain).collect::<Vec<_>>().join("\n")),
        Err(unknown) => return Err(ToolError::UnknownCode(unknown)),
    }
    Ok(Exit::Stopped)
}

/// The code that somebody has typed, as `AND-307`, `and307` or `307`.
fn find(word: &str) -> Result<&'static Code, String> {
    let upper = word.trim().to_uppercase();
    let number = upper.strip_prefix("AND").unwrap_or(&upper).trim_start_matches(['-', '_', ' ']);
    let code = number.parse().ok().and_then(code::of_number);
    code.ok_or_else(|| unknown(word, number))
}

fn explain(code: &Code) -> String {
    let mut text = format!("{}  {}  {}\n", code.name, code.level, code::group(code.number));
    let _ = writeln!(text, "  what it means: {}", code.meaning);
    let remedy = if code.remedy.is_empty() { "nothing, it only informs" } else { code.remedy };
    let _ = writeln!(text, "  what to do:    {remedy}");
    text
}

fn list() -> String {
    let mut text = String::new();
    let mut group = "";
    for code in code::ALL {
        if code::group(code.number) != group {
            group = code::group(code.number);
            let _ = writeln!(text, "{}{group}", if text.is_empty() { "" } else { "\n" });
        }
        let _ = writeln!(text, "  {}  {:5}  {}", code.name, code.level, code.meaning);
    }
    text
}

/// What there is instead of a code that there is not. A word may also be one of a message.
fn unknown(word: &str, number: &str) -> String {
    let lower = word.to_lowercase();
    let says = |code: &&&Code| lower.len() > 2 && code.meaning.to_lowercase().contains(&lower);
    let mut near: Vec<&&Code> = code::ALL.iter().filter(says).collect();
    if near.is_empty() {
        let distance = |code: &&&Code| strsim::levenshtein(&code.number.to_string(), number);
        near = code::ALL.iter().filter(|code| distance(code) == 1).collect();
        // Who mistypes a number has most often the right group.
        near.sort_by_key(|code| number.parse().map_or(u32::MAX, |wanted: u32| wanted.abs_diff(code.number)));
        near.truncate(NEAR);
    }
    let mut text = format!("{word}: there is no such code");
    if !near.is_empty() {
        text.push_str("; near it are");
    }
    for code in near {
        let _ = write!(text, "\n  {}  {}", code.name, code.meaning);
    }
    let _ = write!(text, "\nall codes: ");
    let names: Vec<String> = code::ALL.iter().map(|code| code.number.to_string()).collect();
    text + &names.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_explained_however_it_is_typed() {
        let expected = "AND-307  WARN  Judging and jobs\n  what it means: a step could not be judged\n  \
                        what to do:    Look at the product; the reason names what was missing\n";
        for word in ["AND-307", "and-307", "and307", "307", " AND 307"] {
            assert_eq!(find(word).map(explain).as_deref(), Ok(expected), "{word}");
        }
        assert!(find("101").map(explain).is_ok_and(|text| text.ends_with("nothing, it only informs\n")));
    }

    #[test]
    fn the_remedy_of_a_code_fits_every_camera_that_it_may_be_about() {
        let refused = find("AND-105").map(explain).unwrap_or_default();
        assert!(
            refused.contains("v4l2-ctl") && refused.contains("for a RealSense camera with `rs-"),
            "{refused}"
        );
    }

    #[test]
    fn a_code_that_there_is_not_gets_near_ones_and_the_list() {
        let said = find("AND-399").err().unwrap_or_default();
        assert!(said.starts_with("AND-399: there is no such code; near it are\n  AND-309  "), "{said}");
        assert!(said.contains("\nall codes: 101 102 "), "{said}");
        let said = find("frozen").err().unwrap_or_default();
        assert!(!said.contains("near it"), "nothing is frozen: {said}");
        let said = find("black").err().unwrap_or_default();
        assert!(said.contains("AND-213  the picture is black"), "{said}");
    }

    #[test]
    fn the_list_has_every_code_under_its_group() {
        let list = list();
        assert!(list.starts_with("Camera\n  AND-101  INFO   "), "{list}");
        assert!(code::ALL.iter().all(|code| list.contains(code.name)));
        assert!(list.contains("\n\nPLC\n  AND-501"), "{list}");
    }
}
