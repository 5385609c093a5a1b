//! `REGISTERS.md`, made from the table.

use std::fmt::{self, Write as _};

use shm_schemas::{VerdictKind, VerdictReason};

use super::image::{control, status};
use super::map::{Access, CONTROL_BASE, MAP, MAP_VERSION};
use crate::handshake::{Fault, QUEUE};

/// The text of `REGISTERS.md`.
pub fn document() -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_document(&mut text);
    text
}

fn write_document(out: &mut String) -> fmt::Result {
    write!(out, "{}", introduction())?;
    writeln!(out, "\n## Registers\n\n| address | name | type | access | meaning |\n|---|---|---|---|---|")?;
    for register in MAP {
        let last = register.address + register.words() - 1;
        let range =
            if last == register.address { last.to_string() } else { format!("{}-{last}", register.address) };
        let access = if matches!(register.access, Access::Read) { "r" } else { "rw" };
        let (name, kind, meaning) = (register.name, register.type_name(), register.meaning);
        writeln!(out, "| {range} | `{name}` | {kind} | {access} | {meaning} |")?;
    }
    writeln!(out, "\n## Status word\n\n| bit | name | meaning |\n|---|---|---|")?;
    write_bits(out, &status::BITS)?;
    writeln!(out, "\n## Control word\n\n| bit | name | meaning |\n|---|---|---|")?;
    write_bits(out, &control::BITS)?;
    writeln!(
        out,
        "\nOther bits must be 0: a write that sets one is answered with exception 3 and changes nothing."
    )?;
    writeln!(out, "\n## Numbers\n\n`kind`\n\n| number | word |\n|---|---|")?;
    for kind in VerdictKind::ALL {
        writeln!(out, "| {} | {} |", kind.code(), kind.name())?;
    }
    writeln!(out, "\n`reason`\n\n| number | word |\n|---|---|")?;
    for reason in VerdictReason::ALL {
        writeln!(out, "| {} | {} |", reason.code(), reason.name())?;
    }
    writeln!(out, "\n`error`\n\n| number | meaning and remedy |\n|---|---|")?;
    for fault in Fault::ALL {
        writeln!(out, "| {} | {} |", fault as u16, fault.meaning())?;
    }
    Ok(())
}

fn write_bits(out: &mut String, bits: &[(u16, &str, &str)]) -> fmt::Result {
    for (mask, name, meaning) in bits {
        writeln!(out, "| {} | {name} | {meaning} |", mask.trailing_zeros())?;
    }
    Ok(())
}

fn introduction() -> String {
    format!(
        "\
# Registers of `andond run plc` (Modbus TCP), map version {MAP_VERSION}

Made from `daemon/plc/src/registers/map.rs` by `cargo run -p andon-plc --example registers`; a test compares them.

Addresses are protocol addresses, from 0 (in the older notation 4xxxx and 3xxxx add 1). Functions 3 (read holding registers) and 4
(read input registers) show the same map; functions 6 and 16 write registers from {CONTROL_BASE} on. All others are answered with
exception 1, an unknown address with 2, a malformed request with 3. The unit identifier is echoed and otherwise ignored.

Inside a register Modbus is big-endian. A value of two or four registers has its most significant register first
(`word_order = \"big\"`, the default) or last (`\"little\"`).

Without `writes = true` in the configuration every write is answered with exception 1.

## Reading a result

1. Wait for `done`. It comes with one of `ok`, `nok`, `not-judged`, and only after the journal has the verdict on disk.
2. Read the result block, `sequence` to `sequence_copy`.
3. Set `acknowledge`. `done` drops.
4. Clear `acknowledge`. The next result, if one waits, is offered: `done` rises again with a higher `sequence`.

A result stays until it is acknowledged. {QUEUE} more wait behind it; what comes then is lost, `overrun` is set, and `sequence` jumps by as many
as were lost. With writes off nothing can be acknowledged: a result stays at least for the configured time and then gives way to the
next one; watch `sequence`, and `lost` for losses (`overrun` then stays set).

**No torn result.** Every request is answered from one moment, so a block that is read in one request is whole. Who reads it in several
requests reads upwards, from `sequence` to `sequence_copy`, and keeps what was read only where both are equal: sequences only grow, so
nothing changed between the two. That holds even where every register is read alone: an equal pair over a change would
need 65,536 results between two requests.

**Silence is never OK.** Watch `heartbeat` and `ready`. `ready` drops within 2 s when the camera, the markers, a process, the verdict channel or the journal
is lost, and `busy` with it: no verdict of that run will say OK. The error is latched until `reset_error` (with writes off, until
the line is well again). A `done` that was offered before stays, as it was in the journal before.

## Commands

Set a bit of `control`; wait for the same bit in `carried_out` or `refused`; clear it. Both answers clear with it. A command
acts once, when its bit rises. Write `load_job_id` and `load_model_hash` before `load_job`, or in the same request.
"
    )
}
