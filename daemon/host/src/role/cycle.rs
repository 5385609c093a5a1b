//! The life cycle that all roles share: wait, take what has come, work on it, publish, give a sign of life.
//!
//! A role is a [`Role`]: it names its ports and says what it does in one turn. [`Cycle::run`] does what no role should do by itself. It waits, ends
//! when a stop is asked for, measures the steps, and counts what comes, goes and is lost. It hands the pace of the source and its end from input to
//! output. It gives the signs of life, which come from this loop and from nowhere else.

use std::time::{Duration, Instant};

use andon_ipc::{MonotonicTime, Node, Paced, Port, Wake};
use shm_schemas::{Stamp, flag};

use super::input::Input;
use super::upstream::Upstream;
use super::{CycleError, Failure, Liveness, WAIT};
use crate::log::{code, log};

/// How long a paced writer waits for a reader that makes no progress: longer than any restart takes.
const STUCK: Duration = Duration::from_secs(30);

/// Between two tries to open what is missing: at first soon, and then as often as a person looks.
const FIRST_PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);

/// A reader that stays deaf connects again once a second.
const LOG_DEAF_EVERY: Duration = Duration::from_secs(60);

/// What a role did in a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// There was nothing to do.
    Idle,
    /// A step of its work has gone through. The first one makes the role ready.
    Stepped,
    /// It leaves the cycle, and whoever ran it decides what comes next.
    Left,
}

/// A role's own logic.
pub trait Role {
    /// What ends it.
    type Error: Failure;

    /// Whether messages come all the time while the line works. If so, silence is logged and shows in the role's health.
    /// Verdicts do not: on a bench where nobody works there are none.
    const INPUT_IS_STEADY: bool;

    /// Every port, outputs first. A writer answers its readers when it is looked at, and the look ends at the first port with a message.
    fn ports(&mut self) -> Vec<&mut dyn Port>;

    /// The longest wait for a message before the next turn. The heartbeat has to come around in it.
    fn patience(&self) -> Duration {
        WAIT
    }

    /// Works on the next message, if one has come. It takes one at a time, so that neither a stop nor a sign of life waits
    /// for the end of a queue.
    ///
    /// # Errors
    /// What ends the role.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, Self::Error>;

    /// Finishes what must not be left behind when a stop is asked for.
    ///
    /// # Errors
    /// What ends the role.
    fn stop(&mut self, _cycle: &mut Cycle<'_>) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// The turning loop of a process, with what its role may use in a turn.
pub struct Cycle<'n> {
    node: &'n Node,
    liveness: Liveness,
    /// Who sends what this role takes.
    upstream: Option<Upstream>,
    /// When it was logged last that nothing of it comes.
    deaf_logged: Option<Instant>,
    wake: Wake,
    /// Of the newest message taken: what is sent now depends on it.
    stamp: Stamp,
    flags: u32,
    /// The message that was taken in this turn is the last one of its source.
    is_at_end: bool,
    /// Time of this turn in which the role waited, which is no work.
    waited: Duration,
}

impl<'n> Cycle<'n> {
    /// A cycle that has not begun to turn.
    ///
    /// # Errors
    /// That the channel `health` cannot be opened.
    pub fn new(node: &'n Node) -> Result<Self, CycleError> {
        Ok(Self {
            node,
            liveness: Liveness::new(node)?,
            upstream: Upstream::of(node)?,
            deaf_logged: None,
            wake: Wake::DeadlineMissed,
            stamp: Stamp::default(),
            flags: 0,
            is_at_end: false,
            waited: Duration::ZERO,
        })
    }

    /// Turns until a stop is asked for or the role leaves.
    ///
    /// # Errors
    /// What ends the role.
    pub fn run<R: Role>(&mut self, role: &mut R) -> Result<(), R::Error> {
        // The first turn waits for nothing: a role without input is ready at once.
        let mut patience = Duration::ZERO;
        loop {
            self.wake = self.node.wait(&mut role.ports(), patience).map_err(CycleError::from)?;
            if self.wake == Wake::Stop {
                return role.stop(self);
            }
            // A look that waits for nothing misses nothing.
            if R::INPUT_IS_STEADY && !patience.is_zero() {
                self.liveness.note(&self.wake);
            }
            if self.turn(role)? == Turn::Left {
                return Ok(());
            }
            self.beat()?;
            patience = role.patience();
        }
    }

    /// Gives the signs of life that are due. As often it looks whether the station is still there, also while a turn waits. A player waits for the
    /// time of its next message in every turn, and in few other places.
    fn beat(&mut self) -> Result<(), CycleError> {
        if self.liveness.beat()? {
            self.node.check_root()?;
        }
        Ok(())
    }

    fn turn<R: Role>(&mut self, role: &mut R) -> Result<Turn, R::Error> {
        let began = Instant::now();
        (self.is_at_end, self.waited) = (false, Duration::ZERO);
        let turn = role.turn(self)?;
        if turn == Turn::Stepped {
            if self.is_at_end {
                self.liveness.finished(self.worked_since(began));
            } else {
                self.stepped(began);
            }
        }
        Ok(turn)
    }

    /// A step that began at this time has gone through. For what a role opens before its first turn: where no message may
    /// come for an hour, that is its first step.
    pub fn stepped(&mut self, began: Instant) {
        self.liveness.stepped(self.worked_since(began));
    }

    fn worked_since(&self, began: Instant) -> Duration {
        began.elapsed().saturating_sub(self.waited)
    }

    /// The process's place in the station.
    pub fn node(&self) -> &'n Node {
        self.node
    }

    /// Why the wait before this turn ended.
    pub fn wake(&self) -> Wake {
        self.wake
    }

    /// The signs of life, for what only the role itself can tell.
    pub fn liveness(&mut self) -> &mut Liveness {
        &mut self.liveness
    }

    /// The flags of the newest message taken: [`flag`].
    pub fn flags(&self) -> u32 {
        self.flags
    }

    /// The stamp of the newest message taken.
    pub fn stamp(&self) -> &Stamp {
        &self.stamp
    }

    /// Whether the source waits for its readers, so that nothing may be lost.
    pub fn is_paced(&self) -> bool {
        self.flags & flag::PACED != 0
    }

    /// Whether the message that was taken in this turn is the last one of its source.
    pub fn is_at_end(&self) -> bool {
        self.is_at_end
    }

    /// The next message of the role's data channel. What is sent from now on depends on it and goes at its pace.
    ///
    /// # Errors
    /// The station's shared memory.
    pub fn take<I: Input>(&mut self, input: &mut I) -> Result<Option<I::Sample>, CycleError> {
        let sample = input.take(self.is_paced())?;
        if let Some(sample) = &sample {
            let (stamp, flags) = I::head(sample);
            self.rest_on(*stamp, flags);
            self.liveness.received(stamp);
        } else {
            self.listen_closely(input)?;
        }
        let (lost, restarts) = input.losses();
        self.liveness.losses(lost, restarts);
        Ok(sample)
    }

    /// Nothing waits: connects the input again where the role before it has sent something that has not come.
    fn listen_closely(&mut self, input: &mut impl Input) -> Result<(), CycleError> {
        let Some(upstream) = &mut self.upstream else { return Ok(()) };
        let Some(missing) = upstream.missing(self.node, input)? else { return Ok(()) };
        input.reconnect();
        self.liveness.failing();
        if self.deaf_logged.is_none_or(|at| at.elapsed() >= LOG_DEAF_EVERY) {
            self.deaf_logged = Some(Instant::now());
            let role = upstream.role().name();
            log!(
                code::CHANNEL_DEAF,
                "{missing} messages of {role} have not come: its channel is opened again"
            );
        }
        Ok(())
    }

    /// What is sent from now on depends on this: for a role that is itself the source.
    pub fn rest_on(&mut self, stamp: Stamp, flags: u32) {
        (self.stamp, self.flags) = (stamp, flags);
        self.is_at_end = flags & flag::END_OF_STREAM != 0;
    }

    /// Opens what a role needs before its first turn. What may pass, as a folder that is not mounted yet, is tried again and again, with signs of
    /// life that say so. The log says it once. `None` when a stop was asked for.
    ///
    /// # Errors
    /// What does not pass.
    pub fn until_open<T, E: Failure>(
        &mut self,
        mut open: impl FnMut() -> Result<T, E>,
    ) -> Result<Option<T>, E> {
        let mut pause = FIRST_PAUSE;
        let mut is_logged = false;
        loop {
            match open() {
                Ok(opened) => return Ok(Some(opened)),
                Err(error) if error.may_pass() => {
                    if !std::mem::replace(&mut is_logged, true) {
                        error.report();
                    }
                    self.liveness.failing();
                    self.beat()?;
                    if !self.wait_until(MonotonicTime::now() + pause)? {
                        return Ok(None);
                    }
                    pause = (2 * pause).min(LONGEST_PAUSE);
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Waits until a time on the monotonic clock, with signs of life. False when a stop was asked for.
    ///
    /// # Errors
    /// The station's shared memory.
    pub fn wait_until(&mut self, due: MonotonicTime) -> Result<bool, CycleError> {
        let began = Instant::now();
        loop {
            let left = due.since(MonotonicTime::now());
            if left.is_zero() {
                break;
            }
            if self.node.stop().wait(left.min(WAIT)) {
                return Ok(false);
            }
            self.beat()?;
        }
        self.waited += began.elapsed();
        Ok(true)
    }

    /// Waits until a paced writer may send. A missed deadline says nothing of the role's input here, so it is not noted.
    pub(super) fn wait_for_room(&mut self, writer: &mut impl Paced) -> Result<(), CycleError> {
        let began = Instant::now();
        loop {
            match self.node.wait_for_room(writer, WAIT)? {
                Wake::Room => break,
                Wake::Stop => return Err(CycleError::Stopped),
                _ => self.beat()?,
            }
            if began.elapsed() > STUCK {
                return Err(CycleError::NoProgress(STUCK));
            }
        }
        self.waited += began.elapsed();
        Ok(())
    }
}
