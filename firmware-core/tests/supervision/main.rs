//! Faults of a rig and of its line, one after the other, with the cycle in which each is found.

mod faults;
mod rig;
mod table;
