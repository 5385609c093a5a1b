//! Plays a track file at full speed again and again: memory must stay, and every verdict must be in the journal.
//!
//! `soak [FRAMES] [REPORT]`: ends with an error when a role grows, a message is lost or a verdict is missing.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::line::{Line, ROLES, Settings, Watcher, own_memory_kib, report};
use shm_schemas::RoleId;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// A day at 30 Hz.
const FRAMES: u64 = 2_600_000;
/// After this share of the frames every buffer and cache has its final size.
const WARM: f64 = 0.2;
/// SQLite's page cache grows with the database to its 2000 KiB, and the allocator moves by some pages. A leak of two bytes a
/// frame shows.
const SLACK_KIB: u64 = 3072;
/// Without a new frame for this long the line hangs.
const HANGS: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let frames = arguments.first().map_or(FRAMES, |text| text.parse().expect("a number of frames"));
    let path = arguments.get(1).map_or("target/soak/report.json", String::as_str);
    let mut line = Line::new(Settings { repeat: true, ..Settings::default() });
    let mut watcher = line.launch();
    let began = Instant::now();
    let memory = play(&mut line, &mut watcher, frames);
    let took_s = began.elapsed().as_secs_f64();
    let bad = line.stop();
    // The judge told its last verdicts when it stopped: what is on its channel by now is all.
    watcher.listen(Duration::ZERO);
    let losses: u64 = watcher.newest.iter().map(|health| health.losses).sum();
    let judged = watcher.health(RoleId::Judge).unwrap().received;
    let newest = watcher.heard_newest().unwrap();
    let rows = line.journal().verdicts();
    let grew: Vec<&str> =
        ROLES.into_iter().filter(|role| memory[role].end > memory[role].warm + SLACK_KIB).collect();
    let well = bad.is_empty() && grew.is_empty() && losses == 0 && rows.len() as u64 == newest.1;
    let roles: Vec<String> = memory.iter().map(|(role, memory)| memory.json(role)).collect();
    let text = format!(
        "{{\n  \"frames\": {judged},\n  \"seconds\": {took_s:.1},\n  \"frames_per_second\": {:.0},\n  \
         \"verdicts_sent\": {},\n  \"journal_rows\": {},\n  \"messages_lost\": {losses},\n  \"grew\": {grew:?},\n  \
         \"ended_badly\": {bad:?},\n  \"own_memory_kib\": {{\n    {}\n  }}\n}}\n",
        judged as f64 / took_s,
        newest.1,
        rows.len(),
        roles.join(",\n    ")
    );
    report(path, &text);
    if well { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Memory of a role that is its own, in KiB.
#[derive(Clone, Copy, Default)]
struct Memory {
    warm: u64,
    most: u64,
    end: u64,
}

impl Memory {
    fn json(&self, role: &str) -> String {
        format!("\"{role}\": {{ \"warm\": {}, \"most\": {}, \"end\": {} }}", self.warm, self.most, self.end)
    }
}

/// Waits for so many frames, and looks at the memory of each role meanwhile.
fn play(line: &mut Line, watcher: &mut Watcher, frames: u64) -> BTreeMap<&'static str, Memory> {
    let mut memory: BTreeMap<&str, Memory> =
        ROLES.into_iter().map(|role| (role, Memory::default())).collect();
    let (mut judged, mut newest) = (0, Instant::now());
    while judged < frames {
        watcher.listen(Duration::from_millis(500));
        // A verdict is counted by its number; to keep them all would be the test's own leak.
        watcher.forget_all_but_newest();
        let now = watcher.health(RoleId::Judge).map_or(0, |health| health.received);
        if now > judged {
            (judged, newest) = (now, Instant::now());
        }
        assert!(newest.elapsed() < HANGS, "the line stands still after {judged} frames");
        for role in &mut line.roles {
            assert!(role.ended().is_none(), "{} has ended", role.role);
            let own = own_memory_kib(role.pid()).unwrap();
            let seen = memory.get_mut(role.role).unwrap();
            if (judged as f64) < WARM * frames as f64 {
                seen.warm = seen.warm.max(own);
            }
            (seen.most, seen.end) = (seen.most.max(own), own);
        }
    }
    memory
}
