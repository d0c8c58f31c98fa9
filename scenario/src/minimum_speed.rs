//! The lowest speed at which a step is stable.
//!
//! Creep acts like a damper `f/V` between wheel and rail. The step follows velocity forces by the
//! two-step Adams-Bashforth rule, stable up to a rate of `1/h`; this allows 0.7 of it, so that
//! wheel loads may swing. The rate is that of one wheel's lateral creep against the rail's
//! effective mass and the wheelset's, at the static wheel load.

use firmware_core::vehicle::GRAVITY_M_PER_S2;
use firmware_core::vehicle::Vehicle;
use firmware_core::wheel_rail::table::ContactTable;

/// Share of the stability limit that is used.
const SHARE: f64 = 0.7;

/// Lowest running speed (m/s) for a substep; zero for a cone, which has no rail mass to swing.
pub fn minimum_speed_m_per_s(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    substep_s: f64,
) -> f64 {
    let Some(contact) = contact else { return 1.0 };
    let wheels = 2.0 * vehicle.axles.len().max(1) as f64;
    let load_n = vehicle.mass_kg() * GRAVITY_M_PER_S2 / wheels;
    let shape = contact.tread.at(0.0);
    let approach_m = libm::cbrt(libm::pow(load_n / shape.hertz_n_per_m15, 2.0));
    let mut least = 0.0f64;
    for axle in &vehicle.axles {
        let area_m2 = shape.along_per_sqrt_m * shape.across_per_sqrt_m * approach_m;
        let creep_n = axle.wheel.material.shear_modulus_pa * area_m2 * shape.c22.max(shape.c11);
        let mass_kg = vehicle.bodies.get(axle.body.index()).map_or(1.0, |body| body.mass_kg);
        let rail = axle.rail.map_or(0.0, |rail| 1.0 / rail.mass_kg[0]);
        let rate_times_speed = creep_n * (2.0 / mass_kg + rail);
        least = least.max(rate_times_speed * substep_s / SHARE);
    }
    least
}
