//! Twelve fixed cases of the campaign, and the campaign that is kept.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod fixed_cases;
mod kept_campaign;
