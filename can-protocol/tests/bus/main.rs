//! The bus: round trips, the receiver's status table, and the DBC read by two other parsers.

mod arming;
mod cantools;
mod dbc;
mod receiver;
mod roundtrip;
mod sealed;
mod support;
mod unarmed;
