//! Forms, and clients that send them slowly, in the wrong way or without an end.

#![allow(clippy::unwrap_used)]

mod support;

use std::io::Write as _;

use andon_http::{Offer, Server};
use support::{ask, connect, remaining, served};

fn bound() -> Server {
    let offer = Offer { takes_forms: true, tls: None };
    Server::bind_with(([127, 0, 0, 1], 0).into(), offer).unwrap()
}

/// A form that a browser sends, with further headers.
fn post(headers: &str, body: &str) -> String {
    format!(
        "POST /form HTTP/1.1\r\nHost: here\r\nContent-Type: application/x-www-form-urlencoded\r\nContent-Length: {}\r\n{headers}\r\n{body}",
        body.len()
    )
}

#[test]
fn a_form_comes_whole_with_what_the_browser_says_of_it() {
    served(&bound(), |server| {
        let answer = ask(server, &post("Cookie: a=1\r\nCookie: b=2\r\n", "was=right&verdict=1-2"));
        assert!(
            answer.ends_with("form was=right&verdict=1-2, cookies a=1; b=2, own false, from 127.0.0.1"),
            "{answer}"
        );
        let answer = ask(server, "GET /form HTTP/1.1\r\nHost: here\r\n\r\n");
        assert!(answer.ends_with("no form, cookies , own false, from 127.0.0.1"), "{answer}");
        let chunked = "POST /form HTTP/1.1\r\nHost: here\r\nContent-Type: application/x-www-form-urlencoded; charset=utf-8\r\n\
            Transfer-Encoding: chunked\r\n\r\n3\r\na=b\r\n0\r\n\r\n";
        assert!(ask(server, chunked).contains("form a=b,"));
    });
}

#[test]
fn only_a_page_of_the_server_itself_is_called_its_own() {
    served(&bound(), |server| {
        let own = |headers: &str| ask(server, &post(headers, "")).contains("own true");
        assert!(
            own("Origin: http://here\r\n") && own("Origin: http://HERE\r\nSec-Fetch-Site: same-origin\r\n")
        );
        for headers in [
            "",
            "Origin: null\r\n",
            "Origin: https://here\r\n",
            "Origin: http://here.evil.example\r\n",
            "Origin: http://here:80\r\n",
            "Origin: http://here/\r\n",
            "Origin: http://here\r\nOrigin: http://evil.example\r\n",
            "Origin: http://here\r\nSec-Fetch-Site: cross-site\r\n",
            "Origin: http://here\r\nSec-Fetch-Site: same-site\r\n",
            "Origin: http://here\r\nSec-Fetch-Site: none\r\n",
            "Origin: http://here\r\nSec-Fetch-Site: same-origin\r\nSec-Fetch-Site: same-origin\r\n",
            "Sec-Fetch-Site: same-origin\r\n",
            "Referer: http://here/technician\r\n",
        ] {
            assert!(!own(headers), "{headers}");
        }
    });
}

#[test]
fn what_is_no_form_is_refused_and_so_is_a_long_one() {
    served(&bound(), |server| {
        let of =
            |kind: &str| format!("POST /form HTTP/1.1\r\nHost: here\r\n{kind}Content-Length: 3\r\n\r\na=b");
        for kind in [
            "",
            "Content-Type: text/plain\r\n",
            "Content-Type: application/json\r\n",
            "Content-Type: multipart/form-data; boundary=x\r\n",
            "Content-Type: application/x-www-form-urlencodedx\r\n",
        ] {
            assert!(ask(server, &of(kind)).starts_with("HTTP/1.1 415 "), "{kind}");
        }
        assert!(ask(server, &post("", &"x".repeat(68 << 10))).starts_with("HTTP/1.1 200 "));
        assert!(ask(server, &post("", &"x".repeat((68 << 10) + 1))).starts_with("HTTP/1.1 413 "));
        for length in ["100000000000", "18446744073709551615", "99999999999999999999999", "-1"] {
            let request = post("", "").replace("Content-Length: 0", &format!("Content-Length: {length}"));
            assert!(!ask(server, &request).contains(" 200 "), "{length}");
        }
        for method in ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT"] {
            let answer = ask(server, &post("", "").replace("POST", method));
            assert!(
                answer.starts_with("HTTP/1.1 405 ") && answer.contains("allow: GET, HEAD, POST\r\n"),
                "{answer}"
            );
        }
    });
}

#[test]
fn a_body_without_an_end_is_not_read_to_its_end() {
    served(&bound(), |server| {
        let mut client = connect(server);
        let head = "POST /form HTTP/1.1\r\nHost: here\r\nContent-Type: application/x-www-form-urlencoded\r\nTransfer-Encoding: chunked\r\n\r\n";
        client.write_all(head.as_bytes()).unwrap();
        let chunk = format!("10000\r\n{}\r\n", "x".repeat(1 << 16));
        let taken = (0..16_384).take_while(|_| client.write_all(chunk.as_bytes()).is_ok()).count();
        assert!(taken < 16_384, "a gigabyte was taken");
    });
}

#[test]
fn whoever_sends_a_form_slowly_is_cut_off_and_costs_nobody_else_anything() {
    served(&bound(), |server| {
        let mut slow: Vec<_> = (0..200).map(|_| connect(server)).collect();
        for client in &mut slow {
            // Those that make way for others find their connection closed.
            let _ =
                client.write_all(post("", "").replace("Content-Length: 0", "Content-Length: 9").as_bytes());
            let _ = client.write_all(b"a");
        }
        for _ in 0..20 {
            assert!(ask(server, &post("", "a=b")).contains("form a=b,"));
        }
        for client in slow {
            let answer = remaining(client);
            assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 408 "), "{answer}");
        }
    });
}

#[test]
fn a_server_that_takes_no_forms_refuses_them() {
    served(&Server::bind(([127, 0, 0, 1], 0).into()).unwrap(), |server| {
        assert!(ask(server, &post("", "a=b")).starts_with("HTTP/1.1 405 "));
    });
}
