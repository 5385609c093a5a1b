//! The part ids.

use super::*;

/// What a client writes to set the part of the next job.
fn with_part(bytes: &[u8]) -> Control {
    let mut part = [0; shm_schemas::PART_BYTES];
    part[..bytes.len()].copy_from_slice(bytes);
    Control { word: control::ENABLE | control::SET_PART, part, ..ENABLED }
}

#[test]
fn a_part_id_is_given_to_the_judge_until_it_has_it_and_again_before_enable_after_its_restart() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(with_part(b"A-17 "), 0);
    let command = machine.next_command(0).unwrap();
    assert_eq!((command.kind, command.part.text()), (CommandKind::SetPart, "A-17"));
    assert_eq!(machine.image(0).executing & control::SET_PART, control::SET_PART);
    let with_id = Judging { part: command.part, ..watching() };
    answer(&mut machine, &command, Refusal::None, with_id);
    let image = machine.image(0);
    assert_eq!(image.carried_out & control::SET_PART, control::SET_PART);
    assert_eq!(image.next_part.text(), "A-17");
    machine.write(ENABLED, 0);
    assert_eq!(machine.next_command(0), None, "the registers of the id may be written before its bit");

    machine.judging(&Judging { is_enabled: 0, ..watching() }, 0);
    let again = machine.next_command(0).unwrap();
    assert_eq!((again.kind, again.part.text()), (CommandKind::SetPart, "A-17"));
    answer(&mut machine, &again, Refusal::None, Judging { is_enabled: 0, ..with_id });
    assert_eq!(machine.next_command(0).unwrap().kind, CommandKind::Enable);
}

#[test]
fn a_part_id_survives_a_restart_of_this_role_and_of_the_judge_together() {
    for (given, kept) in [(&b"A-17"[..], "A-17"), (b"", "")] {
        let (mut machine, mut journal) = ready_with_journal(WRITES);
        machine.write(with_part(given), 0);
        journal.settle(&mut machine, 0);
        let mut machine = restarted(WRITES, &mut journal);
        let scanned = PartId::new(b"scanned").unwrap();
        machine.judging(&Judging { part: scanned, ..watching() }, 0);
        let again = machine.next_command(0).unwrap();
        assert_eq!((again.kind, again.part.text()), (CommandKind::SetPart, kept));
    }
}

#[test]
fn a_part_id_that_is_none_is_refused_and_the_next_job_has_none_instead_of_the_one_before() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.write(with_part(b"A-17"), 0);
    let command = machine.next_command(0).unwrap();
    answer(&mut machine, &command, Refusal::None, Judging { part: command.part, ..watching() });
    machine.write(ENABLED, 0);
    machine.write(with_part(b"A\x01"), 0);
    let image = machine.image(0);
    assert_eq!((image.refused, image.refusal), (control::SET_PART, u16::from(Refusal::BadPart.code())));
    let none = machine.next_command(0).unwrap();
    assert_eq!((none.kind, none.part), (CommandKind::SetPart, PartId::NONE));
}

#[test]
fn a_plc_that_gives_no_part_id_leaves_that_of_the_tool() {
    let (mut machine, _) = ready_with_journal(WRITES);
    machine.judging(&Judging { part: PartId::new(b"scanned").unwrap(), ..watching() }, 0);
    assert_eq!(machine.next_command(0), None);
    assert_eq!(machine.image(0).next_part.text(), "scanned");
}
