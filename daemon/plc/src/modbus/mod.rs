//! The Modbus TCP server of `andond run plc`.
//!
//! ```text
//! caller's thread                              │ thread "modbus"
//! VerdictSource ─► Handshake::verdict, line …  │  client ─► Gate ─► tokio-modbus ─► Service
//! CommandSink   ◄─ Handshake::next_ask         │                                      │
//!                        └──────────── one mutex, held for microseconds ──────────────┘
//! ```
//!
//! Every request is answered from one state under the mutex: no request can see half a result.

mod config;
mod counters;
mod gate;
mod service;

use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use shm_schemas::Verdict;
use thiserror::Error;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio_modbus::server::tcp::Server;

pub use config::Config;
pub use counters::Counters;

use crate::handshake::{Ask, Handshake, Line, Settings};
use crate::registers::{Image, WordOrder};
use gate::Gate;
use service::Service;

/// The longest that the loop waits for the line: a command of a client waits no longer than this to be told on.
const TURN: Duration = Duration::from_millis(20);

/// What comes from the line.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// A verdict of the channel.
    Verdict(Verdict),
    /// The journal has every verdict of this epoch up to `seq` on disk.
    Confirmed {
        /// The epoch of the judge.
        epoch: u64,
        /// The newest verdict.
        seq: u64,
    },
    /// How the line is; at 1 Hz or faster.
    Line(Line),
}

/// Where verdicts come from. The loop of the role turns in here: feed the watchdog here.
pub trait VerdictSource {
    /// The next event; `None` when nothing came within `wait`. An error is reported as a line fault, as an event.
    fn next(&mut self, wait: Duration) -> Option<Event>;

    /// The loop has turned, and this is what the registers show now: for logs.
    fn turned(&mut self, _image: &Image) {}
}

/// Where commands go.
pub trait CommandSink {
    /// Tells the line. False: it could not be told.
    fn tell(&mut self, ask: &Ask) -> bool;
}

/// Why the server could not start or go on.
#[derive(Debug, Error)]
pub enum ServeError {
    /// The address cannot be listened on.
    #[error(
        "cannot listen on {address} for Modbus: {source}; is another server there, or is the port below 1024 or the \
         address not this machine's? See `bind` of the plc section"
    )]
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
    open: AtomicUsize,
    started: Instant,
    writes: bool,
    word_order: WordOrder,
}

impl Shared {
    /// The state is whole after every call of it, so a panic elsewhere leaves it usable.
    fn handshake(&self) -> MutexGuard<'_, Handshake> {
        self.handshake.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn now_ns(&self) -> u64 {
        // 2^64 ns are 584 years.
        self.started.elapsed().as_nanos() as u64
    }
}

/// Serves until `stop` is set.
///
/// # Errors
/// [`ServeError`] where the server cannot start.
pub fn serve(
    config: Config,
    source: &mut impl VerdictSource,
    sink: &mut impl CommandSink,
    stop: &AtomicBool,
) -> Result<(), ServeError> {
    ModbusServer::start(config)?.run(source, sink, stop);
    Ok(())
}

/// A server that listens. It answers from the start, and is `online` only while [`ModbusServer::run`] turns.
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
            open: AtomicUsize::new(0),
            started: Instant::now(),
            writes: config.writes,
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

    /// Where it listens; with port 0 in the configuration the port that the system chose.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What it has seen.
    pub fn counters(&self) -> Arc<Counters> {
        Arc::clone(&self.shared.counters)
    }

    /// Turns the loop until `stop` is set.
    pub fn run(&self, source: &mut impl VerdictSource, sink: &mut impl CommandSink, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            let event = source.next(TURN);
            let now_ns = self.shared.now_ns();
            let mut handshake = self.shared.handshake();
            match event {
                Some(Event::Verdict(verdict)) => handshake.verdict(&verdict, now_ns),
                Some(Event::Confirmed { epoch, seq }) => handshake.confirmed(epoch, seq, now_ns),
                Some(Event::Line(line)) => handshake.line(line, now_ns),
                None => {}
            }
            handshake.tick(now_ns);
            while let Some(ask) = handshake.next_ask() {
                // The sink may take its time; clients must not wait for it.
                drop(handshake);
                let told = sink.tell(&ask);
                handshake = self.shared.handshake();
                handshake.asked(&ask, told);
            }
            let image = handshake.image(now_ns);
            drop(handshake);
            source.turned(&image);
        }
    }
}

impl Drop for ModbusServer {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been printed by the panic hook; nothing is left to tell.
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
            (Service { shared: Arc::clone(&shared), _open: open }, gate)
        });
        std::future::ready(Ok(connection))
    };
    let ended = |error: io::Error| tracing::debug!(%error, "a Modbus connection ended");
    loop {
        let accepting = server.serve(&connect, ended);
        // biased: an end that is asked for goes first.
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

/// One open connection; it counts until it is dropped.
struct Open(Arc<Shared>);

impl Drop for Open {
    fn drop(&mut self) {
        self.0.open.fetch_sub(1, Ordering::Relaxed);
        Counters::add(&self.0.counters.ended);
    }
}

/// Whether one more connection of this peer is taken.
fn admit(shared: &Arc<Shared>, config: &Config, peer: SocketAddr) -> Option<Open> {
    let address = peer.ip().to_canonical();
    let allowed = config.allowed_clients.contains(&address);
    // Only this one task accepts, so nothing comes between the look and the count.
    if !allowed || shared.open.load(Ordering::Relaxed) >= config.connections {
        Counters::add(&shared.counters.refused);
        tracing::debug!(%peer, allowed, "Modbus connection refused: see `allowed_clients` and `connections`");
        return None;
    }
    Counters::add(&shared.counters.accepted);
    shared.open.fetch_add(1, Ordering::Relaxed);
    Some(Open(Arc::clone(shared)))
}
