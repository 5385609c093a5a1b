//! What an engineer orders on the board. The role sends it to the line, and says what became of it.

use andon_http::{Later, Response};
use base64ct::{Base64UrlUnpadded, Encoding as _};
use shm_schemas::{PIECE_BYTES, Showing, TASK_NAME_BYTES, TASK_TEXT_BYTES, TaskKind, task_flag};

use crate::access::Visitor;
use crate::address::Address;
use crate::answer::HTML;
use crate::board::Board;
use crate::form::Form;
use crate::page;

/// Orders that wait for the line.
const WAITING: usize = 8;

/// A task that somebody orders.
#[derive(Debug)]
pub struct Order {
    /// The name of the login.
    pub login: String,
    /// What is to be done.
    pub kind: TaskKind,
    /// The job, where there is one.
    pub name: String,
    /// What else is to be said.
    pub text: String,
    /// Bits of [`task_flag`].
    pub flags: u8,
    /// What an answer answers.
    pub showing: Option<Showing>,
    /// Of a recording that is sent: a piece of it.
    pub piece: Option<Piece>,
    address: Address,
    later: Later,
}

/// A piece of a recording. One without bytes, of a recording of no size, breaks it off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The number that the browser has given the recording.
    pub film: u64,
    /// How many bytes of it come before.
    pub at: u64,
    /// Bytes of the whole.
    pub size: u64,
    /// The bytes of this piece, [`PIECE_BYTES`] at most.
    pub bytes: Vec<u8>,
}

impl Piece {
    fn read(form: &Form) -> Option<Self> {
        let number = |key| form.get(key).parse().ok();
        let bytes = Base64UrlUnpadded::decode_vec(form.get("piece")).ok();
        let bytes = bytes.filter(|bytes| bytes.len() <= PIECE_BYTES)?;
        Some(Self { film: number("film")?, at: number("at")?, size: number("size")?, bytes })
    }
}

/// What became of an order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ordered {
    /// It has begun, or was passed on.
    Taken,
    /// It is not done, for this reason.
    Refused(String),
    /// The role that does it does not answer.
    Unheard,
}

/// Why a form is no order.
#[derive(Debug, PartialEq, Eq)]
enum NoOrder {
    /// It asks for nothing that there is.
    Nothing,
    /// It says more than an order has room for: half of it would be another order.
    TooMuch,
}

/// What a form asks for.
#[derive(Debug, PartialEq, Eq)]
struct Asked {
    kind: TaskKind,
    name: String,
    text: String,
    flags: u8,
    showing: Option<Showing>,
    piece: Option<Piece>,
}

impl Asked {
    fn of(kind: TaskKind, name: String, text: String) -> Self {
        Self { kind, name, text, flags: 0, showing: None, piece: None }
    }

    fn read(form: &Form) -> Result<Self, NoOrder> {
        if form.is_cut() {
            return Err(NoOrder::TooMuch);
        }
        let lines = |key| form.all(key).collect::<Vec<_>>().join("\n");
        let job = || form.get("job").to_owned();
        let mut asked = match form.get("do") {
            "live" => Self::of(TaskKind::TeachLive, job(), form.get("count").to_owned()),
            "films" => Self::of(TaskKind::TeachFilms, job(), lines("film")),
            "again" => Self::of(TaskKind::TeachAgain, job(), String::new()),
            "name" => Self::of(TaskKind::Name, job(), lines("step")),
            "markers" => Self::of(TaskKind::Markers, String::new(), String::new()),
            "look" => Self::of(TaskKind::Look, String::new(), String::new()),
            "calibrate" => {
                let text = format!("{}\n{}", form.get("side"), lines("marker"));
                Self::of(TaskKind::Calibrate, String::new(), text)
            }
            "new" => {
                let text = format!("{}\n{}\n{}", form.get("camera"), form.get("language"), lines("part"));
                Self::of(TaskKind::New, form.get("station").to_owned(), text)
            }
            "film" => {
                let piece = Piece::read(form).ok_or(NoOrder::Nothing)?;
                Self {
                    piece: Some(piece),
                    ..Self::of(TaskKind::Film, form.get("name").to_owned(), String::new())
                }
            }
            "stop" => Self::of(TaskKind::Stop, String::new(), String::new()),
            "" => Self::of_button(form).ok_or(NoOrder::Nothing)?,
            _ => return Err(NoOrder::Nothing),
        };
        for (key, flag) in
            [("force", task_flag::FORCE), ("add", task_flag::ADD), ("pictures", task_flag::PICTURES)]
        {
            asked.flags |= if form.get(key).is_empty() { 0 } else { flag };
        }
        let fits = asked.name.len() <= TASK_NAME_BYTES && asked.text.len() <= TASK_TEXT_BYTES;
        if fits { Ok(asked) } else { Err(NoOrder::TooMuch) }
    }

    /// What a button of a list asks for: its value names the job, and what of it.
    fn of_button(form: &Form) -> Option<Self> {
        const BUTTONS: [(&str, TaskKind); 5] = [
            ("load", TaskKind::Load),
            ("whatif", TaskKind::Whatif),
            ("back", TaskKind::RollBack),
            ("without", TaskKind::Without),
            ("answer", TaskKind::Answer),
        ];
        let (value, kind) = BUTTONS.into_iter().find_map(|(key, kind)| {
            let value = form.get(key);
            (!value.is_empty()).then_some((value, kind))
        })?;
        let (name, text) = value.split_once('/').unwrap_or((value, ""));
        if kind != TaskKind::Answer {
            return Some(Self::of(kind, name.to_owned(), text.to_owned()));
        }
        let showing = Showing::ALL.iter().copied().find(|showing| showing.name() == name)?;
        Some(Self { showing: Some(showing), ..Self::of(kind, String::new(), text.to_owned()) })
    }
}

impl Board {
    pub(crate) fn order(&mut self, form: &Form, visitor: &Visitor, address: Address) -> Response {
        let (asked, session) = match (Asked::read(form), &visitor.session) {
            (Ok(asked), Some(session)) => (asked, session),
            (Err(NoOrder::TooMuch), _) => {
                let page = page::notice(self, &address, "engineer.too_much", "");
                return Response::ok(HTML, page).with_status(413);
            }
            _ => return Response::text(400, "the form asks for nothing that there is\n"),
        };
        if !self.settings.takes_orders {
            return Response::ok(HTML, page::notice(self, &address, "engineer.off", "")).with_status(409);
        }
        if self.desk.orders.len() >= WAITING {
            return Response::text(503, "too many orders wait; try again\n");
        }
        let (response, later) = Response::later();
        let Asked { kind, name, text, flags, showing, piece } = asked;
        let login = session.login.name.clone();
        self.desk.orders.push(Order { login, kind, name, text, flags, showing, piece, address, later });
        response
    }

    /// What engineers have ordered. [`Board::answer_order`] takes what became of each.
    pub fn take_orders(&mut self) -> Vec<Order> {
        std::mem::take(&mut self.desk.orders)
    }

    /// Tells who has ordered it what became of it.
    pub fn answer_order(&mut self, order: Order, ordered: &Ordered) {
        let Order { address, later, piece, .. } = order;
        if piece.is_some() {
            // A script reads it.
            return later.send(match ordered {
                Ordered::Taken => Response::text(200, ""),
                Ordered::Refused(why) => Response::text(409, why),
                Ordered::Unheard => Response::text(503, "the role executor does not answer\n"),
            });
        }
        let told = |key, status, why: &str| {
            Response::ok(HTML, page::notice(self, &address, key, why)).with_status(status)
        };
        let response = match ordered {
            Ordered::Taken => Response::see(&address.link()),
            Ordered::Refused(why) => told("engineer.refused", 409, why),
            Ordered::Unheard => told("engineer.unheard", 503, ""),
        };
        later.send(response);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    type Told = Result<(TaskKind, String, String, u8), NoOrder>;

    fn asked(form: &str) -> Told {
        let Asked { kind, name, text, flags, .. } = Asked::read(&Form::read(form.as_bytes()))?;
        Ok((kind, name, text, flags))
    }

    fn task(kind: TaskKind, name: &str, text: &str, flags: u8) -> Told {
        Ok((kind, name.to_owned(), text.to_owned(), flags))
    }

    #[test]
    fn a_form_asks_for_one_task() {
        assert_eq!(asked("do=live&job=polish&count=5"), task(TaskKind::TeachLive, "polish", "5", 0));
        assert_eq!(
            asked("do=films&job=polish&film=a.mp4&film=b.mp4&force=1&pictures=1"),
            task(TaskKind::TeachFilms, "polish", "a.mp4\nb.mp4", task_flag::FORCE | task_flag::PICTURES)
        );
        assert_eq!(
            asked("do=name&job=polish&step=Polish+it&step=Measure"),
            task(TaskKind::Name, "polish", "Polish it\nMeasure", 0)
        );
        assert_eq!(asked("load=polish"), task(TaskKind::Load, "polish", "", 0));
        assert_eq!(asked("back=polish/07"), task(TaskKind::RollBack, "polish", "07", 0));
        assert_eq!(asked("do=stop"), task(TaskKind::Stop, "", "", 0));
        let answer = Asked::read(&Form::read(b"answer=keep/t")).unwrap();
        assert_eq!((answer.text.as_str(), answer.showing), ("t", Some(Showing::Keep)));
        let end = Asked::read(&Form::read(b"answer=run/")).unwrap();
        assert_eq!((end.text.as_str(), end.showing), ("", Some(Showing::Run)));
    }

    #[test]
    fn what_is_no_task_asks_for_nothing_and_what_is_too_long_is_too_much() {
        for form in ["", "do=delete", "load=", "answer=never/k"] {
            assert_eq!(asked(form), Err(NoOrder::Nothing), "{form}");
        }
        let long = "x".repeat(TASK_TEXT_BYTES);
        let many = "film=a.mp4&".repeat(2000);
        for form in [
            format!("load={long}"),
            format!("do=name&job=polish&step={long}&step={long}"),
            format!("do=films&job=polish&{many}"),
            format!("{many}do=films&job=polish"),
        ] {
            assert_eq!(asked(&form), Err(NoOrder::TooMuch), "{}", &form[..40]);
        }
    }

    #[test]
    fn letters_are_the_bytes_that_they_were_and_what_is_none_is_refused() {
        let bytes = |letters: &str| {
            let form = format!("film=1&at=0&size=1&piece={letters}");
            Piece::read(&Form::read(form.as_bytes())).map(|piece| piece.bytes)
        };
        // From RFC 4648, chapter 10, without what fills them up.
        for (text, letters) in [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(bytes(letters).as_deref(), Some(text.as_bytes()));
        }
        assert_eq!(bytes("-_-_"), Some(vec![0xfb, 0xff, 0xbf]));
        for letters in ["Z", "Zg==", "Zm9v Zm9v", "Zm9v%2B", "/", "Zh", "\u{fc}"] {
            assert_eq!(bytes(letters), None, "{letters}");
        }
    }

    #[test]
    fn fifty_recordings_and_twenty_long_names_of_steps_are_one_order() {
        let films = format!("film={}.mp4&", "x".repeat(52)).repeat(50);
        let (kind, _, text, _) = asked(&format!("do=films&job=polish&{films}")).unwrap();
        assert_eq!((kind, text.lines().count()), (TaskKind::TeachFilms, 50));
        let steps = format!("step={}&", "%E6%AD%A5".repeat(60)).repeat(20);
        let (kind, _, text, _) = asked(&format!("do=name&job=polish&{steps}")).unwrap();
        assert_eq!((kind, text.lines().count()), (TaskKind::Name, 20));
    }
}
