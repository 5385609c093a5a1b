//! What the board answers: first whether the asker may have it, then what it is.

use andon_http::{Request, Response};
use shm_schemas::MessageId;

use crate::access::{FILM, Login, Logins, MADE, Needs, Place, Rank, Refused, Tried, Try, Visitor};
use crate::address::{Address, Page, is_plain};
use crate::board::Board;
use crate::confirm::{Asked, Kept, Was};
use crate::desk::MadeFile;
use crate::film::Wanted;
use crate::form::Form;
use crate::page;
use crate::watchers::AGAIN;

pub(crate) const HTML: &str = "text/html; charset=utf-8";
pub(crate) const SVG: &str = "image/svg+xml";
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";

const STYLE: &str = include_str!("page/board.css");
const SCRIPT: &str = include_str!("page/board.js");
const SOUND: &str = include_str!("page/sound.js");
const PLAYER: &str = include_str!("page/player.js");
const UPLOAD: &str = include_str!("page/upload.js");

/// Nothing comes from anywhere else, nothing of it goes to another site, and no browser keeps it. A browser says where a form comes from only where
/// the policy of the referrer lets it say so to the board itself.
const SAFETY: &[(&str, &str)] = &[
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'self'; \
         frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

impl Board {
    /// Answers a browser.
    pub fn answer(&mut self, request: &Request) -> Response {
        self.answered(request).with(SAFETY)
    }

    fn answered(&mut self, request: &Request) -> Response {
        if !self.guard.knows(request) {
            return Response::text(421, "the board does not answer to this name\n");
        }
        if request.is_from_another_site {
            return Response::text(403, "the board is not for pages of other sites\n");
        }
        let Some(place) = Place::of(request, self.settings.is_look) else {
            return Response::text(404, "the board is at /, at /technician and at /engineer\n");
        };
        let is_use = request.form.is_some() || matches!(place, Place::Page(_));
        let visitor = self.access.visitor(request, is_use, self.now_ns);
        match request.form.as_deref().map(Form::read) {
            None => match place.get() {
                Some(needs) => self.get(request, place, needs, &visitor),
                None => Response::text(405, "this is for forms\n").with_own("allow", "POST".to_owned()),
            },
            Some(form) => match place.post() {
                Some(needs) => self.post(request, place, needs, &visitor, form),
                None => {
                    Response::text(405, "no form is taken here\n").with_own("allow", "GET, HEAD".to_owned())
                }
            },
        }
    }

    fn get(&mut self, request: &Request, place: Place, needs: Needs, visitor: &Visitor) -> Response {
        let is_kept_out = match needs {
            Needs::ToRead(rank) => !self.access.is_open() && visitor.rank < Some(rank),
            Needs::ToEnter(rank) | Needs::ToAct(rank) => visitor.rank < Some(rank),
            Needs::Nothing => false,
        };
        if is_kept_out {
            return self.turned_away(request, place, visitor);
        }
        match place {
            Place::Page(page) => self.page(&Address::new(page, &request.query), visitor),
            Place::Events(_) => self.watch(&request.query, visitor),
            Place::Picture if self.settings.picture => self.view(&request.query),
            Place::Style => Response::ok("text/css; charset=utf-8", STYLE),
            Place::Script => Response::ok(JAVASCRIPT, SCRIPT),
            Place::Sound => Response::ok(JAVASCRIPT, SOUND),
            Place::Player => Response::ok(JAVASCRIPT, PLAYER),
            Place::Upload => Response::ok(JAVASCRIPT, UPLOAD),
            Place::Film => self.of_film(request, visitor),
            Place::Step => match self.job.picture_at(&request.path) {
                Some(jpeg) if self.settings.picture => Response::ok("image/jpeg", jpeg),
                _ => Response::text(404, "there is no picture of such a step\n"),
            },
            Place::LogIn => self.login_page(&Address::of_login(&request.query), None),
            Place::Kiosk => self.kiosk(request),
            Place::Made => self.of_made(request),
            Place::Picture | Place::LogOut | Place::Confirm | Place::Order => {
                Response::text(404, "the board has no such thing\n")
            }
        }
    }

    /// What somebody gets who may not see a place.
    fn turned_away(&self, request: &Request, place: Place, visitor: &Visitor) -> Response {
        match place {
            Place::Page(page) => {
                let address = Address::new(page, &request.query);
                match visitor.rank {
                    None => Response::see(&address.login()),
                    Some(_) => self.login_page(&address, Some(Refused::More)),
                }
            }
            // The page that watched is loaded again, and then says what is to be done.
            Place::Events(_) => Response::ok("text/event-stream", AGAIN),
            _ => Response::text(401, "log in first\n"),
        }
    }

    fn post(
        &mut self,
        request: &Request,
        place: Place,
        needs: Needs,
        visitor: &Visitor,
        form: Form,
    ) -> Response {
        const FOREIGN: &str = "the form does not come from a page of the board; load the page again\n";
        if !request.is_from_own_page {
            return Response::text(403, FOREIGN);
        }
        let address = Address::of_login(&form.query());
        if let Needs::ToAct(rank) = needs {
            let Some(session) = &visitor.session else { return Response::see(&address.login()) };
            if !session.csrf.is(form.get("csrf")) {
                return Response::text(403, FOREIGN);
            }
            if session.rank < rank {
                return self.login_page(&address, Some(Refused::More));
            }
        }
        match place {
            Place::LogIn => self.log_in(request, form, &address),
            Place::LogOut => {
                let cookie = self.access.log_out(request);
                let to = if self.access.is_open() { address.link() } else { address.login() };
                Response::see(&to).with_own("set-cookie", cookie)
            }
            Place::Confirm => self.ask_to_confirm(&form, visitor, address),
            Place::Order => self.order(&form, visitor, address),
            _ => Response::text(404, "the board has no such thing\n"),
        }
    }

    fn page(&mut self, address: &Address, visitor: &Visitor) -> Response {
        match address.page {
            Page::Technician => self.asked_ns = Some(self.now_ns),
            Page::Engineer | Page::Job => self.desk.ask(self.now_ns),
            _ => (),
        }
        let address = address.clone().for_visitor(visitor);
        if address.page == Page::Event
            && self.settings.picture
            && let Some(event) = self.event(&address.at).copied()
        {
            return self.asks.add(Wanted::Film, &event, address, visitor);
        }
        Response::ok(HTML, page::whole(self, &address, visitor, None))
    }

    /// What a disk has of an event. A recording is kept as a file, under the last name of its path.
    fn of_film(&mut self, request: &Request, visitor: &Visitor) -> Response {
        let address = Address::new(Page::Event, &request.query).for_visitor(visitor);
        let event = self.event(&address.at).filter(|_| self.settings.picture).copied();
        let wanted = match request.path.strip_prefix(FILM) {
            Some("frame.svg") => address.frame.parse().ok().map(Wanted::Frame),
            Some(name) if is_plain(name) => Some(Wanted::Recording(name.to_owned())),
            _ => None,
        };
        let Some((wanted, event)) = wanted.zip(event) else {
            return Response::text(404, "the board knows no such event, or shows no pictures\n");
        };
        let is_file = matches!(wanted, Wanted::Recording(_));
        let response = self.asks.add(wanted, &event, address, visitor);
        match is_file {
            true => response.with_own("content-disposition", "attachment".to_owned()),
            false => response,
        }
    }

    /// What a command of an engineer has made, under the last name of its path.
    fn of_made(&mut self, request: &Request) -> Response {
        let name = request.path.strip_prefix(MADE).unwrap_or_default();
        let of = Address::new(Page::Job, &request.query).at;
        let Some(file) = MadeFile::named(name, of) else {
            return Response::text(404, "there is no such file\n");
        };
        if file.is_picture() && !self.settings.picture {
            return Response::text(404, "this board shows no picture\n");
        }
        let to_keep = match &file {
            MadeFile::Markers => Some("attachment; filename=markers.pdf".to_owned()),
            // Only letters, digits, dots, dashes and underscores were read of it.
            MadeFile::Station(name) => Some(format!("attachment; filename={name}.toml")),
            _ => None,
        };
        let response = self.desk.fetch(file);
        match to_keep {
            Some(how) => response.with_own("content-disposition", how),
            None => response,
        }
    }

    fn login_page(&self, address: &Address, refused: Option<Refused>) -> Response {
        let response = Response::ok(HTML, page::login(self, address, refused));
        let response = response.with_status(refused.map_or(200, Refused::status));
        match refused {
            Some(Refused::Wait(seconds)) => response.with_own("retry-after", seconds.to_string()),
            _ => response,
        }
    }

    fn watch(&mut self, query: &str, visitor: &Visitor) -> Response {
        let browser = Address::browser(query);
        if !self.watchers.make_room(browser) {
            return Response::text(503, "as many browsers watch already as can be served\n");
        }
        let (response, feed) = Response::feed("text/event-stream");
        self.watchers.add(feed, Address::of_events(query).for_visitor(visitor), browser, visitor.pass);
        response
    }

    /// The picture comes as soon as there is one.
    fn view(&mut self, query: &str) -> Response {
        if !self.viewers.have_room() {
            return Response::text(503, "as many browsers wait for a picture as can be served\n");
        }
        let (response, feed) = Response::feed(SVG);
        self.viewers.add(feed, Address::new(Page::Technician, query), self.now_ns);
        response
    }

    /// Gives a screen the cookie that its link is for. The page leads on by itself: where another site had the link, a browser would not send the
    /// cookie with an address that it is led to.
    fn kiosk(&self, request: &Request) -> Response {
        let token = request.query.strip_prefix("token=").unwrap_or_default();
        match self.access.kiosk(token) {
            Some(cookie) => Response::ok(HTML, page::kiosk(self)).with_own("set-cookie", cookie),
            None => Response::text(403, "this link is none, or the kiosk was removed\n"),
        }
    }

    fn log_in(&mut self, request: &Request, form: Form, address: &Address) -> Response {
        let (response, later) = Response::later();
        match self.access.log_in(request, form, self.now_ns, later) {
            Ok(()) => response,
            Err(refused) => self.login_page(address, Some(refused)),
        }
    }

    /// The logins that there are now.
    pub fn logins(&mut self, logins: Logins) {
        self.access.set_logins(logins);
    }

    /// The passwords that are to be compared with those of the logins. [`Board::compared`] takes what came of each.
    pub fn take_tries(&mut self) -> Vec<Try> {
        self.access.take_tries()
    }

    /// A password was compared: the login, where it was right. Returns what became of it, for the log.
    pub fn compared(&mut self, number: u64, login: Option<Login>) -> Option<Tried> {
        let (pending, tried, cookie) = self.access.compared(number, login, self.now_ns)?;
        let address = Address::of_login(&pending.form.query());
        let response = match (tried.rank, cookie) {
            (Some(rank), Some(cookie)) => {
                let page = if rank >= Place::reader(address.page) { address.page } else { Page::Worker };
                Response::see(&Address { page, ..address }.link()).with_own("set-cookie", cookie)
            }
            (Some(_), None) => self.login_page(&address, Some(Refused::Busy)),
            (None, _) => self.login_page(&address, Some(Refused::Wrong)),
        };
        pending.later.send(response);
        Some(tried)
    }

    fn ask_to_confirm(&mut self, form: &Form, visitor: &Visitor, address: Address) -> Response {
        let said = Was::ALL.into_iter().find_map(|was| {
            let verdict = form.get(was.name());
            (!verdict.is_empty()).then(|| (was, MessageId::named(verdict)))
        });
        let (Some((was, Some(verdict))), Some(session)) = (said, &visitor.session) else {
            return Response::text(400, "the form names no verdict\n");
        };
        let (response, later) = Response::later();
        match self.asked.len() < crate::confirm::WAITING {
            true => {
                let login = session.login.name.clone();
                self.asked.push(Asked { login, verdict, was, address, later });
                response
            }
            false => Response::text(503, "too much is being kept; try again\n"),
        }
    }

    /// What people ask the line to keep. [`Board::answer_asked`] takes what came of each.
    pub fn take_asked(&mut self) -> Vec<Asked> {
        std::mem::take(&mut self.asked)
    }

    /// Tells who has asked what came of it.
    pub fn answer_asked(&mut self, asked: Asked, kept: Kept) {
        let Asked { address, later, .. } = asked;
        let response = match kept {
            Kept::Kept => Response::see(&address.link()),
            Kept::Gone => {
                Response::ok(HTML, page::notice(self, &address, "confirm.gone", "")).with_status(404)
            }
            Kept::Unkept => {
                Response::ok(HTML, page::notice(self, &address, "confirm.unkept", "")).with_status(503)
            }
        };
        later.send(response);
    }
}

impl Address {
    /// The address as this visitor sees its page.
    fn for_visitor(self, visitor: &Visitor) -> Self {
        Self { may_confirm: visitor.may_act_as(Rank::Technician), ..self }
    }
}
