//! Coordinates over which a residual may have a shape.
//!
//! Those of the damper's end are measured; those of the dashpot are simulated behind clearance and
//! stiffness: the knee of a valve is single-valued over the velocity of the dashpot and a loop over
//! that of the end.

use crate::simulation::walk;
use crate::test_set::Test;
use firmware_core::damper::{Damper, MapCoordinate};
use std::ops::ControlFlow;

/// A reversal counts once the motion is faster than this share of its largest speed.
pub(crate) const UNDER_WAY: f64 = 0.02;

/// A coordinate of a residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// Displacement of the end, m.
    Displacement,
    /// Velocity of the dashpot, m/s.
    DashpotVelocity,
    /// Simulated force, N.
    Force,
    /// Time since the motion last reversed, s.
    TimeSinceReversal,
    /// Time since the beginning of the test, s.
    Time,
    /// Temperature, degrees Celsius.
    Temperature,
}

impl Coordinate {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Displacement,
        Self::DashpotVelocity,
        Self::Force,
        Self::TimeSinceReversal,
        Self::Time,
        Self::Temperature,
    ];

    /// Its name in results.
    pub const fn name(self) -> &'static str {
        match self.of_a_damper() {
            Some(coordinate) => coordinate.name(),
            None if matches!(self, Self::Time) => "time",
            None => "temperature",
        }
    }

    /// Its label on an axis, with its unit.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Displacement => "displacement (m)",
            Self::DashpotVelocity => "dashpot velocity (m/s)",
            Self::Force => "simulated force (N)",
            Self::TimeSinceReversal => "time since reversal (s)",
            Self::Time => "time (s)",
            Self::Temperature => "temperature (degC)",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self.of_a_damper() {
            Some(coordinate) => coordinate.unit(),
            None if matches!(self, Self::Time) => "s",
            None => "degC",
        }
    }

    /// The same coordinate of a damper, if the damper knows it while it runs.
    pub const fn of_a_damper(self) -> Option<MapCoordinate> {
        match self {
            Self::Displacement => Some(MapCoordinate::Displacement),
            Self::DashpotVelocity => Some(MapCoordinate::DashpotVelocity),
            Self::Force => Some(MapCoordinate::Force),
            Self::TimeSinceReversal => Some(MapCoordinate::TimeSinceReversal),
            Self::Time | Self::Temperature => None,
        }
    }

    /// Its upper and its lower branch in words.
    pub const fn branches(self) -> (&'static str, &'static str) {
        if self.parts_by_force() {
            ("in tension", "in compression")
        } else {
            ("extending", "compressing")
        }
    }

    /// True when the two branches of a residual part by the sense of the force, and not of motion.
    const fn parts_by_force(self) -> bool {
        matches!(self, Self::Time | Self::Temperature)
    }
}

/// All coordinates of one test, sample by sample, and the branch of each.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    values: [Vec<f64>; 6],
    forward: Vec<bool>,
    tension: Vec<bool>,
}

impl Track {
    /// Simulates the test again and keeps the motion of the dashpot.
    pub(crate) fn simulate(damper: &Damper, test: &Test, start_m: f64) -> Self {
        let record = &test.record;
        let samples = record.force_n.len();
        let (mut dashpot, mut force) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
        walk(damper, test, start_m, samples, |force_n, state| {
            force.push(force_n);
            dashpot.push(state.piston_velocity_m_per_s());
            ControlFlow::Continue(())
        });
        let largest = record.velocity_m_per_s.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let (mut forward, mut since, mut now, mut reversed) = (vec![], vec![], true, 0);
        for (i, v) in record.velocity_m_per_s.iter().enumerate() {
            if (*v > 0.0) != now && v.abs() > UNDER_WAY * largest {
                (now, reversed) = (*v > 0.0, i);
            }
            forward.push(now);
            since.push((i - reversed) as f64 * record.step_s);
        }
        let tension = force.iter().map(|f| *f > 0.0).collect();
        let time = (0..samples).map(|i| i as f64 * record.step_s).collect();
        let temperature = record.temperature_degc.clone().unwrap_or_default();
        let displacement = record.displacement_m.clone();
        let values = [displacement, dashpot, force, since, time, temperature];
        Self { values, forward, tension }
    }

    /// A coordinate sample by sample; empty where it was not measured.
    pub(crate) fn values(&self, coordinate: Coordinate) -> &[f64] {
        &self.values[coordinate as usize]
    }

    /// True for the upper branch: extending, or, over slow coordinates, in tension.
    pub(crate) fn upper(&self, coordinate: Coordinate, sample: usize) -> bool {
        if coordinate.parts_by_force() { self.tension[sample] } else { self.forward[sample] }
    }
}
