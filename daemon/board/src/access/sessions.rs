//! Who has logged in, and for how long.

use super::logins::Login;
use super::rights::Rank;
use super::token::{Token, TokenHash};

/// Sessions in all. The one that was not used for the longest makes way for a new one.
const MOST: usize = 64;

/// Sessions of one login: a person has a few browsers.
const OF_ONE_LOGIN: usize = 8;

/// A session ends when nobody has turned a page for so long. What a page fetches by itself is no use.
const IDLE_NS: u64 = 30 * 60 * 1_000_000_000;

/// A session ends after so long in any case: a shift.
const LONGEST_NS: u64 = 12 * 3600 * 1_000_000_000;

/// A session, as the rest of the board sees it.
#[derive(Clone, Debug)]
pub(crate) struct Session {
    pub(crate) number: u64,
    pub(crate) login: Login,
    pub(crate) rank: Rank,
    /// Every form of this session has it, and no page of another site can read it.
    pub(crate) csrf: Token,
}

#[cfg(test)]
impl Session {
    /// One of an engineer.
    pub(crate) fn sample(name: &str) -> Self {
        let rank = Rank::Engineer;
        let login = Login { name: name.to_owned(), rank, password: String::new() };
        Self { number: 1, login, rank, csrf: Token::new().unwrap_or_else(|| unreachable!()) }
    }
}

#[derive(Debug)]
struct Kept {
    hash: TokenHash,
    session: Session,
    began_ns: u64,
    used_ns: u64,
}

impl Kept {
    fn lasts(&self, now_ns: u64) -> bool {
        now_ns.saturating_sub(self.used_ns) < IDLE_NS && now_ns.saturating_sub(self.began_ns) < LONGEST_NS
    }
}

/// All of them. They are in memory alone: a board that starts again asks for passwords again.
#[derive(Debug, Default)]
pub(crate) struct Sessions {
    kept: Vec<Kept>,
    begun: u64,
}

impl Sessions {
    /// Begins one, and returns its token; `None` where the system gives no random bytes.
    pub(super) fn begin(&mut self, login: Login, now_ns: u64) -> Option<Token> {
        let (token, csrf) = (Token::new()?, Token::new()?);
        self.kept.retain(|kept| kept.lasts(now_ns));
        let is_own = |kept: &Kept| kept.session.login.name == login.name;
        if self.kept.iter().filter(|kept| is_own(kept)).count() >= OF_ONE_LOGIN {
            self.make_way(is_own);
        }
        if self.kept.len() >= MOST {
            self.make_way(|_| true);
        }
        self.begun += 1;
        let session = Session { number: self.begun, rank: login.rank, login, csrf };
        self.kept.push(Kept { hash: token.hash(), session, began_ns: now_ns, used_ns: now_ns });
        Some(token)
    }

    /// Ends the one of these that was not used for the longest.
    fn make_way(&mut self, of: impl Fn(&Kept) -> bool) {
        let oldest = self.kept.iter().enumerate().filter(|(_, kept)| of(kept));
        if let Some((place, _)) = oldest.min_by_key(|(_, kept)| kept.used_ns) {
            self.kept.remove(place);
        }
    }

    /// The session of a token.
    pub(super) fn find(&mut self, token: &Token, is_use: bool, now_ns: u64) -> Option<Session> {
        let hash = token.hash();
        let kept = self.kept.iter_mut().find(|kept| kept.hash.equals(&hash))?;
        if !kept.lasts(now_ns) {
            return None;
        }
        if is_use {
            kept.used_ns = now_ns;
        }
        Some(kept.session.clone())
    }

    pub(super) fn end(&mut self, token: &Token) {
        let hash = token.hash();
        self.kept.retain(|kept| !kept.hash.equals(&hash));
    }

    /// Ends all but these.
    pub(super) fn keep(&mut self, is_kept: impl Fn(&Session) -> bool) {
        self.kept.retain(|kept| is_kept(&kept.session));
    }

    pub(super) fn lasts(&self, number: u64, now_ns: u64) -> bool {
        self.kept.iter().any(|kept| kept.session.number == number && kept.lasts(now_ns))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn login(name: &str) -> Login {
        Login { name: name.to_owned(), rank: Rank::Technician, password: String::new() }
    }

    #[test]
    fn a_session_ends_when_it_is_not_used_and_after_a_shift_in_any_case() {
        let mut sessions = Sessions::default();
        let token = sessions.begin(login("maria"), 0).unwrap();
        assert!(sessions.find(&token, false, IDLE_NS - 1).is_some());
        assert!(sessions.find(&token, true, IDLE_NS - 2).is_some(), "what is no use prolongs nothing");
        assert!(sessions.find(&token, false, 2 * IDLE_NS - 3).is_some());
        assert!(sessions.find(&token, false, 2 * IDLE_NS - 2).is_none());
        let token = sessions.begin(login("maria"), 0).unwrap();
        let ends = (0..LONGEST_NS).step_by(IDLE_NS as usize / 2).map(|at| sessions.find(&token, true, at));
        assert!(ends.into_iter().all(|found| found.is_some()));
        assert!(sessions.find(&token, true, LONGEST_NS).is_none());
    }

    #[test]
    fn there_are_never_more_sessions_than_have_room_and_no_login_drives_out_the_others() {
        let mut sessions = Sessions::default();
        let first = sessions.begin(login("paul"), 0).unwrap();
        let tokens: Vec<Token> = (1..30).map(|at| sessions.begin(login("maria"), at).unwrap()).collect();
        assert_eq!(sessions.kept.len(), 1 + OF_ONE_LOGIN);
        assert!(sessions.find(&first, true, 30).is_some());
        assert!(sessions.find(&tokens[0], true, 30).is_none());
        for number in 0..200 {
            sessions.begin(login(&number.to_string()), 31 + number).unwrap();
        }
        assert_eq!(sessions.kept.len(), MOST);
    }
}
