//! `metrics`: what the line does, in numbers that a monitoring system fetches over HTTP (OpenMetrics).
//!
//! It only reads, and nothing waits for it: the line goes on without it as before.
//!
//! It is a role of its own because a fault or a slow scrape in `plc` could cost the handshake. Here it costs a scrape.
//!
//! The server reads and writes in a thread of its own. The loop of the role answers, so what it says of the line is of this moment.

mod counts;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Role, Turn};
use andon_http::{Request, Response, Server};
use andon_ipc::{MonotonicTime, Node, Port, Reader, Wake};
use andon_plc::handshake::{Line, watches};
use shm_schemas::{Couples, Detections, Health, Judging, Stamp, Verdict};

use super::RoleError;
use super::disabled;
use super::line::LineHealth;
use counts::{Counts, Stage};

/// The media type of OpenMetrics 1.0.
const OPEN_METRICS: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// The longest wait: a client waits no longer than this to be answered.
const TURN: Duration = Duration::from_millis(50);

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    if config.metrics.enable {
        let mut role = Metrics::open(&mut cycle, config)?;
        cycle.run(&mut role)
    } else {
        log!(code::METRICS_OFF, "metrics.enable is false: nothing listens");
        disabled::run(&mut cycle)
    }
}

struct Metrics {
    server: Server,
    counts: Counts,
    health: Reader<Health>,
    judging: Reader<Judging>,
    detections: Reader<Detections>,
    couples: Reader<Couples>,
    verdicts: Reader<Verdict>,
    line: LineHealth,
    newest_judging: Option<Judging>,
    /// What was sent before this start is not counted: a start after it may have counted it already.
    began: MonotonicTime,
    journal: PathBuf,
}

impl Role for Metrics {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![&mut self.health, &mut self.judging, &mut self.detections, &mut self.couples, &mut self.verdicts]
    }

    fn patience(&self) -> Duration {
        TURN
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        if let Wake::WriterGone { .. } = cycle.wake() {
            self.line.departed(MonotonicTime::now());
        }
        self.count()?;
        self.server.serve(|request| {
            answer(request, || {
                let now = MonotonicTime::now();
                let is_ready = is_ready(&mut self.line, self.newest_judging.as_ref(), now);
                self.counts.ready(is_ready, now);
                self.counts.disk(&self.journal);
                self.counts.text()
            })
        });
        Ok(Turn::Idle)
    }
}

impl Metrics {
    /// A server that listens is the first step: readiness must not wait for a worker.
    fn open(cycle: &mut Cycle<'_>, config: &Config) -> Result<Self, RoleError> {
        let began = Instant::now();
        let address = SocketAddr::new(config.metrics.bind, config.metrics.port);
        let server = Server::bind(address).map_err(|source| RoleError::Metrics { address, source })?;
        let node = cycle.node();
        let role = Self {
            server,
            counts: Counts::new(&config.station.name),
            health: node.reader()?,
            judging: node.reader()?,
            detections: node.reader()?,
            couples: node.reader()?,
            verdicts: node.reader()?,
            line: LineHealth::new(config),
            newest_judging: None,
            began: MonotonicTime::now(),
            journal: config.journal_path(),
        };
        log!(code::METRICS_LISTENING, { address = %address }, "metrics at http://{address}/metrics");
        cycle.stepped(began);
        Ok(role)
    }

    fn count(&mut self) -> Result<(), RoleError> {
        while let Some(health) = self.health.take()? {
            self.line.received(&health);
            self.counts.health(&health);
        }
        while let Some(judging) = self.judging.take()? {
            self.newest_judging = Some(*judging);
        }
        let is_new = |stamp: &Stamp| MonotonicTime::sent(stamp) >= self.began;
        while let Some(detections) = self.detections.take()? {
            if is_new(&detections.stamp) {
                self.counts.latency(Stage::Detections, latency(&detections.stamp));
            }
        }
        while let Some(couples) = self.couples.take()? {
            if is_new(&couples.stamp) {
                self.counts.latency(Stage::Couples, latency(&couples.stamp));
            }
        }
        while let Some(verdict) = self.verdicts.take()? {
            if is_new(&verdict.stamp) {
                self.counts.verdict(&verdict);
                self.counts.latency(Stage::Verdict, latency(&verdict.stamp));
            }
        }
        Ok(())
    }
}

fn answer(request: &Request, text: impl FnOnce() -> String) -> Response {
    match request.path.as_str() {
        "/metrics" => Response::ok(OPEN_METRICS, text()),
        _ => Response::text(404, "the metrics are at /metrics\n"),
    }
}

/// From the frame that a message depends on to the message; `None` where there was no frame.
fn latency(stamp: &Stamp) -> Option<Duration> {
    let captured = MonotonicTime::from_nanoseconds(stamp.captured_ns);
    (stamp.captured_ns > 0).then(|| MonotonicTime::sent(stamp).since(captured))
}

/// Whether the line could judge a part now. The PLC's own `ready` also waits for its reset after a fault.
fn is_ready(line: &mut LineHealth, judging: Option<&Judging>, now: MonotonicTime) -> bool {
    line.line(now) == Line::Ready && judging.is_some_and(|judging| watches(judging, now.nanoseconds()))
}
