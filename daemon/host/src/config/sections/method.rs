//! The section `[method]`.

use crate::config::keys::Keys;
use crate::config::value::within;
use andon_core::capacity::PERSIST_FRAMES;
use andon_core::config::{Contact, Method};

const MAX_PERSIST_FRAMES: u8 = PERSIST_FRAMES as u8;

/// `[method]`: see [`Method`], whose defaults these are.
pub(in crate::config) fn keys(method: &mut Method, k: &mut impl Keys) {
    k.key(
        "rate_hz",
        &mut method.rate_hz,
        within(5.0, 240.0, "Hz"),
        "Rate of the grid: feature couples per second. A job must be judged at the rate at which it was taught.",
    );
    k.key("bins", &mut method.bins, within(4, 36, ""), "N, the number of direction bins around the circle.");
    contact(
        &mut method.hand_contact,
        ["hand_contact_on_m", "hand_contact_off_m"],
        "Hand and object: a contact begins when their interaction points come closer than this.",
        k,
    );
    contact(
        &mut method.object_contact,
        ["object_contact_on_m", "object_contact_off_m"],
        "Object and object. A contact begins when their interaction points come closer than this. It also does when one that a hand brings comes to rest within the distance at which it ends.",
        k,
    );
    k.key(
        "persist_frames",
        &mut method.persist_frames,
        within(1, MAX_PERSIST_FRAMES, "frames"),
        "How long a contact must hold before it counts. Verdicts come later by this time.",
    );
    k.key(
        "rest_speed_m_s",
        &mut method.rest_speed_m_s,
        within(0.001, 0.5, "m/s"),
        "Under this speed a hand or an object is at rest and has no direction.",
    );
    k.key(
        "dead_band_m_s2",
        &mut method.dead_band_m_s2,
        within(0.001, 10.0, "m/s²"),
        "Under this tangential acceleration the speed is constant.",
    );
    k.key(
        "filter_frames",
        &mut method.filter_frames,
        within(1, 31, "frames"),
        "Window of the opening-closing filter on the motion features: odd; 1 filters nothing.",
    );
    k.key(
        "blind_ms",
        &mut method.blind_ms,
        within(50, 10_000, "ms"),
        "When a hand or an object is hidden for longer than this, it is out of sight. The running IU is then not judged, and is never OK. Shorter gaps are bridged where what is seen afterwards fits.",
    );
    k.key(
        "idle_end_ms",
        &mut method.idle_end_ms,
        within(500, 600_000, "ms"),
        "A pause: no hand has been seen for this long. The job ends with it if all of it was done, or if something on the bench was moved meanwhile. Otherwise it goes on when the worker is back.",
    );
}

fn contact(contact: &mut Contact, [on, off]: [&'static str; 2], meaning: &'static str, k: &mut impl Keys) {
    k.key(on, &mut contact.on_m, within(0.001, 0.5, "m"), meaning);
    k.key(
        off,
        &mut contact.off_m,
        within(0.001, 0.5, "m"),
        "The contact ends when they are farther apart than this; at least the distance at which it begins.",
    );
}
