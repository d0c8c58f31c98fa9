//! A rig that is lost while its vehicle goes on: the slot's own model takes over.
//!
//! ```text
//! F = (1 - g) F_model + g F_last        g: from where it is to 0 within 20 ms
//!
//! |F_k - F_(k-1)| <= |M_k - M_(k-1)| + pi / (2 n) |F_last - M_(k-1)|      n: cycles of the fade
//! ```
//! `F_last` is the last force that was believed, and nothing that arrives later is used. The model
//! has been stepped on the vehicle's motion all the time, so it is in step when it takes over: the
//! force has no step, only a slope. The ram gets no more motion; its command comes to rest.
//!
//! A slot whose rig has dropped out stays so until the line is started again.

use super::LineState;
use super::slot::SlotState;
use crate::command::Command;

impl LineState {
    /// Has a slot go on with its model; its rig is not believed any more.
    pub fn drop_out(&mut self, slot: usize) {
        debug_assert!(slot < self.slots.len(), "no slot {slot}");
        if let Some(memory) = self.slots.get_mut(slot) {
            (memory.has_dropped_out, memory.is_force_believed) = (true, false);
        }
    }
}

impl SlotState {
    /// One cycle of the ram's way to rest.
    pub(super) fn come_to_rest(&mut self, cycle_s: f64) {
        self.command = self.command.stopping(cycle_s, self.limits.acceleration_m_per_s2);
        self.wanted = self.command;
        debug_assert!(self.command.is_finite(), "a stop begins at a sound command");
    }

    /// Whether the model has taken over and the ram is sent nowhere.
    pub(super) fn is_out(&self) -> bool {
        let Command { velocity_m_per_s, .. } = self.command;
        self.coupling.is_empty() && velocity_m_per_s == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::yawing_bogie::{Coupled, bogie, rig, stands_in};
    use super::super::{Fade, Slot};
    use crate::guard::ForceInput;
    use crate::supervision::{Event, State};
    use crate::track::Track;
    use crate::vehicle::Vehicle;
    use core::f64::consts::FRAC_PI_2;

    const FADE: Fade = Fade { motion_cycles: 100, measuring_cycles: 0, coupling_cycles: 100 };

    /// The rig of slot 0 measures 400 N too much.
    fn measured(slot: usize, force_n: f64) -> ForceInput {
        ForceInput::Fresh(if slot == 0 { force_n + 400.0 } else { force_n })
    }

    /// What arrives of the rig of slot 0 after it has dropped out: nothing that may be used.
    fn absurd(slot: usize, force_n: f64) -> ForceInput {
        ForceInput::Fresh(if slot == 0 { 90e3 } else { force_n })
    }

    /// A line in RUN.
    fn running<'a>(vehicle: &'a Vehicle, track: &'a Track<'a>, second: Slot<'a>) -> Coupled<'a> {
        let mut line = Coupled::new(vehicle, track, second, FADE);
        (0..250).for_each(|_| line.cycle(measured));
        assert_eq!(line.state.state, State::Run);
        line
    }

    #[test]
    fn the_force_goes_over_to_the_model_without_a_step_and_the_ram_rests() {
        let (vehicle, track) = (bogie(), Track::default());
        let mut line = running(&vehicle, &track, rig());
        let speed = line.state.slots[0].command.velocity_m_per_s.abs();
        assert!(speed > 1e-3, "{speed} m/s");
        line.state.drop_out(0);
        let mut furthest_n = 0.0_f64;
        for cycle in 1..=100 {
            let (before_n, model_n) = (line.force_n(0), line.state.slots[0].damper.force_n());
            line.cycle(absurd);
            let slot = &line.state.slots[0];
            let model_step_n = (slot.damper.force_n() - model_n).abs();
            let fade_n = FRAC_PI_2 / 20.0 * (slot.guard.force_n - model_n).abs();
            let step_n = (line.force_n(0) - before_n).abs();
            assert!(step_n <= model_step_n + fade_n + 1e-9, "{cycle}: {step_n} {fade_n}");
            furthest_n = furthest_n.max((line.force_n(0) - slot.damper.force_n()).abs());
            assert_eq!(slot.coupling.is_empty(), cycle >= 20, "{cycle}");
            if cycle >= 20 {
                assert_eq!(line.force_n(0), slot.damper.force_n(), "{cycle}");
            }
        }
        // It began at what the rig measured.
        assert!(furthest_n > 200.0, "{furthest_n} N");
        let [out, other, ..] = &line.state.slots;
        assert_eq!((out.command.velocity_m_per_s, out.wanted), (0.0, out.command));
        assert!(other.coupling.is_full() && other.command.velocity_m_per_s != 0.0);
        assert_eq!((line.state.state, out.has_dropped_out), (State::Run, true));
    }

    #[test]
    fn the_model_is_in_step_when_it_takes_over() {
        let (vehicle, track) = (bogie(), Track::default());
        // A rig that measures what the model computes: dropping out changes nothing.
        let course = |drops_out: bool| {
            let mut line = Coupled::new(&vehicle, &track, rig(), FADE);
            let mut last_n = [0.0; 2];
            for cycle in 0..600 {
                if cycle == 300 && drops_out {
                    line.state.drop_out(0);
                }
                line.cycle(|slot, _| ForceInput::Fresh(last_n[slot]));
                last_n = [0, 1].map(|slot| line.state.slots[slot].damper.force_n());
            }
            line.yaw_rad()
        };
        let (stays, drops) = (course(false), course(true));
        // The measured force is held over a cycle, the model acts in every substep.
        assert!((stays - drops).abs() < 0.02 * stays.abs().max(1e-5), "{stays} {drops}");
    }

    #[test]
    fn what_the_rig_stood_for_goes_over_to_its_own_model() {
        let (vehicle, track) = (bogie(), Track::default());
        let mut line = running(&vehicle, &track, stands_in(true));
        line.state.drop_out(0);
        (0..20).for_each(|_| line.cycle(absurd));
        for _ in 0..50 {
            line.cycle(absurd);
            assert_eq!(line.force_n(1), line.state.slots[1].damper.force_n());
            let sum_n = line.force_n(0) + line.force_n(1);
            assert!(sum_n.abs() < 1e-6, "both move oppositely: {sum_n} N");
        }
    }

    #[test]
    fn an_orderly_end_does_not_wait_for_a_ram_that_is_lost() {
        let (vehicle, track) = (bogie(), Track::default());
        let mut line = running(&vehicle, &track, rig());
        line.state.drop_out(0);
        (0..50).for_each(|_| line.cycle(absurd));
        let rests_at = line.state.slots[0].command;
        line.state.on(Event::End);
        let mut cycles = 0;
        while !line.line.is_faded_out(&line.state) {
            line.cycle(absurd);
            cycles += 1;
        }
        assert_eq!((cycles, line.state.slots[0].command), (200, rests_at));
        // Coupled anew, it is a rig like any other.
        let mut again = Coupled::new(&vehicle, &track, rig(), FADE);
        again.cycle(measured);
        assert!(!again.state.slots[0].has_dropped_out);
    }
}
