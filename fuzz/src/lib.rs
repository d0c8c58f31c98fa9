//! What every decoder and loader must do with bytes that nobody expected: return, with a value or
//! an error. It must not panic, hang, or break one of the rules that its target states.
//!
//! A [`Target`] takes bytes. Coverage-guided fuzzing looks for bytes that break it:
//!
//! ```text
//! cargo xtask fuzz frames --seconds 600
//! ```
//!
//! The corpora under `fuzz/corpus` hold what fuzzing found worth keeping, and every input that ever
//! broke a target. The ordinary tests replay all of it.

mod frames;
mod own_messages;
mod records;
mod rig;
mod tables;
mod temporary;
mod toml_files;

/// A decoder or loader with the rules that must hold for any bytes.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Its name, which is that of its corpus.
    pub name: &'static str,
    /// Feeds it.
    pub run: fn(&[u8]),
}

/// All targets.
pub const TARGETS: [Target; 6] = [
    Target { name: "frames", run: frames::frames },
    Target { name: "rig", run: rig::rig },
    Target { name: "toml_files", run: toml_files::toml_files },
    Target { name: "tables", run: tables::tables },
    Target { name: "records", run: records::records },
    Target { name: "own_messages", run: own_messages::own_messages },
];

/// Feeds bytes to the target of a name; whether there is one.
pub fn run(name: &str, bytes: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    target.inspect(|target| (target.run)(bytes)).is_some()
}
