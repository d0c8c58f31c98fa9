//! The real-time host.
