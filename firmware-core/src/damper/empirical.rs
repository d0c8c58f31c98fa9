//! A map over one coordinate, fitted to the residual of a damper model: empirical, and no physics.
//!
//! ```text
//! F = F_damper + m_s(q)        q: displacement, dashpot velocity, chain force, time since reversal
//! ```
//!
//! m is straight between its knots and constant beyond the first and the last: it never
//! extrapolates. It has two branches, s: one while the eyes move apart, one while they move
//! together. The sense of motion turns when the eyes move the other way faster than
//! `reversal_m_per_s`, so that noise at the ends of a stroke turns nothing. The map is added to the
//! force that comes out, after every effect and the sensor, so the damper within feels nothing of
//! it.
//!
//! Limits: it holds only inside the range of the records it was fitted to, and it keeps no balance
//! of energy. It is no effect and is not in the catalogue: its cause is unknown.

use heapless::Vec;

use super::DamperState;
use super::error::DamperError;

/// Most knots of a map.
pub const MAP_KNOTS: usize = 16;

/// Fewest knots of a map.
const FEWEST_KNOTS: usize = 2;

/// What a map may be drawn over: what a running damper knows of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapCoordinate {
    /// Displacement between the eyes, m.
    Displacement,
    /// Velocity of the piston, m/s.
    DashpotVelocity,
    /// Force in the chain, N, without parallel parts and sensor.
    Force,
    /// Time since the motion last turned, s.
    TimeSinceReversal,
}

impl MapCoordinate {
    /// As it is written in files and results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::DashpotVelocity => "dashpot_velocity",
            Self::Force => "force",
            Self::TimeSinceReversal => "time_since_reversal",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::DashpotVelocity => "m/s",
            Self::Force => "N",
            Self::TimeSinceReversal => "s",
        }
    }

    /// Its value at the end of the last step. Time is counted only by a damper that has a map.
    #[inline]
    pub fn of(self, state: &DamperState) -> f64 {
        match self {
            Self::Displacement => state.motion.displacement_m,
            Self::DashpotVelocity => state.piston_velocity_m_per_s,
            Self::Force => state.chain_force_n,
            Self::TimeSinceReversal => state.turned.since_s,
        }
    }
}

/// A knot of a map: both branches at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapKnot {
    /// Where, in the unit of the coordinate.
    pub at: f64,
    /// Force while the eyes move apart, N.
    pub upper_n: f64,
    /// Force while they move together, N.
    pub lower_n: f64,
}

/// The sense of motion, and since when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turned {
    /// The eyes move together; at the start they count as moving apart.
    compresses: bool,
    /// Time since the motion last turned, s.
    since_s: f64,
}

impl Turned {
    /// Nothing has happened yet.
    pub(super) const NEW: Self = Self { compresses: false, since_s: 0.0 };
}

impl DamperState {
    /// The branch of a map: true while the eyes move apart. Kept only by a damper that has a map.
    pub fn extends(&self) -> bool {
        !self.turned.compresses
    }
}

/// A force over one coordinate, parallel to the whole damper.
#[derive(Debug, Clone, PartialEq)]
pub struct EmpiricalMap {
    coordinate: MapCoordinate,
    knots: Vec<MapKnot, MAP_KNOTS>,
    reversal_m_per_s: f64,
}

impl EmpiricalMap {
    /// A map through knots in rising order. The motion turns when the eyes move the other way
    /// faster than `reversal_m_per_s`.
    ///
    /// # Errors
    /// [`DamperError::MapKnots`], [`DamperError::MapNotRising`], or [`DamperError::Parameter`] for
    /// a number that is not finite and a speed below zero.
    ///
    /// ```
    /// use firmware_core::damper::{EmpiricalMap, MapCoordinate, MapKnot};
    /// let knots = [
    ///     MapKnot { at: -1e-3, upper_n: 10.0, lower_n: 0.0 },
    ///     MapKnot { at: 1e-3, upper_n: 30.0, lower_n: -40.0 },
    /// ];
    /// let map = EmpiricalMap::new(MapCoordinate::Displacement, &knots, 1e-3)?;
    /// assert_eq!(map.force_n(0.0, true), 20.0);
    /// assert_eq!(map.force_n(5e-3, false), -40.0);
    /// # Ok::<(), firmware_core::damper::DamperError>(())
    /// ```
    pub fn new(
        coordinate: MapCoordinate,
        knots: &[MapKnot],
        reversal_m_per_s: f64,
    ) -> Result<Self, DamperError> {
        let given = knots.len();
        let count = DamperError::MapKnots { given, fewest: FEWEST_KNOTS, most: MAP_KNOTS };
        let kept = Vec::from_slice(knots).map_err(|_| count)?;
        if given < FEWEST_KNOTS {
            return Err(count);
        }
        let checked = |parameter, value: f64, lower: f64| {
            if value >= lower && value <= f64::MAX {
                return Ok(());
            }
            let (owner, upper) = ("empirical", f64::MAX);
            Err(DamperError::Parameter { owner, parameter, value, lower, upper })
        };
        for knot in knots {
            checked("at", knot.at, -f64::MAX)?;
            checked("upper_n", knot.upper_n, -f64::MAX)?;
            checked("lower_n", knot.lower_n, -f64::MAX)?;
        }
        for (before, after) in knots.iter().zip(knots.iter().skip(1)) {
            if after.at <= before.at {
                return Err(DamperError::MapNotRising { at: after.at, after: before.at });
            }
        }
        checked("reversal_m_per_s", reversal_m_per_s, 0.0)?;
        Ok(Self { coordinate, knots: kept, reversal_m_per_s })
    }

    /// What it is drawn over.
    pub fn coordinate(&self) -> MapCoordinate {
        self.coordinate
    }

    /// The knots, rising.
    pub fn knots(&self) -> &[MapKnot] {
        &self.knots
    }

    /// Speed the other way at which the motion has turned, m/s.
    pub fn reversal_m_per_s(&self) -> f64 {
        self.reversal_m_per_s
    }

    /// The knot at or below a place, and how far the place is towards the next one, from 0 to 1;
    /// beyond an end, the end.
    #[inline]
    pub fn place(&self, at: f64) -> (usize, f64) {
        let next = self.knots.iter().position(|knot| knot.at > at).unwrap_or(self.knots.len());
        let index = next.saturating_sub(1);
        match (next.checked_sub(1).and_then(|i| self.knots.get(i)), self.knots.get(next)) {
            // Halved, so that knots at both ends of all numbers are no infinity apart.
            (Some(a), Some(b)) => (index, (0.5 * at - 0.5 * a.at) / (0.5 * b.at - 0.5 * a.at)),
            _ => (index, 0.0),
        }
    }

    /// The force at a place of a branch, N.
    #[inline]
    pub fn force_n(&self, at: f64, extends: bool) -> f64 {
        debug_assert!(self.knots.len() >= FEWEST_KNOTS, "a map of {} knots", self.knots.len());
        let (index, share) = self.place(at);
        debug_assert!(index < self.knots.len(), "knot {index} of {}", self.knots.len());
        let value = |knot: &MapKnot| if extends { knot.upper_n } else { knot.lower_n };
        let here = self.knots.get(index).map_or(0.0, value);
        let next = self.knots.get(index + 1).map_or(here, value);
        (1.0 - share) * here + share * next
    }

    /// Brings the sense of motion to the end of a step and returns the force there, N.
    pub(super) fn advance(
        &self,
        state: &mut DamperState,
        velocity_m_per_s: f64,
        step_s: f64,
    ) -> f64 {
        let turned = &mut state.turned;
        turned.since_s += step_s;
        let other_way_m_per_s =
            if turned.compresses { velocity_m_per_s } else { -velocity_m_per_s };
        if other_way_m_per_s > self.reversal_m_per_s {
            *turned = Turned { compresses: !turned.compresses, since_s: 0.0 };
        }
        self.force_n(self.coordinate.of(state), state.extends())
    }
}

#[cfg(test)]
mod tests {
    use super::super::effects::{ForceOffset, SensorDelay};
    use super::super::{Damper, Effect, Motion, Nominal};
    use super::*;

    const STEP_S: f64 = 1e-3;

    fn knot(at: f64, upper_n: f64, lower_n: f64) -> MapKnot {
        MapKnot { at, upper_n, lower_n }
    }

    fn map(coordinate: MapCoordinate) -> EmpiricalMap {
        let knots = [knot(-2.0, 1.0, -1.0), knot(0.0, 3.0, -5.0), knot(1.0, 7.0, -6.0)];
        EmpiricalMap::new(coordinate, &knots, 1e-3).unwrap()
    }

    /// A sine from mid-stroke, with its velocity or without.
    fn motion(step: u32, with_velocity: bool) -> Motion {
        let (sin, cos) = libm::sincos(22.0 * STEP_S * f64::from(step));
        Motion::new(3e-3 * sin, if with_velocity { 3e-3 * 22.0 * cos } else { 0.0 })
    }

    #[test]
    fn straight_between_knots_and_constant_beyond_them() {
        let map = map(MapCoordinate::Displacement);
        for (at, upper_n, lower_n) in [
            (-9.0, 1.0, -1.0),
            (-2.0, 1.0, -1.0),
            (-1.0, 2.0, -3.0),
            (0.0, 3.0, -5.0),
            (0.25, 4.0, -5.25),
            (1.0, 7.0, -6.0),
            (f64::MAX, 7.0, -6.0),
        ] {
            assert_eq!((map.force_n(at, true), map.force_n(at, false)), (upper_n, lower_n), "{at}");
        }
        assert_eq!(
            (map.place(-9.0), map.place(0.5), map.place(2.0)),
            ((0, 0.0), (1, 0.5), (2, 0.0))
        );
        let far = [knot(-f64::MAX, -4.0, 0.0), knot(f64::MAX, 4.0, 0.0)];
        let far = EmpiricalMap::new(MapCoordinate::Force, &far, 0.0).unwrap();
        assert_eq!((far.force_n(0.0, true), far.force_n(0.5 * f64::MAX, true)), (0.0, 2.0));
    }

    #[test]
    fn impossible_maps_are_refused() {
        let new = |knots: &[MapKnot], reversal| {
            EmpiricalMap::new(MapCoordinate::Force, knots, reversal).map(|_| ())
        };
        let count = |given| Err(DamperError::MapKnots { given, fewest: 2, most: MAP_KNOTS });
        let many: Vec<MapKnot, 17> = (0..17).map(|k| knot(f64::from(k), 0.0, 0.0)).collect();
        assert_eq!(new(&many[..1], 0.0), count(1));
        assert_eq!(new(&many, 0.0), count(17));
        assert_eq!(new(&many[..16], 0.0), Ok(()));
        let twice = [knot(1.0, 0.0, 0.0), knot(1.0, 1.0, 1.0)];
        assert_eq!(new(&twice, 0.0), Err(DamperError::MapNotRising { at: 1.0, after: 1.0 }));
        for (bad, name) in [
            (knot(f64::NAN, 0.0, 0.0), "at"),
            (knot(2.0, f64::INFINITY, 0.0), "upper_n"),
            (knot(2.0, 0.0, f64::NAN), "lower_n"),
        ] {
            let Err(DamperError::Parameter { parameter, .. }) = new(&[many[0], bad], 0.0) else {
                panic!("{name}: another answer");
            };
            assert_eq!(parameter, name);
        }
        assert!(new(&many[..2], -1e-3).is_err() && new(&many[..2], f64::NAN).is_err());
    }

    #[test]
    fn the_force_that_comes_out_is_the_dampers_and_the_maps() {
        let knots = [knot(-2e-3, 50.0, -80.0), knot(1e-3, 90.0, 10.0), knot(2e-3, -30.0, 0.0)];
        let map = EmpiricalMap::new(MapCoordinate::Displacement, &knots, 1e-3).unwrap();
        let offset: Effect = ForceOffset { offset_n: 7.0 }.into();
        let late: Effect = SensorDelay { delay_s: 2.5e-3 }.into();
        for effects in [&[][..], &[offset], &[late]] {
            for with_velocity in [true, false] {
                let plain = Damper::new(Nominal::NEW, effects).unwrap().prepared(STEP_S);
                let with_map = plain.clone().with_empirical(map.clone());
                let (mut one, mut other) = (DamperState::rest(), DamperState::rest());
                for step in 1..=700 {
                    let to = motion(step, with_velocity);
                    let plain_n = plain.advance(&mut one, to, STEP_S);
                    let with_n = with_map.advance(&mut other, to, STEP_S);
                    // Of the motion alone: extending up to a quarter of the period and so on.
                    let quarters = 22.0 * STEP_S * f64::from(step) / core::f64::consts::FRAC_PI_2;
                    let near = (quarters - libm::round(quarters)).abs() < 0.1;
                    let extends = (quarters as u32).div_ceil(2).is_multiple_of(2);
                    if !near {
                        let expected = plain_n + map.force_n(to.displacement_m, extends);
                        assert_eq!((with_n, other.extends()), (expected, extends), "{step}");
                    }
                    assert_eq!((other.force_n(), one.chain_force_n), (with_n, other.chain_force_n));
                    assert_eq!(one.piston_m(), other.piston_m());
                }
                assert_eq!(with_map.without_empirical(), plain);
            }
        }
    }

    #[test]
    fn time_runs_from_the_turn_and_noise_turns_nothing() {
        let map = map(MapCoordinate::TimeSinceReversal);
        let damper = Damper::new(Nominal::NEW, &[]).unwrap().with_empirical(map);
        let since = |state: &DamperState| MapCoordinate::TimeSinceReversal.of(state);
        let mut state = DamperState::rest();
        // Slower than the threshold: no turn.
        for step in 1..=10 {
            damper.advance(&mut state, Motion::new(-0.5e-6 * f64::from(step), -0.5e-3), STEP_S);
        }
        assert!(state.extends() && (since(&state) - 10.0 * STEP_S).abs() < 1e-12);
        damper.advance(&mut state, Motion::new(-10e-6, -5e-3), STEP_S);
        assert!(!state.extends() && since(&state) == 0.0);
        for step in 1..=5 {
            damper.advance(&mut state, Motion::new(-10e-6 - 5e-6 * f64::from(step), 0.0), STEP_S);
        }
        assert!(!state.extends() && (since(&state) - 5.0 * STEP_S).abs() < 1e-12);
    }

    #[test]
    fn every_coordinate_is_that_of_the_state() {
        for coordinate in [MapCoordinate::DashpotVelocity, MapCoordinate::Force] {
            let slope = [knot(-1e6, -1e6, -1e6), knot(1e6, 1e6, 1e6)];
            let map = EmpiricalMap::new(coordinate, &slope, 0.0).unwrap();
            let damper = Damper::new(Nominal::NEW, &[]).unwrap().with_empirical(map);
            let mut state = DamperState::rest();
            for step in 1..=200 {
                let force_n = damper.advance(&mut state, motion(step, true), STEP_S);
                let added_n = force_n - state.chain_force_n();
                let expected = match coordinate {
                    MapCoordinate::Force => state.chain_force_n(),
                    _ => state.piston_velocity_m_per_s(),
                };
                assert!((added_n - expected).abs() < 1e-8, "{coordinate:?}: {added_n} {expected}");
            }
        }
    }
}
