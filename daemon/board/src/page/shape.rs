//! One shape for each state, so that no state is told by its colour alone.

use super::state::State;

/// A drawing in a field of 100 by 100, in the colour of the text.
pub(super) const fn of(state: State) -> &'static str {
    match state {
        // Three dots.
        State::Starting => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><circle cx=\"20\" cy=\"50\" r=\"11\"/><circle cx=\"50\" cy=\"50\" r=\"11\"/>\
             <circle cx=\"80\" cy=\"50\" r=\"11\"/></svg>"
        }
        // An eye that is crossed out.
        State::Stopped(_) => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path class=\"line\" d=\"M4 50 Q50 2 96 50 Q50 98 4 50 Z\"/>\
             <circle cx=\"50\" cy=\"50\" r=\"15\"/><path class=\"line\" d=\"M12 90 L88 10\"/></svg>"
        }
        // Two bars.
        State::Off | State::NoJob => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path d=\"M22 12 h20 v76 h-20 Z M58 12 h20 v76 h-20 Z\"/></svg>"
        }
        // A ring.
        State::Ready => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><circle class=\"line\" cx=\"50\" cy=\"50\" r=\"42\"/></svg>"
        }
        // A ring with an arrow.
        State::Working => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><circle class=\"line\" cx=\"50\" cy=\"50\" r=\"42\"/>\
             <path d=\"M40 28 L74 50 L40 72 Z\"/></svg>"
        }
        // A triangle with an exclamation mark.
        State::Check => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path class=\"line\" d=\"M50 8 L95 90 H5 Z\"/>\
             <path d=\"M45 34 h10 l-2 30 h-6 Z\"/><circle cx=\"50\" cy=\"76\" r=\"6\"/></svg>"
        }
        // A diamond with a question mark.
        State::NotJudged => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path class=\"line\" d=\"M50 5 L95 50 L50 95 L5 50 Z\"/>\
             <path class=\"line\" d=\"M38 40 a12 12 0 1 1 17 11 q-5 3 -5 9\"/><circle cx=\"50\" cy=\"73\" r=\"5\"/></svg>"
        }
        // An octagon with a cross.
        State::Fault => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path class=\"line\" d=\"M32 6 H68 L94 32 V68 L68 94 H32 L6 68 V32 Z\"/>\
             <path class=\"line\" d=\"M33 33 L67 67 M67 33 L33 67\"/></svg>"
        }
        // A tick.
        State::Good => {
            "<svg viewBox=\"0 0 100 100\" aria-hidden=\"true\"><path class=\"line\" d=\"M10 54 L38 82 L90 20\"/></svg>"
        }
    }
}
