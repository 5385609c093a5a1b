//! What engineers order on the board, by forms over real sockets. The table of `safe.rs` says who may do so.

use std::time::{Duration, Instant};

use andon_board::{Audited, Job, Known, KnownJob, Order, Ordered, Piece, Step, Version};
use shm_schemas::{PIECE_BYTES, Printed, PrintedState, Task, TaskKind};

use crate::answer::{header, status};
use crate::beside::PATIENCE;
use crate::plant::{Plant, served};

/// Sends an engineer's form and says what became of the order that it is: what is to be told of that order, and the answer.
fn answered<T>(plant: &Plant, form: &str, ordered: &Ordered, tell: impl Fn(&Order) -> T) -> (T, String) {
    let session = plant.session("engineer");
    let form = format!("{form}&csrf={}&to=engineer&lang=de", plant.csrf(&session));
    std::thread::scope(|scope| {
        let answer = scope.spawn(|| plant.post("/engineer/order", &session, &form));
        let deadline = Instant::now() + PATIENCE;
        let order = loop {
            if let Some(order) = plant.orders.lock().unwrap().pop() {
                break order;
            }
            assert!(Instant::now() < deadline, "nothing is ordered");
            std::thread::sleep(Duration::from_millis(2));
        };
        let told = tell(&order);
        plant.board.lock().unwrap().answer_order(order, ordered);
        (told, answer.join().unwrap())
    })
}

/// Of an order: what is to be done, and the name of the login, that of the job and what else was said.
fn ordered(plant: &Plant, form: &str, ordered: &Ordered) -> (TaskKind, [String; 3], String) {
    let ((kind, words), answer) = answered(plant, form, ordered, |order| {
        (order.kind, [&order.login, &order.name, &order.text].map(String::clone))
    });
    (kind, words, answer)
}

#[test]
fn what_an_engineer_orders_goes_to_the_line_with_the_name_of_the_login_and_is_answered_by_what_became_of_it()
{
    served(|plant| {
        let (kind, words, answer) = ordered(plant, "load=polish", &Ordered::Taken);
        assert_eq!((kind, words), (TaskKind::Load, ["engineer", "polish", ""].map(str::to_owned)));
        assert_eq!((status(&answer), header(&answer, "location")), (303, "/engineer?lang=de"));
        let why = Ordered::Refused("another task is running <script>".to_owned());
        let (kind, words, answer) = ordered(plant, "do=films&job=polish&film=a.mp4&film=b.mp4", &why);
        assert_eq!(kind, TaskKind::TeachFilms);
        assert_eq!(words, ["engineer", "polish", "a.mp4\nb.mp4"].map(str::to_owned));
        assert_eq!(status(&answer), 409);
        assert!(answer.contains("another task is running &lt;script&gt;"), "{answer}");
        let (_, _, answer) = ordered(plant, "do=markers", &Ordered::Unheard);
        assert!(status(&answer) == 503 && answer.contains("executor"), "{answer}");
    });
}

#[test]
fn a_piece_of_a_recording_goes_to_the_line_and_is_answered_to_a_script() {
    served(|plant| {
        let sent = |piece: &str, ordered: &Ordered| {
            let form = format!("do=film&film=7&name=run1.mp4&at=3&size=9&piece={piece}");
            answered(plant, &form, ordered, |order| {
                assert_eq!((order.kind, order.name.as_str()), (TaskKind::Film, "run1.mp4"));
                order.piece.clone().unwrap()
            })
        };
        let (piece, answer) = sent("ZmlsbXM", &Ordered::Taken);
        assert_eq!(piece, Piece { film: 7, at: 3, size: 9, bytes: b"films".to_vec() });
        assert_eq!(status(&answer), 200);
        let (_, answer) = sent("ZmlsbXM", &Ordered::Refused("there is one <already>".to_owned()));
        assert!(status(&answer) == 409 && answer.ends_with("there is one <already>"), "{answer}");
        assert!(answer.contains("content-type: text/plain"), "{answer}");
        assert_eq!(status(&sent("ZmlsbXM", &Ordered::Unheard).1), 503);
        let (piece, _) = sent(&"A".repeat(PIECE_BYTES / 3 * 4), &Ordered::Taken);
        assert_eq!(piece.bytes.len(), PIECE_BYTES);
    });
}

#[test]
fn a_piece_that_is_none_comes_without_a_token_or_from_who_may_not_send_is_kept_by_nobody() {
    served(|plant| {
        let session = plant.session("engineer");
        let csrf = plant.csrf(&session);
        let piece = "do=film&film=7&name=run1.mp4&at=0&size=9&piece=ZmlsbXM";
        for (form, expected) in [
            ("do=film&name=run1.mp4&at=0&size=9&piece=ZmlsbXM".to_owned(), 400),
            ("do=film&film=-7&name=run1.mp4&at=0&size=9&piece=ZmlsbXM".to_owned(), 400),
            ("do=film&film=7&name=run1.mp4&at=x&size=9&piece=ZmlsbXM".to_owned(), 400),
            ("do=film&film=7&name=run1.mp4&at=0&size=1e9&piece=ZmlsbXM".to_owned(), 400),
            ("do=film&film=7&name=run1.mp4&at=0&size=9&piece=Zml+sbXM".to_owned(), 400),
            ("do=film&film=7&name=run1.mp4&at=0&size=9&piece=%00%01".to_owned(), 400),
            (format!("{piece}{}", "A".repeat(PIECE_BYTES / 3 * 4)), 400),
            (format!("{piece}{}", "A".repeat(80_000)), 413),
            (format!("do=film&film=7&name={}&at=0&size=9&piece=ZmlsbXM", "x".repeat(65)), 413),
        ] {
            let answer = plant.post("/engineer/order", &session, &format!("{form}&csrf={csrf}"));
            assert_eq!(status(&answer), expected, "{}", &form[..40]);
        }
        for csrf in ["", "&csrf=", "&csrf=0123456789abcdef"] {
            let answer = plant.post("/engineer/order", &session, &format!("{piece}{csrf}"));
            assert_eq!(status(&answer), 403, "{csrf}");
        }
        for rank in ["worker", "technician"] {
            let session = plant.session(rank);
            let form = format!("{piece}&csrf={}", plant.csrf(&session));
            assert_eq!(status(&plant.post("/engineer/order", &session, &form)), 403, "{rank}");
        }
        assert_eq!(status(&plant.post("/engineer/order", "", &format!("{piece}&csrf={csrf}"))), 303);
        assert!(plant.orders.lock().unwrap().is_empty());
    });
}

#[test]
fn an_order_that_is_none_or_too_long_is_refused_and_what_a_job_is_called_is_text() {
    served(|plant| {
        let session = plant.session("engineer");
        let csrf = plant.csrf(&session);
        for form in ["do=delete", "do=", "load=", "answer=x/k"] {
            let answer = plant.post("/engineer/order", &session, &format!("{form}&csrf={csrf}"));
            assert_eq!(status(&answer), 400, "{form}");
        }
        let long = "x".repeat(5000);
        for form in [format!("do=name&job=polish&step={long}"), format!("load={long}")] {
            let form = format!("{form}&csrf={csrf}&to=engineer&lang=de");
            let answer = plant.post("/engineer/order", &session, &form);
            assert!(status(&answer) == 413 && answer.contains("auf einmal"), "{answer}");
            assert!(answer.contains("href=\"/engineer?lang=de\""), "it leads back: {answer}");
        }
        assert!(plant.orders.lock().unwrap().is_empty());
        let markup = "\"><script>alert(1)</script>".to_owned();
        let version =
            Version { hash: markup.clone(), date: markup.clone(), runs: 1, steps: 1, has_report: true };
        let job = KnownJob {
            name: "polish".to_owned(),
            title: markup.clone(),
            version: version.clone(),
            names: Job { steps: vec![Step { name: markup.clone(), ..Step::default() }], ..Job::default() },
            runs: vec![markup.clone()],
            earlier: vec![version],
            has_report: true,
            ..KnownJob::default()
        };
        let broken = KnownJob { name: markup.clone(), fault: markup.clone(), ..KnownJob::default() };
        let known = Known { jobs: vec![job, broken], films: vec![markup.clone()], ..Known::default() };
        plant.board.lock().unwrap().known(known);
        let mut task = Task { number: 1, kind: TaskKind::TeachLive.code(), ..Task::default() };
        assert!(task.say(&markup, &markup, ""));
        let mut printed = Printed { state: PrintedState::Line.code(), ..Printed::default() };
        printed.of(&task);
        printed.say(&markup);
        plant.board.lock().unwrap().printed(&printed);
        let (kind, who, what) = (markup.clone(), markup.clone(), markup.clone());
        let deed = Audited { utc_ns: 7, kind, who, what, became: markup.clone() };
        plant.board.lock().unwrap().audited(vec![deed]);
        for address in ["/engineer", "/engineer/job?at=polish"] {
            let page = plant.get(address, &session);
            assert_eq!(status(&page), 200, "{page}");
            assert!(page.contains("&lt;script&gt;alert") && !page.contains("<script>alert"), "{page}");
        }
        // No name leads to a file that the board does not know.
        for path in ["/engineer/made/", "/engineer/made/../x", "/engineer/made/look.png", "/engineer/made/x"]
        {
            let answer = plant.get(path, &session);
            assert!(
                status(&answer) == 404 && !answer.contains("there is none"),
                "{path}: nobody is asked for it"
            );
        }
    });
}
