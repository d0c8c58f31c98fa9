//! The damper against independent integrations, against published numbers, and against the laws
//! that hold for every damper.

mod accuracy;
mod catalogue;
mod laws;
mod published;
mod reference;
mod sizes;
