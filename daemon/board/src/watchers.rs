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

/// How often a list for people to read may change under their eyes. What the worker sees changes at once.
const CALM_NS: u64 = 1_000_000_000;

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
pub(crate) struct Watchers(Vec<Watcher>);

#[derive(Debug)]
struct Watcher {
    feed: Feed,
    address: Address,
    browser: String,
    /// What has let it in; none is needed where everybody may read.
    pass: Option<Pass>,
    /// What its page shows, as the message that says so.
    shown: Bytes,
    /// The state of the board of which that is.
    version: Option<u64>,
    told_ns: u64,
    drawn_ns: u64,
}

impl Watchers {
    /// Whether one more page of this browser may come. The oldest of a browser makes way for its newest: it is the one that nobody looks at, or has
    /// lost its connection. All that give no name are one browser.
    pub(crate) fn make_room(&mut self, browser: &str) -> bool {
        let mut own = (0..self.0.len()).filter(|place| self.0[*place].browser == browser);
        let oldest = own.next().filter(|_| own.count() + 1 >= OF_ONE_BROWSER);
        if let Some(oldest) = oldest {
            // It may have gone.
            let _ = self.0.remove(oldest).feed.send(ELSEWHERE);
        }
        self.0.len() < MOST
    }

    /// Whether anybody looks at this page.
    pub(crate) fn look_at(&self, page: Page) -> bool {
        self.0.iter().any(|watcher| watcher.address.page == page)
    }

    /// Ends the feeds of those whose pass has ended.
    pub(crate) fn cut(&mut self, is_over: impl Fn(Pass) -> bool) {
        self.0.retain(|watcher| {
            let is_over = watcher.pass.is_some_and(&is_over);
            // It may have gone.
            is_over.then(|| watcher.feed.send(AGAIN)).is_none()
        });
    }

    pub(crate) fn add(&mut self, feed: Feed, address: Address, browser: &str, pass: Option<Pass>) {
        if feed.send(RETRY) {
            let (browser, shown, version) = (browser.to_owned(), Bytes::new(), None);
            self.0.push(Watcher { feed, address, browser, pass, shown, version, told_ns: 0, drawn_ns: 0 });
        }
    }

    /// Sends each what has changed on its page since it was told last. `draw` draws a page, once for all who look at the same one.
    pub(crate) fn tell(&mut self, version: u64, now_ns: u64, draw: impl Fn(&Address) -> String) {
        let mut drawn = HashMap::<Address, Bytes>::new();
        self.0.retain_mut(|watcher| {
            watcher.tell(version, now_ns, |address| {
                let message = |address: &Address| format!("event: show\ndata: {}\n\n", draw(address)).into();
                drawn.entry(address.clone()).or_insert_with_key(message).clone()
            })
        });
    }
}

impl Watcher {
    /// False when the browser has gone, or does not read.
    fn tell(&mut self, version: u64, now_ns: u64, message: impl FnOnce(&Address) -> Bytes) -> bool {
        let is_calm = self.address.page == Page::Worker || now_ns.saturating_sub(self.drawn_ns) >= CALM_NS;
        if is_calm && self.version != Some(version) {
            (self.version, self.drawn_ns) = (Some(version), now_ns);
            let drawn = message(&self.address);
            if drawn != self.shown {
                (self.shown, self.told_ns) = (drawn.clone(), now_ns);
                return self.feed.send(drawn);
            }
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
    use super::*;
    use std::cell::RefCell;

    use andon_http::Response;

    #[test]
    fn a_page_that_several_look_at_is_drawn_once() {
        let mut watchers = Watchers::default();
        let [worker, technician] =
            [Page::Worker, Page::Technician].map(|page| Address { page, ..Address::default() });
        // Their clients read nothing, and are there as long as these are.
        let _responses: Vec<_> = [&worker, &technician, &worker, &worker]
            .map(|address| {
                let (response, feed) = Response::feed("text/event-stream");
                watchers.add(feed, address.clone(), "", None);
                response
            })
            .into();
        let drawn = RefCell::new(Vec::new());
        let draw = |address: &Address| {
            drawn.borrow_mut().push(address.page);
            "<p>".to_owned()
        };
        watchers.tell(1, CALM_NS, draw);
        assert_eq!(*drawn.borrow(), [Page::Worker, Page::Technician]);
        watchers.tell(1, 2 * CALM_NS, draw);
        assert_eq!((drawn.borrow().len(), watchers.0.len()), (2, 4), "nothing has changed");
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
        assert_eq!(watchers.0.len(), 1 + OF_ONE_BROWSER);
        assert_eq!(watchers.0[0].browser, "other");
        assert!((watchers.0.len()..MOST).all(|number| come(&mut watchers, &number.to_string())));
        assert!(!watchers.make_room("more"), "all places are taken");
        assert!(watchers.make_room("one"), "it takes its own");
    }
}
