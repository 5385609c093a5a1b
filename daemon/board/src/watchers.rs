//! The browsers that watch, each its page.

use std::collections::HashMap;

use andon_http::{Bytes, Feed};

use crate::access::Pass;
use crate::address::{Address, Page};

/// Pages that are watched at once; the server has as many places again for requests.
const MOST: usize = 32;

/// Pages that one browser watches at once. It keeps six connections to one place, so that with a sixth feed it could load nothing more.
const OF_ONE_BROWSER: usize = 5;

/// How often a browser hears that the board is there, if nothing else is to be said. A page calls its server lost after three of these.
const BEAT_NS: u64 = 250_000_000;

/// How often a list for people to read may change under their eyes, if nothing is new in it. What the worker sees changes at once.
const CALM_NS: u64 = 1_000_000_000;

/// What is new is shown at once. What comes within this time after it, as the verdicts at the end of a piece, is shown together.
const TOGETHER_NS: u64 = 40_000_000;

/// Each drawing of a view takes this from its time, so that a line on which everything is wrong costs no more than five in a second.
const TAKES_NS: u64 = 200_000_000;

/// How far ahead of its time a view may be.
const AHEAD_NS: u64 = 800_000_000;

/// What says that the board is there.
const ALIVE: &str = "event: alive\ndata: 1\n\n";

/// What says that other pages of the same browser are watched instead.
const ELSEWHERE: &str = "event: elsewhere\ndata: 1\n\n";

/// What lets a page load itself again: who looks at it may not see it any more.
pub(crate) const AGAIN: &str = "event: again\ndata: 1\n\n";

/// How soon a browser connects again by itself, in milliseconds.
const RETRY: &str = "retry: 500\n\n";

/// All of them.
#[derive(Debug, Default)]
pub(crate) struct Watchers {
    all: Vec<Watcher>,
    /// What those see who look at the same page.
    views: HashMap<Address, View>,
}

#[derive(Debug)]
struct Watcher {
    feed: Feed,
    address: Address,
    browser: String,
    /// What has let it in; none is needed where everybody may read.
    pass: Option<Pass>,
    /// The number of what its page shows; 0 where nothing was sent.
    shown: u64,
    told_ns: u64,
}

/// The states of the board that a page may show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Version {
    /// Changes with whatever a page may show.
    pub(crate) all: u64,
    /// Changes with what somebody waits for: verdicts, what is said of them, and the state of the line.
    pub(crate) news: u64,
}

/// A page as it was drawn last.
#[derive(Debug, Default)]
struct View {
    message: Bytes,
    /// Changes with the message.
    number: u64,
    /// The state of the board of which that is.
    version: Option<Version>,
    drawn_ns: u64,
    /// Until when the drawings so far have taken its time.
    taken_ns: u64,
}

impl Watchers {
    /// Whether one more page of this browser may come. The oldest of a browser makes way for its newest: it is the one that nobody looks at, or has
    /// lost its connection. All that give no name are one browser.
    pub(crate) fn make_room(&mut self, browser: &str) -> bool {
        let mut own = (0..self.all.len()).filter(|place| self.all[*place].browser == browser);
        let oldest = own.next().filter(|_| own.count() + 1 >= OF_ONE_BROWSER);
        if let Some(oldest) = oldest {
            // It may have gone.
            let _ = self.all.remove(oldest).feed.send(ELSEWHERE);
        }
        self.all.len() < MOST
    }

    /// Whether anybody looks at this page.
    pub(crate) fn look_at(&self, page: Page) -> bool {
        self.all.iter().any(|watcher| watcher.address.page == page)
    }

    /// Ends the feeds of those whose pass has ended.
    pub(crate) fn cut(&mut self, is_over: impl Fn(Pass) -> bool) {
        self.all.retain(|watcher| {
            let is_over = watcher.pass.is_some_and(&is_over);
            // It may have gone.
            is_over.then(|| watcher.feed.send(AGAIN)).is_none()
        });
    }

    pub(crate) fn add(&mut self, feed: Feed, address: Address, browser: &str, pass: Option<Pass>) {
        if feed.send(RETRY) {
            self.all.push(Watcher { feed, address, browser: browser.to_owned(), pass, shown: 0, told_ns: 0 });
        }
    }

    /// Sends each what has changed on its page since it was told last. `draw` draws a page, once for all who look at the same one.
    pub(crate) fn tell(&mut self, version: Version, now_ns: u64, draw: impl Fn(&Address) -> String) {
        let Self { all, views } = self;
        views.retain(|address, _| all.iter().any(|watcher| watcher.address == *address));
        all.retain_mut(|watcher| {
            let view = views.entry(watcher.address.clone()).or_default();
            // A page that has just been loaded must not go back to what was drawn before it.
            let is_due = watcher.shown == 0 || view.is_due(watcher.address.page, version, now_ns);
            if is_due && view.version != Some(version) {
                view.put(version, now_ns, draw(&watcher.address));
            }
            watcher.tell(view, now_ns)
        });
    }
}

impl View {
    fn is_due(&self, page: Page, version: Version, now_ns: u64) -> bool {
        let since_ns = now_ns.saturating_sub(self.drawn_ns);
        let is_new = self.version.is_none_or(|drawn| drawn.news != version.news);
        let has_time = since_ns >= TOGETHER_NS && self.taken_ns <= now_ns + AHEAD_NS;
        page == Page::Worker || since_ns >= CALM_NS || is_new && has_time
    }

    fn put(&mut self, version: Version, now_ns: u64, drawn: String) {
        self.version = Some(version);
        self.drawn_ns = now_ns;
        self.taken_ns = self.taken_ns.max(now_ns) + TAKES_NS;
        let message = Bytes::from(format!("event: show\ndata: {drawn}\n\n"));
        if message != self.message {
            self.message = message;
            self.number += 1;
        }
    }
}

impl Watcher {
    /// False when the browser has gone, or does not read.
    fn tell(&mut self, view: &View, now_ns: u64) -> bool {
        if view.number != self.shown {
            (self.shown, self.told_ns) = (view.number, now_ns);
            return self.feed.send(view.message.clone());
        }
        if now_ns.saturating_sub(self.told_ns) < BEAT_NS {
            return true;
        }
        self.told_ns = now_ns;
        self.feed.send(ALIVE)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::cell::RefCell;

    use andon_http::Response;
    use shm_schemas::{Health, RoleId, VerdictLevel};

    use crate::board::Board;
    use crate::confirm::Was;
    use crate::line::{Ill, Line, Stop};
    use crate::sample::{right, settings};

    /// One more who looks at a page. The client reads nothing, and is there as long as this is.
    fn look_at(watchers: &mut Watchers, page: Page) -> Response {
        let (response, feed) = Response::feed("text/event-stream");
        watchers.add(feed, Address { page, ..Address::default() }, "", None);
        response
    }

    /// The pages that are drawn.
    fn drawn(watchers: &mut Watchers, all: u64, news: u64, now_ns: u64) -> Vec<Page> {
        let drawn = RefCell::new(Vec::new());
        watchers.tell(Version { all, news }, now_ns, |address| {
            drawn.borrow_mut().push(address.page);
            format!("<p>{all}")
        });
        drawn.into_inner()
    }

    #[test]
    fn a_page_that_several_look_at_is_drawn_once_whenever_they_came() {
        let mut watchers = Watchers::default();
        let pages = [Page::Worker, Page::Technician, Page::Worker, Page::Worker];
        let mut responses: Vec<_> = pages.map(|page| look_at(&mut watchers, page)).into();
        assert_eq!(drawn(&mut watchers, 1, 1, CALM_NS), [Page::Worker, Page::Technician]);
        assert_eq!(drawn(&mut watchers, 1, 1, 2 * CALM_NS), [], "nothing has changed");
        let later_ns = 2 * CALM_NS + CALM_NS / 2;
        responses.push(look_at(&mut watchers, Page::Technician));
        assert_eq!(
            drawn(&mut watchers, 2, 1, later_ns),
            [Page::Worker, Page::Technician],
            "it is not shown what was before it came"
        );
        for (all, now_ns) in [(3, later_ns + CALM_NS), (4, later_ns + 2 * CALM_NS)] {
            assert_eq!(drawn(&mut watchers, all, 1, now_ns), [Page::Worker, Page::Technician]);
        }
        assert!(watchers.all.iter().all(|watcher| watcher.shown == watchers.views[&watcher.address].number));
        assert_eq!((watchers.all.len(), watchers.views.len()), (5, 2));
        watchers.all.retain(|watcher| watcher.address.page == Page::Worker);
        drawn(&mut watchers, 4, 1, later_ns + 3 * CALM_NS);
        assert_eq!(watchers.views.len(), 1, "what nobody looks at is forgotten");
    }

    #[test]
    fn a_list_shows_what_is_new_at_once_and_everything_else_once_a_second() {
        let mut watchers = Watchers::default();
        let _response = look_at(&mut watchers, Page::Technician);
        let mut draws = |all, news, now_ns| !drawn(&mut watchers, all, news, CALM_NS + now_ns).is_empty();
        assert!(draws(1, 1, 0));
        assert!(!draws(2, 1, CALM_NS / 2), "nothing is new");
        assert!(draws(3, 2, CALM_NS / 2 + 1));
        assert!(!draws(4, 3, CALM_NS / 2 + 2), "it is shown together with what comes now");
        assert!(draws(5, 4, CALM_NS / 2 + 1 + TOGETHER_NS));
        assert!(draws(6, 4, 2 * CALM_NS));
    }

    #[test]
    fn a_line_on_which_everything_is_wrong_costs_five_drawings_in_a_second() {
        let mut watchers = Watchers::default();
        let _response = look_at(&mut watchers, Page::Technician);
        // Its client reads nothing, and is cut off after more.
        let (turn_ns, seconds) = (10_000_000, 10);
        let turns = seconds * CALM_NS / turn_ns;
        let count = |turn| drawn(&mut watchers, turn, turn, CALM_NS + turn * turn_ns).len() as u64;
        let drawn: u64 = (0..turns).map(count).sum();
        assert!((5 * seconds..=5 * seconds + 5).contains(&drawn), "{drawn} in {seconds} s");
    }

    #[test]
    fn a_verdict_and_what_is_said_of_it_are_new_and_a_sign_of_life_is_not() {
        let mut board = Board::new(settings());
        let _response = look_at(&mut board.watchers, Page::Technician);
        let mut verdict = right(VerdictLevel::Job, 0);
        verdict.stamp.seq = 7;
        let row = format!("e{}", verdict.stamp.id());
        let shows = |board: &mut Board, now_ns, text: &str| {
            board.publish(now_ns);
            let view = board.watchers.views.values().next().unwrap();
            String::from_utf8_lossy(&view.message).contains(text)
        };
        assert!(!shows(&mut board, CALM_NS, &row));
        board.verdict(&verdict);
        assert!(shows(&mut board, CALM_NS + 2 * TOGETHER_NS, &row));
        board.confirmed(verdict.stamp.id(), Was::Right, "login maria");
        assert!(shows(&mut board, CALM_NS + 4 * TOGETHER_NS, "maria"));
        board.line(Line::Stopped(Stop::Role), Some((RoleId::Judge, Ill::Silent)));
        assert!(shows(&mut board, CALM_NS + 6 * TOGETHER_NS, "judge gives no sign"));
        board.health(&Health { role: RoleId::Judge.code(), losses: 4711, ..Health::default() });
        let before = board.watchers.views.values().next().unwrap().drawn_ns;
        board.publish(CALM_NS + 8 * TOGETHER_NS);
        assert_eq!(board.watchers.views.values().next().unwrap().drawn_ns, before);
    }

    #[test]
    fn the_oldest_page_of_a_browser_makes_way_for_its_newest_and_no_other_browser_does() {
        let mut watchers = Watchers::default();
        let mut responses = Vec::new();
        let mut come = |watchers: &mut Watchers, browser: &str| {
            let has_room = watchers.make_room(browser);
            let (response, feed) = Response::feed("text/event-stream");
            watchers.add(feed, Address::default(), browser, None);
            responses.push(response);
            has_room
        };
        assert!(come(&mut watchers, "other"));
        assert!((0..2 * OF_ONE_BROWSER).all(|_| come(&mut watchers, "one")));
        assert_eq!(watchers.all.len(), 1 + OF_ONE_BROWSER);
        assert_eq!(watchers.all[0].browser, "other");
        assert!((watchers.all.len()..MOST).all(|number| come(&mut watchers, &number.to_string())));
        assert!(!watchers.make_room("more"), "all places are taken");
        assert!(watchers.make_room("one"), "it takes its own");
    }
}
