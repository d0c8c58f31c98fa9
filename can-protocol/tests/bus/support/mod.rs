//! What the topics share: sample messages, the DBC as text, and its bits moved by hand.

pub(crate) mod dbc_text;
pub(crate) mod exchange;
pub(crate) mod rules;
pub(crate) mod samples;
pub(crate) mod wire;
