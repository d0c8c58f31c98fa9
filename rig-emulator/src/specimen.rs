//! What is mounted between the eyes: the damper, a rigid bar, or a constant load.
//!
//! ```text
//! bar   F = k (x - x_0)       x_0: where the ram stood when the rig was started
//! load  F = constant
//! ```
//! The bar has neither mass nor damping, and its ends have no play.

use crate::mechanics::Mounting;
use firmware_core::damper::{Damper, Motion};
use scenario::damper_mass;
use scenario::rig::{Mounted, RigSetup};

/// What is mounted, for one length of substep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Specimen {
    mounted: Mounted,
    damper: Damper,
}

impl Specimen {
    /// That of a rig; its length of substep is still to be set.
    pub(crate) fn of(setup: &RigSetup) -> Self {
        Self { mounted: setup.mounted, damper: setup.damper.clone() }
    }

    /// The same without the moving mass of a damper, and that mass (kg).
    pub(crate) fn without_mass(self) -> (Self, f64) {
        if self.mounted != Mounted::Damper {
            return (self, 0.0);
        }
        let mass_kg = damper_mass::mass_kg(&self.damper).unwrap_or(0.0);
        match damper_mass::without(self.damper.clone()) {
            Ok(damper) => (Self { damper, ..self }, mass_kg),
            Err(_) => (self, 0.0),
        }
    }

    /// The same for another length of substep (s).
    #[must_use]
    pub(crate) fn prepared(self, step_s: f64) -> Self {
        Self { damper: self.damper.prepared(step_s), ..self }
    }

    /// The force (N) after a substep that ends with this motion of the eyes.
    pub(crate) fn advance(&self, mounting: &mut Mounting, motion: Motion, step_s: f64) -> f64 {
        match self.mounted {
            Mounted::Damper => self.damper.advance(&mut mounting.damper, motion, step_s),
            Mounted::Bar { stiffness_n_per_m } => {
                stiffness_n_per_m * (motion.displacement_m - mounting.at_m)
            }
            Mounted::Load { force_n } => force_n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Emulator, Reading, Reference, Target};
    use scenario::rig::{DisplacementSensor, RigFile, SensorSetup};
    use std::f64::consts::TAU;

    const PERIOD_S: f64 = 1e-3;

    /// An ideal rig with a fixture of 100 MN/m, without noise and lag.
    fn rig(mounted: Mounted, sensors: SensorSetup) -> RigSetup {
        let (fixture_m_per_n, lag_s) = (1e-8, 0.0);
        let (force_noise_n, displacement_noise_m) = (0.0, 0.0);
        RigSetup {
            mounted,
            sensors,
            fixture_m_per_n,
            lag_s,
            force_noise_n,
            displacement_noise_m,
            ..RigFile::default_setup().unwrap()
        }
    }

    /// The readings of a second of 20 um at 5 Hz about 3 mm, where the rig is started.
    fn readings(setup: &RigSetup) -> Vec<Reading> {
        let emulator = Emulator::new(setup, PERIOD_S, 0);
        let mut state = emulator.start_at(3e-3);
        let mut cycle = |n: u32| {
            let angle = TAU * 5.0 * f64::from(n) * PERIOD_S;
            let displacement_m = 3e-3 + 20e-6 * libm::sin(angle);
            let velocity_m_per_s = 20e-6 * TAU * 5.0 * libm::cos(angle);
            let reference = Reference { displacement_m, velocity_m_per_s };
            emulator.cycle(&mut state, Target::Follow(reference))
        };
        (0..1000).map(&mut cycle).collect()
    }

    #[test]
    fn a_bar_is_a_spring_in_series_with_the_fixture() {
        let bar = Mounted::Bar { stiffness_n_per_m: 1e9 };
        let at_ram =
            SensorSetup { displacement: DisplacementSensor::Ram, ..SensorSetup::default() };
        for (sensors, stiffness_n_per_m) in
            [(at_ram, 1.0 / (1e-8 + 1e-9)), (SensorSetup::default(), 1e9)]
        {
            for reading in readings(&rig(bar, sensors)) {
                let expected_n = stiffness_n_per_m * (reading.displacement_m - 3e-3);
                assert!((reading.force_n - expected_n).abs() < 1e-3, "{reading:?}");
            }
        }
    }

    #[test]
    fn a_late_load_cell_shows_an_earlier_force_with_its_gain_and_offset() {
        let bar = Mounted::Bar { stiffness_n_per_m: 1e9 };
        let now = readings(&rig(bar, SensorSetup::default()));
        let (force_gain, force_offset_n) = (0.98, 40.0);
        for (late, whole) in [(2.0, 2), (7.25, 7)] {
            let force_skew_s = late * PERIOD_S;
            let sensors =
                SensorSetup { force_skew_s, force_gain, force_offset_n, ..SensorSetup::default() };
            let share = late - whole as f64;
            for (n, reading) in readings(&rig(bar, sensors)).iter().enumerate().skip(10) {
                let [later, earlier] = [whole, whole + 1].map(|cycles| now[n - cycles].force_n);
                let expected_n = 0.98 * (later + share * (earlier - later)) + 40.0;
                assert!((reading.force_n - expected_n).abs() < 1e-9, "{reading:?}");
            }
        }
    }

    #[test]
    fn a_load_does_not_depend_on_the_motion() {
        let load = Mounted::Load { force_n: 4903.0 };
        let found = readings(&rig(load, SensorSetup::default()));
        assert!(found.iter().all(|reading| (reading.force_n - 4903.0).abs() < 1e-6));
    }
}
