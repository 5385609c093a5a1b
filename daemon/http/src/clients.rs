//! Who is connected. There is always room for one more: whoever has connected and asked nothing makes way, and then whoever reads an answer slowly.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rustix::net::sockopt;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;
use tokio::time::sleep;

use super::connection::{Service, serve};

/// Clients that are served at once. Each may hold a request and an answer in memory.
const CLIENTS: usize = 64;

/// After a failure to accept, as when there are no file descriptors left, and while all that are connected are being answered.
const PAUSE: Duration = Duration::from_millis(100);

/// Who was answered so long ago, and still reads its answer, makes way for another. A machine in the same hall reads within milliseconds.
const SLOW: Duration = Duration::from_secs(1);

/// A client that confirms nothing of what was sent to it for so long is gone, in milliseconds.
const UNREACHABLE_MS: u32 = 10_000;

/// How far a client is.
#[derive(Clone, Debug, Default)]
pub(super) struct Progress(Arc<Mutex<Step>>);

#[derive(Clone, Copy, Debug, Default)]
enum Step {
    #[default]
    Connected,
    /// Its request has come, and the loop answers it soon.
    Asked,
    /// It reads its answer since then.
    Answered(Instant),
    /// It gets a feed, of which the program knows best how long it goes on.
    Fed,
}

impl Progress {
    /// Its request has come, with its form.
    pub(super) fn asked(&self) {
        *self.step() = Step::Asked;
    }

    /// It is sent its answer from now on.
    pub(super) fn answered(&self, is_feed: bool) {
        *self.step() = if is_feed { Step::Fed } else { Step::Answered(Instant::now()) };
    }

    fn step(&self) -> MutexGuard<'_, Step> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct Client {
    task: JoinHandle<()>,
    progress: Progress,
}

impl Client {
    fn is_silent(&self) -> bool {
        matches!(*self.progress.step(), Step::Connected)
    }

    fn is_slow(&self) -> bool {
        matches!(*self.progress.step(), Step::Answered(since) if since.elapsed() >= SLOW)
    }
}

/// Serves every client, each beside the others, until it is dropped.
pub(super) async fn accept_all(listener: &TcpListener, service: &Service) {
    let mut clients = VecDeque::new();
    loop {
        match listener.accept().await {
            Ok((stream, peer)) => {
                // A short message must not wait for the acknowledgement of the one before it. Without this it comes late, and comes all the same.
                let _ = stream.set_nodelay(true);
                cut_off_when_unreachable(&stream);
                make_room(&mut clients).await;
                let (progress, service) = (Progress::default(), service.clone());
                // The runtime has one thread, and ends with it whatever still waits.
                let task = tokio::spawn(serve(stream, peer.ip(), service, progress.clone()));
                clients.push_back(Client { task, progress });
            }
            Err(error) => {
                tracing::debug!(%error, "a client was not accepted");
                sleep(PAUSE).await;
            }
        }
    }
}

/// A machine whose cable was pulled says nothing, and the system would wait for it a quarter of an hour. Where it cannot be told not to, it waits.
fn cut_off_when_unreachable(stream: &TcpStream) {
    if let Err(error) = sockopt::set_tcp_user_timeout(stream, UNREACHABLE_MS) {
        tracing::debug!(%error, "a client that is gone may keep its place");
    }
}

/// Waits until fewer clients are connected than are served at once. The oldest of those that have asked nothing is cut off. A request comes within
/// milliseconds, and a thousand silent connections must not keep a browser out. If there is none, it is the oldest of those that read slowly.
async fn make_room(clients: &mut VecDeque<Client>) {
    loop {
        clients.retain(|client| !client.task.is_finished());
        if clients.len() < CLIENTS {
            return;
        }
        let silent = clients.iter().position(Client::is_silent);
        match silent.or_else(|| clients.iter().position(Client::is_slow)) {
            Some(place) => {
                if let Some(client) = clients.remove(place) {
                    client.task.abort();
                }
            }
            None => sleep(PAUSE).await,
        }
    }
}
