//! The Modbus TCP server of `andond run plc`.
//!
//! ```text
//! the role's thread                             │ thread "modbus"
//! the line ─► Handshake::verdict, confirmed …   │  client ─► Gate ─► tokio-modbus ─► Service
//! the line ◄─ Handshake::next_command           │                                      │
//!                        └───────────── one mutex, held for microseconds ──────────────┘
//! ```
//!
//! Each request is answered from one state under the mutex, so that no request can see half a result.

mod config;
mod counters;
mod gate;
mod rejections;
mod service;
mod written;

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use thiserror::Error;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio_modbus::server::tcp::Server;

pub use config::Config;
pub use counters::Counters;
pub use rejections::{Cause, Rejection, Rejections};
pub use written::Write;

use crate::handshake::{Handshake, Settings};
use crate::registers::WordOrder;
use gate::Gate;
use service::Service;
use written::MAX_WRITES;

/// Why the server could not start or go on.
#[derive(Debug, Error)]
pub enum ServeError {
    /// The address cannot be listened on.
    #[error("cannot listen on {address} for Modbus: {source}")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// A thread or the runtime could not be made.
    #[error("cannot start the Modbus thread: {0}")]
    Thread(io::Error),
}

/// What the loop and every connection share.
struct Shared {
    handshake: Mutex<Handshake>,
    counters: Arc<Counters>,
    /// What clients have written and the loop has not asked for yet.
    written: Mutex<Vec<Write>>,
    open: AtomicUsize,
    started: Instant,
    writes: bool,
    commanders: Vec<IpAddr>,
    word_order: WordOrder,
}

impl Shared {
    /// The state is consistent after each of its methods, so it stays usable after a panic in another thread.
    fn handshake(&self) -> MutexGuard<'_, Handshake> {
        self.handshake.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, write: Write) {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        // A PLC writes the same word in every cycle.
        if write.before != write.after && written.len() < MAX_WRITES {
            written.push(write);
        }
    }

    fn now_ns(&self) -> u64 {
        // 2^64 ns are 584 years.
        self.started.elapsed().as_nanos() as u64
    }
}

/// A server that listens. It answers from the start, and is `online` only while
/// [`Handshake::tick`] is called through [`ModbusServer::handshake`].
pub struct ModbusServer {
    shared: Arc<Shared>,
    address: SocketAddr,
    /// Dropping it ends the thread.
    stop: Option<oneshot::Sender<()>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl ModbusServer {
    /// Listens and answers.
    ///
    /// # Errors
    /// [`ServeError`]
    pub fn start(config: Config) -> Result<Self, ServeError> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()
            .map_err(ServeError::Thread)?;
        let bind = config.bind;
        let bound = |source| ServeError::Bind { address: bind, source };
        let listener = runtime.block_on(TcpListener::bind(bind)).map_err(bound)?;
        let address = listener.local_addr().map_err(bound)?;
        let hold_ns = u64::try_from(config.hold.as_nanos()).unwrap_or(u64::MAX);
        let shared = Arc::new(Shared {
            handshake: Mutex::new(Handshake::new(Settings { writes: config.writes, hold_ns }, 0)),
            counters: Arc::default(),
            written: Mutex::default(),
            open: AtomicUsize::new(0),
            started: Instant::now(),
            writes: config.writes,
            commanders: config.commanders.clone(),
            word_order: config.word_order,
        });
        let (stop, stopped) = oneshot::channel();
        let for_thread = Arc::clone(&shared);
        let thread = thread::Builder::new()
            .name("modbus".into())
            .spawn(move || runtime.block_on(listen(listener, for_thread, config, stopped)))
            .map_err(ServeError::Thread)?;
        Ok(Self { shared, address, stop: Some(stop), thread: Some(thread) })
    }

    /// The address that it listens on. Port 0 in the configuration lets the system choose the port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What clients have done so far.
    pub fn counters(&self) -> Arc<Counters> {
        Arc::clone(&self.shared.counters)
    }

    /// What clients have written to the control block since the last call.
    pub fn writes(&self) -> Vec<Write> {
        std::mem::take(&mut *self.shared.written.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Calls the state machine with the server's time in nanoseconds. Clients wait for their answers meanwhile, so `act` must not
    /// wait for anything itself.
    pub fn handshake<R>(&self, act: impl FnOnce(&mut Handshake, u64) -> R) -> R {
        act(&mut self.shared.handshake(), self.shared.now_ns())
    }
}

impl Drop for ModbusServer {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // If the thread has panicked, the panic hook has printed it.
            let _ = thread.join();
        }
    }
}

/// Accepts until the sender of `stopped` is dropped.
async fn listen(
    listener: TcpListener,
    shared: Arc<Shared>,
    config: Config,
    mut stopped: oneshot::Receiver<()>,
) {
    let server = Server::new(listener);
    let connect = |stream: TcpStream, peer: SocketAddr| {
        let connection = admit(&shared, &config, peer).map(|open| {
            let gate = Gate::new(stream, config.idle_timeout, Arc::clone(&shared.counters));
            (Service { shared: Arc::clone(&shared), client: peer.ip().to_canonical(), _open: open }, gate)
        });
        std::future::ready(Ok(connection))
    };
    let ended = |error: io::Error| tracing::debug!(%error, "a Modbus connection ended");
    loop {
        let accepting = server.serve(&connect, ended);
        // biased: a stop comes before another connection.
        tokio::select! {
            biased;
            _ = &mut stopped => return,
            // `accept` failed: too many open files, or the peer was gone already. Every connection is closed; go on.
            result = accepting => if let Err(error) = result {
                tracing::warn!(%error, "cannot accept a Modbus connection; trying again in 100 ms");
                tokio::time::sleep(Duration::from_millis(100)).await;
            },
        }
    }
}

/// Counts one open connection until it is dropped.
struct Open(Arc<Shared>);

impl Drop for Open {
    fn drop(&mut self) {
        self.0.open.fetch_sub(1, Ordering::Relaxed);
        Counters::add(&self.0.counters.ended);
    }
}

/// Accepts one more connection of this peer, or refuses it.
fn admit(shared: &Arc<Shared>, config: &Config, peer: SocketAddr) -> Option<Open> {
    let address = peer.ip().to_canonical();
    let allowed = config.allowed_clients.contains(&address);
    // Only this task accepts connections, so the number cannot change between the test and the count.
    if !allowed || shared.open.load(Ordering::Relaxed) >= config.connections {
        Counters::add(&shared.counters.refused);
        let cause = if allowed { Cause::TooMany } else { Cause::NotAllowed };
        shared.counters.rejections.add(address, cause);
        return None;
    }
    Counters::add(&shared.counters.accepted);
    shared.open.fetch_add(1, Ordering::Relaxed);
    Some(Open(Arc::clone(shared)))
}
