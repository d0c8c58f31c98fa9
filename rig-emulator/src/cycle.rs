//! What goes into a cycle of a rig, and what comes out of it.

use crate::actuator::{Limits, Reference};

/// What the ram does in a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// Follow the reference that runs on from here.
    Follow(Reference),
    /// Come to rest and hold.
    Hold,
    /// Go to mid-stroke slowly.
    Centre,
}

/// What the sensors show at the end of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Load cell, tension positive (N).
    pub force_n: f64,
    /// Displacement across the damper's eyes, or at the ram where its sensor is there, extension
    /// positive (m).
    pub displacement_m: f64,
    /// Displacement of the ram (m).
    pub ram_displacement_m: f64,
    /// How far the ram is behind the command, pure delay included; zero unless it follows (m).
    pub behind_m: f64,
    /// Limits that changed the motion in this cycle.
    pub limits: Limits,
}
