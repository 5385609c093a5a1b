//! How a section declares its keys: once, for the reader of files and for the writers.

use super::value::Value;

/// Walks over all keys of the configuration in the order of the reference.
///
/// A section is declared by one function over this trait. The name, the default, the allowed range and the meaning of a key are therefore written
/// once. The reference cannot differ from what the reader enforces.
pub(super) trait Keys: Sized {
    /// A section `[name]`.
    fn section(&mut self, name: &'static str, meaning: &'static str, keys: impl FnOnce(&mut Self));

    /// A list of sections `[[name]]`. A later file replaces the whole list.
    fn list<T: Default>(
        &mut self,
        name: &'static str,
        meaning: &'static str,
        items: &mut Vec<T>,
        keys: impl Fn(&mut T, &mut Self),
    );

    /// A key with a default: `value` holds it.
    fn key<T: Value>(&mut self, name: &'static str, value: &mut T, limit: T::Limit, meaning: &'static str);

    /// A key that at least one file must have. `example` is TOML.
    fn required<T: Value>(
        &mut self,
        name: &'static str,
        value: &mut T,
        limit: T::Limit,
        _example: &'static str,
        meaning: &'static str,
    ) {
        self.key(name, value, limit, meaning);
    }

    /// A key that may be left out. `example` is TOML.
    fn optional<T: Value>(
        &mut self,
        name: &'static str,
        value: &mut Option<T>,
        limit: T::Limit,
        example: &'static str,
        meaning: &'static str,
    );
}
