//! Where the force of a damper slot comes from in a cycle, as the record keeps it.

/// Where the force of a slot comes from. The codes are those of `record.npy`.
///
/// ```
/// use hil_host::record::ForceSource;
/// assert!(ForceSource::ALL.iter().all(|one| ForceSource::from_code(one.code()) == Some(*one)));
/// assert_eq!(ForceSource::from_code(5), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ForceSource {
    /// Nothing is mounted.
    #[default]
    Nothing = 0,
    /// The model of a slot without a rig.
    Model = 1,
    /// A rig.
    Rig = 2,
    /// The rig of another slot, which stands for this one.
    StandIn = 3,
    /// The model of a slot whose rig has dropped out.
    DroppedOut = 4,
}

impl ForceSource {
    /// All sources in the order of their codes.
    pub const ALL: [Self; 5] =
        [Self::Nothing, Self::Model, Self::Rig, Self::StandIn, Self::DroppedOut];

    /// The code in the record.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The source of a code; `None` for a code that no record holds.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}
