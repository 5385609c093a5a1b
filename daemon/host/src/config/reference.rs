//! Writes the annotated reference from the declarations that the reader enforces.

use super::Config;
use super::keys::Keys;
use super::value::Value;

const HEAD: &str = "\
Andon: every key, its meaning, what is allowed, and its default.

A station needs one file with its name, its objects and whatever differs from this page: see stations/demo.toml. \
Files are read in the order in which they are given; a later one overrides key by key, and `objects` as a whole. \
A relative path starts at the folder of the file that contains it. A key that does not exist is a fault; all \
faults are reported at once, and then nothing starts. `andond check -c FILE` only checks.";

/// Longest line, in bytes: a technician's terminal shows it without a break.
const WIDTH: usize = 110;

/// The reference, `config/andon.toml`.
#[must_use]
pub fn reference() -> String {
    let mut writer = Writer { text: String::new(), commented: false };
    writer.comment(HEAD);
    Config::default().keys(&mut writer);
    writer.text
}

/// The visitor that writes what it sees.
struct Writer {
    text: String,
    /// Whether the keys belong to an example, which is commented out.
    commented: bool,
}

impl Writer {
    /// Writes `text` as comments, with its lines broken at [`WIDTH`].
    fn comment(&mut self, text: &str) {
        for paragraph in text.lines() {
            let mut line = String::from("#");
            for word in paragraph.split(' ') {
                if line.len() + 1 + word.len() > WIDTH {
                    self.line(&line);
                    line.truncate(1);
                }
                line.push(' ');
                line.push_str(word);
            }
            self.line(line.trim_end());
        }
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn entry(&mut self, meaning: &str, allowed: &str, rest: &str, commented: bool, line: &str) {
        self.text.push('\n');
        self.comment(meaning);
        self.comment(&format!("Allowed: {allowed}. {rest}"));
        let mark = if commented || self.commented { "#" } else { "" };
        self.line(&format!("{mark}{line}"));
    }
}

impl Keys for Writer {
    fn section(&mut self, name: &'static str, meaning: &'static str, keys: impl FnOnce(&mut Self)) {
        self.text.push('\n');
        self.comment(&format!("---- {name}: {meaning}"));
        self.line(&format!("[{name}]"));
        keys(self);
    }

    fn list<T: Default>(
        &mut self,
        name: &'static str,
        meaning: &'static str,
        _: &mut Vec<T>,
        keys: impl Fn(&mut T, &mut Self),
    ) {
        self.text.push('\n');
        self.comment(&format!("---- {name}: {meaning}"));
        self.line(&format!("#[[{name}]]"));
        self.commented = true;
        keys(&mut T::default(), self);
        self.commented = false;
    }

    fn key<T: Value>(&mut self, name: &'static str, value: &mut T, limit: T::Limit, meaning: &'static str) {
        let value = value.write();
        self.entry(
            meaning,
            &T::allowed(&limit),
            &format!("Default: {value}."),
            false,
            &format!("{name} = {value}"),
        );
    }

    fn required<T: Value>(
        &mut self,
        name: &'static str,
        _: &mut T,
        limit: T::Limit,
        example: &'static str,
        meaning: &'static str,
    ) {
        self.entry(meaning, &T::allowed(&limit), "Required.", true, &format!("{name} = {example}"));
    }

    fn optional<T: Value>(
        &mut self,
        name: &'static str,
        _: &mut Option<T>,
        limit: T::Limit,
        example: &'static str,
        meaning: &'static str,
    ) {
        self.entry(meaning, &T::allowed(&limit), "Default: none.", true, &format!("{name} = {example}"));
    }
}
