//! Who may see and do what: logins, their sessions, and the rights of both.
//!
//! A password is compared by whoever calls [`crate::Board`], because that takes long; here is what follows from it.

mod delays;
mod logins;
mod rights;
mod sessions;
mod token;

use std::net::IpAddr;

use andon_http::{Later, Request};

use crate::form::Form;
use delays::Delays;
use sessions::Sessions;
use token::{Token, TokenHash};

pub use logins::{Login, Logins, LoginsError, MAX_NAME};
pub use rights::Rank;
pub(crate) use rights::{FILM, MADE, Needs, Place};
pub(crate) use sessions::Session;

/// Passwords that wait to be compared.
const WAITING: usize = 8;

/// A password that somebody has typed, to be compared with what the file of logins says.
pub struct Try {
    /// Its number, for the answer.
    pub number: u64,
    /// The name of the login.
    pub name: String,
    /// The password.
    pub password: String,
}

/// A password must not get into a log.
impl std::fmt::Debug for Try {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Try").field("number", &self.number).field("name", &self.name).finish_non_exhaustive()
    }
}

/// What became of somebody who wanted to log in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tried {
    /// The name that was given.
    pub name: String,
    /// Where it came from.
    pub peer: IpAddr,
    /// The rank of the login, where the password was right.
    pub rank: Option<Rank>,
}

/// Who asks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Visitor {
    /// What they may see; `None` is somebody unknown.
    pub(crate) rank: Option<Rank>,
    /// With a session they may act.
    pub(crate) session: Option<Session>,
    /// What lets them in.
    pub(crate) pass: Option<Pass>,
}

/// What lets somebody in, as long as it lasts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pass {
    /// The number of a session.
    Session(u64),
    /// The token of a kiosk.
    Kiosk(TokenHash),
}

impl Visitor {
    /// Whether they may do what this rank may.
    pub(crate) fn may_act_as(&self, rank: Rank) -> bool {
        self.session.as_ref().is_some_and(|session| session.rank >= rank)
    }
}

/// Somebody whose password is being compared.
#[derive(Debug)]
pub(crate) struct Pending {
    number: u64,
    name: String,
    peer: IpAddr,
    /// The token of the session that they had.
    before: Option<Token>,
    pub(crate) form: Form,
    pub(crate) later: Later,
}

/// Why somebody is not let in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    /// The name or the password is wrong.
    Wrong,
    /// After wrong ones nobody looks at a password for so many seconds.
    Wait(u64),
    /// Nobody looks at it, because too many others wait.
    Busy,
    /// The login is for less.
    More,
}

impl Refused {
    /// The status of the answer.
    pub(crate) const fn status(self) -> u16 {
        match self {
            Self::Wrong => 401,
            Self::Wait(_) => 429,
            Self::Busy => 503,
            Self::More => 403,
        }
    }

    /// The key of what is said.
    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Wrong => "login.wrong",
            Self::Wait(_) => "login.wait",
            Self::Busy => "login.busy",
            Self::More => "login.more",
        }
    }
}

/// All of it.
#[derive(Debug)]
pub(crate) struct Access {
    /// The name of the cookie. Browsers send a cookie to all ports of a machine, and each station has another.
    cookie: String,
    is_secure: bool,
    /// Whether whoever reaches the board may read.
    is_open: bool,
    logins: Logins,
    sessions: Sessions,
    delays: Delays,
    tries: Vec<Try>,
    pending: Vec<Pending>,
    tried: u64,
}

impl Access {
    /// `is_secure` says that browsers reach it by TLS alone, `is_open` that all who reach it may read.
    pub(crate) fn new(port: u16, is_secure: bool, is_open: bool) -> Self {
        // Over TLS no other site of the machine, and nobody on the way, can set a cookie with this prefix.
        let prefix = if is_secure { "__Host-" } else { "" };
        Self {
            cookie: format!("{prefix}andon-{port}"),
            is_secure,
            is_open,
            logins: Logins::default(),
            sessions: Sessions::default(),
            delays: Delays::default(),
            tries: Vec::new(),
            pending: Vec::new(),
            tried: 0,
        }
    }

    /// Whether whoever reaches the board may read.
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// The logins that there are now. Sessions of those that are gone, or have changed, end.
    pub(crate) fn set_logins(&mut self, logins: Logins) {
        self.sessions.keep(|session| logins.has(&session.login));
        self.logins = logins;
    }

    /// Whether nobody can log in.
    pub(crate) fn has_no_logins(&self) -> bool {
        self.logins.is_empty()
    }

    /// Who sends a request.
    pub(crate) fn visitor(&mut self, request: &Request, is_use: bool, now_ns: u64) -> Visitor {
        let Some(token) = self.token(request) else { return Visitor::default() };
        if let Some(session) = self.sessions.find(&token, is_use, now_ns) {
            let pass = Some(Pass::Session(session.number));
            return Visitor { rank: Some(session.rank), session: Some(session), pass };
        }
        let hash = token.hash();
        if self.logins.has_kiosk(&hash) {
            return Visitor { rank: Some(Rank::Worker), session: None, pass: Some(Pass::Kiosk(hash)) };
        }
        Visitor::default()
    }

    fn token(&self, request: &Request) -> Option<Token> {
        let mut cookies = request.cookies.split(';').filter_map(|cookie| cookie.trim().split_once('='));
        cookies.find(|(name, _)| *name == self.cookie).and_then(|(_, value)| Token::read(value))
    }

    /// The value of `Set-Cookie` that gives the browser a token for so many seconds; without any until it is closed.
    fn set_cookie(&self, value: &str, seconds: Option<u32>) -> String {
        let secure = if self.is_secure { "; Secure" } else { "" };
        let age = seconds.map(|seconds| format!("; Max-Age={seconds}")).unwrap_or_default();
        format!("{}={value}; Path=/; HttpOnly; SameSite=Strict{secure}{age}", self.cookie)
    }

    /// The cookie of a kiosk, if this is the token of one.
    pub(crate) fn kiosk(&self, token: &str) -> Option<String> {
        /// Half a year; whoever calls the link again begins anew.
        const SECONDS: u32 = 180 * 24 * 3600;
        let token = Token::read(token).filter(|token| self.logins.has_kiosk(&token.hash()))?;
        Some(self.set_cookie(token.text(), Some(SECONDS)))
    }

    /// Lets a password be compared; `later` answers then.
    pub(crate) fn log_in(
        &mut self,
        request: &Request,
        form: Form,
        now_ns: u64,
        later: Later,
    ) -> Result<(), Refused> {
        let [name, password] = ["name", "password"].map(|key| form.get(key).to_owned());
        let peer = request.peer.unwrap_or(IpAddr::from([0; 4]));
        if let Some(seconds) = self.delays.wait_s(&name, peer, now_ns) {
            return Err(Refused::Wait(seconds));
        }
        if self.pending.len() >= WAITING {
            return Err(Refused::Busy);
        }
        // Several at once count as wrong ones until they were compared: otherwise a hundred could be tried in the time of one.
        self.delays.failed(&name, peer, now_ns);
        self.tried += 1;
        let (number, before) = (self.tried, self.token(request));
        self.tries.push(Try { number, name: name.clone(), password });
        self.pending.push(Pending { number, name, peer, before, form: form.without("password"), later });
        Ok(())
    }

    /// The passwords that are to be compared.
    pub(crate) fn take_tries(&mut self) -> Vec<Try> {
        std::mem::take(&mut self.tries)
    }

    /// A password was compared; the login where it was right. Returns who waits, what became of them, and the cookie of their session.
    pub(crate) fn compared(
        &mut self,
        number: u64,
        login: Option<Login>,
        now_ns: u64,
    ) -> Option<(Pending, Tried, Option<String>)> {
        let place = self.pending.iter().position(|pending| pending.number == number)?;
        let pending = self.pending.remove(place);
        let rank = login.as_ref().map(|login| login.rank);
        let cookie = login.and_then(|login| {
            self.delays.succeeded(&pending.name, pending.peer);
            // Whoever had one before gets another: a token that somebody else has put into this browser is worth nothing.
            if let Some(before) = &pending.before {
                self.sessions.end(before);
            }
            let token = self.sessions.begin(login, now_ns)?;
            Some(self.set_cookie(token.text(), None))
        });
        let tried = Tried { name: pending.name.clone(), peer: pending.peer, rank };
        Some((pending, tried, cookie))
    }

    /// Ends the session of this request, and returns the cookie that says so.
    pub(crate) fn log_out(&mut self, request: &Request) -> String {
        if let Some(token) = self.token(request) {
            self.sessions.end(&token);
        }
        self.set_cookie("", Some(0))
    }

    /// Whether somebody may still be there who was let in.
    pub(crate) fn lasts(&self, pass: Pass, now_ns: u64) -> bool {
        match pass {
            Pass::Session(number) => self.sessions.lasts(number, now_ns),
            Pass::Kiosk(hash) => self.logins.has_kiosk(&hash),
        }
    }
}
