//! The hashes that the host has found for the same runs, when it built this image.

/// A run and its hash.
pub struct Expected {
    /// What is run: `creep`, `effect`, `compensator`, `state`, `codec`.
    pub group: &'static str,
    /// Which of them.
    pub name: &'static str,
    /// How many steps.
    pub steps: u32,
    /// The host's hash.
    pub hash: u64,
}

include!(concat!(env!("OUT_DIR"), "/expected.rs"));
