//! A form of a browser: pairs of keys and values.

/// What was sent. A key that comes twice has its first value.
#[derive(Clone, Default)]
pub(crate) struct Form {
    pairs: Vec<(String, String)>,
    /// Whether it has more pairs than are read.
    is_cut: bool,
}

/// A form may have a password.
impl std::fmt::Debug for Form {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.pairs.iter().map(|(key, _)| key)).finish()
    }
}

/// More pairs than any form of the board has: one that names many steps, or many recordings, has the most.
const MOST: usize = 1024;

impl Form {
    /// Reads what a browser sends; what cannot be read is left out.
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let mut pairs = bytes.split(|byte| *byte == b'&');
        let read = pairs.by_ref().take(MOST).filter_map(pair).collect();
        Self { pairs: read, is_cut: pairs.next().is_some() }
    }

    /// Whether it has more pairs than are read. The others are then as if they had not come.
    pub(crate) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The value of a key; empty where there is none.
    pub(crate) fn get(&self, key: &str) -> &str {
        self.pairs.iter().find(|(known, _)| known == key).map_or("", |(_, value)| value)
    }

    /// All values of a key.
    pub(crate) fn all<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a str> {
        self.pairs.iter().filter(move |(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    pub(crate) fn without(mut self, key: &str) -> Self {
        self.pairs.retain(|(known, _)| known != key);
        self
    }

    /// The pairs as the query of an address, as far as a query is plain.
    pub(crate) fn query(&self) -> String {
        self.pairs.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join("&")
    }
}

fn pair(bytes: &[u8]) -> Option<(String, String)> {
    let equals = bytes.iter().position(|byte| *byte == b'=')?;
    Some((text(&bytes[..equals])?, text(&bytes[equals + 1..])?))
}

/// Text with its `+` and its `%20`.
fn text(bytes: &[u8]) -> Option<String> {
    let mut plain = Vec::with_capacity(bytes.len());
    let mut bytes = bytes.iter();
    while let Some(byte) = bytes.next() {
        plain.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digit = |byte: Option<&u8>| char::from(*byte?).to_digit(16);
                let (high, low) = (digit(bytes.next())?, digit(bytes.next())?);
                u8::try_from(high * 16 + low).ok()?
            }
            other => *other,
        });
    }
    String::from_utf8(plain).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_a_browser_writes_them() {
        let form = Form::read(b"name=maria&password=a%26b%3D+%C3%BC&name=paul&empty=");
        assert_eq!(
            ["name", "password", "empty", "none"].map(|key| form.get(key)),
            ["maria", "a&b= \u{fc}", "", ""]
        );
        assert_eq!(form.clone().without("password").get("password"), "");
        assert!(!format!("{form:?}").contains("a&b"));
    }

    #[test]
    fn what_cannot_be_read_is_left_out() {
        for bytes in [&b""[..], b"name", b"%", b"name=%", b"name=%4", b"name=%zz", b"name=%ff", b"=", b"&&&"]
        {
            assert_eq!(Form::read(bytes).get("name"), "", "{bytes:?}");
        }
        let many = "a=1&".repeat(1000);
        let form = Form::read(many.repeat(2).as_bytes());
        assert_eq!((form.pairs.len(), form.is_cut()), (MOST, true));
        assert!(!Form::read(many.as_bytes()).is_cut());
    }
}
