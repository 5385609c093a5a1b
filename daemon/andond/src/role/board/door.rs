//! Compares passwords with the file of logins, and tells when that file has changed.
//!
//! A comparison takes tens of milliseconds and some megabytes on purpose, and a disk may be slow: a thread does it, one after the other.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;
use std::time::Duration;

use andon_board::{Board, Login, Logins, Try};
use andon_host::log::{code, log};

use crate::boards::LoginsFile;

/// How often it looks whether the file has changed: somebody whose login was removed is out within this time.
const LOOK: Duration = Duration::from_secs(1);

/// What the thread tells.
enum Told {
    Logins(Logins),
    Compared(u64, Option<Login>),
}

/// The door. Its thread ends when this is dropped.
pub(super) struct Door {
    tries: Sender<Try>,
    told: Receiver<Told>,
}

impl Door {
    /// Begins to look at the file of logins.
    pub(super) fn open(file: LoginsFile) -> std::io::Result<Self> {
        let ((tries, tried), (tell, told)) = (channel(), channel());
        Builder::new().name("door".into()).spawn(move || keep(file, &tried, &tell))?;
        Ok(Self { tries, told })
    }

    /// Gives the thread what is to be compared, and the board what came of it.
    pub(super) fn turn(&self, board: &mut Board) {
        for told in self.told.try_iter() {
            match told {
                Told::Logins(logins) => board.logins(logins),
                Told::Compared(number, login) => tell(board, number, login),
            }
        }
        for of in board.take_tries() {
            // The thread lasts as long as this.
            let _ = self.tries.send(of);
        }
    }
}

fn tell(board: &mut Board, number: u64, login: Option<Login>) {
    let Some(tried) = board.compared(number, login) else { return };
    let (name, peer) = (&tried.name, tried.peer);
    match tried.rank {
        Some(rank) => log!(code::BOARD_LOGIN, "{name}, {}, from {peer}", rank.name()),
        None => log!(code::BOARD_LOGIN_REFUSED, "as {name:?}, from {peer}"),
    }
}

fn keep(mut file: LoginsFile, tried: &Receiver<Try>, tell: &Sender<Told>) {
    let mut wait = Duration::ZERO;
    loop {
        let of = match tried.recv_timeout(wait) {
            Ok(of) => Some(of),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return,
        };
        wait = LOOK;
        if let Some(read) = file.renew() {
            if let Err(error) = read {
                log!(code::BOARD_LOGINS_UNREADABLE, "{error}");
            }
            if tell.send(Told::Logins(file.logins.clone())).is_err() {
                return;
            }
        }
        if let Some(Try { number, name, password }) = of
            && tell.send(Told::Compared(number, file.logins.find(&name, &password))).is_err()
        {
            return;
        }
    }
}
