//! Contacts: edges by distance with hysteresis, believed once they have held for `persist_frames`.

use crate::config::Contact;

/// What one edge of the scene graph has been lately.
///
/// The newest frame is `persist_frames` ahead of the one whose couple is made, so a change is believed from its true
/// first frame on, and only if it held for `persist_frames`, that first frame included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Edge {
    /// Bit k: near (with hysteresis) k frames before the newest. 32 frames are more than the greatest delay.
    near: u32,
    /// Believed, in the newest frame that was asked for.
    believed: bool,
}

impl Edge {
    /// Takes the newest distance. An edge begins only where both things are `sighted`.
    pub(super) fn push(&mut self, distance: f32, sighted: bool, contact: &Contact) {
        let near =
            if self.is_near() { distance <= contact.off_m } else { sighted && distance < contact.on_m };
        self.near = self.near << 1 | u32::from(near);
    }

    /// The newest frame says that there is no contact, whatever the distance.
    pub(super) fn push_apart(&mut self) {
        self.near <<= 1;
    }

    /// Near in the newest frame, believed or not.
    pub(super) fn is_near(self) -> bool {
        self.near & 1 == 1
    }

    /// Near in each of the newest `frames`.
    pub(super) fn held_for(self, frames: u8) -> bool {
        let all = window(frames, 0);
        self.near & all == all
    }

    /// Moves on to the frame `age` frames before the newest and says whether there is a contact in it. Without
    /// `persist` frames from there to the newest (the end of a recording) nothing new is believed.
    pub(super) fn believe(&mut self, age: usize, persist: u8) -> bool {
        if let Some(rest) = (age + 1).checked_sub(usize::from(persist)) {
            let frames = window(persist, rest);
            self.believed = match self.believed {
                true => self.near & frames != 0,
                false => self.near & frames == frames,
            };
        }
        self.believed
    }

    /// Believed, in the newest frame that was asked for.
    pub(super) fn is_believed(self) -> bool {
        self.believed
    }
}

/// `frames` set bits from bit `from` on.
fn window(frames: u8, from: usize) -> u32 {
    ((1 << frames) - 1) << from
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::String;
    use std::vec::Vec;

    const CONTACT: Contact = Contact { on_m: 0.03, off_m: 0.045 };

    /// Whether a contact is believed, for each frame, where couples are made `persist` frames late.
    fn believed(distances: &[f32], persist: u8) -> Vec<bool> {
        let mut edge = Edge::default();
        let mut said = Vec::new();
        for (newest, distance) in distances.iter().enumerate() {
            edge.push(*distance, true, &CONTACT);
            if newest >= usize::from(persist) {
                said.push(edge.believe(usize::from(persist), persist));
            }
        }
        for age in (0..usize::from(persist)).rev() {
            said.push(edge.believe(age, persist));
        }
        said
    }

    fn runs(text: &str) -> Vec<f32> {
        // `-` far, `x` near, `=` between the two distances.
        text.chars()
            .map(|c| match c {
                '-' => 1.0,
                'x' => 0.01,
                _ => 0.04,
            })
            .collect()
    }

    fn text(said: &[bool]) -> String {
        said.iter().map(|believed| if *believed { 'x' } else { '-' }).collect()
    }

    #[test]
    fn a_contact_is_believed_after_persist_frames_from_its_first_frame_on() {
        assert_eq!(text(&believed(&runs("---xxxxx-----"), 5)), "---xxxxx-----");
        assert_eq!(text(&believed(&runs("---xxxx-----"), 5)), "------------");
    }

    #[test]
    fn a_contact_ends_after_persist_frames_at_its_true_end() {
        assert_eq!(text(&believed(&runs("xxxxx--xx---xx---"), 3)), "xxxxxxxxx--------");
    }

    #[test]
    fn between_the_two_distances_a_contact_stays_what_it_was() {
        assert_eq!(text(&believed(&runs("====xxx====--===---"), 2)), "----xxxxxxx--------");
    }

    #[test]
    fn at_the_end_of_a_recording_nothing_is_believed_that_has_not_held_long_enough() {
        assert_eq!(text(&believed(&runs("----xx"), 3)), "------");
        assert_eq!(text(&believed(&runs("---xxx"), 3)), "---xxx");
        assert_eq!(text(&believed(&runs("xxx---"), 3)), "xxx---");
        assert_eq!(text(&believed(&runs("xxxx--"), 3)), "xxxxxx");
    }
}
