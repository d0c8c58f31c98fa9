//! Plants that differ from the nominal one.

use rig_emulator::BenchmarkPlant;
use signal::random::Random;

/// Standard deviation of the stiffness of the specimen, N/m.
const STIFFNESS_N_PER_M: f64 = 5e4;
/// Standard deviation of the damping of the valve, 1/s.
const VALVE_DAMPING_PER_S: f64 = 3.3;
/// Standard deviation of the stiffness of the valve, 1/s2.
const VALVE_STIFFNESS_PER_S2: f64 = 3.3e3;
/// Standard deviation of the leakage, 1/s.
const LEAKAGE_PER_S: f64 = 1.3;

/// A plant whose uncertain parameters are drawn. The frame without the specimen follows its
/// stiffness, so that both together stay the whole frame.
pub(crate) fn perturbed(random: &mut Random) -> BenchmarkPlant {
    let mut plant = BenchmarkPlant::nominal();
    plant.specimen.stiffness_n_per_m += STIFFNESS_N_PER_M * random.gaussian();
    plant.valve_damping_per_s += VALVE_DAMPING_PER_S * random.gaussian();
    plant.valve_stiffness_per_s2 += VALVE_STIFFNESS_PER_S2 * random.gaussian();
    plant.leakage_per_s += LEAKAGE_PER_S * random.gaussian();
    plant
}
