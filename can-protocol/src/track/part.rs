//! The halves in which a sample of the track travels.

/// One half of a sample: two of its four channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrackPart {
    /// The mean of both rails: vertical, positive down, and alignment, positive right.
    CentreLine,
    /// Their difference: cross level, right rail lower, and gauge, wider than nominal.
    Rails,
}

impl TrackPart {
    /// Both.
    pub const ALL: [Self; 2] = [Self::CentreLine, Self::Rails];
}
