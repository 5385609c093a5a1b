//! Which objects a hand acts on: `o_j` and `o_l` on the shortest path from the hand (paper III-A.3; DESIGN 4, "Scene graph").

/// The hand's place in the scene graph of one frame.
///
/// ```text
///           touches                    lets go, o_j touches o_l
///   Idle ------------> Acts (o_j, o_l?) ------------------------> Released (o_j, o_l)
///    ^                  |      ^                                     |        |
///    |   lets go        |      |              touches                |        |
///    +------------------+      +-------------------------------------+        |
///    +------------------------------------------------------------------------+
///                              o_j and o_l part
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Place {
    /// The hand touches nothing.
    #[default]
    Idle,
    /// The hand touches `j`, which may touch `l`.
    Acts {
        /// `o_j`.
        j: usize,
        /// `o_l`.
        l: Option<usize>,
    },
    /// The hand has let go of `j`, which still touches `l`.
    Released {
        /// `o_j`.
        j: usize,
        /// `o_l`.
        l: usize,
    },
}

/// Something that an edge leads to, with the distance that it costs.
pub(super) type Way = (usize, f32);

impl Place {
    /// The place in the next frame. `touched`: ways from the hand; `neighbours`: ways from an object to objects.
    ///
    /// This is a Dijkstra search from the hand, cut after its second node: the first node that it settles after the hand is the
    /// nearest one, `o_j`; as the path leads on through `o_j` (which holds its place, whatever else the hand touches), the next one is the
    /// nearest to `o_j`, `o_l`. Who holds a place keeps it until its edge ends. Of equal distances the lowest index wins.
    pub(super) fn next<W: Iterator<Item = Way>>(
        self,
        touched: impl Iterator<Item = Way> + Clone,
        neighbours: impl Fn(usize) -> W,
    ) -> Self {
        let (held, beside) = match self {
            Self::Idle => (None, None),
            Self::Acts { j, l } => (Some(j), l),
            Self::Released { j, l } => (Some(j), Some(l)),
        };
        if let Some(j) = settle(touched, held) {
            // `o_l` holds its place only as long as `o_j` does.
            let beside = beside.filter(|_| held == Some(j));
            return Self::Acts { j, l: settle(neighbours(j), beside) };
        }
        match (self, held) {
            // What the released object leans on may not change: that would be something else that happens.
            (Self::Released { l, .. }, Some(j)) if neighbours(j).any(|(other, _)| other == l) => self,
            (Self::Acts { .. }, Some(j)) => match settle(neighbours(j), beside) {
                Some(l) => Self::Released { j, l },
                None => Self::Idle,
            },
            _ => Self::Idle,
        }
    }
}

/// The one that holds the place if there is a way to it, else the nearest.
fn settle(ways: impl Iterator<Item = Way>, holder: Option<usize>) -> Option<usize> {
    let mut nearest: Option<Way> = None;
    for (to, distance) in ways {
        if holder == Some(to) {
            return holder;
        }
        if nearest.is_none_or(|(_, least)| distance < least) {
            nearest = Some((to, distance));
        }
    }
    nearest.map(|(to, _)| to)
}
