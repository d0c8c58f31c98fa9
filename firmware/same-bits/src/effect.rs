//! Each effect alone on a new damper, in a motion of two sines.

use crate::two_sines::{self, STEP_S};
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};
use firmware_core::fnv;

/// How many there are: those of the catalogue, and none as the last one.
pub const COUNT: usize = CATALOGUE.len() + 1;

/// Name of one; "none" behind the catalogue.
pub fn name(number: usize) -> &'static str {
    CATALOGUE.get(number).map_or("none", |info| info.name)
}

/// Forces of a damper with this effect at its usual size; none where it cannot be built.
#[inline(never)]
pub fn run(number: usize, steps: u32) -> Option<u64> {
    let scale = Nominal::NEW.scale();
    let effect = match CATALOGUE.get(number) {
        None => None,
        Some(info) => {
            let mut values = [0.0; VALUES_MAX];
            let rows = info.parameters.iter();
            let count = values.iter_mut().zip(rows).map(|(v, row)| *v = row.usual(&scale)).count();
            Some(Effect::from_values(info.name, values.get(..count)?).ok()?)
        }
    };
    let damper = Damper::new(Nominal::NEW, effect.as_slice()).ok()?.prepared(STEP_S);
    let motion = |step| {
        let at = two_sines::at(step);
        Motion::new(at.displacement_m, at.velocity_m_per_s)
    };
    let mut state = DamperState::starting(motion(0));
    let forces = (1..=steps).map(|step| damper.advance(&mut state, motion(step), STEP_S));
    Some(forces.fold(fnv::START, |hash, force_n| fnv::add(hash, force_n.to_bits())))
}

/// No effect has more parameters.
const VALUES_MAX: usize = 8;
