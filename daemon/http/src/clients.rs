//! Who is connected. There is always room for one more: whoever has connected and asked nothing makes way.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio::time::sleep;

use super::Call;
use super::connection::serve;

/// Clients that are served at once. Each may hold a request and an answer in memory.
const CLIENTS: usize = 64;

/// After a failure to accept, as when there are no file descriptors left, and while all that are connected are being answered.
const PAUSE: Duration = Duration::from_millis(100);

/// Whether a client has sent its request.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked(Arc<AtomicBool>);

impl Asked {
    pub(super) fn say(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_said(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

struct Client {
    task: JoinHandle<()>,
    asked: Asked,
}

/// Serves every client, each beside the others, until it is dropped.
pub(super) async fn accept_all(listener: &TcpListener, calls: &mpsc::Sender<Call>) {
    let mut clients = VecDeque::new();
    loop {
        match listener.accept().await {
            Ok((stream, _)) => {
                // A short message must not wait for the acknowledgement of the one before it. Without this it comes late, and comes all the same.
                let _ = stream.set_nodelay(true);
                make_room(&mut clients).await;
                let (asked, calls) = (Asked::default(), calls.clone());
                // The runtime has one thread, and ends with it whatever still waits.
                let task = tokio::spawn(serve(stream, calls, asked.clone()));
                clients.push_back(Client { task, asked });
            }
            Err(error) => {
                tracing::debug!(%error, "a client was not accepted");
                sleep(PAUSE).await;
            }
        }
    }
}

/// Waits until fewer clients are connected than are served at once. The oldest of those that have asked nothing is cut off: a request comes within
/// milliseconds, and a thousand silent connections must not keep a browser out.
async fn make_room(clients: &mut VecDeque<Client>) {
    loop {
        clients.retain(|client| !client.task.is_finished());
        if clients.len() < CLIENTS {
            return;
        }
        match clients.iter().position(|client| !client.asked.is_said()) {
            Some(silent) => {
                if let Some(client) = clients.remove(silent) {
                    client.task.abort();
                }
            }
            None => sleep(PAUSE).await,
        }
    }
}
