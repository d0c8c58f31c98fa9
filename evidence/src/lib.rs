//! Is it right?

pub mod campaign;
pub mod error;
pub mod reproduce;
pub mod validation;
