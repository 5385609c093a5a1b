//! Names of recordings in a form of their own: `{person}_{what}_r{run}`.

use super::Written;
use regex_lite::Regex;

/// How the names of recordings say who did what: text with the fields `{person}`, `{what}` and `{run}`, and `*` for anything. It is held against
/// the name without its ending.
#[derive(Clone, Debug)]
pub struct Pattern {
    text: String,
    regex: Regex,
}

/// Why a pattern cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{problem}; its fields are {{person}}, {{what}} and {{run}}, and * is anything: '{{person}}_{{what}}_r{{run}}'"
)]
pub struct PatternError {
    problem: String,
}

impl Pattern {
    /// Reads a pattern.
    ///
    /// # Errors
    /// A field that does not exist or comes twice, and a pattern without `{person}` or `{what}`.
    pub fn new(text: &str) -> Result<Self, PatternError> {
        let problem = |problem: String| PatternError { problem };
        let mut expression = String::from("^");
        let mut seen: Vec<&str> = Vec::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            expression += &literal(before);
            let (field, behind) =
                after.split_once('}').ok_or_else(|| problem("a field has no }".to_owned()))?;
            if seen.contains(&field) {
                return Err(problem(format!("{{{field}}} comes twice")));
            }
            expression += match field {
                "person" => "(?<person>.+?)",
                "what" => "(?<what>.+?)",
                "run" => "(?<run>[0-9]+)",
                _ => return Err(problem(format!("there is no field {{{field}}}"))),
            };
            seen.push(field);
            rest = behind;
        }
        if !seen.iter().any(|field| ["person", "what"].contains(field)) {
            return Err(problem("it says neither who nor what".to_owned()));
        }
        expression += &literal(rest);
        expression.push('$');
        let regex = Regex::new(&expression).map_err(|error| problem(error.to_string()))?;
        Ok(Self { text: text.to_owned(), regex })
    }

    /// The pattern as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What a name says; `None` where it has another form. Who is not named is one person, and what is not named was correct.
    pub(super) fn read(&self, stem: &str) -> Option<Written> {
        let found = self.regex.captures(stem)?;
        let field = |name: &str| found.name(name).map(|field| field.as_str().to_owned());
        Some(Written {
            person: field("person").unwrap_or_else(|| "1".to_owned()),
            what: field("what").unwrap_or_else(|| super::CORRECT.to_owned()),
            repetition: field("run").and_then(|number| number.parse().ok()),
        })
    }
}

/// Text that means itself, and `*`.
fn literal(text: &str) -> String {
    text.split('*').map(regex_lite::escape).collect::<Vec<_>>().join(".*?")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn read(pattern: &str, stem: &str) -> Option<(String, String, Option<u32>)> {
        let Written { person, what, repetition } = Pattern::new(pattern).unwrap().read(stem)?;
        Some((person, what, repetition))
    }

    #[test]
    fn the_fields_of_a_name_are_read_wherever_they_stand() {
        let good = |person: &str, n| Some((person.to_owned(), "good".to_owned(), n));
        assert_eq!(read("{person}_{what}_r{run}", "anna_good_r3"), good("anna", Some(3)));
        assert_eq!(read("shift.{run} ({what}) {person}", "shift.12 (good) anna"), good("anna", Some(12)));
        assert_eq!(read("*-{what}", "monday-good"), good("1", None));
        assert_eq!(read("{person}-{what}", "anna-good"), good("anna", None));
    }

    #[test]
    fn a_name_of_another_form_says_nothing() {
        for name in ["anna_good", "anna_good_r", "anna_good_rx", "_good_r1"] {
            assert_eq!(read("{person}_{what}_r{run}", name), None, "{name}");
        }
        assert_eq!(read("a.c_{what}", "abc_good"), None, "a point is a point");
    }

    #[test]
    fn a_pattern_that_says_nothing_is_refused_with_an_example() {
        for (pattern, problem) in [
            ("piece{run}", "neither who nor what"),
            ("{who}_{what}", "no field {who}"),
            ("{what}_{what}", "comes twice"),
            ("{what", "no }"),
        ] {
            let said = Pattern::new(pattern).unwrap_err().to_string();
            assert!(said.contains(problem) && said.contains("{person}_{what}_r{run}"), "{said}");
        }
    }
}
