//! The camera's picture and what the line makes of it, as the program that has both gives them.

/// A picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// As JPEG.
    pub jpeg: Vec<u8>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The hands and parts that the line works with.
    pub things: Vec<Thing>,
}

/// A hand or a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// Which one.
    pub what: What,
    /// How its place is known.
    pub visibility: Visibility,
    /// Lines in the picture, each from one point to another, in pixels; none where its place is not known.
    pub lines: Vec<[[f32; 2]; 2]>,
}

/// Which hand, or the part with this id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// The right hand.
    RightHand,
    /// The left hand.
    LeftHand,
    /// A part.
    Part(u16),
}

/// How the place of something is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// It is in the picture.
    Seen,
    /// It lies where it was, or moves with the hand that holds it.
    Assumed,
    /// Nobody knows where it is.
    Unseen,
}
