//! Is it right?

pub mod campaign;
pub mod reproduce;
pub mod validation;
