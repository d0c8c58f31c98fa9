//! What arrived for a damper slot in a cycle, as the record keeps it.

use firmware_core::guard::ForceInput;

/// What arrived for a slot in a cycle. The codes are those of `record.npy`.
///
/// ```
/// use hil_host::record::InputKind;
/// assert!(InputKind::ALL.iter().all(|kind| InputKind::from_code(kind.code()) == Some(*kind)));
/// assert_eq!(InputKind::from_code(4), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InputKind {
    /// The slot has no rig.
    #[default]
    NoRig = 0,
    /// A new measurement with a valid force.
    Fresh = 1,
    /// Nothing.
    Missing = 2,
    /// A frame that failed a check, or a rig that reports its force as invalid.
    Invalid = 3,
}

impl InputKind {
    /// All kinds in the order of their codes.
    pub const ALL: [Self; 4] = [Self::NoRig, Self::Fresh, Self::Missing, Self::Invalid];

    /// The code in the record.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The kind of a code; `None` for a code that no record holds.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// Whether a rig was to answer and gave no force.
    pub const fn is_stale(self) -> bool {
        matches!(self, Self::Missing | Self::Invalid)
    }
}

impl From<ForceInput> for InputKind {
    fn from(input: ForceInput) -> Self {
        match input {
            ForceInput::Fresh(_) => Self::Fresh,
            ForceInput::Missing => Self::Missing,
            ForceInput::Invalid => Self::Invalid,
        }
    }
}
