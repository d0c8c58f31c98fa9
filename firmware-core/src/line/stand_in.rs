//! A slot without a rig of its own: the rig in another slot stands for its damper.
//!
//! ```text
//! F = (1 - g) F_model(x) + s g F_measured        g: coupling of that rig, s = -1 or 1
//! ```
//! The two yaw dampers of a bogie move oppositely where the bogie does nothing but yaw: then
//! `x = -x_rig`, and for a damper with `F(-x) = -F(x)` the reversed force is the one that a second
//! rig would measure. A motion of both in the same direction, such as pitch of the carbody, is not
//! in the measured force.
//!
//! The slot's own model is stepped on the slot's own motion in every substep, whether its force
//! acts or not. While the rig is faded in and out, the model's force is that of this slot, so both
//! slots of a pair have a damper at all times and change over together.
//!
//! Limits: the sign holds for a damper that stands opposite on the same bogie. For a damper of
//! another bogie the motion is a different one, and the force may even drive it.

use crate::damper::{Damper, DamperState, Motion};
use crate::supervision::Ramp;

/// A slot for which the rig in another slot stands.
#[derive(Debug, Clone, PartialEq)]
pub struct StandIn {
    /// The damper that acts while the measured force is faded in and out.
    pub model: Damper,
    /// The slot of the rig.
    pub of: usize,
    /// Whether the sign of the measured force is reversed.
    pub is_reversed: bool,
}

impl StandIn {
    /// The force of a substep (N), from that of the rig and its coupling.
    #[inline]
    pub(super) fn force_n(
        &self,
        model: &mut DamperState,
        motion: Motion,
        (measured_n, coupling): (f64, Ramp),
        substep_s: f64,
    ) -> f64 {
        let model_n = self.model.advance(model, motion, substep_s);
        coupling.between(model_n, if self.is_reversed { -measured_n } else { measured_n })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Fade;
    use super::super::yawing_bogie::{Coupled, bogie, rig, stands_in};
    use crate::guard::ForceInput;
    use crate::supervision::Event;
    use crate::track::Track;

    const FADE: Fade = Fade { motion_cycles: 200, measuring_cycles: 0, coupling_cycles: 200 };

    #[test]
    fn in_pure_yaw_one_rig_and_its_partner_are_two_rigs_to_rounding() {
        let (vehicle, track) = (bogie(), Track::default());
        let mut two = Coupled::new(&vehicle, &track, rig(), FADE);
        let mut one = Coupled::new(&vehicle, &track, stands_in(true), FADE);
        let mut most_n = 0.0_f64;
        for cycle in 0..3000 {
            // Fades in, runs, and fades out again.
            if cycle == 2000 {
                two.state.on(Event::End);
                one.state.on(Event::End);
            }
            two.cycle(|_, force_n| ForceInput::Fresh(force_n));
            one.cycle(|_, force_n| ForceInput::Fresh(force_n));
            most_n = most_n.max(two.force_n(1).abs());
            let off_rad = (one.yaw_rad() - two.yaw_rad()).abs();
            assert!(off_rad < 1e-15, "cycle {cycle}: {off_rad} rad");
            let off_n = (one.force_n(1) - two.force_n(1)).abs();
            assert!(off_n < 1e-6, "cycle {cycle}: {off_n} N");
        }
        assert!(most_n > 500.0, "{most_n} N");
    }

    #[test]
    fn with_the_wrong_sign_the_pair_takes_no_energy_out_of_yaw() {
        let (vehicle, track) = (bogie(), Track::default());
        let energy_left = |is_reversed: bool| {
            let second = stands_in(is_reversed);
            let mut line = Coupled::new(&vehicle, &track, second, Fade::default());
            let mut last_s_rad = 0.0_f64;
            for cycle in 0..2000 {
                line.cycle(|_, force_n| ForceInput::Fresh(force_n));
                if cycle >= 1600 {
                    last_s_rad = last_s_rad.max(line.yaw_rad().abs());
                }
            }
            (last_s_rad / 2e-3) * (last_s_rad / 2e-3)
        };
        // Both dampers: c = 2 * 30e3 * 1.4^2 N m s on 12e3 kg m2, minus the clearance.
        let (right, wrong) = (energy_left(true), energy_left(false));
        assert!(right < 0.05, "{right}");
        // Their forces cancel: the spring alone is left.
        assert!(wrong > 0.95, "{wrong}");
        let decay = libm::exp(-2.0 * 1.6 * 30e3 * 1.4 * 1.4 / 12e3);
        assert!(right > decay, "more than two dampers can take: {right}, {decay}");
    }
}
