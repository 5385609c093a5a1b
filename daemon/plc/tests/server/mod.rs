//! A Modbus server over channels instead of shared memory, and a client of plain bytes.

use andon_plc::handshake::{Fault, Handshake, Line, LineCommand};
use andon_plc::modbus::{Config, Counters, ModbusServer};
use shm_schemas::{
    AccountKept, CommandKind, Journalled, JudgePhase, Judging, NO_INDEX, PartId, Verdict, VerdictLevel,
    VerdictOutcome,
};
use std::io::{Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longer than anything here takes; a test that waits for this long has failed.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

/// The line as the role sees it.
struct LineEnd {
    verdicts: Receiver<Verdict>,
    commands: Sender<LineCommand>,
    has_camera: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
    writes: bool,
}

/// A journal that keeps everything at once.
#[derive(Default)]
struct Journal {
    kept: AccountKept,
    asked: u32,
    row: u64,
}

impl Journal {
    fn keep(&mut self, handshake: &mut Handshake, now_ns: u64) {
        while let Some(update) = handshake.update(now_ns) {
            (self.kept.account, self.asked) = (update.account, update.asked);
            handshake.kept(&self.kept, now_ns);
        }
    }

    fn write(&mut self, handshake: &mut Handshake, verdict: Verdict, now_ns: u64) {
        let (before, boot) = (self.row, self.kept.account.boot);
        self.row += 1;
        let (journal, row, asked) = (self.kept.journal, self.row, self.asked);
        let message = Journalled { journal, row, before, boot, asked, verdict, ..Journalled::default() };
        handshake.journalled(&message, now_ns);
    }
}

/// What a judge says after it has done this.
fn done(mut judging: Judging, command: &LineCommand) -> Judging {
    judging.command = command.number;
    match command.kind {
        CommandKind::Enable => judging.is_enabled = 1,
        CommandKind::Disable => judging.is_enabled = 0,
        CommandKind::LoadJob => (judging.job_id, judging.model_hash) = (command.job_id, command.model_hash),
        CommandKind::Start => judging.phase = JudgePhase::Running.code(),
        CommandKind::Abort => judging.phase = JudgePhase::Waiting.code(),
        CommandKind::SetPart => judging.part = command.part,
    }
    judging
}

/// The loop of the role `plc`, over channels instead of shared memory.
fn run(server: &ModbusServer, line: &LineEnd) {
    let mut journal = Journal::default();
    let mut judging = Judging {
        phase: JudgePhase::Waiting.code(),
        is_enabled: (!line.writes).into(),
        job_id: 7,
        ..Judging::default()
    };
    server.handshake(|handshake, now_ns| handshake.kept(&journal.kept, now_ns));
    while !line.stop.load(Ordering::Relaxed) {
        let verdict = line.verdicts.recv_timeout(Duration::from_millis(20)).ok();
        let state = match line.has_camera.load(Ordering::Relaxed) {
            true => Line::Ready,
            false => Line::Fault { fault: Fault::Camera, detail: 104 },
        };
        server.handshake(|handshake, now_ns| {
            journal.keep(handshake, now_ns);
            if let Some(verdict) = verdict {
                (judging.verdict_epoch, judging.verdict_seq) = (verdict.stamp.epoch, verdict.stamp.seq);
                journal.write(handshake, verdict, now_ns);
            }
            handshake.tick(state, now_ns);
            if let Some(command) = handshake.next_command(now_ns) {
                judging = done(judging, &command);
                line.commands.send(command).unwrap();
            }
            handshake.judging(&judging, now_ns);
            journal.keep(handshake, now_ns);
        });
    }
}

/// A server that runs until it is dropped, with a line that is healthy until a test says otherwise.
pub(crate) struct TestServer {
    pub(crate) address: SocketAddr,
    pub(crate) counters: Arc<Counters>,
    pub(crate) commands: Receiver<LineCommand>,
    verdicts: Sender<Verdict>,
    has_camera: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
    role: Option<thread::JoinHandle<()>>,
    seq: u64,
}

/// A configuration for tests: loopback, any port, writes on.
pub(crate) fn config() -> Config {
    Config { bind: "127.0.0.1:0".parse().unwrap(), writes: true, ..Config::default() }
}

impl TestServer {
    pub(crate) fn start(config: Config) -> Self {
        let writes = config.writes;
        let server = ModbusServer::start(config).unwrap();
        let (address, counters) = (server.address(), server.counters());
        let (verdicts, from_line) = channel();
        let (to_line, commands) = channel();
        let (has_camera, stop) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
        let line = LineEnd {
            verdicts: from_line,
            commands: to_line,
            has_camera: Arc::clone(&has_camera),
            stop: Arc::clone(&stop),
            writes,
        };
        let role = Some(thread::spawn(move || run(&server, &line)));
        Self { address, counters, commands, verdicts, has_camera, stop, role, seq: 0 }
    }

    /// Connects or disconnects the camera.
    pub(crate) fn camera(&self, is_connected: bool) {
        self.has_camera.store(is_connected, Ordering::Relaxed);
    }

    /// A verdict comes, and the journal has it.
    pub(crate) fn verdict(&mut self, outcome: VerdictOutcome) {
        self.seq += 1;
        let mut verdict = sample(self.seq, outcome);
        verdict.stamp.seq = self.seq;
        self.verdicts.send(verdict).unwrap();
    }

    pub(crate) fn client(&self) -> Client {
        Client::connect(self.address)
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.role.take().map(thread::JoinHandle::join);
    }
}

/// Fields that follow from the number, so that a mix of two verdicts is noticed.
pub(crate) fn sample(number: u64, outcome: VerdictOutcome) -> Verdict {
    let mut verdict = Verdict {
        level: VerdictLevel::Iu.code(),
        outcome: outcome.code(),
        job_id: 7,
        model_hash: number.wrapping_mul(0x9E37_79B9_7F4A_7C15),
        distance: number as f32,
        threshold: 2.5,
        decided_utc_ns: 1_700_000_000_250_000_000,
        nearest: NO_INDEX,
        activity: 1,
        iu: 2,
        part: PartId::new(format!("p{number}").as_bytes()).unwrap(),
        ..Default::default()
    };
    (verdict.stamp.epoch, verdict.stamp.seq) = (1, number);
    verdict
}

/// A client of plain bytes, written after the specification. It shares nothing with the server.
pub(crate) struct Client(TcpStream);

impl Client {
    pub(crate) fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_nodelay(true).unwrap();
        Self(stream)
    }

    /// Connects from another address of this machine.
    pub(crate) fn connect_from(own: IpAddr, address: SocketAddr) -> Self {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build().unwrap();
        let connect = async {
            let socket = tokio::net::TcpSocket::new_v4().unwrap();
            socket.bind(SocketAddr::new(own, 0)).unwrap();
            socket.connect(address).await.unwrap().into_std().unwrap()
        };
        let stream = runtime.block_on(connect);
        stream.set_nonblocking(false).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_nodelay(true).unwrap();
        Self(stream)
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).unwrap();
    }

    /// Sends, or does nothing when the server has closed the connection.
    pub(crate) fn send_if_open(&mut self, bytes: &[u8]) {
        let _ = self.0.write_all(bytes);
    }

    /// The PDU of the next answer; `None` when the server has closed the connection.
    pub(crate) fn answer(&mut self) -> Option<Vec<u8>> {
        let mut header = [0; 7];
        self.0.read_exact(&mut header).ok()?;
        let length = usize::from(u16::from_be_bytes([header[4], header[5]]));
        let mut pdu = vec![0; length - 1];
        self.0.read_exact(&mut pdu).ok()?;
        Some(pdu)
    }

    pub(crate) fn ask(&mut self, pdu: &[u8]) -> Vec<u8> {
        let mut frame = vec![0, 1, 0, 0, 0, u8::try_from(pdu.len() + 1).unwrap(), 1];
        frame.extend_from_slice(pdu);
        self.send(&frame);
        self.answer().unwrap()
    }

    pub(crate) fn read(&mut self, address: u16, count: u16) -> Vec<u16> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), count.to_be_bytes());
        let answer = self.ask(&[3, a, b, c, d]);
        assert_eq!(answer[0], 3, "exception {}", answer[1]);
        answer[2..].chunks(2).map(|two| u16::from_be_bytes([two[0], two[1]])).collect()
    }

    pub(crate) fn write(&mut self, address: u16, value: u16) -> Vec<u8> {
        let ([a, b], [c, d]) = (address.to_be_bytes(), value.to_be_bytes());
        self.ask(&[6, a, b, c, d])
    }

    /// Reads until the status word has all these bits set and those cleared.
    pub(crate) fn wait_for(&mut self, set: u16, cleared: u16) {
        let until = Instant::now() + PATIENCE;
        loop {
            let status = self.read(0, 1)[0];
            if status & set == set && status & cleared == 0 {
                return;
            }
            assert!(Instant::now() < until, "status {status:#b}, expected {set:#b} and not {cleared:#b}");
            thread::sleep(Duration::from_millis(2));
        }
    }
}

pub(crate) fn count(counter: &AtomicU64) -> u64 {
    counter.load(Ordering::Relaxed)
}
