//! The largest force that a damper on a rig is believed, from a run of the vehicle with models.
//!
//! ```text
//! F_max = max(1.5 |F_model|_max, 5 kN)          1.5: limit_ratio of the force in [plausibility]
//! ```
//! The vehicle runs with the model of every rig's slot over the beginning of its own track, as fast
//! as possible. A damper that is half as strong again as its model is still a possible damper; a
//! thousandfold force is none.

use crate::progress_bar::LateBar;
use firmware_core::guard::ForceInput;
use firmware_core::line::{Line, Slot};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::{ForceLimit, Run};

/// The least limit (N): on a perfect track the model does nothing.
const LEAST_N: f64 = 5e3;

/// Cycles that are looked at: two minutes, which take a second.
const LONGEST_S: f64 = 120.0;

/// Cycles after which progress is shown again.
const SHOWN: u64 = 1000;

/// The largest believed force of every slot (N). The line's track has to reach as far as is looked.
pub(super) fn believed_forces_n(
    run: &Run,
    mut line: Line<'_>,
    shows_progress: bool,
) -> [f64; DAMPER_SLOTS] {
    let ratio = match run.plausibility.force {
        ForceLimit::Ratio(ratio) => ratio,
        ForceLimit::Force(force_n) => return [force_n; DAMPER_SLOTS],
    };
    line.slots.iter_mut().for_each(Slot::use_model);
    let mut state = line.start(run.start.state.clone());
    let mut most_n = [0.0_f64; DAMPER_SLOTS];
    // The ramps run over the same track.
    let cycles = run.cycles() + 4 * u64::from(run.motion.ramp_cycles);
    let cycles = cycles.min(run.rate.cycles(LONGEST_S));
    let mut bar = shows_progress.then(|| LateBar::new("forces of the models", cycles));
    for cycle in 0..cycles {
        if let Some(bar) = bar.as_mut().filter(|_| cycle.is_multiple_of(SHOWN)) {
            bar.at(cycle);
        }
        line.step(&mut state, &[ForceInput::Missing; DAMPER_SLOTS]);
        for (most, force) in most_n.iter_mut().zip(&state.vehicle.damper_n) {
            *most = most.max(force.lane(0).abs());
        }
        if state.is_safe() {
            break;
        }
    }
    if let Some(bar) = bar {
        bar.finish();
    }
    most_n.map(|most| (ratio * most).max(LEAST_N))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::line;
    use scenario::run::Overrides;
    use std::path::Path;

    #[test]
    fn the_limit_is_half_as_much_again_as_the_model_reaches() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(10.0), ..Overrides::default() };
        let mut run = Run::load(&path, overrides).unwrap();
        let track = run.track.view();
        let believed_n = believed_forces_n(&run, line(&run, &track), false);
        // The model reaches 20 kN.
        assert!((25e3..35e3).contains(&believed_n[0]), "{believed_n:?}");
        run.plausibility.force = ForceLimit::Force(12e3);
        let track = run.track.view();
        assert_eq!(believed_forces_n(&run, line(&run, &track), false), [12e3; DAMPER_SLOTS]);
    }
}
