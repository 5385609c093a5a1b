//! Who may see and do what on a plant's network, by hostile requests over real sockets.

#![allow(clippy::unwrap_used)]

mod answer;
mod beside;
mod orders;
mod plant;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::time::{Duration, Instant};

use andon_board::{Kept, Rank, Was};
use answer::{cookie, header, status};
use beside::{PATIENCE, until};
use plant::{Plant, fault, served, served_at};

const ADDRESSES: [&str; 24] = [
    "/",
    "/technician",
    "/step/0000000000000007-1.jpg",
    "/technician/event?at=17-4",
    "/technician/explain",
    "/technician/film/one.mcap?at=17-4",
    "/events?view=worker",
    "/events?view=technician",
    "/events?view=event",
    "/picture.svg",
    "/board.css",
    "/board.js",
    "/sound.js",
    "/player.js",
    "/upload.js",
    "/login",
    "/kiosk",
    "/logout",
    "/confirm",
    "/engineer",
    "/engineer/job?at=polish",
    "/events?view=engineer",
    "/engineer/made/report.html?at=polish",
    "/engineer/order",
];

/// Waits for the head of an answer alone: a feed has no end.
fn head(plant: &Plant, target: &str, cookie: &str) -> (u16, String) {
    let mut stream = plant.connect();
    let request =
        format!("GET {target} HTTP/1.1\r\nHost: localhost:{}\r\nCookie: {cookie}\r\n\r\n", plant.port);
    stream.write_all(request.as_bytes()).unwrap();
    let mut lines = BufReader::new(stream).lines().map_while(Result::ok);
    let first = lines.next().unwrap_or_default();
    let _ = lines.by_ref().take_while(|line| !line.is_empty()).count();
    // What shows the station, and what tells a page to load itself again.
    let event = if first.contains(" 200 ") && target.starts_with("/events") {
        lines.find(|line| line.starts_with("event: ")).unwrap_or_default()
    } else {
        String::new()
    };
    (status(&first), event)
}

#[test]
fn each_rank_gets_what_the_table_says_and_nothing_else() {
    served(|plant| {
        let kiosk = plant.logins.lock().unwrap().add_kiosk("screen").unwrap();
        plant.tell_logins();
        let kiosk = cookie(&plant.get(&format!("/kiosk?token={kiosk}"), ""));
        let worker = plant.session("worker");
        let [technician, engineer] = ["technician", "engineer"].map(|name| plant.session(name));
        // Nobody, kiosk, worker, technician, engineer.
        let askers = ["", &kiosk, &worker, &technician, &engineer];
        for (address, expected) in ADDRESSES.into_iter().zip([
            [303, 200, 200, 200, 200],
            [303, 403, 403, 200, 200],
            // No step has a picture.
            [401, 404, 404, 404, 404],
            [303, 403, 403, 200, 200],
            [303, 403, 403, 200, 200],
            // There is none.
            [401, 401, 401, 404, 404],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [401, 401, 401, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [200, 200, 200, 200, 200],
            [403, 403, 403, 403, 403],
            [405, 405, 405, 405, 405],
            [405, 405, 405, 405, 405],
            [303, 403, 403, 403, 200],
            [303, 403, 403, 403, 200],
            [200, 200, 200, 200, 200],
            // There is none.
            [401, 401, 401, 401, 404],
            [405, 405, 405, 405, 405],
        ]) {
            for (asker, expected) in askers.iter().zip(expected) {
                let (status, event) = head(plant, address, asker);
                assert_eq!(status, expected, "{address} of {asker}");
                let may_watch = match address {
                    "/events?view=worker" => !asker.is_empty(),
                    "/events?view=technician" | "/events?view=event" => {
                        [&technician[..], &engineer].contains(asker)
                    }
                    "/events?view=engineer" => *asker == engineer,
                    _ => continue,
                };
                assert_eq!(
                    event,
                    if may_watch { "event: show" } else { "event: again" },
                    "{address} of {asker}"
                );
            }
        }
        // What shows nothing of the station is the same for all.
        for address in ["/login", "/board.css", "/board.js", "/sound.js", "/player.js", "/upload.js"] {
            let answer = plant.get(address, "");
            assert!(!answer.contains("bench1") && !answer.contains("WrongObject"), "{answer}");
        }
        for (address, expected) in ADDRESSES.into_iter().zip([
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            // A form without a name and a password.
            [401; 5],
            [405; 5],
            [303, 303, 303, 303, 303],
            [303, 303, 403, 400, 400],
            [405; 5],
            [405; 5],
            [405; 5],
            [405; 5],
            [303, 303, 403, 403, 400],
        ]) {
            for (asker, expected) in askers.iter().zip(expected) {
                if address == "/login" {
                    // After each wrong password the next has to wait for longer, and never for more than a minute.
                    plant.pass(60);
                }
                // Logging out would end a session that is still needed.
                let own = if address == "/logout" { "" } else { asker };
                let csrf = if own.is_empty() || *own == kiosk { String::new() } else { plant.csrf(own) };
                let answer = plant.post(address, own, &format!("csrf={csrf}"));
                assert_eq!(status(&answer), expected, "{address} of {asker}: {answer}");
            }
        }
    });
}

#[test]
fn the_page_of_an_event_is_answered_later_to_the_session_that_has_asked_and_its_login_leads_back_to_it() {
    served(|plant| {
        let event = "/technician/event?lang=de&at=17-4&frame=3";
        let answer = plant.get(event, "");
        assert_eq!(header(&answer, "location"), "/login?to=event&lang=de&at=17-4&frame=3");
        let form = "name=technician&password=correct+horse&to=event&lang=de&at=17-4&frame=3";
        let answer = plant.post("/login", "", form);
        assert_eq!(header(&answer, "location"), event);
        let session = cookie(&answer);
        let page = plant.get(event, &session);
        let out = format!("name=\"csrf\" value=\"{}\"", plant.csrf(&session));
        let form = "<form id=\"confirm\" method=\"post\" action=\"/confirm\">";
        let button = "<button form=\"confirm\" name=\"wrong\" value=\"17-4\">";
        let place = "name=\"frame\" value=\"3\"";
        for text in ["action=\"/logout\"", "<span>technician</span>", &out, form, button, place] {
            assert!(page.contains(text), "{text} is not in {page}");
        }
        let download = plant.get("/technician/film/one.mcap?at=17-4", &session);
        assert_eq!(header(&download, "content-disposition"), "attachment");
        assert_eq!(header(&download, "referrer-policy"), "same-origin");
    });
}

#[test]
fn where_only_this_machine_reaches_it_all_may_read_and_nobody_acts_without_a_login() {
    served_at(Ipv4Addr::LOCALHOST, |plant| {
        for address in ["/", "/technician"] {
            let page = plant.get(address, "");
            assert!(
                status(&page) == 200 && page.contains("/login?to=") && !page.contains("<button form"),
                "{page}"
            );
        }
        assert_eq!(head(plant, "/events?view=technician", "").1, "event: show");
        // What an engineer has is for engineers, whoever is at the machine.
        for (address, expected) in
            [("/engineer", 303), ("/engineer/job?at=polish", 303), ("/engineer/made/markers.pdf", 401)]
        {
            assert_eq!(status(&plant.get(address, "")), expected, "{address}");
        }
        assert_eq!(head(plant, "/events?view=job&at=polish", "").1, "event: again");
        assert_eq!(status(&plant.post("/engineer/order", "", "do=markers")), 303);
        assert!(plant.orders.lock().unwrap().is_empty());
        assert_eq!(status(&plant.post("/confirm", "", "right=17-4")), 303);
        assert_eq!(plant.asked(), 0);
        let session = plant.session("technician");
        assert!(
            plant
                .get("/technician", &session)
                .contains("<button form=\"confirm\" name=\"right\" value=\"17-4\">")
        );
    });
}

#[test]
fn a_form_of_another_site_or_without_the_token_of_its_session_does_nothing() {
    served(|plant| {
        let [session, other] = ["technician", "engineer"].map(|name| plant.session(name));
        let (csrf, foreign) = (plant.csrf(&session), plant.csrf(&other));
        assert_ne!(csrf, foreign);
        let right = format!("right=17-4&csrf={csrf}");
        let own = format!("http://localhost:{}", plant.port);
        for origin in [
            String::new(),
            "Origin: null\r\n".to_owned(),
            "Origin: http://evil.example\r\n".to_owned(),
            format!("Origin: {own}\r\nSec-Fetch-Site: cross-site\r\n"),
            format!(
                "Origin: {own}\r\nSec-Fetch-Site: same-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document\r\n"
            ),
            "Origin: http://evil.example\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document\r\n".to_owned(),
            format!("Origin: https://localhost:{}\r\n", plant.port),
            "Origin: http://localhost\r\n".to_owned(),
        ] {
            for target in ["/confirm", "/logout", "/login", "/engineer/order"] {
                let answer = plant.post_from(target, &session, &origin, &right);
                assert_eq!(status(&answer), 403, "{target} {origin}: {answer}");
            }
        }
        for form in [
            "right=17-4".to_owned(),
            "right=17-4&csrf=".to_owned(),
            format!("right=17-4&csrf={}", &csrf[1..]),
            format!("right=17-4&csrf={foreign}"),
            format!("right=17-4&csrf={}", "0".repeat(64)),
            format!("right=17-4&CSRF={csrf}"),
        ] {
            for target in ["/confirm", "/logout", "/engineer/order"] {
                assert_eq!(status(&plant.post(target, &session, &form)), 403, "{target} {form}");
            }
        }
        // A token in the address is none of the form, and what is no form is not read.
        assert_eq!(status(&plant.post(&format!("/confirm?csrf={csrf}"), &session, "right=17-4")), 403);
        for kind in ["text/plain", "multipart/form-data; boundary=x", "application/json"] {
            let request = format!(
                "POST /confirm HTTP/1.1\r\nHost: localhost:{}\r\nCookie: {session}\r\nOrigin: {own}\r\nContent-Type: {kind}\r\n\
                 Content-Length: {}\r\n\r\n{right}",
                plant.port,
                right.len()
            );
            assert_eq!(status(&plant.sent(&request)), 415, "{kind}");
        }
        let renamed = plant.sent(&format!(
            "POST /confirm HTTP/1.1\r\nHost: evil.example\r\nCookie: {session}\r\nOrigin: http://evil.example\r\nContent-Type: \
             application/x-www-form-urlencoded\r\nContent-Length: {}\r\n\r\n{right}",
            right.len()
        ));
        assert_eq!(status(&renamed), 421);
        assert_eq!(plant.asked(), 0);
        assert_eq!(status(&plant.get("/technician", &session)), 200, "it is still logged in");
    });
}

#[test]
fn a_session_is_a_new_one_after_each_login_and_ends_with_its_logout() {
    served(|plant| {
        // Somebody else has put a token into this browser.
        let fixed = format!("andon-{}={}", plant.port, "a".repeat(64));
        let answer = plant.log_in("technician", &fixed);
        let session = cookie(&answer);
        assert_ne!(session, fixed);
        assert_eq!(status(&plant.get("/", &fixed)), 303, "it opens nothing");
        let attributes: Vec<&str> = header(&answer, "set-cookie").split("; ").skip(1).collect();
        assert_eq!(attributes, ["Path=/", "HttpOnly", "SameSite=Strict"]);
        assert_eq!(header(&answer, "location"), "/technician");

        let again = cookie(&plant.log_in("technician", &session));
        assert_ne!(again, session);
        assert_eq!(status(&plant.get("/", &session)), 303, "the one before has ended");

        let csrf = plant.csrf(&again);
        let answer = plant.post("/logout", &again, &format!("csrf={csrf}&to=technician"));
        assert_eq!((status(&answer), header(&answer, "location")), (303, "/login?to=technician"));
        assert!(header(&answer, "set-cookie").contains("Max-Age=0"), "{answer}");
        assert_eq!(status(&plant.get("/", &again)), 303, "the cookie is worth nothing");
        assert_eq!(status(&plant.post("/confirm", &again, &format!("csrf={csrf}&right=17-4"))), 303);
        assert_eq!(plant.asked(), 0);
        // The token is long, and is not in the page.
        assert_eq!(session.split_once('=').unwrap().1.len(), 64);
        let last = plant.session("technician");
        assert!(!plant.get("/technician", &last).contains(last.split_once('=').unwrap().1));
    });
}

fn watch(plant: &Plant, view: &str, cookie: &str) -> BufReader<TcpStream> {
    let mut stream = plant.connect();
    let request = format!(
        "GET /events?view={view} HTTP/1.1\r\nHost: localhost:{}\r\nCookie: {cookie}\r\n\r\n",
        plant.port
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut feed = BufReader::new(stream);
    until(&mut feed, "event: show");
    feed
}

#[test]
fn a_session_that_nobody_uses_ends_with_its_feed_and_a_page_that_fetches_by_itself_is_no_use() {
    served(|plant| {
        let session = plant.session("technician");
        let mut feed = watch(plant, "technician", &session);
        plant.pass(20 * 60);
        assert_eq!(status(&plant.get("/technician", &session)), 200);
        plant.pass(20 * 60);
        assert_eq!(head(plant, "/picture.svg", &session).0, 200);
        assert_eq!(head(plant, "/events?view=technician", &session).1, "event: show");
        plant.pass(11 * 60);
        until(&mut feed, "event: again");
        assert_eq!(head(plant, "/events?view=technician", &session).1, "event: again");
        assert_eq!(status(&plant.get("/technician", &session)), 303);
    });
}

#[test]
fn a_login_that_is_removed_or_gets_another_password_is_out() {
    served(|plant| {
        let [worker, technician] = ["worker", "technician"].map(|name| plant.session(name));
        let mut feeds = [watch(plant, "worker", &worker), watch(plant, "technician", &technician)];
        plant.logins.lock().unwrap().remove("worker");
        plant.logins.lock().unwrap().add("technician", Rank::Technician, "battery staple").unwrap();
        plant.tell_logins();
        for feed in &mut feeds {
            until(feed, "event: again");
        }
        assert_eq!([&worker, &technician].map(|of| status(&plant.get("/", of))), [303, 303]);
        assert_eq!(status(&plant.log_in("technician", "")), 401);
    });
}

#[test]
fn wrong_passwords_are_delayed_and_delay_nobody_who_has_logged_in() {
    served(|plant| {
        let session = plant.session("technician");
        let wrong = |name: &str| plant.post("/login", "", &format!("name={name}&password=wrong"));
        for name in ["technician", "nobody", "engineer"] {
            let answer = wrong(name);
            assert_eq!(status(&answer), 401, "{answer}");
            // What is said is the same for a name that there is and for one that there is not.
            assert!(answer.contains("The name or the password is wrong."), "{answer}");
            assert!(!answer.contains("set-cookie"), "{answer}");
        }
        let answer = wrong("technician");
        assert_eq!((status(&answer), header(&answer, "retry-after")), (429, "1"));
        // Also who knows the password waits.
        assert_eq!(status(&plant.log_in("engineer", "")), 429);
        assert_eq!(status(&plant.get("/technician", &session)), 200, "who is in is not delayed");
        plant.pass(1);
        assert_eq!(status(&wrong("technician")), 401);
        let answer = wrong("technician");
        assert_eq!((status(&answer), header(&answer, "retry-after")), (429, "2"));
        plant.pass(2);
        assert_eq!(status(&plant.log_in("engineer", "")), 303);
    });
}

#[test]
fn a_hundred_passwords_at_once_are_not_compared_at_once() {
    served(|plant| {
        let form = "name=technician&password=wrong";
        let request = format!(
            "POST /login HTTP/1.1\r\nHost: localhost:{0}\r\nOrigin: http://localhost:{0}\r\nContent-Type: application/x-www-form-urlencoded\r\n\
             Content-Length: {1}\r\n\r\n{form}",
            plant.port,
            form.len()
        );
        let mut clients: Vec<TcpStream> = (0..40).map(|_| plant.connect()).collect();
        for client in &mut clients {
            client.write_all(request.as_bytes()).unwrap();
        }
        let answers: Vec<u16> = clients
            .into_iter()
            .map(|mut client| {
                let mut answer = String::new();
                let _ = client.read_to_string(&mut answer);
                status(&answer)
            })
            .collect();
        let compared = answers.iter().filter(|status| **status == 401).count();
        assert_eq!(compared, 3, "{answers:?}");
        assert!(answers.iter().all(|status| [401, 429].contains(status)), "{answers:?}");
    });
}

#[test]
fn a_kiosk_shows_the_workers_page_alone_until_it_is_removed() {
    served(|plant| {
        let token = plant.logins.lock().unwrap().add_kiosk("screen").unwrap();
        plant.tell_logins();
        for wrong in ["", "token=", &format!("token={}", "0".repeat(64)), &format!("x={token}")] {
            let answer = plant.get(&format!("/kiosk?{wrong}"), "");
            assert!(status(&answer) == 403 && !answer.contains("set-cookie"), "{wrong}: {answer}");
        }
        let answer = plant.get(&format!("/kiosk?token={token}"), "");
        let attributes = header(&answer, "set-cookie");
        assert!(
            ["HttpOnly", "SameSite=Strict", "Max-Age="].iter().all(|of| attributes.contains(of)),
            "{answer}"
        );
        let kiosk = cookie(&answer);
        assert_eq!(status(&plant.get("/", &kiosk)), 200);
        let mut feed = watch(plant, "worker", &kiosk);
        assert_eq!(status(&plant.get("/technician", &kiosk)), 403);
        assert_eq!(status(&plant.post("/confirm", &kiosk, "right=17-4&csrf=")), 303);
        plant.logins.lock().unwrap().remove("screen");
        plant.tell_logins();
        until(&mut feed, "event: again");
        assert_eq!(status(&plant.get("/", &kiosk)), 303);
    });
}

#[test]
fn what_is_said_of_a_verdict_goes_to_the_line_with_the_name_of_the_login_and_is_answered_when_it_is_kept() {
    served(|plant| {
        let session = plant.session("technician");
        let csrf = plant.csrf(&session);
        for (number, (form, kept, expected)) in [
            ("right=17-4", Kept::Kept, 303),
            ("wrong=17-4", Kept::Unkept, 503),
            ("wrong=17-5", Kept::Gone, 404),
        ]
        .into_iter()
        .enumerate()
        {
            let form = format!("{form}&csrf={csrf}&to=technician&lang=de&at=17-4");
            std::thread::scope(|scope| {
                let answer = scope.spawn(|| plant.post("/confirm", &session, &form));
                let deadline = Instant::now() + PATIENCE;
                while plant.asked() == 0 {
                    assert!(Instant::now() < deadline, "nothing is asked");
                    std::thread::sleep(Duration::from_millis(2));
                }
                let asked = plant.asked.lock().unwrap().remove(0);
                assert_eq!(asked.login, "technician");
                assert_eq!(asked.was, if number == 0 { Was::Right } else { Was::Wrong });
                plant.board.lock().unwrap().answer_asked(asked, kept);
                let answer = answer.join().unwrap();
                assert_eq!(status(&answer), expected, "{answer}");
                let back = "/technician?lang=de&at=17-4";
                let leads =
                    header(&answer, "location") == back || answer.contains(&back.replace('&', "&amp;"));
                assert!(leads, "{answer}");
            });
        }
        for form in ["", "right=", "right=x", "right=17", "right=-1-4", "was=right&verdict=17-4"] {
            let answer = plant.post("/confirm", &session, &format!("{form}&csrf={csrf}"));
            assert_eq!(status(&answer), 400, "{form}");
        }
        // Whoever has said it, markup is text.
        let verdict = fault(4).stamp.id();
        plant.board.lock().unwrap().confirmed(verdict, Was::Wrong, "<script>alert(1)</script>");
        let page = plant.get("/technician", &session);
        assert!(page.contains("&lt;script&gt;alert") && !page.contains("<script>alert"), "{page}");
        assert!(!page.contains("name=\"wrong\" value=\"17-4\""), "it is said already");
    });
}

#[test]
fn whatever_a_form_says_it_leads_nowhere_else_and_is_text() {
    served(|plant| {
        for place in [
            "to=//evil.example",
            "to=https://evil.example",
            "lang=%0d%0aset-cookie:+x=1",
            "at=%22%3E%3Cscript%3E",
        ] {
            let answer = plant.post("/login", "", &format!("name=technician&password=correct+horse&{place}"));
            assert_eq!((status(&answer), header(&answer, "location")), (303, "/"), "{answer}");
            let answer = plant.get(&format!("/login?{place}"), "");
            assert!(!answer.contains("evil") && !answer.contains("<script"), "{answer}");
        }
    });
}
