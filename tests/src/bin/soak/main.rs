//! Plays a track file at full speed again and again: no role's memory may grow, and every verdict must be in the journal.
//!
//! `soak [FRAMES] [REPORT]`: fails when a role grows, when a message is lost or when a verdict is missing.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, ROLES, Settings, Watcher, own_memory_kib};
use andon_tests::measure::{Arguments, report};
use serde_json::{Value, json};
use shm_schemas::RoleId;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// A day at 30 Hz.
const FRAMES: u64 = 2_600_000;
/// After this share of the frames every buffer and cache has its final size.
const WARM: f64 = 0.2;
/// SQLite's page cache grows with the database to its 2000 KiB, and the allocator varies by some pages. A leak of two bytes
/// per frame is found.
const SLACK_KIB: u64 = 3072;
/// The line hangs when no new frame has been judged for this long.
const HANGS: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let arguments = Arguments::of_this_program();
    let frames = arguments.number(0, FRAMES);
    let mut line = Line::new(Settings { repeat: true, ..Settings::default() });
    let mut watcher = line.launch();
    let began = Instant::now();
    let memory = play(&mut line, &mut watcher, frames);
    let took_s = began.elapsed().as_secs_f64();
    let failures = line.stop();
    // The judge sends its last verdicts when it is stopped: after this its channel holds nothing more.
    watcher.listen(Duration::ZERO);
    let lost: u64 = watcher.healths.iter().map(|health| health.losses).sum();
    let judged = watcher.health(RoleId::Judge).unwrap().received;
    let (_, sent) = watcher.newest_verdict_key().unwrap();
    let rows = line.journal().verdicts().len() as u64;
    let grown: Vec<&str> =
        ROLES.into_iter().filter(|role| memory[role].end > memory[role].warm + SLACK_KIB).collect();
    let has_passed = failures.is_empty() && grown.is_empty() && lost == 0 && rows == sent;
    let text = json!({
        "frames": judged,
        "seconds": took_s,
        "frames_per_second": judged as f64 / took_s,
        "verdicts_sent": sent,
        "journal_rows": rows,
        "messages_lost": lost,
        "grown": grown,
        "failures": failures,
        "own_memory_kib": memory.iter().map(|(role, memory)| (*role, memory.json())).collect::<BTreeMap<_, _>>(),
    });
    report(arguments.path(1, "target/soak/report.json"), &text, has_passed)
}

/// Memory of a role that is its own, in KiB.
#[derive(Clone, Copy, Default)]
struct Memory {
    warm: u64,
    max: u64,
    end: u64,
}

impl Memory {
    fn json(self) -> Value {
        json!({ "warm": self.warm, "max": self.max, "end": self.end })
    }
}

/// Waits until this many frames have been judged, and measures the memory of each role meanwhile.
fn play(line: &mut Line, watcher: &mut Watcher, frames: u64) -> BTreeMap<&'static str, Memory> {
    let mut memory: BTreeMap<&str, Memory> =
        ROLES.into_iter().map(|role| (role, Memory::default())).collect();
    let (mut judged, mut newest) = (0, Instant::now());
    while judged < frames {
        watcher.listen(Duration::from_millis(500));
        // The number of the newest verdict counts them; to keep them all would be a leak of this program.
        watcher.forget_all_but_newest();
        let now = watcher.health(RoleId::Judge).map_or(0, |health| health.received);
        if now > judged {
            (judged, newest) = (now, Instant::now());
        }
        assert!(newest.elapsed() < HANGS, "the line stands still after {judged} frames");
        for role in &mut line.roles {
            assert!(role.ended().is_none(), "{} has ended", role.role);
            let own = own_memory_kib(role.pid()).unwrap();
            let memory = memory.get_mut(role.role).unwrap();
            if (judged as f64) < WARM * frames as f64 {
                memory.warm = memory.warm.max(own);
            }
            (memory.max, memory.end) = (memory.max.max(own), own);
        }
    }
    memory
}
