//! The questions of `andond new`: a person answers them, or flags do.

use std::io::{self, BufRead, Write};

use super::{DEVICE, SIDE_M};
use crate::cli::metres::{Named, named, side};
use crate::cli::{Hands, New};

/// What a station needs to know.
#[derive(Debug, PartialEq)]
pub(super) struct Answers {
    pub(super) parts: Vec<Named>,
    /// Side of the markers that have none of their own, in metres.
    pub(super) side_m: f64,
    pub(super) camera: String,
    pub(super) hands: Hands,
}

impl Answers {
    /// The flags, and the defaults of those that are missing.
    pub(super) fn of_flags(flags: &New) -> Self {
        Self {
            parts: flags.parts.clone(),
            side_m: flags.side.unwrap_or(SIDE_M),
            camera: flags.camera.clone().unwrap_or_else(|| DEVICE.to_owned()),
            hands: flags.hands.unwrap_or(Hands::Both),
        }
    }
}

/// Asks for what the flags leave open. An empty answer takes the default, which stands in brackets.
pub(super) fn answers(input: &mut impl BufRead, output: &mut impl Write, flags: &New) -> io::Result<Answers> {
    let mut answers = Answers::of_flags(flags);
    let mut person = Person { input, output };
    writeln!(
        person.output,
        "Parts and tools that carry a marker, one on each line: brick, or brick=0.033 with the side of its black square in metres.\nAn empty \
         line ends the list."
    )?;
    loop {
        let question = format!("  part {}: ", answers.parts.len() + 1);
        match person
            .answer(&question, |text| if text.is_empty() { Ok(None) } else { named(text).map(Some) })?
        {
            Some(part) => answers.parts.push(part),
            None => break,
        }
    }
    if flags.side.is_none() {
        let question = format!("Side of their black squares, in metres [{SIDE_M}]: ");
        answers.side_m =
            person.answer(&question, |text| if text.is_empty() { Ok(SIDE_M) } else { side(text) })?;
    }
    if flags.camera.is_none() {
        let question = format!(
            "Camera: a device, the word realsense, a film, a .bag file or a folder of pictures [{DEVICE}]: "
        );
        answers.camera =
            person.answer(&question, |text| Ok(if text.is_empty() { DEVICE } else { text }.to_owned()))?;
    }
    if flags.hands.is_none() {
        answers.hands = person.answer("Hands that work here, right, left or both [both]: ", hands)?;
    }
    Ok(answers)
}

fn hands(text: &str) -> Result<Hands, String> {
    match text {
        "right" => Ok(Hands::Right),
        "left" => Ok(Hands::Left),
        "both" | "" => Ok(Hands::Both),
        _ => Err("answer right, left or both".to_owned()),
    }
}

struct Person<'a, R, W> {
    input: &'a mut R,
    output: &'a mut W,
}

impl<R: BufRead, W: Write> Person<'_, R, W> {
    /// Asks until the answer can be understood. Where the input ends, it is the empty answer.
    fn answer<T>(&mut self, question: &str, read: impl Fn(&str) -> Result<T, String>) -> io::Result<T> {
        loop {
            write!(self.output, "{question}")?;
            self.output.flush()?;
            let mut line = String::new();
            self.input.read_line(&mut line)?;
            match read(line.trim()) {
                Ok(answer) => return Ok(answer),
                Err(problem) => writeln!(self.output, "  {problem}")?,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn flags() -> New {
        New {
            name: "bench1".into(),
            parts: vec![],
            side: None,
            camera: None,
            hands: None,
            board: None,
            language: "en".into(),
            out: None,
            force: false,
        }
    }

    fn asked(typed: &str, flags: &New) -> (Answers, String) {
        let mut said = Vec::new();
        let answers = answers(&mut typed.as_bytes(), &mut said, flags).unwrap();
        (answers, String::from_utf8(said).unwrap())
    }

    #[test]
    fn a_person_is_asked_until_the_answer_can_be_understood() {
        let typed = "brick\npolisher=36\npolisher=0.036\n\n40\n0.05\nfilm.mp4\nfeet\nright\n";
        let (answers, said) = asked(typed, &flags());
        let names: Vec<_> = answers.parts.iter().map(|part| (part.name.as_str(), part.side_m)).collect();
        assert_eq!(names, [("brick", None), ("polisher", Some(0.036))]);
        assert_eq!(
            (answers.side_m, answers.camera.as_str(), answers.hands),
            (0.05, "film.mp4", Hands::Right)
        );
        assert!(said.contains("36 mm is 0.036") && said.contains("40 mm is 0.04"), "{said}");
        assert!(said.contains("answer right, left or both"), "{said}");
    }

    #[test]
    fn empty_answers_are_the_defaults_and_what_a_flag_says_is_not_asked() {
        let (answers, _) = asked("brick\n\n\n\n\n", &flags());
        assert_eq!((answers.side_m, answers.camera.as_str(), answers.hands), (SIDE_M, DEVICE, Hands::Both));
        let flags = New { side: Some(0.03), hands: Some(Hands::Left), ..flags() };
        let (answers, said) = asked("brick\n", &flags);
        assert_eq!((answers.side_m, answers.hands), (0.03, Hands::Left));
        assert!(!said.contains("Side") && !said.contains("Hands"), "{said}");
    }
}
