//! The compensators, before a rig that answers the command of six cycles ago a little too small.

use crate::two_sines::{self, STEP_S};
use firmware_core::compensation::{Adaptive, Answer, Compensator, Feedforward, Load, Series};
use firmware_core::fnv;

/// By name.
pub const NAMES: [&str; 3] = ["none", "feedforward", "adaptive"];

/// Delay of the rig in cycles.
const DELAY: usize = 6;

/// The same in time (s).
const DELAY_S: f64 = 6.0 * STEP_S;

/// Gain of the rig.
const GAIN: f64 = 0.97;

/// Stiffness of its specimen (N/m), and what its force takes.
const STIFFNESS_N_PER_M: f64 = 5e6;
const LOAD: Load = Load { m_per_n: 1e-8, s_per_n: 1e-7 };

fn of(name: &str) -> Option<Compensator> {
    let series = Series::IDENTITY.with_delay(0.8 * DELAY_S);
    match name {
        "none" => Some(Compensator::None),
        "feedforward" => Some(Compensator::Feedforward(Feedforward::polynomial(3, DELAY_S))),
        "adaptive" => {
            Some(Compensator::Adaptive(Adaptive { load: LOAD, ..Adaptive::new(series, 7.0) }))
        }
        _ => None,
    }
}

/// Commands of a compensator; none where there is none of this name.
#[inline(never)]
pub fn run(name: &str, steps: u32) -> Option<u64> {
    let compensator = of(name)?.with_known_delay(-0.5 * STEP_S);
    let mut state = compensator.start();
    let mut on_the_way = [0.0; DELAY];
    let mut hash = fnv::START;
    for step in 0..steps {
        let [oldest, ..] = on_the_way;
        let answer = Answer {
            displacement_m: GAIN * oldest,
            force_n: STIFFNESS_N_PER_M * oldest,
            age_cycles: 0,
        };
        // Now and then an answer is lost.
        let answer = (step % 101 != 0).then_some(answer);
        let command = compensator.step(&mut state, two_sines::at(step), answer, STEP_S);
        state.sent(command);
        on_the_way.rotate_left(1);
        if let Some(newest) = on_the_way.last_mut() {
            *newest = command.displacement_m;
        }
        for value in [command.displacement_m, command.velocity_m_per_s] {
            hash = fnv::add(hash, value.to_bits());
        }
    }
    Some(hash)
}
