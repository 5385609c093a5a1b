//! Which objects a hand acts on: `o_j` and `o_l` on the shortest path from the hand (paper III-A.3).

/// What a hand does in the scene graph of one frame.
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
pub(super) enum Interaction {
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

/// An edge: the index of the object that it leads to, and its length in metres.
pub(super) type Edge = (usize, f32);

impl Interaction {
    /// `o_j`.
    pub(super) fn held(self) -> Option<usize> {
        match self {
            Self::Idle => None,
            Self::Acts { j, .. } | Self::Released { j, .. } => Some(j),
        }
    }

    /// `o_j` and `o_l`.
    pub(super) fn pair(self) -> Option<(usize, usize)> {
        match self {
            Self::Acts { j, l } => Some((j, l?)),
            Self::Released { j, l } => Some((j, l)),
            Self::Idle => None,
        }
    }

    /// Whether the hand acts on the object.
    pub(super) fn acts_on(self, object: usize) -> bool {
        matches!(self, Self::Acts { j, .. } if j == object)
    }

    /// Whether the object is `o_j` or `o_l`.
    pub(super) fn involves(self, object: usize) -> bool {
        self.held() == Some(object) || self.pair().is_some_and(|(_, l)| l == object)
    }

    /// The interaction in the next frame. `touched` are the edges from the hand, `neighbours` those from an object to others.
    ///
    /// This is a Dijkstra search from the hand that stops after its second node. `o_j` is the one nearest to the hand, `o_l` the one nearest to `o_j`.
    /// An object remains `o_j` or `o_l` until its edge ends, even if another comes nearer. Of equal distances the lowest index wins.
    pub(super) fn next<E: Iterator<Item = Edge>>(
        self,
        touched: impl Iterator<Item = Edge> + Clone,
        neighbours: impl Fn(usize) -> E,
    ) -> Self {
        let (former_j, former_l) = (self.held(), self.pair().map(|(_, l)| l));
        if let Some(j) = nearest(touched, former_j) {
            // `o_l` remains only as long as `o_j` does.
            let former_l = former_l.filter(|_| former_j == Some(j));
            return Self::Acts { j, l: nearest(neighbours(j), former_l) };
        }
        match (self, former_j) {
            // A released object that comes to touch something else is another event, in which the hand has no part.
            (Self::Released { l, .. }, Some(j)) if neighbours(j).any(|(other, _)| other == l) => self,
            (Self::Acts { .. }, Some(j)) => {
                nearest(neighbours(j), former_l).map_or(Self::Idle, |l| Self::Released { j, l })
            }
            _ => Self::Idle,
        }
    }
}

/// The object to which the shortest edge leads, or the `former` one if there still is an edge to it.
fn nearest(edges: impl Iterator<Item = Edge>, former: Option<usize>) -> Option<usize> {
    let mut nearest: Option<Edge> = None;
    for (to, distance) in edges {
        if former == Some(to) {
            return former;
        }
        if nearest.is_none_or(|(_, min)| distance < min) {
            nearest = Some((to, distance));
        }
    }
    nearest.map(|(to, _)| to)
}
