//! The evidence that is kept in the repository.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod kept_campaign;
