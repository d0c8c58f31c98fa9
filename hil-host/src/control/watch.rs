//! The watch over a damper on a rig: measured force less the force of a model that moves alike.
//!
//! ```text
//! r = F_measured - F_model        s^2 += (1 - exp(-h/T)) (r^2 - s^2)
//! ```
//!
//! The model is driven with the displacement that came with the measured force, straight between
//! two measurements: at 1 ms that costs 0.01 % of the force. After a time to settle, in which the
//! model forgets where it started, the usual residual is learnt as a plain rms; from there on the
//! running rms s forgets with the window T. **Drift** is raised where s rises above the limit and
//! cleared where it falls below two thirds of it. A limit that is a multiple of the learnt rms
//! grows with the force: where the track gets rougher, the imperfections of a model grow in
//! proportion.
//!
//! Every cycle costs the same except for events in the damper. Nothing is allocated, and the loop
//! does not depend on the watch. Without a fresh measurement the watch waits and then takes a
//! longer step.

use can_protocol::Watch as Verdict;
use firmware_core::damper::{Damper, DamperState, Motion};
use scenario::watch::{Limit, WatchSetup};

/// Share of the limit below which drift is cleared.
const RELEASE: f64 = 2.0 / 3.0;

/// Parameters of a watch.
#[derive(Debug, Clone, PartialEq)]
pub struct Watch {
    /// Length of a cycle (s).
    cycle_s: f64,
    damper: Damper,
    settle_cycles: u64,
    learn_cycles: u64,
    forget: f64,
    limit: Limit,
}

/// What a watch remembers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WatchState {
    damper: Option<DamperState>,
    /// Cycles since the last measurement that was used.
    waited: u32,
    /// Measurements used.
    used: u64,
    residual2: f64,
    force2: f64,
    learnt: Option<Learnt>,
    drift: bool,
    /// What it shows.
    pub view: View,
}

/// What is usual.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Learnt {
    residual2: f64,
    force2: f64,
}

/// What a watch shows after a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Measured less modelled force of the last measurement (N).
    pub residual_n: Option<f64>,
    /// Running rms of it (N); none while the model settles.
    pub residual_rms_n: Option<f64>,
    /// Where drift is raised (N); none while the usual residual is learnt.
    pub limit_n: Option<f64>,
    /// How it stands.
    pub verdict: Verdict,
}

impl Default for View {
    fn default() -> Self {
        Self { residual_n: None, residual_rms_n: None, limit_n: None, verdict: Verdict::None }
    }
}

impl Watch {
    /// A watch for cycles of `cycle_s`.
    pub fn new(setup: &WatchSetup, cycle_s: f64) -> Self {
        debug_assert!(cycle_s > 0.0 && cycle_s.is_finite(), "a cycle of {cycle_s} s");
        let cycles = |time_s: f64| libm::round(time_s / cycle_s) as u64;
        Self {
            cycle_s,
            damper: setup.damper.clone().prepared(cycle_s),
            settle_cycles: cycles(setup.settle_s),
            learn_cycles: cycles(setup.learn_s).max(1),
            forget: -libm::expm1(-cycle_s / setup.window_s),
            limit: setup.limit,
        }
    }

    /// Lets a cycle pass in which nothing fresh was measured.
    pub fn wait(&self, state: &mut WatchState) {
        state.waited = state.waited.saturating_add(1);
    }

    /// Takes in a measured displacement and the force measured with it.
    pub fn take(&self, state: &mut WatchState, displacement_m: f64, force_n: f64) {
        let motion = Motion::new(displacement_m, 0.0);
        let Some(damper) = &mut state.damper else {
            state.damper = Some(DamperState::starting(motion));
            state.waited = 0;
            return;
        };
        let step_s = self.cycle_s * (1.0 + f64::from(state.waited));
        state.waited = 0;
        let residual_n = force_n - self.damper.advance(damper, motion, step_s);
        state.view.residual_n = Some(residual_n);
        state.view.verdict = Verdict::Learning;
        state.used += 1;
        let Some(counted) = state.used.checked_sub(self.settle_cycles).filter(|n| *n > 0) else {
            return;
        };
        // A plain mean while learning, then a forgetting one that starts from it.
        let weight = if counted <= self.learn_cycles { 1.0 / counted as f64 } else { self.forget };
        state.residual2 += weight * (residual_n * residual_n - state.residual2);
        state.force2 += weight * (force_n * force_n - state.force2);
        state.view.residual_rms_n = Some(libm::sqrt(state.residual2));
        if counted == self.learn_cycles {
            state.learnt = Some(Learnt { residual2: state.residual2, force2: state.force2 });
        }
        let Some(learnt) = state.learnt else { return };
        let limit2 = match self.limit {
            Limit::Force(force_n) => force_n * force_n,
            Limit::Ratio(ratio) => {
                let rougher = if learnt.force2 > 0.0 { state.force2 / learnt.force2 } else { 1.0 };
                ratio * ratio * learnt.residual2 * rougher.max(1.0)
            }
        };
        let release2 = RELEASE * RELEASE * limit2;
        state.drift =
            if state.drift { state.residual2 >= release2 } else { state.residual2 > limit2 };
        state.view.limit_n = Some(libm::sqrt(limit2));
        state.view.verdict = if state.drift { Verdict::Drift } else { Verdict::Steady };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::damper::Nominal;
    use scenario::run::CYCLE_S;

    fn watch(limit: Limit) -> Watch {
        let damper = Damper::new(Nominal::NEW, &[]).unwrap();
        Watch::new(
            &WatchSetup { damper, settle_s: 0.1, learn_s: 1.0, window_s: 2.0, limit },
            CYCLE_S,
        )
    }

    /// Displacement of a damper that rests in its clearance: the model has no force.
    const STILL_M: f64 = 0.02e-3;

    /// Cycles from the step of the residual from 10 to 50 N until the verdict changes.
    fn cycles_until(verdict: Verdict, watch: &Watch, state: &mut WatchState, force_n: f64) -> u32 {
        for cycle in 1..100_000 {
            watch.take(state, STILL_M, if cycle % 2 == 0 { force_n } else { -force_n });
            if state.view.verdict == verdict {
                return cycle;
            }
        }
        panic!("never {verdict:?}");
    }

    #[test]
    fn drift_is_raised_and_taken_back_at_the_cycle_of_the_formula() {
        let watch = watch(Limit::Force(30.0));
        let mut state = WatchState::default();
        // The first measurement places the model, 100 settle, 1000 teach.
        assert_eq!(cycles_until(Verdict::Steady, &watch, &mut state, 10.0), 1 + 100 + 1000);
        // s^2 = 50^2 - (50^2 - 10^2) exp(-k h/T) > 30^2
        let k = (2000.0 * libm::log(2400.0 / 1600.0)).floor() as u32 + 1;
        assert_eq!(cycles_until(Verdict::Drift, &watch, &mut state, 50.0), k);
        // s^2 = 10^2 + (s_0^2 - 10^2) exp(-k h/T) < 20^2
        let rms_n = state.view.residual_rms_n.unwrap();
        let start = rms_n * rms_n;
        let k = (2000.0 * libm::log((start - 100.0) / 300.0)).floor() as u32 + 1;
        assert_eq!(cycles_until(Verdict::Steady, &watch, &mut state, 10.0), k);
    }

    #[test]
    fn a_healthy_damper_never_drifts_however_rough_it_gets() {
        // The rig's damper differs by 2 % from the model; the motion grows tenfold.
        let rig = Damper::new(Nominal { ce_n_s_per_m: 1.02e6, ..Nominal::NEW }, &[]).unwrap();
        let watch = watch(Limit::Ratio(3.0));
        let (mut state, mut mounted) = (WatchState::default(), DamperState::rest());
        for i in 1..=20_000 {
            let t = 1e-3 * f64::from(i);
            let x = 0.4e-3 * (1.0 + 0.45 * t) * libm::sin(20.0 * t);
            let force_n = rig.advance(&mut mounted, Motion::new(x, 0.0), CYCLE_S);
            watch.take(&mut state, x, force_n);
            assert_ne!(state.view.verdict, Verdict::Drift, "{t}");
        }
        assert!(state.view.residual_rms_n.unwrap() > 10.0 && state.view.verdict == Verdict::Steady);
    }

    #[test]
    fn gaps_in_the_measurement_are_bridged() {
        let rig = Damper::new(Nominal::NEW, &[]).unwrap();
        let watch = watch(Limit::Force(500.0));
        let (mut state, mut mounted) = (WatchState::default(), DamperState::rest());
        for i in 1..=5000_u32 {
            let t = 1e-3 * f64::from(i);
            let x = 3e-3 * libm::sin(20.0 * t);
            let force_n = rig.advance(&mut mounted, Motion::new(x, 0.0), CYCLE_S);
            if i % 50 < 3 {
                watch.wait(&mut state);
            } else {
                watch.take(&mut state, x, force_n);
            }
        }
        // A straight line over 4 ms instead of four over 1 ms.
        let rms_n = state.view.residual_rms_n.unwrap();
        assert!(rms_n < 30.0, "{rms_n}");
        assert_eq!(state.view.verdict, Verdict::Steady);
    }
}
