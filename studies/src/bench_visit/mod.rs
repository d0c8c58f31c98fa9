//! A visit to a damper bench that exists only as a model.

pub mod excitation;
