//! The damper.
