//! The file of logins: names, what they are for, and the hashes of their passwords; and the kiosks.

use std::fmt;

use argon2::Argon2;
use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher as _, PasswordVerifier as _};
use serde::{Deserialize, Serialize};

use super::rights::Rank;
use super::token::{Token, TokenHash};

/// The longest name of a login, in characters: the audit trail has room for it.
pub const MAX_NAME: usize = 32;

/// The fewest characters of a password, as NIST SP 800-63B asks for.
const LEAST: usize = 8;
/// The most bytes of a password: a form has room for them.
const MOST: usize = 256;

/// Random bytes of the salt of a password.
const SALT: usize = 16;

const HEAD: &str = "# Logins of the board. `andond board login` and `andond board remove` change them.\n\n";

/// What is wrong with a file of logins, or with a login.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoginsError {
    /// It is no such file.
    #[error("it is no file of logins: {0}; remove it, and make the logins again")]
    Format(String),
    /// The name of a login.
    #[error("the name {0:?} is none: 1 to {MAX_NAME} letters, digits, dots, dashes and underscores")]
    Name(String),
    /// The password of a login.
    #[error("the password must have {LEAST} characters at least, and {MOST} bytes at most")]
    Password,
    /// The system gives no random bytes, or the password no hash.
    #[error("the password cannot be kept: {0}")]
    Hash(String),
}

/// A login.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Login {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub rank: Rank,
    /// The hash of its password, by Argon2id as PHC writes it.
    pub(super) password: String,
}

/// A hash is no password, and none of a log either.
impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.name, self.rank.name())
    }
}

/// A screen that shows the worker's page without a person who logs in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Kiosk {
    name: String,
    /// The hash of its token.
    token: String,
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Logins {
    #[serde(default)]
    logins: Vec<Login>,
    #[serde(default)]
    kiosks: Vec<Kiosk>,
}

impl Logins {
    /// Reads a file of logins.
    ///
    /// # Errors
    /// That it is none.
    pub fn parse(text: &str) -> Result<Self, LoginsError> {
        let read: Self =
            toml::from_str(text).map_err(|error| LoginsError::Format(error.message().to_owned()))?;
        for login in &read.logins {
            PasswordHash::new(&login.password)
                .map_err(|error| LoginsError::Format(format!("the password of {}: {error}", login.name)))?;
        }
        Ok(read)
    }

    /// The file of logins.
    #[must_use]
    pub fn text(&self) -> String {
        // Names, words and hexadecimal digits can be written.
        format!("{HEAD}{}", toml::to_string(self).unwrap_or_default())
    }

    /// Whether nobody can log in.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.logins.is_empty()
    }

    /// The names of the logins and what they are for; a kiosk is for nothing but the worker's page.
    pub fn names(&self) -> impl Iterator<Item = (&str, Option<Rank>)> {
        let logins = self.logins.iter().map(|login| (login.name.as_str(), Some(login.rank)));
        logins.chain(self.kiosks.iter().map(|kiosk| (kiosk.name.as_str(), None)))
    }

    /// Adds a login, in place of one of the same name.
    ///
    /// # Errors
    /// A name or a password that cannot be one.
    pub fn add(&mut self, name: &str, rank: Rank, password: &str) -> Result<(), LoginsError> {
        check_name(name)?;
        if password.chars().count() < LEAST || password.len() > MOST {
            return Err(LoginsError::Password);
        }
        let mut salt = [0; SALT];
        getrandom::fill(&mut salt).map_err(|error| LoginsError::Hash(error.to_string()))?;
        let hash = Argon2::default().hash_password_with_salt(password.as_bytes(), &salt);
        let password = hash.map_err(|error| LoginsError::Hash(error.to_string()))?.to_string();
        self.remove(name);
        self.logins.push(Login { name: name.to_owned(), rank, password });
        Ok(())
    }

    /// Adds a kiosk, in place of one of the same name, and returns the token that its link has.
    ///
    /// # Errors
    /// A name that cannot be one.
    pub fn add_kiosk(&mut self, name: &str) -> Result<String, LoginsError> {
        check_name(name)?;
        let token = Token::new().ok_or_else(|| LoginsError::Hash("no random bytes".to_owned()))?;
        self.remove(name);
        self.kiosks.push(Kiosk { name: name.to_owned(), token: token.hash().text() });
        Ok(token.text().to_owned())
    }

    /// Removes a login or a kiosk. False where there is none of this name.
    pub fn remove(&mut self, name: &str) -> bool {
        let before = self.names().count();
        self.logins.retain(|login| login.name != name);
        self.kiosks.retain(|kiosk| kiosk.name != name);
        self.names().count() < before
    }

    /// The login of this name and password. It takes as long where there is no such name, and some tens of milliseconds in any case.
    #[must_use]
    pub fn find(&self, name: &str, password: &str) -> Option<Login> {
        let login = self.logins.iter().find(|login| login.name == name);
        let hash = login.map_or(NOBODY, |login| &login.password);
        let is_right = PasswordHash::new(hash)
            .is_ok_and(|hash| Argon2::default().verify_password(password.as_bytes(), &hash).is_ok());
        login.filter(|_| is_right).cloned()
    }

    /// Whether there is this login, as it is.
    pub(super) fn has(&self, login: &Login) -> bool {
        self.logins.contains(login)
    }

    /// Whether this is the hash of the token of a kiosk.
    pub(super) fn has_kiosk(&self, hash: &TokenHash) -> bool {
        self.kiosks.iter().filter_map(|kiosk| TokenHash::read(&kiosk.token)).any(|known| known.equals(hash))
    }
}

/// What a password is compared with where there is no such name, so that nobody learns names from the time that it takes.
const NOBODY: &str =
    "$argon2id$v=19$m=19456,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";

fn check_name(name: &str) -> Result<(), LoginsError> {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"._-".contains(&byte);
    let is_one = (1..=MAX_NAME).contains(&name.len()) && name.bytes().all(is_plain);
    if is_one { Ok(()) } else { Err(LoginsError::Name(name.to_owned())) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_login_is_found_by_its_password_alone_also_after_it_was_written() {
        let mut logins = Logins::default();
        logins.add("maria", Rank::Technician, "correct horse").unwrap();
        let read = Logins::parse(&logins.text()).unwrap();
        assert_eq!(read, logins);
        let found = read.find("maria", "correct horse").unwrap();
        assert_eq!((found.name.as_str(), found.rank), ("maria", Rank::Technician));
        for (name, password) in
            [("maria", "correct horsf"), ("maria", ""), ("paul", "correct horse"), ("", "")]
        {
            assert_eq!(read.find(name, password), None, "{name} {password}");
        }
        assert!(!read.text().contains("horse") && !format!("{read:?}").contains("argon2"));
        assert!(PasswordHash::new(NOBODY).is_ok());
    }

    #[test]
    fn a_new_password_takes_the_place_of_the_old_one_and_a_login_can_be_removed() {
        let mut logins = Logins::default();
        logins.add("maria", Rank::Technician, "correct horse").unwrap();
        let old = logins.find("maria", "correct horse").unwrap();
        logins.add("maria", Rank::Engineer, "battery staple").unwrap();
        assert!(!logins.has(&old) && logins.find("maria", "correct horse").is_none());
        assert_eq!(logins.names().collect::<Vec<_>>(), [("maria", Some(Rank::Engineer))]);
        assert!(logins.remove("maria") && !logins.remove("maria") && logins.is_empty());
    }

    #[test]
    fn a_kiosk_is_known_by_its_token() {
        let mut logins = Logins::default();
        let token = logins.add_kiosk("bench1").unwrap();
        let hash = Token::read(&token).unwrap().hash();
        assert!(logins.has_kiosk(&hash) && !logins.text().contains(&token) && logins.is_empty());
        assert!(logins.remove("bench1") && !logins.has_kiosk(&hash));
    }

    #[test]
    fn what_is_no_name_no_password_and_no_file_is_refused_with_what_to_do() {
        let mut logins = Logins::default();
        for name in ["", "maria lopez", "m\u{fc}ller", "a\n", &"x".repeat(MAX_NAME + 1)] {
            assert!(
                matches!(logins.add(name, Rank::Worker, "correct horse"), Err(LoginsError::Name(_))),
                "{name}"
            );
            assert!(logins.add_kiosk(name).is_err(), "{name}");
        }
        for password in ["", "1234567", &"x".repeat(MOST + 1)] {
            assert_eq!(logins.add("maria", Rank::Worker, password), Err(LoginsError::Password));
        }
        for text in
            ["x", "[[logins]]\nname = 1", "[[logins]]\nname=\"a\"\nrank=\"worker\"\npassword=\"plain\""]
        {
            let error = Logins::parse(text).unwrap_err().to_string();
            assert!(error.contains("make the logins again"), "{error}");
        }
        assert_eq!(Logins::parse("").unwrap(), Logins::default());
    }
}
