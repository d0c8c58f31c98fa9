//! The ram: an actuator that follows a reference a little late.
//!
//! A first-order lag towards the reference, solved exactly over a substep in which the reference
//! runs on at a constant rate `r(s) = r + v s`:
//!
//! ```text
//! x' = (r - x) / lag        x(s) = r(s) - v lag + (x - r + v lag) exp(-s / lag)
//! ```
//!
//! The rate is limited by the servo valve, the travel by the stroke. The ram stops by
//! itself: it decelerates at [`DECELERATION_M_PER_S2`] from any speed, harder only
//! where its end stop is nearer than that, so its velocity never jumps. Servo dynamics of higher
//! order, oil compliance and supply pressure are not modelled here.
//!
//! The same stop and the same way to the middle guide the reference of the drives that a controller
//! moves (`servo`, `benchmark` of `rig-emulator`).

use super::plant::{Limits, Reference, Target};

/// Deceleration with which the ram comes to rest (m/s2). From 80 mm/s, about the peak of a yaw
/// damper on this vehicle, it stands after 8 ms and 0.3 mm.
pub const DECELERATION_M_PER_S2: f64 = 10.0;

/// Speed at which the ram goes to mid-stroke when asked to (m/s).
pub const CENTRING_M_PER_S: f64 = 5e-3;

/// Time constant with which it arrives there (s).
const CENTRING_LAG_S: f64 = 0.02;

/// The ram's parameters for one length of substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ram {
    /// Largest travel from the middle to either side (m).
    pub stroke_m: f64,
    /// Largest speed (m/s).
    pub rate_m_per_s: f64,
    /// Time constant of the lag (s), zero for none.
    pub lag_s: f64,
    step_s: f64,
    /// Residual of a deviation after one substep, as a share.
    residual: f64,
}

/// Where a ram is, or the reference of one, and how fast.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RamState {
    /// Displacement from mid-stroke, extension positive (m).
    pub displacement_m: f64,
    /// Velocity (m/s).
    pub velocity_m_per_s: f64,
}

impl Ram {
    /// A ram for substeps of this length (s).
    pub fn new(stroke_m: f64, rate_m_per_s: f64, lag_s: f64, step_s: f64) -> Self {
        let residual = if lag_s > 0.0 { libm::exp(-step_s / lag_s) } else { 0.0 };
        Self { stroke_m, rate_m_per_s, lag_s, step_s, residual }
    }

    /// Length of a substep (s).
    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// One cycle of so many substeps; `each` is told where the ram is after each of them.
    pub fn cycle(
        &self,
        state: &mut RamState,
        target: Target,
        substeps: u32,
        mut each: impl FnMut(RamState),
    ) -> Limits {
        let mut limits = Limits::default();
        for substep in 0..substeps {
            match target {
                Target::Follow(reference) => {
                    let reference = reference.after(f64::from(substep) * self.step_s);
                    self.follow(state, reference, &mut limits);
                }
                Target::Hold => self.stop(state),
                Target::Centre => self.centre(state),
            }
            each(*state);
        }
        limits
    }

    /// One substep after the reference.
    pub fn follow(&self, state: &mut RamState, reference: Reference, limits: &mut Limits) {
        let Reference { displacement_m: r, velocity_m_per_s: v } = reference;
        let start = state.displacement_m;
        let (end_reference, behind) = (r + v * self.step_s, v * self.lag_s);
        let end = end_reference - behind + (start - r + behind) * self.residual;
        let most = self.rate_m_per_s * self.step_s;
        let travel = bounded(end - start, most);
        let velocity = if self.lag_s > 0.0 {
            (end_reference - start - travel) / self.lag_s
        } else {
            travel / self.step_s
        };
        limits.rate |= travel != end - start;
        limits.stroke |= r.abs() > self.stroke_m;
        state.velocity_m_per_s = bounded(velocity, self.rate_m_per_s);
        state.displacement_m = start + travel;
        self.stop_at_the_end(state, limits);
    }

    /// A reference within stroke and speed, as the state of a guided reference.
    pub fn kept_within(&self, reference: Reference) -> RamState {
        let Self { stroke_m, rate_m_per_s, .. } = *self;
        RamState {
            displacement_m: bounded(reference.displacement_m, stroke_m),
            velocity_m_per_s: bounded(reference.velocity_m_per_s, rate_m_per_s),
        }
    }

    /// One substep of coming to rest.
    pub fn stop(&self, state: &mut RamState) {
        self.glide(state, 0.0);
    }

    /// One substep towards mid-stroke, slowly, and at rest when it is there.
    pub fn centre(&self, state: &mut RamState) {
        let x = state.displacement_m;
        let speed = CENTRING_M_PER_S.min(x.abs() / CENTRING_LAG_S);
        self.glide(state, -speed.copysign(x));
    }

    fn glide(&self, state: &mut RamState, target_m_per_s: f64) {
        let v = state.velocity_m_per_s;
        let room = (self.stroke_m - state.displacement_m * v.signum()).max(0.0);
        let needed = if v == 0.0 { 0.0 } else { v * v / (2.0 * room) };
        let most = needed.max(DECELERATION_M_PER_S2) * self.step_s;
        let next = v + bounded(target_m_per_s - v, most);
        state.displacement_m += 0.5 * (v + next) * self.step_s;
        state.velocity_m_per_s = next;
        self.stop_at_the_end(state, &mut Limits::default());
    }

    fn stop_at_the_end(&self, state: &mut RamState, limits: &mut Limits) {
        if state.displacement_m.abs() > self.stroke_m {
            *state = RamState {
                displacement_m: self.stroke_m.copysign(state.displacement_m),
                velocity_m_per_s: 0.0,
            };
            limits.stroke = true;
        }
    }
}

/// A value within a bound to either side. `f64::clamp` can panic, which a board must not.
pub(super) fn bounded(value: f64, most: f64) -> f64 {
    debug_assert!(most >= 0.0, "a bound of {most}");
    if value < -most {
        -most
    } else if value > most {
        most
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.25e-3;

    fn ram() -> Ram {
        Ram::new(0.1, 1.0, 0.5e-3, STEP_S)
    }

    #[test]
    fn a_step_is_approached_exponentially() {
        let mut state = RamState::default();
        let reference = Reference { displacement_m: 0.1e-3, velocity_m_per_s: 0.0 };
        for _ in 0..8 {
            ram().follow(&mut state, reference, &mut Limits::default());
        }
        // Four time constants.
        let expected = 0.1e-3 * (1.0 - libm::exp(-4.0));
        assert!((state.displacement_m - expected).abs() < 1e-15);
        assert!((state.velocity_m_per_s - (0.1e-3 - expected) / 0.5e-3).abs() < 1e-12);
    }

    #[test]
    fn a_ramp_is_followed_at_its_own_speed_one_lag_behind() {
        let mut state = RamState::default();
        let ramp = Reference { displacement_m: 0.0, velocity_m_per_s: 0.08 };
        for step in 0..200 {
            ram().follow(&mut state, ramp.after(f64::from(step) * STEP_S), &mut Limits::default());
        }
        let expected = 0.08 * (200.0 * STEP_S - 0.5e-3);
        assert!((state.displacement_m - expected).abs() < 1e-12);
        assert!((state.velocity_m_per_s - 0.08).abs() < 1e-12);
    }

    #[test]
    fn speed_and_stroke_hold_and_say_so() {
        let (mut state, mut limits) = (RamState::default(), Limits::default());
        let far = Reference { displacement_m: 0.3, velocity_m_per_s: 0.0 };
        ram().follow(&mut state, far, &mut limits);
        assert_eq!(limits, Limits { stroke: true, rate: true });
        assert!((state.displacement_m - 1.0 * STEP_S).abs() < 1e-15);
        for _ in 0..1000 {
            let before = state.displacement_m;
            ram().follow(&mut state, far, &mut limits);
            assert!(state.displacement_m - before <= STEP_S + 1e-15);
        }
        assert_eq!(state, RamState { displacement_m: 0.1, velocity_m_per_s: 0.0 });
    }

    #[test]
    fn it_stops_with_its_own_deceleration_and_in_front_of_the_end() {
        for start_m in [0.0, 0.0992, -0.05, 0.0999] {
            let mut state = RamState { displacement_m: start_m, velocity_m_per_s: 0.08 };
            // v^2 / 2a is 0.32 mm, more than the remaining stroke at 99.9 mm.
            let hardest = (0.08_f64 * 0.08 / (2.0 * (0.1 - start_m))).max(DECELERATION_M_PER_S2);
            let mut steps = 0;
            while state.velocity_m_per_s != 0.0 && steps < 1000 {
                let before = state.velocity_m_per_s;
                ram().stop(&mut state);
                let change = (before - state.velocity_m_per_s) / STEP_S;
                assert!(change <= 1.3 * hardest, "{change} m/s2 from {start_m} m");
                steps += 1;
            }
            assert!(state.displacement_m <= 0.1 && steps <= 32, "{state:?} after {steps}");
        }
    }

    #[test]
    fn centring_ends_in_the_middle_at_rest() {
        let mut state = RamState { displacement_m: -4.0e-3, velocity_m_per_s: 0.0 };
        for _ in 0..4 * 1200 {
            ram().centre(&mut state);
            assert!(state.velocity_m_per_s.abs() <= CENTRING_M_PER_S + 1e-12);
            assert!(state.displacement_m <= 0.0, "past the middle: {state:?}");
        }
        assert!(state.displacement_m.abs() < 1e-9, "{state:?}");
        assert!(state.velocity_m_per_s.abs() < 1e-7, "{state:?}");
    }
}
