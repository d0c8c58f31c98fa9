//! Faults of a rig and of its line, one after the other, with the cycle in which each is found: the
//! tests that fail when a detector is removed.

mod detectors;
mod faults;
mod rig;
mod table;
