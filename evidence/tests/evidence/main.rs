//! Twelve fixed cases of the campaign.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod fixed_cases;
