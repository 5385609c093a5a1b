//! The Modbus server on a real socket, with a client of plain bytes.
#![allow(clippy::unwrap_used)]

mod server;

use andon_plc::modbus::{Cause, Config, ModbusServer};
use andon_plc::registers::status::{BUSY, DONE, ERROR, NOK, OK, ONLINE, OVERRUN, READY};
use server::{Client, PATIENCE, TestServer, config, count, sample};
use shm_schemas::{CommandKind, VerdictOutcome};
use std::thread;
use std::time::{Duration, Instant};

const ENABLE: u16 = 1;
const LOAD_JOB: u16 = 2;
const START: u16 = 4;
const ACKNOWLEDGE: u16 = 16;
const RESET_ERROR: u16 = 32;

/// An enabled, ready server and its client.
fn ready() -> (TestServer, Client) {
    let server = TestServer::start(config());
    let mut client = server.client();
    client.write(100, ENABLE);
    client.wait_for(ONLINE | READY, 0);
    (server, client)
}

#[test]
fn a_result_is_offered_acknowledged_and_followed_by_the_next() {
    let (mut server, mut client) = ready();
    server.verdict(VerdictOutcome::Ok);
    server.verdict(VerdictOutcome::Anomaly);
    client.wait_for(DONE | OK, NOK);
    let block = client.read(11, 37);
    assert_eq!((block[..2].to_vec(), block[35..].to_vec()), (vec![0, 1], vec![0, 1]));
    assert_eq!(block[20..22], [0x3F80, 0], "distance 1.0");
    client.write(100, ENABLE | ACKNOWLEDGE);
    client.wait_for(0, DONE | OK);
    client.write(100, ENABLE);
    client.wait_for(DONE | NOK, OK);
    assert_eq!(client.read(11, 2), [0, 2]);
    assert_eq!(server.commands.recv_timeout(PATIENCE).unwrap().kind, CommandKind::Enable);
    assert!(server.commands.try_recv().is_err(), "the line has no part in an acknowledgement");
}

#[test]
fn a_job_is_selected_loaded_and_started_in_one_request_each() {
    let (server, mut client) = ready();
    let load = [16, 0, 100, 0, 7, 14, 0, (ENABLE | LOAD_JOB) as u8, 0, 0, 0, 42, 0, 0, 0, 0, 0, 0, 0, 9];
    assert_eq!(client.ask(&load), [16, 0, 100, 0, 7]);
    assert_eq!(server.commands.recv_timeout(PATIENCE).unwrap().kind, CommandKind::Enable);
    let command = server.commands.recv_timeout(PATIENCE).unwrap();
    assert_eq!((command.kind, command.job_id, command.model_hash), (CommandKind::LoadJob, 42, 9));
    client.write(100, ENABLE);
    client.write(100, ENABLE | START);
    client.wait_for(BUSY, 0);
}

#[test]
fn ready_drops_when_the_camera_is_lost_and_comes_back_after_reset() {
    let (server, mut client) = ready();
    server.camera(false);
    client.wait_for(ERROR, READY);
    assert_eq!(client.read(4, 3), [2, 0, 104]);
    server.camera(true);
    thread::sleep(Duration::from_millis(50));
    client.wait_for(ERROR, READY);
    client.write(100, ENABLE | RESET_ERROR);
    client.wait_for(READY, ERROR);
}

#[test]
fn the_heartbeat_moves() {
    let (_server, mut client) = ready();
    let first = client.read(3, 1);
    let until = std::time::Instant::now() + PATIENCE;
    while client.read(3, 1) == first {
        assert!(std::time::Instant::now() < until, "the heartbeat stands still");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_loop_that_does_not_turn_is_not_online() {
    // Nobody calls `run`, as when the role hangs.
    let server = ModbusServer::start(config()).unwrap();
    let mut client = Client::connect(server.address());
    thread::sleep(Duration::from_millis(600));
    assert_eq!(client.read(0, 1)[0] & (ONLINE | READY), 0);
}

#[test]
fn eight_results_wait_behind_the_offered_one_and_none_is_lost() {
    let (mut server, mut client) = ready();
    for _ in 0..12 {
        server.verdict(VerdictOutcome::Ok);
    }
    let until = Instant::now() + PATIENCE;
    while client.read(8, 1) != [8] {
        assert!(Instant::now() < until, "{} wait", client.read(8, 1)[0]);
    }
    assert_eq!(client.read(0, 1)[0] & (DONE | OVERRUN), DONE);
    assert_eq!(client.read(8, 3), [8, 0, 0]);
}

#[test]
fn malformed_requests_are_answered_with_their_exception_and_counted() {
    let (server, mut client) = ready();
    for (pdu, answer) in [
        (&[3, 0, 0, 0, 0][..], [0x83, 3]),         // no register
        (&[3, 0, 0, 0, 126], [0x83, 3]),           // too many
        (&[3, 0, 0], [0x83, 3]),                   // too short
        (&[3, 0, 0, 0, 1, 0], [0x83, 3]),          // too long
        (&[6, 0, 100, 0], [0x86, 3]),              // too short
        (&[16, 0, 100, 0, 1, 4, 0, 1], [0x90, 3]), // byte count of two registers
        (&[16, 0, 100, 128, 0, 0], [0x90, 3]),     // the count that overflows in the decoder
        (&[1, 0, 0, 0, 1], [0x81, 1]),             // coils
        (&[43, 14, 1, 0], [0xAB, 1]),              // not served
        (&[0], [0x80, 1]),
        (&[0x99, 1], [0x99, 1]),
    ] {
        assert_eq!(client.ask(pdu), answer, "{pdu:?}");
    }
    assert_eq!(count(&server.counters.malformed), 11);
    for (pdu, answer) in [
        (&[3, 0, 127, 0, 1][..], [0x83, 2]),
        (&[4, 255, 255, 0, 1], [0x84, 2]),
        (&[6, 0, 0, 0, 1], [0x86, 2]),     // read only
        (&[6, 0, 100, 0, 128], [0x86, 3]), // a bit without a meaning
    ] {
        assert_eq!(client.ask(pdu), answer, "{pdu:?}");
    }
    assert_eq!(count(&server.counters.exceptions), 4);
    client.wait_for(READY, ERROR);
}

#[test]
fn frames_that_come_in_pieces_or_together_are_answered_in_order() {
    let (_server, mut client) = ready();
    let good = [0, 7, 0, 0, 0, 6, 1, 3, 0, 7, 0, 1]; // reads the version of the map
    let bad = [0, 8, 0, 0, 0, 3, 1, 3, 0];
    let mut all = [good.as_slice(), &bad, &good].concat();
    let last = all.split_off(all.len() - 3);
    client.send(&all);
    assert_eq!(client.answer().unwrap(), [3, 2, 0, 6]);
    assert_eq!(client.answer().unwrap(), [0x83, 3]);
    for byte in last {
        client.send(&[byte]);
    }
    assert_eq!(client.answer().unwrap(), [3, 2, 0, 6]);
}

#[test]
fn a_stream_that_is_no_modbus_is_closed_and_others_go_on() {
    let (server, mut client) = ready();
    for bytes in [&b"GET / HTTP/1.1\r\n"[..], &[0, 1, 0, 0, 0, 1, 1, 0], &[0, 1, 0, 0, 2, 0, 1, 0]] {
        let mut other = server.client();
        other.send(bytes);
        assert_eq!(other.answer(), None);
    }
    assert_eq!(count(&server.counters.unframed), 3);
    client.wait_for(READY, ERROR);
}

#[test]
fn without_writes_every_write_is_refused_and_results_give_way_to_each_other() {
    let mut server = TestServer::start(Config { writes: false, hold: Duration::from_millis(20), ..config() });
    let mut client = server.client();
    client.wait_for(READY, 0);
    assert_eq!(client.write(100, ENABLE), [0x86, 1]);
    server.verdict(VerdictOutcome::Ok);
    server.verdict(VerdictOutcome::Anomaly);
    client.wait_for(DONE | NOK, OK);
    assert_eq!(client.read(11, 2), [0, 2]);
    assert!(server.commands.try_recv().is_err(), "no command is sent to the line");
}

#[test]
fn only_a_commander_writes_and_another_client_is_named_once() {
    let panel = "127.0.0.2".parse().unwrap();
    let server =
        TestServer::start(Config { allowed_clients: vec!["127.0.0.1".parse().unwrap(), panel], ..config() });
    let (mut plc, mut reader) = (server.client(), Client::connect_from(panel, server.address));
    plc.write(100, ENABLE);
    plc.wait_for(READY, 0);
    for (address, value) in [(100, 0), (100, ENABLE | RESET_ERROR), (126, ENABLE)] {
        assert_eq!(reader.write(address, value), [0x86, 1], "{address}");
    }
    assert_eq!(reader.read(100, 1), [ENABLE], "it reads all the same");
    reader.wait_for(READY, 0);
    let rejections = server.counters.rejections.take();
    assert_eq!(rejections.into_iter().collect::<Vec<_>>(), [((panel, Cause::NoCommander), 3)]);
}

#[test]
fn two_commanders_leave_each_other_s_bits() {
    let (server, mut plc) = ready();
    let mut panel = server.client();
    server.camera(false);
    plc.wait_for(ERROR, READY);
    server.camera(true);
    // A fault that is still there is latched again at once.
    let until = std::time::Instant::now() + PATIENCE;
    while panel.read(0, 1)[0] & ERROR != 0 {
        assert!(std::time::Instant::now() < until, "the error is not reset");
        panel.write(125, RESET_ERROR);
        panel.write(126, RESET_ERROR);
        thread::sleep(Duration::from_millis(20));
    }
    plc.wait_for(READY, ERROR);
    assert_eq!(plc.read(100, 1), [ENABLE]);
    assert_eq!(plc.read(125, 2), [0, 0]);
}

#[test]
fn everything_up_to_the_control_block_is_read_in_one_request() {
    let (mut server, mut client) = ready();
    server.verdict(VerdictOutcome::Ok);
    client.wait_for(DONE | OK, 0);
    let all = client.read(0, 100);
    assert_eq!(
        (all[11..13].to_vec(), all[46..48].to_vec(), all[76..78].to_vec()),
        (vec![0, 1], vec![0, 1], vec![0, 1])
    );
    assert_eq!(all[60], 0x7031, "the part p1 of the result");
    assert_eq!((all[59], &all[94..98]), (0, &[0; 4][..]), "no note and no measure");
    assert_eq!(all[98..100], [0, 1]);
    assert_eq!(client.read(48, 52), all[48..]);
}

#[test]
fn strangers_and_one_connection_too_many_are_refused() {
    let stranger =
        TestServer::start(Config { allowed_clients: vec!["192.0.2.1".parse().unwrap()], ..config() });
    assert_eq!(ask_or_closed(stranger.client()), None);
    assert_eq!(count(&stranger.counters.refused), 1);

    let server = TestServer::start(Config { connections: 2, ..config() });
    let (mut first, mut second) = (server.client(), server.client());
    first.read(0, 1);
    second.read(0, 1);
    assert_eq!(ask_or_closed(server.client()), None);
    drop(second);
    let until = std::time::Instant::now() + PATIENCE;
    while ask_or_closed(server.client()).is_none() {
        assert!(std::time::Instant::now() < until, "the closed connection still counts");
        thread::sleep(Duration::from_millis(5));
    }
    first.read(0, 1);
}

/// One request; `None` where the server closes instead of answering.
fn ask_or_closed(mut client: Client) -> Option<Vec<u8>> {
    client.send_if_open(&[0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1]);
    client.answer()
}

#[test]
fn an_idle_connection_is_closed_and_so_is_one_that_sends_a_byte_from_time_to_time() {
    let server = TestServer::start(Config { idle_timeout: Duration::from_millis(100), ..config() });
    let mut idle = server.client();
    assert_eq!(idle.answer(), None);
    let mut slow = server.client();
    for _ in 0..100 {
        slow.send_if_open(&[0]);
        thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(slow.answer(), None);
    assert_eq!(count(&server.counters.idle_closed) + count(&server.counters.unframed), 2);
}

#[test]
fn an_address_that_is_taken_is_an_error_that_names_it() {
    let server = TestServer::start(config());
    let error = ModbusServer::start(Config { bind: server.address, ..config() }).err().unwrap().to_string();
    assert!(error.contains(&server.address.to_string()) && error.contains("already in use"), "{error}");
}

/// Results change every millisecond while clients read the block in one request or in several, then ever more slowly. On a busy machine a client that
/// needs 67 requests gets no result whole that lasts a millisecond.
#[test]
fn no_client_reads_a_torn_result() {
    let mut server = TestServer::start(Config { writes: false, hold: Duration::ZERO, ..config() });
    let address = server.address;
    let readers: Vec<_> =
        [67, 40, 9, 1].map(|part| thread::spawn(move || read_in_parts(address, part))).into_iter().collect();
    let mut pause = Duration::from_millis(1);
    while readers.iter().any(|reader| !reader.is_finished()) {
        server.verdict(VerdictOutcome::Ok);
        thread::sleep(pause);
        pause = pause.mul_f64(1.005);
    }
    for reader in readers {
        println!("100 whole results, {} discarded", reader.join().unwrap());
    }
}

/// Reads the result block with `part` registers per request, until 100 were read whole (their two sequences are equal), and
/// checks those. Returns the number of discarded ones.
fn read_in_parts(address: std::net::SocketAddr, part: u16) -> u32 {
    let mut client = Client::connect(address);
    let (mut whole, mut discarded) = (0, 0);
    while whole < 100 {
        let mut block = vec![];
        while block.len() < 67 {
            let from = block.len() as u16;
            block.extend(client.read(11 + from, part.min(67 - from)));
        }
        let number =
            |at: usize, words: usize| block[at..at + words].iter().fold(0, |n, &w| n << 16 | u64::from(w));
        if number(0, 2) != number(65, 2) || number(0, 2) == 0 {
            assert!(part != 67 || number(0, 2) == 0, "one request is always whole");
            discarded += 1;
            continue;
        }
        whole += 1;
        let seq = number(31, 4);
        assert_eq!(number(5, 4), seq.wrapping_mul(0x9E37_79B9_7F4A_7C15), "hash of another result");
        assert_eq!(f32::from_bits(number(20, 2) as u32), seq as f32, "distance of another result");
        assert_eq!(number(35, 2), number(0, 2));
        let text: Vec<u8> = block[49..65].iter().flat_map(|word| word.to_be_bytes()).collect();
        assert_eq!(text, sample(seq, VerdictOutcome::Ok).part.bytes(), "part of another result");
    }
    discarded
}
