//! The accounts of the consumers, and the identity of a database.

use super::*;
use shm_schemas::PartId;

#[test]
fn the_account_of_the_plc_is_kept_and_before_the_first_it_says_where_the_journal_ends() {
    let mut bench = Bench::new();
    bench.send(4, 1..=3);
    let none = bench.journal.account(RoleId::Plc).unwrap();
    assert_eq!((none.boot, none.row, none.epoch, none.seq), (0, 3, 4, 3));
    let mut account = Account {
        boot: 2,
        number: u64::MAX,
        row: 5,
        epoch: u64::MAX,
        seq: 6,
        sequence: u32::MAX,
        lost: 7,
        has_overrun: 1,
        error: 3,
        error_detail: 104,
        shown_row: 1,
        shown_sequence: 8,
        is_acknowledged: 1,
        wanted_job: 12,
        wanted_hash: u64::MAX,
        gives_parts: 1,
        part: PartId::new(b"A-17").unwrap(),
        journal: bench.journal.identity(),
        ..Account::default()
    };
    (account.waiting_rows[0], account.waiting_sequences[0]) = (2, 9);
    (account.waiting_rows[1], account.waiting_sequences[1]) = (4, 11);
    bench.journal.keep(RoleId::Plc, &account).unwrap();
    let again = Journal::open(&bench.path(), KEEP).unwrap();
    assert_eq!(again.account(RoleId::Plc).unwrap(), account);
    // To say that there is none is not the same as to say nothing.
    (account.number, account.part) = (1, PartId::NONE);
    bench.journal.keep(RoleId::Plc, &account).unwrap();
    assert_eq!(
        bench.journal.account(RoleId::Plc).unwrap(),
        account,
        "the newest takes the place of the one before"
    );
}

#[test]
fn each_consumer_has_an_account_of_its_own() {
    let mut bench = Bench::new();
    bench.send(1, 1..=5);
    let account = |row| Account { boot: 1, row, journal: bench.journal.identity(), ..Account::default() };
    let [plc, other] = [account(5), account(2)];
    bench.journal.keep(RoleId::Plc, &plc).unwrap();
    assert_eq!(bench.journal.account(RoleId::Tool).unwrap().boot, 0, "it has none yet");
    bench.journal.keep(RoleId::Tool, &other).unwrap();
    let again = Journal::open(&bench.path(), KEEP).unwrap();
    assert_eq!(again.account(RoleId::Plc).unwrap(), plc);
    assert_eq!(again.account(RoleId::Tool).unwrap(), other);
    assert_eq!(again.consumers().unwrap(), [RoleId::Plc, RoleId::Tool]);
}

#[test]
fn what_is_offered_or_waits_is_not_settled() {
    let mut account = Account { row: 9, ..Account::default() };
    assert_eq!(account.settled(), 9);
    (account.waiting_rows[0], account.waiting_rows[1]) = (6, 8);
    assert_eq!(account.settled(), 5);
    account.shown_row = 4;
    assert_eq!(account.settled(), 3);
    account.is_acknowledged = 1;
    assert_eq!(account.settled(), 5);
}

#[test]
fn every_database_has_an_identity_of_its_own() {
    assert_ne!(Bench::new().journal.identity(), Bench::new().journal.identity());
}
