//! Is it right? What shows that identification and vehicle studies give correct numbers.
//!
//! | module | what |
//! | --- | --- |
//! | [`validation`] | numbers of this program compared with published numbers and closed forms |
//! | [`reproduce`] | the study of 2014 on the yaw dampers of an SS9, figure by figure |
//! | [`campaign`] | how often `identify` is right, on simulated records of known dampers |
//! | [`EvidenceError`] | what can go wrong in any of them |
//!
//! Read [`validation`] first: one file per reference, each with its tolerance derived.
//!
//! The crate stands on top of all others that compute: `identification` and `virtual-bench` for the
//! campaign, `vehicle-studies` for the figures. Only the command line uses it.

pub mod campaign;
mod error;
pub mod reproduce;
pub mod validation;

pub use error::EvidenceError;
