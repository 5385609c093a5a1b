//! TLS, and clients that do not speak it, speak an old one, or do not go on.

#![allow(clippy::unwrap_used)]

mod support;

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::{Arc, LazyLock};

use andon_http::{Offer, Server, Tls, self_signed};
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject as _;
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};
use support::{ask, connect, remaining, served};

/// A certificate for `localhost`, and its key.
static KEYS: LazyLock<[String; 2]> = LazyLock::new(|| self_signed(&["localhost".to_owned()]).unwrap());

fn bound() -> Server {
    let [certificate, key] = &*KEYS;
    let tls = Tls::new(certificate.as_bytes(), key.as_bytes()).unwrap();
    Server::bind_with(([127, 0, 0, 1], 0).into(), Offer { tls: Some(tls), takes_forms: true }).unwrap()
}

/// A client that trusts the certificate, and calls the server by this name.
fn shaken(server: &Server, name: &'static str) -> StreamOwned<ClientConnection, TcpStream> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_slice(KEYS[0].as_bytes()).unwrap()).unwrap();
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let connection = ClientConnection::new(Arc::new(config), name.try_into().unwrap()).unwrap();
    StreamOwned::new(connection, connect(server))
}

fn ask_encrypted(server: &Server) -> String {
    let mut stream = shaken(server, "localhost");
    stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: https://localhost\r\n\r\n").unwrap();
    remaining(stream)
}

#[test]
fn a_client_that_trusts_the_certificate_is_served_and_one_that_wants_another_name_is_not() {
    served(&bound(), |server| {
        let answer = ask_encrypted(server);
        assert!(answer.starts_with("HTTP/1.1 200 ") && answer.contains("own true"), "{answer}");
        assert!(shaken(server, "evil.example").write_all(b"GET / HTTP/1.1\r\n\r\n").is_err());
    });
}

#[test]
fn a_client_of_plain_http_is_told_so_and_gets_nothing_else() {
    served(&bound(), |server| {
        for request in ["GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", "POST / HTTP/1.1\r\n\r\n", "\u{1}"] {
            let answer = ask(server, request);
            assert!(answer.starts_with("HTTP/1.1 400 ") && answer.contains("https://"), "{answer}");
            assert!(!answer.contains("cookies"), "{answer}");
        }
        assert!(ask_encrypted(server).starts_with("HTTP/1.1 200 "));
    });
}

/// The first message of a client that speaks at most this version, 3 for TLS 1.2 down to 0 for SSL 3.
fn hello(version: u8) -> Vec<u8> {
    let mut body = vec![3, version];
    body.extend([7; 32]);
    // No session; ciphers that a server of that time would take; no compression.
    body.extend([0, 0, 8, 0xc0, 0x2f, 0xc0, 0x30, 0x00, 0x9c, 0x00, 0x2f, 1, 0]);
    let mut message = vec![22, 3, 1, 0, u8::try_from(body.len() + 4).unwrap(), 1, 0, 0];
    message.push(u8::try_from(body.len()).unwrap());
    message.extend(body);
    message
}

#[test]
fn old_versions_of_tls_are_refused() {
    served(&bound(), |server| {
        for version in 0..=3 {
            let mut client = connect(server);
            client.write_all(&hello(version)).unwrap();
            let mut answer = Vec::new();
            let _ = client.read_to_end(&mut answer);
            // An alert that ends it, and no other message of a handshake.
            assert_eq!((answer[0], answer.len(), answer[5]), (21, 7, 2), "{version}: {answer:?}");
        }
    });
}

#[test]
fn whoever_stops_within_the_handshake_is_cut_off_and_costs_nobody_else_anything() {
    served(&bound(), |server| {
        let begin = hello(3);
        let mut slow: Vec<TcpStream> = (0..60).map(|_| connect(server)).collect();
        for (client, length) in slow.iter_mut().zip(0..) {
            // Some say nothing, some a part, some are refused at once.
            client.write_all(&begin[..length % begin.len()]).unwrap();
        }
        for _ in 0..20 {
            assert!(ask_encrypted(server).starts_with("HTTP/1.1 200 "));
        }
        assert!(slow.into_iter().all(|client| !remaining(client).contains("HTTP")));
    });
}

#[test]
fn a_thousand_connections_that_are_half_open_keep_nobody_out() {
    served(&bound(), |server| {
        let begin = hello(3);
        let half_open: Vec<TcpStream> = (0..1000)
            .map(|_| {
                let mut client = connect(server);
                let _ = client.write_all(&begin[..20]);
                client
            })
            .collect();
        for _ in 0..20 {
            assert!(ask_encrypted(server).starts_with("HTTP/1.1 200 "));
        }
        drop(half_open);
    });
}

#[test]
fn a_client_that_sends_rubbish_after_the_handshake_holds_up_nobody() {
    served(&bound(), |server| {
        let mut client = shaken(server, "localhost");
        client.write_all(b"GET / HT").unwrap();
        client.sock.write_all(&[23, 3, 3, 0, 5, 1, 2, 3, 4, 5]).unwrap();
        assert!(ask_encrypted(server).starts_with("HTTP/1.1 200 "));
        assert!(!remaining(client).contains(" 200 "));
    });
}
