//! `REGISTERS.md`, generated from the table.

use std::fmt::{self, Write as _};

use shm_schemas::{
    JudgePhase, PART_BYTES, Refusal, VerdictLevel, VerdictMeasure, VerdictNote, VerdictReason,
};

use crate::handshake::{Fault, QUEUE};
use crate::modbus::Config;
use crate::registers::{Access, CONTROL_BASE, MAP, MAP_VERSION, control, measure_scale, status};

/// The text of `REGISTERS.md`.
pub fn document() -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_document(&mut text);
    text
}

/// Writes the table of an enum of the wire, whose values the register of this name shows.
macro_rules! write_numbers {
    ($out:expr, $register:literal, $enum:ty) => {{
        writeln!($out, "\n`{}`\n\n| number | name | meaning |\n|---|---|---|", $register)?;
        <$enum>::ALL
            .iter()
            .try_for_each(|it| writeln!($out, "| {} | {} | {} |", it.code(), it.name(), it.meaning()))
    }};
}

fn write_document(out: &mut String) -> fmt::Result {
    write!(out, "{}", introduction())?;
    writeln!(out, "\n## Registers\n\n| address | name | type | access | meaning |\n|---|---|---|---|---|")?;
    for register in MAP {
        let last = register.address + register.words() - 1;
        let range =
            if last == register.address { last.to_string() } else { format!("{}-{last}", register.address) };
        let access = match register.access {
            Access::Read => "r",
            Access::ReadWrite(_) | Access::WriteText(_) => "rw",
            Access::Bits(_) => "w",
        };
        let (name, kind, meaning) = (register.name, register.type_name(), register.meaning);
        writeln!(out, "| {range} | `{name}` | {kind} | {access} | {meaning} |")?;
    }
    writeln!(out, "\n## Status word\n\n| bit | name | meaning |\n|---|---|---|")?;
    write_bits(out, &status::BITS)?;
    writeln!(out, "\n## Control word\n\n| bit | name | meaning |\n|---|---|---|")?;
    write_bits(out, &control::BITS)?;
    writeln!(
        out,
        "\nAll other bits must be 0. A write that sets one is answered with exception 3 and changes nothing."
    )?;
    writeln!(out, "\n## Numbers")?;
    write_numbers!(out, "level", VerdictLevel)?;
    write_numbers!(out, "reason", VerdictReason)?;
    write_numbers!(out, "note", VerdictNote)?;
    writeln!(out, "\n`measure`\n\n| number | name | meaning | unit in the registers |\n|---|---|---|---|")?;
    for measure in VerdictMeasure::ALL {
        let (number, name, unit) = (measure.code(), measure.name(), measure_scale(*measure).1);
        writeln!(out, "| {number} | {name} | {} | {unit} |", measure.meaning())?;
    }
    write_numbers!(out, "refusal", Refusal)?;
    write_numbers!(out, "phase", JudgePhase)?;
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
    let Config { connections, idle_timeout, hold, .. } = Config::default();
    let (idle_s, hold_ms, words) = (idle_timeout.as_secs(), hold.as_millis(), PART_BYTES / 2);
    format!(
        "\
# Registers of `andond run plc` (Modbus TCP), map version {MAP_VERSION}

Generated from `daemon/plc/src/registers` by `cargo run -p andon-plc --example registers`; a test compares the two.

## Access

- Addresses are protocol addresses and count from 0. Add 1 where a tool counts from 40001 or 30001.
- Functions 3 (read holding registers) and 4 (read input registers) read the same registers. Functions 6 and 16 write the registers
  from {CONTROL_BASE} on; they need `plc.writes = true` in the configuration. Registers 0 to 124 fit in one read request, and 100 to
  124 in one write request. A controller may simply exchange both in every cycle.
- Exception 1: the function is not served, or a client that may only read tries to write. Exception 2: the address is outside the map, or
  the register is read-only. Exception 3: the request is malformed, or it sets a control bit that has no meaning. Addresses
  below {CONTROL_BASE} that are not in the table read as 0.
- The unit identifier is echoed and otherwise ignored.
- Only the clients in `plc.allow` may connect, {connections} of them at once, and only those in `plc.commanders` may write:
  normally the one PLC. The log names the address of every other client that tries. A connection that sends no complete request for {idle_s} s is closed.
- Inside a register Modbus is big-endian. A value of two or four registers has its most significant register first, which is
  `plc.word_order = \"big\"`, the default. With `\"little\"` the least significant register is first. A controller with a
  little-endian processor can then lay the registers over a variable of 32 or 64 bits.
- A text has {PART_BYTES} bytes of printable ASCII in {words} registers, whatever `plc.word_order` is. The first character is the high byte of the
  first register, the second its low byte. It is padded with zeros. A client may also pad it with spaces; what follows the
  first zero is ignored.
- Numbers of activities and IUs count from 0.

## Terms

| here | elsewhere |
|---|---|
| station | one bench with its PC; in PackML a machine |
| judge | the process that compares what is done with the job |
| job | the recipe that is loaded, and one execution of it |
| activity, IU | a step of the job, and one contact of a hand and a part within it |
| part, part id | the workpiece and its serial number |
| result | a verdict that is offered: `ok` is good quality, `nok` is bad quality (an anomaly), and `not-judged` is uncertain: it is neither |
| `ready` and not `busy`, `busy`, `error` | in PackML about Idle, Execute and Aborted |
| `abort` | ends the running job as not judged; it stops no machine |
| `acknowledge` | the handshake that takes a result; an alarm is reset by `reset_error`, in PackML Clear |

No bit of this map is a safety function.

## Reading a result

1. Wait for `done`. One of `ok`, `nok`, `not-judged` is set with it. The journal has the result on disk by then.
2. Read the result block, from `sequence` to `sequence_end`; `measure` to `sequence_measure` say which measure was out of its bounds.
3. Write that `sequence` to `acknowledge_sequence` and set `acknowledge`, in one request. `done` drops once the journal has stored the acknowledgement.
4. Clear `acknowledge`. If another result waits, `done` rises again with a higher `sequence`.

A result stays until it is acknowledged, and {QUEUE} more can wait behind it. Further ones wait in the journal and are offered in their
turn: a controller that was offline gets everything that was judged meanwhile. A result is lost only where the journal does not have it:
`overrun` is set, `lost` counts it, and `sequence` has a gap of one.

**A restart loses nothing.** The journal keeps what was acknowledged, what waits, `lost`, `overrun` and `error`. After a restart of this
server `boot` is higher, the control block is 0, and the result that was not acknowledged is offered again.
It has its old `sequence`. A client that has already taken a result of this number acknowledges it again and does not count it twice. A client
that writes in every cycle may still write its old control block after the restart, before it can know of it. That is why `acknowledge`
names its result. An acknowledgement that names any other result than the offered one is refused, and nothing is lost.

Without `plc.writes` nobody can acknowledge. A result then stays for at least {hold_ms} ms, and until another one takes its place. A result
that comes while {QUEUE} wait is lost: such a client is meant to see what happens now. Watch `sequence`: a gap is a loss. `overrun` stays set once it is set.

**No result is torn.** Each request is answered from one state, so a block that is read in one request belongs to one result. A client
that needs several requests reads upwards from `sequence` to `sequence_end`, and discards what it has read unless the two are equal.
One that does not want the part may end at `sequence_copy`. One that wants the measure reads on to `sequence_measure`, which must be equal too.
`sequence` only grows, so nothing can have changed between two equal values, even if every register is read by itself. For the
halves of two sequences to look alike, 65,536 results would have to pass between two requests.

**Silence is never OK.** Treat the station as not ready when `heartbeat` has not moved for 1 s or when `ready` is not set. `ready` drops within
2 s when the camera or a process of the station fails. It drops within 4 s when the journal hangs, as it may for a while on a busy disk.
`busy` drops with it. `error` then names the first fault and stays until `reset_error`; without `plc.writes` it stays until the station is ready again. A result that is offered at that time
stays offered.

## Commands

1. Set the bit of the command in `control`. A command acts once, when its bit rises.
2. While it is under way, the same bit is set in `executing`. Wait until it is set in `carried_out` or in `refused`; `refusal` then says why.
3. Clear the bit in `control`. Both answers clear with it.

`carried_out` means that the judge has done it, and for `acknowledge` that the journal keeps it. A judge that does not answer within 2 s
counts as having refused. Write `load_job_id` and `load_model_hash` before `load_job`, or in the same request; `job_in_force` and `hash_in_force` say
which job the judge has. A job that is refused changes nothing.

While a job runs `load_job` is refused, unless a fault is latched. Then `busy` is not set, and the running job will have no result that counts. A
lasting fault must not keep the cell from changing over. The judge aborts the job as not judged, and reports no anomaly in it.

**Whose bit it is.** Each client that writes `control` writes all of its bits. Where two clients write (`plc.commanders`), such as a PLC and a panel, both
write `control_set` and `control_clear` instead. A panel that resets an error sets and clears `reset_error`, and `enable` stays the PLC's.

## The part

1. Before the part comes to the bench, write its id to `part` and set `set_part`, in one request. Blanks and line ends before and after
   it, which scanners add, are removed. An empty id is allowed: zeros, or only blanks and line ends.
2. Wait for `carried_out`, as for every command: then `next_part` shows the id. Clear `set_part`.
3. The id goes with every verdict of every job that begins from then on, until another one is set. It is in `result_part`, in the journal,
   in the output of `andond tail --json` and in the struct for C.

**It counts from the next job on.** A job begins with the first touch, or with `start`. It keeps the id that was in force then. An id
that is set in the middle of a job is for the next job. So a PLC can set it while the worker is still finishing the part before.

**Never the wrong one.** An id with a byte that is not printable ASCII is refused. The next job then has none instead of the one before. A judge that
starts again is given the id before `enable`; it takes the rest of the work for a new job. After a restart of this server the client
sets the id again, before it writes `enable`; the judge keeps the last one until then. Where nothing was ever written here, a scanner
or a person gives the id by `andond part ID`; once `set_part` was used, that is refused.

**A judge that restarts gets its job again.** With `plc.writes` nothing is judged before `enable` is first written. A judge that starts again is given `enable` and the job
that was loaded last, and until it has both, `ready` is not set. The journal keeps the loaded job over a restart of this server too. The
control block is 0 then, and nothing is judged until the client writes `enable` again.

## A program for the PLC

[`andon.st`](andon.st) is a whole client in structured text (IEC 61131-3), to be copied. It sets parts, loads jobs, takes results,
acknowledges them, and goes on after a restart of either side. A test runs exactly this text through a shift with faults and kills, and
compares its account with the journal.
"
    )
}
