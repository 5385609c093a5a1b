//! The browsers that wait for the camera's picture. A picture is made only where one does.

use std::collections::HashMap;

use andon_http::{Bytes, Feed};

use crate::address::Address;

/// Browsers that wait at once. Each holds a connection of the server, which has 64: for these, for 32 feeds, and for whoever comes.
const MOST: usize = 24;

/// How long a browser waits. Where no frame comes for so long, there is no picture.
const PATIENCE_NS: u64 = 2_000_000_000;

/// All of them.
#[derive(Debug, Default)]
pub(crate) struct Viewers(Vec<Viewer>);

#[derive(Debug)]
struct Viewer {
    feed: Feed,
    address: Address,
    since_ns: u64,
}

impl Viewers {
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether one more may come.
    pub(crate) fn have_room(&self) -> bool {
        self.0.len() < MOST
    }

    pub(crate) fn add(&mut self, feed: Feed, address: Address, since_ns: u64) {
        self.0.push(Viewer { feed, address, since_ns });
    }

    /// Gives each the picture, which ends its wait. `draw` draws it, once for each language.
    pub(crate) fn show(self, draw: impl Fn(&Address) -> String) {
        let mut drawn = HashMap::<Address, Bytes>::new();
        for Viewer { feed, address, .. } in self.0 {
            let picture = drawn.entry(address).or_insert_with_key(|address| draw(address).into());
            // One that has left needs none.
            let _ = feed.send(picture.clone());
        }
    }

    /// Lets those go that have waited for too long: their answer is empty.
    pub(crate) fn give_up(&mut self, now_ns: u64) {
        self.0.retain(|viewer| now_ns.saturating_sub(viewer.since_ns) < PATIENCE_NS);
    }
}
