//! The servo-hydraulic rig: controller, servo-valve, cylinder, fixture, end mass, damper.
//!
//! ```text
//! reference r --[ controller ]-- valve u --[ oil pL ]-- ram m_r --[ fixture k, load cell ]--
//!                                                  end mass m_e --[ damper F ]-- ground
//!
//! controller   c = (ff r' + K (r - x_r)) A / Q_max           clamped to the full opening
//! oil          V/(4 beta) pL' = Q(u, pL) - A x_r' - Cl pL
//! ram          m_r x_r'' = A pL - b x_r' - N
//! end mass     m_e x_e'' = N - F(x_e),   N = k (x_r - x_e) + d (x_r' - x_e')
//! heat         C T' = F x_e' - H (T - T_ambient)
//! ```
//!
//! Nothing here is a delay in ms. The ram lags by what the controller leaves, `(1 - ff)/K`
//! of time on a ramp; by the spool (`valve`); and under load, where the open valve gives less flow.
//! The oil column is a spring of `4 beta A^2 / V` between valve and ram, and `A x_r'` is the
//! natural velocity feedback of a cylinder. The load cell shows `N`, which is the force of the
//! damper and the inertia of the end mass. The equations are those of Merritt, Hydraulic Control
//! Systems (1967); the usual numbers are assumed (`scenario::rig::ServoFile`).
//!
//! **Substeps.** A cycle is divided into equal substeps of 1/32 ms at most. The fastest part, the
//! end mass between fixture and damper, may vibrate at 2.5 kHz ([`scenario::rig::FASTEST_HZ`]):
//! half a radian per substep, a quarter of what leapfrog stands. Forces and pressure stand at the
//! ends of the substeps and velocities in their middle (leapfrog), so that the springs keep their
//! energy. The damper gets the velocity at the end, extrapolated from the last two. The controller
//! sees the ram as it is when a substep begins, as a digital one does. Half of the substep moves
//! the ram by 0.1 um and the force by 2 N of 18 kN (a test compares).
//!
//! **Stop.** In HOLD and CENTRE the reference is guided as an ideal ram is ([`Ram`]). It begins
//! where the controller asks for the opening that the valve has been asked for, at the speed of the
//! ram, so that the stop begins without a jolt however far the ram was behind. The ram is never
//! exactly at rest: see [`crate::AT_REST_M_PER_S`].
//!
//! **Temperature.** One temperature for all of the damper
//! ([`firmware_core::damper::HeatBalance`]). An effect `temperature_fade` of the damper follows it;
//! without that effect the force does not depend on it.
//!
//! Limits: the two sides of the cylinder are equal, and the volume of oil does not depend on the
//! position; no cavitation; friction of the seals is viscous; end stops take the speed of the ram
//! without a bounce. A `moving_mass` of the damper is added to the end mass: as a force it would
//! need the acceleration that it causes.

mod masses;
mod valve;

#[cfg(test)]
mod tests;

use crate::mechanics::Mechanics;
use crate::specimen::Specimen;
use firmware_core::damper::Motion;
use masses::Masses;
use nodes::rig::{Limits, Ram, RamState, Target};
use scenario::rig::{RigSetup, ServoSetup};
use valve::{Spool, Valve};

/// Longest substep (s).
const LONGEST_STEP_S: f64 = 1e-3 / 32.0;

/// A servo-hydraulic rig for one length of cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Servo {
    setup: ServoSetup,
    /// What stops and centres the reference.
    guide: Ram,
    /// Speed of the ram with the valve fully open and no load (m/s).
    open_m_per_s: f64,
    valve: Valve,
    /// `4 beta / V` (Pa/m3).
    oil_pa_per_m3: f64,
    masses: Masses,
    end_mass_kg: f64,
    fixture_n_per_m: f64,
    fixture_n_s_per_m: f64,
    specimen: Specimen,
    substeps: u32,
    step_s: f64,
}

/// What it remembers besides its mechanics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ServoState {
    reference: RamState,
    follows: bool,
    /// Opening that the controller asks for.
    command: f64,
    spool: Spool,
    pressure_pa: f64,
    /// Velocities of ram and end mass in the middle of the last substep (m/s).
    velocities: [f64; 2],
    temperature_degc: f64,
}

impl ServoState {
    /// What the controller is asked to follow.
    pub(crate) fn reference(&self) -> RamState {
        self.reference
    }

    /// Temperature of the damper, degrees Celsius.
    pub(crate) fn temperature_degc(&self) -> f64 {
        self.temperature_degc
    }
}

impl Servo {
    /// The rig for cycles of `period_s`.
    pub(crate) fn new(setup: &RigSetup, drive: ServoSetup, period_s: f64) -> Self {
        Self::with_substeps(setup, drive, period_s, substeps(period_s))
    }

    /// The rig with so many substeps in a cycle.
    fn with_substeps(setup: &RigSetup, drive: ServoSetup, period_s: f64, substeps: u32) -> Self {
        debug_assert!(setup.fixture_m_per_n > 0.0, "a servo rig has a fixture that gives way");
        let step_s = period_s / f64::from(substeps);
        let fixture_n_per_m = 1.0 / setup.fixture_m_per_n;
        let (specimen, of_damper_kg) = Specimen::of(setup).without_mass();
        let end_mass_kg = drive.end_mass_kg + of_damper_kg;
        let open_m_per_s = drive.no_load_speed_m_per_s();
        let fixture_n_s_per_m =
            2.0 * drive.fixture_damping_ratio * libm::sqrt(fixture_n_per_m * end_mass_kg);
        Self {
            guide: Ram::new(setup.stroke_m, open_m_per_s, 0.0, step_s),
            open_m_per_s,
            valve: Valve::new(&drive, step_s),
            oil_pa_per_m3: 4.0 * drive.bulk_modulus_pa / drive.oil_volume_m3,
            masses: Masses::new(
                [drive.ram_mass_kg, end_mass_kg],
                [drive.friction_n_s_per_m, fixture_n_s_per_m],
                step_s,
            ),
            end_mass_kg,
            fixture_n_per_m,
            fixture_n_s_per_m,
            specimen: specimen.prepared(step_s),
            substeps,
            step_s,
            setup: drive,
        }
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub(crate) fn with_period(self, period_s: f64) -> Self {
        let substeps = substeps(period_s);
        let step_s = period_s / f64::from(substeps);
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.guide;
        let friction = [self.setup.friction_n_s_per_m, self.fixture_n_s_per_m];
        Self {
            guide: Ram::new(stroke_m, rate_m_per_s, lag_s, step_s),
            valve: Valve::new(&self.setup, step_s),
            masses: Masses::new([self.setup.ram_mass_kg, self.end_mass_kg], friction, step_s),
            specimen: self.specimen.prepared(step_s),
            substeps,
            step_s,
            ..self
        }
    }

    /// Its memory with the ram at rest at a displacement (m).
    pub(crate) fn resting_at(&self, ram_m: f64) -> ServoState {
        ServoState {
            reference: RamState { displacement_m: ram_m, ..RamState::default() },
            follows: false,
            command: 0.0,
            spool: Spool::default(),
            pressure_pa: 0.0,
            velocities: [0.0; 2],
            temperature_degc: self.setup.ambient_degc,
        }
    }

    /// One cycle; the limits that changed the motion.
    pub(crate) fn cycle(&self, at: &mut Mechanics, own: &mut ServoState, target: Target) -> Limits {
        let follows = matches!(target, Target::Follow(_));
        if own.follows && !follows {
            own.reference = self.taken_over(at, own);
        }
        own.follows = follows;
        at.mounting.damper.set_temperature_degc(Some(own.temperature_degc));
        let (mut limits, mut work_j) = (Limits::default(), 0.0);
        for substep in 0..self.substeps {
            match target {
                Target::Follow(reference) => {
                    let now = reference.after(f64::from(substep) * self.step_s);
                    limits.stroke |= now.displacement_m.abs() > self.guide.stroke_m;
                    own.reference = self.guide.kept_within(now);
                }
                Target::Hold => self.guide.stop(&mut own.reference),
                Target::Centre => self.guide.centre(&mut own.reference),
            }
            let (eyes_m, force_n) = (at.eyes_m, at.force_n);
            self.substep(at, own, &mut limits);
            work_j += 0.5 * (force_n + at.force_n) * (at.eyes_m - eyes_m);
        }
        let period_s = f64::from(self.substeps) * self.step_s;
        let (heat, ambient_degc) = (self.setup.heat, self.setup.ambient_degc);
        own.temperature_degc =
            heat.step(own.temperature_degc, work_j / period_s, ambient_degc, period_s);
        limits
    }

    /// The reference from which a stop begins: the controller asks for the same opening as before.
    fn taken_over(&self, at: &Mechanics, own: &ServoState) -> RamState {
        let ServoSetup { controller_gain_per_s, feed_forward, .. } = self.setup;
        let RamState { displacement_m, velocity_m_per_s } = at.ram;
        let asked_m_per_s = own.command * self.open_m_per_s;
        let ahead_m = (asked_m_per_s - feed_forward * velocity_m_per_s) / controller_gain_per_s;
        let Ram { stroke_m, rate_m_per_s, .. } = self.guide;
        RamState {
            displacement_m: (displacement_m + ahead_m).clamp(-stroke_m, stroke_m),
            velocity_m_per_s: velocity_m_per_s.clamp(-rate_m_per_s, rate_m_per_s),
        }
    }

    /// One substep: controller, spool, masses, oil, damper.
    fn substep(&self, at: &mut Mechanics, own: &mut ServoState, limits: &mut Limits) {
        let wanted = self.controller(own.reference, at.ram.displacement_m);
        own.command = wanted.clamp(-1.0, 1.0);
        limits.rate |= own.command != wanted;
        let opening = self.valve.advance(&mut own.spool, own.command);

        let before = own.velocities;
        let spring_n = self.fixture_n_per_m * (at.ram.displacement_m - at.eyes_m);
        let push_n = self.setup.area_m2 * own.pressure_pa;
        own.velocities = self.masses.advance(before, [push_n - spring_n, spring_n - at.force_n]);
        at.ram.displacement_m += self.step_s * own.velocities[0];
        at.eyes_m += self.step_s * own.velocities[1];
        let mut ends = [extrapolated(before[0], own.velocities[0]), 0.0];
        if at.ram.displacement_m.abs() > self.guide.stroke_m {
            at.ram.displacement_m = self.guide.stroke_m.copysign(at.ram.displacement_m);
            (own.velocities[0], ends[0]) = (0.0, 0.0);
            limits.stroke = true;
        }
        ends[1] = extrapolated(before[1], own.velocities[1]);
        at.ram.velocity_m_per_s = ends[0];

        let rate = |pressure_pa: f64| {
            let flow = self.valve.flow_m3_per_s(opening, pressure_pa);
            let swept = self.setup.area_m2 * own.velocities[0];
            self.oil_pa_per_m3 * (flow - swept - self.setup.leakage_m3_per_s_pa * pressure_pa)
        };
        let middle_pa = own.pressure_pa + 0.5 * self.step_s * rate(own.pressure_pa);
        own.pressure_pa += self.step_s * rate(middle_pa);

        let motion = Motion::new(at.eyes_m, ends[1]);
        at.force_n = self.specimen.advance(&mut at.mounting, motion, self.step_s);
        at.load_cell_n = self.fixture_n_per_m * (at.ram.displacement_m - at.eyes_m)
            + self.fixture_n_s_per_m * (ends[0] - ends[1]);
    }

    /// The opening that the controller wants, beyond the full one where it wants more.
    fn controller(&self, reference: RamState, ram_m: f64) -> f64 {
        let ServoSetup { controller_gain_per_s, feed_forward, .. } = self.setup;
        let RamState { displacement_m, velocity_m_per_s } = reference;
        let speed_m_per_s =
            feed_forward * velocity_m_per_s + controller_gain_per_s * (displacement_m - ram_m);
        speed_m_per_s / self.open_m_per_s
    }
}

/// Substeps of a cycle.
fn substeps(period_s: f64) -> u32 {
    libm::ceil(period_s / LONGEST_STEP_S - 1e-9).max(1.0) as u32
}

/// The velocity at the end of a substep, from those in the middle of the last two.
fn extrapolated(before: f64, now: f64) -> f64 {
    now + 0.5 * (now - before)
}
