//! Writes a configuration as a file that reads back as the same configuration.

use super::Config;
use super::keys::Keys;
use super::value::Value;

/// The configuration in force, as TOML without comments: what `andond config` prints.
#[must_use]
pub fn in_force(config: &Config) -> String {
    let mut writer = Writer::default();
    config.clone().keys(&mut writer);
    writer.0
}

#[derive(Default)]
struct Writer(String);

impl Writer {
    fn heading(&mut self, heading: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.0 += &format!("{heading}\n");
    }
}

impl Keys for Writer {
    fn section(&mut self, name: &'static str, _: &'static str, keys: impl FnOnce(&mut Self)) {
        self.heading(&format!("[{name}]"));
        keys(self);
    }

    fn list<T: Default>(
        &mut self,
        name: &'static str,
        _: &'static str,
        items: &mut Vec<T>,
        keys: impl Fn(&mut T, &mut Self),
    ) {
        for item in items {
            self.heading(&format!("[[{name}]]"));
            keys(item, self);
        }
    }

    fn key<T: Value>(&mut self, name: &'static str, value: &mut T, _: T::Limit, _: &'static str) {
        self.0 += &format!("{name} = {}\n", value.write());
    }

    fn optional<T: Value>(
        &mut self,
        name: &'static str,
        value: &mut Option<T>,
        limit: T::Limit,
        _: &'static str,
        meaning: &'static str,
    ) {
        if let Some(value) = value {
            self.key(name, value, limit, meaning);
        }
    }
}
