//! A board that a test reaches as a plant's network does.

#![allow(clippy::unwrap_used)]

use std::net::{Ipv4Addr, TcpStream};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use andon_board::{Asked, Board, Logins, NoFilm, Order, Rank, Settings, Wanted};
use andon_http::{Offer, Response, Server};
use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome, VerdictReason};

use crate::answer::{cookie, status};
use crate::beside::{beside, connect, sent};

const PASSWORD: &str = "correct horse";
const SECOND_NS: u64 = 1_000_000_000;

/// A board that is reached from a network, beside its loop.
pub(crate) struct Plant {
    pub(crate) port: u16,
    /// CLOCK_MONOTONIC of the board.
    pub(crate) now_ns: AtomicU64,
    pub(crate) logins: Mutex<Logins>,
    pub(crate) asked: Mutex<Vec<Asked>>,
    pub(crate) orders: Mutex<Vec<Order>>,
    pub(crate) board: Mutex<Board>,
}

/// Runs a test beside a board that listens on this address; what is tried is over the loopback address all the same.
pub(crate) fn served_at(bind: Ipv4Addr, test: impl FnOnce(&Plant)) {
    let offer = Offer { takes_forms: true, tls: None };
    let server = Server::bind_with((Ipv4Addr::LOCALHOST, 0).into(), offer).unwrap();
    let port = server.address().port();
    let mut board = Board::new(Settings { takes_orders: true, ..Settings::new("bench1", bind.into(), port) });
    board.verdict(&fault(4));
    let plant = Plant {
        port,
        now_ns: AtomicU64::new(SECOND_NS),
        logins: Mutex::default(),
        asked: Mutex::default(),
        orders: Mutex::default(),
        board: Mutex::new(board),
    };
    for rank in Rank::ALL {
        plant.logins.lock().unwrap().add(rank.name(), rank, PASSWORD).unwrap();
    }
    plant.tell_logins();
    beside(|| plant.turn(&server), || test(&plant));
}

/// On a network.
pub(crate) fn served(test: impl FnOnce(&Plant)) {
    served_at(Ipv4Addr::new(10, 0, 0, 7), test);
}

pub(crate) fn fault(seq: u64) -> Verdict {
    let mut verdict = Verdict {
        level: VerdictLevel::Iu.code(),
        outcome: VerdictOutcome::Anomaly.code(),
        reason: VerdictReason::WrongObject.code(),
        ..Verdict::NONE
    };
    (verdict.stamp.epoch, verdict.stamp.seq) = (17, seq);
    verdict
}

impl Plant {
    pub(crate) fn turn(&self, server: &Server) {
        let mut board = self.board.lock().unwrap();
        board.publish(self.now_ns.load(Ordering::Relaxed));
        for of in board.take_tries() {
            let login = self.logins.lock().unwrap().find(&of.name, &of.password);
            board.compared(of.number, login);
        }
        for ask in board.asks() {
            match ask.wanted {
                Wanted::Film => board.film(ask, &Err(NoFilm::NoClip)),
                _ => ask.answer(Response::text(404, "there is none\n")),
            }
        }
        for fetch in board.take_fetches() {
            fetch.answer(Response::text(404, "there is none\n"));
        }
        self.orders.lock().unwrap().extend(board.take_orders());
        for asked in board.take_asked() {
            self.asked.lock().unwrap().push(asked);
        }
        server.serve(|request| board.answer(request));
    }

    pub(crate) fn tell_logins(&self) {
        self.board.lock().unwrap().logins(self.logins.lock().unwrap().clone());
    }

    /// Lets time pass. Every request from now on is answered after it.
    pub(crate) fn pass(&self, seconds: u64) {
        let mut board = self.board.lock().unwrap();
        let before_ns = self.now_ns.fetch_add(seconds * SECOND_NS, Ordering::Relaxed);
        board.publish(before_ns + seconds * SECOND_NS);
    }

    pub(crate) fn connect(&self) -> TcpStream {
        connect(self.port)
    }

    pub(crate) fn sent(&self, request: &str) -> String {
        sent(self.port, request.as_bytes())
    }

    /// Gets an address with this cookie.
    pub(crate) fn get(&self, target: &str, cookie: &str) -> String {
        self.sent(&format!(
            "GET {target} HTTP/1.1\r\nHost: localhost:{}\r\nCookie: {cookie}\r\n\r\n",
            self.port
        ))
    }

    /// Sends a form as a page of the board does.
    pub(crate) fn post(&self, target: &str, cookie: &str, form: &str) -> String {
        let origin = format!("Origin: http://localhost:{}\r\nSec-Fetch-Site: same-origin\r\n", self.port);
        self.post_from(target, cookie, &origin, form)
    }

    pub(crate) fn post_from(&self, target: &str, cookie: &str, origin: &str, form: &str) -> String {
        self.sent(&format!(
            "POST {target} HTTP/1.1\r\nHost: localhost:{}\r\nCookie: {cookie}\r\n{origin}Content-Type: \
             application/x-www-form-urlencoded\r\nContent-Length: {}\r\n\r\n{form}",
            self.port,
            form.len()
        ))
    }

    pub(crate) fn log_in(&self, name: &str, cookie: &str) -> String {
        self.post("/login", cookie, &format!("name={name}&password=correct+horse&to=technician"))
    }

    /// The cookie of a new session.
    pub(crate) fn session(&self, name: &str) -> String {
        let answer = self.log_in(name, "");
        assert_eq!(status(&answer), 303, "{answer}");
        cookie(&answer)
    }

    /// The token that the forms of a session have.
    pub(crate) fn csrf(&self, session: &str) -> String {
        let page = self.get("/", session);
        let from =
            page.split_once("name=\"csrf\" value=\"").unwrap_or_else(|| unreachable!("no token in {page}")).1;
        from.split('"').next().unwrap().to_owned()
    }

    pub(crate) fn asked(&self) -> usize {
        self.asked.lock().unwrap().len()
    }
}
