//! The benchmark rig: the plant of the virtual benchmark as the drive of a damper rig.
//!
//! ```text
//! reference -> BenchmarkPlant -> ram x_r = eyes -> damper F(x_r)
//! ```
//!
//! The displacement follows the command as that of the benchmark does: 25 ms late at 1 Hz, 16 ms at
//! 16 Hz, with less than half of the amplitude there. The force is that of the rig's own damper at
//! this displacement. It does not act back on the plant, which carries the specimen of the
//! benchmark: the plant was published as a whole, and a damper of 18 kN would stall its 9 kN. It is
//! the most unfavourable rig for a compensator whose delay is known exactly.
//!
//! It stops and centres by its reference. Poles of the plant at -8 +- 422i 1/s ring after that, so
//! that it counts as being at rest only after some 0.4 s. The reference ends where the ram would
//! stand at the end of the stroke; the ram may overshoot it by a few per cent. A fixture is not
//! modelled.

use crate::benchmark_plant::{BenchmarkPlant, PlantState};
use crate::integration::runge_kutta;
use crate::mechanics::Mechanics;
use crate::specimen::Specimen;
use firmware_core::damper::Motion;
use nodes::rig::{Limits, Ram, RamState, Target};
use scenario::rig::RigSetup;

/// Longest substep (s): the benchmark's own is 1/4096 s.
const LONGEST_STEP_S: f64 = 0.125e-3;

/// A benchmark rig for one length of cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Benchmark {
    plant: BenchmarkPlant,
    specimen: Specimen,
    /// What stops and centres the reference, within its own stroke.
    guide: Ram,
    stroke_m: f64,
    substeps: u32,
    step_s: f64,
}

/// What it remembers besides its mechanics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BenchmarkState {
    reference: RamState,
    plant: PlantState,
}

impl BenchmarkState {
    /// What the plant is asked to follow.
    pub(crate) fn reference(&self) -> RamState {
        self.reference
    }
}

impl Benchmark {
    /// The benchmark rig for cycles of `period_s`.
    pub(crate) fn new(setup: &RigSetup, period_s: f64) -> Self {
        let plant = BenchmarkPlant::nominal();
        let guide = Ram::new(setup.stroke_m / plant.static_gain(), setup.rate_m_per_s, 0.0, 0.0);
        let specimen = Specimen::of(setup);
        let stroke_m = setup.stroke_m;
        Self { plant, specimen, guide, stroke_m, substeps: 1, step_s: 0.0 }.with_period(period_s)
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub(crate) fn with_period(self, period_s: f64) -> Self {
        let substeps = libm::ceil(period_s / LONGEST_STEP_S - 1e-9).max(1.0) as u32;
        let step_s = period_s / f64::from(substeps);
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.guide;
        let guide = Ram::new(stroke_m, rate_m_per_s, lag_s, step_s);
        Self { specimen: self.specimen.prepared(step_s), guide, substeps, step_s, ..self }
    }

    /// Its memory with the ram at rest at a displacement (m).
    pub(crate) fn resting_at(&self, ram_m: f64) -> BenchmarkState {
        let displacement_m = ram_m / self.plant.static_gain();
        BenchmarkState {
            reference: RamState { displacement_m, ..RamState::default() },
            plant: self.plant.resting_under(displacement_m),
        }
    }

    /// One cycle; the limits that changed the motion.
    pub(crate) fn cycle(
        &self,
        at: &mut Mechanics,
        own: &mut BenchmarkState,
        target: Target,
    ) -> Limits {
        let mut limits = Limits::default();
        for substep in 0..self.substeps {
            let from_m = own.reference.displacement_m;
            match target {
                Target::Follow(reference) => {
                    let until = reference.after(f64::from(substep + 1) * self.step_s);
                    limits.stroke |= until.displacement_m.abs() > self.guide.stroke_m;
                    own.reference = self.guide.kept_within(until);
                }
                Target::Hold => self.guide.stop(&mut own.reference),
                Target::Centre => self.guide.centre(&mut own.reference),
            }
            self.move_plant(at, own, from_m);
        }
        limits.rate |= at.ram.velocity_m_per_s.abs() > self.guide.rate_m_per_s;
        limits.stroke |= at.ram.displacement_m.abs() > self.stroke_m;
        limits
    }

    /// Plant and damper over a substep in which the reference comes straight from `from_m`.
    fn move_plant(&self, at: &mut Mechanics, own: &mut BenchmarkState, from_m: f64) {
        let slope_m_per_s = (own.reference.displacement_m - from_m) / self.step_s;
        own.plant = runge_kutta(&own.plant, self.step_s, |state, since_s| {
            self.plant.slope(state, from_m + slope_m_per_s * since_s)
        });
        let [displacement_m, velocity_m_per_s, ..] =
            own.plant.map(|value| self.plant.output_gain * value);
        at.ram = RamState { displacement_m, velocity_m_per_s };
        at.eyes_m = displacement_m;
        let motion = Motion::new(displacement_m, velocity_m_per_s);
        at.force_n = self.specimen.advance(&mut at.mounting, motion, self.step_s);
        at.load_cell_n = at.force_n;
    }
}

#[cfg(test)]
mod tests {
    use crate::emulator::Emulator;
    use nodes::rig::{Reference, Target};
    use scenario::rig::{RigFile, RigKind, RigSetup};
    use scenario::source::Source;
    use std::f64::consts::TAU;
    use std::path::Path;

    const PERIOD_S: f64 = 1e-3;

    fn setup() -> RigSetup {
        let file = RigFile { kind: Some(RigKind::RthsBenchmark), ..RigFile::default() };
        let setup = file.build(&Source::from_text(Path::new("rig.toml"), "")).unwrap();
        RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, ..setup }
    }

    fn follow(displacement_m: f64, velocity_m_per_s: f64) -> Target {
        Target::Follow(Reference { displacement_m, velocity_m_per_s })
    }

    #[test]
    fn the_rig_is_as_late_and_as_weak_as_its_plant() {
        let rig = Emulator::new(&setup(), PERIOD_S, 0);
        for (hz, delay_ms, gain) in
            [(1.0, 24.96, 0.999), (3.6, 23.7, 0.916), (10.0, 19.0, 0.633), (16.0, 15.8, 0.471)]
        {
            let mut state = rig.start();
            let (omega, amplitude_m) = (TAU * hz, 1e-3);
            let (mut sine, mut cosine) = (0.0, 0.0);
            // Five seconds have whole periods of all four.
            for cycle in 0..10_000_u32 {
                let angle = omega * f64::from(cycle) * PERIOD_S;
                let x = amplitude_m * libm::sin(angle);
                let v = amplitude_m * omega * libm::cos(angle);
                let reading = rig.cycle(&mut state, follow(x, v));
                if cycle >= 5000 {
                    let angle = omega * f64::from(cycle + 1) * PERIOD_S;
                    sine += reading.ram_displacement_m * libm::sin(angle) / 2500.0;
                    cosine += reading.ram_displacement_m * libm::cos(angle) / 2500.0;
                }
            }
            let found_ms = -1e3 * libm::atan2(cosine, sine) / omega;
            let found = libm::hypot(sine, cosine) / amplitude_m;
            println!("{hz} Hz: {found_ms:.2} ms, gain {found:.4}");
            assert!((found_ms - delay_ms).abs() < 0.06, "{hz} Hz: {found_ms} ms");
            assert!((found - gain).abs() < 0.002, "{hz} Hz: {found}");
        }
    }

    #[test]
    fn its_force_is_that_of_its_damper_where_the_ram_is() {
        let setup = setup();
        let rig = Emulator::new(&setup, PERIOD_S, 0);
        let mut state = rig.start();
        let mut reading = rig.cycle(&mut state, follow(0.0, 0.05));
        for cycle in 1..1000_u32 {
            reading = rig.cycle(&mut state, follow(0.05 * PERIOD_S * f64::from(cycle), 0.05));
        }
        // A ramp with the gain of the plant at rest: the relief is open.
        let expected_n = setup.damper.steady_force_n(0.05 * 1.0075);
        assert!((reading.force_n / expected_n - 1.0).abs() < 1e-3, "{} N", reading.force_n);
        assert_eq!(reading.displacement_m, reading.ram_displacement_m);
    }

    #[test]
    fn it_stands_where_it_starts_and_stops_as_softly_as_it_follows() {
        let rig = Emulator::new(&setup(), PERIOD_S, 0);
        let mut state = rig.start_at(0.03);
        for _ in 0..100 {
            rig.cycle(&mut state, Target::Hold);
        }
        assert!((state.ram().displacement_m - 0.03).abs() < 1e-9, "{:?}", state.ram());
        for cycle in 0..500_u32 {
            rig.cycle(&mut state, follow(0.03 - 0.08e-3 * f64::from(cycle), -0.08));
        }
        assert!(!rig.is_at_rest(&state));
        let (mut before, mut hardest, mut cycles) = (state.ram().velocity_m_per_s, 0.0_f64, 0);
        while !rig.is_at_rest(&state) && cycles < 1000 {
            rig.cycle(&mut state, Target::Hold);
            hardest = hardest.max((state.ram().velocity_m_per_s - before).abs() / PERIOD_S);
            before = state.ram().velocity_m_per_s;
            cycles += 1;
        }
        println!("{hardest:.2} m/s2 at most, at rest after {cycles} ms");
        assert!(hardest <= 20.0 && hardest > 1.0, "{hardest} m/s2");
        assert!(cycles < 500, "{cycles} ms");
    }
}
