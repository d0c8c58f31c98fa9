//! A motion that grows from cycle to cycle and will reach the end of the stroke.
//!
//! ```text
//! A_1 < A_2 < A_3,      A_3 > 0.6 L,      A_3 (A_3 / A_2)^2 > L       L: the limit of the stroke
//! ```
//! `A` is the size of a cycle: half of the way from its lowest to its highest displacement. At the
//! ratio of the last two cycles, the second cycle from now passes the limit. Hunting that settles
//! below the limit stops growing, and is a result.

/// Cycles of the motion that are compared.
const COMPARED: usize = 3;

/// Share of the limit below which growth is of no concern.
const LEAST_SHARE: f64 = 0.6;

/// Reversals smaller than this share of the limit are ripples on the motion.
const RIPPLE_SHARE: f64 = 0.02;

/// The size of the last cycles of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Growth {
    /// Furthest displacement since the last reversal (m).
    extreme_m: f64,
    /// Whether the motion goes to larger displacements; none before the first reversal.
    rises: Option<bool>,
    /// Displacement of the last reversal, if there was one (m).
    turned_m: Option<f64>,
    /// The same for the one before.
    turned_before_m: Option<f64>,
    /// Sizes of the last cycles, the newest last; zero where there is none yet (m).
    sizes_m: [f64; COMPARED],
}

impl Growth {
    /// Takes the displacement of a control cycle. The size of the last cycle of the motion (m),
    /// where it grows so that it will pass the limit.
    pub fn take(&mut self, displacement_m: f64, limit_m: f64) -> Option<f64> {
        debug_assert!(limit_m > 0.0, "a stroke of {limit_m} m");
        let ripple_m = RIPPLE_SHARE * limit_m;
        match self.rises {
            None => {
                let from = *self.turned_m.get_or_insert(displacement_m);
                if (displacement_m - from).abs() > ripple_m {
                    self.rises = Some(displacement_m > from);
                    self.extreme_m = displacement_m;
                }
                None
            }
            Some(rises) => {
                let further = if rises {
                    displacement_m > self.extreme_m
                } else {
                    displacement_m < self.extreme_m
                };
                if further {
                    self.extreme_m = displacement_m;
                    return None;
                }
                if (displacement_m - self.extreme_m).abs() <= ripple_m {
                    return None;
                }
                self.turn(displacement_m, !rises, limit_m)
            }
        }
    }

    /// The motion has turned round at its extreme.
    fn turn(&mut self, displacement_m: f64, rises: bool, limit_m: f64) -> Option<f64> {
        let turned_m = self.extreme_m;
        let size_m = self.turned_m.map_or(0.0, |other_m| 0.5 * (turned_m - other_m).abs());
        let is_whole = rises && self.turned_before_m.is_some();
        self.turned_before_m = self.turned_m.replace(turned_m);
        (self.rises, self.extreme_m) = (Some(rises), displacement_m);
        if !is_whole {
            return None;
        }
        let [_, first, before] = self.sizes_m;
        let last = size_m;
        self.sizes_m = [first, before, last];
        let ratio = last / before;
        let grows = first > 0.0 && before > first && last > before;
        let reaches = last > LEAST_SHARE * limit_m && last * ratio * ratio > limit_m;
        (grows && reaches).then_some(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time and size at which growth is found first, in a sine whose size is a function of time.
    fn found(limit_m: f64, size_m: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut growth = Growth::default();
        (0..60_000).find_map(|n| {
            let t = f64::from(n) * 1e-3;
            let x = size_m(t) * libm::sin(core::f64::consts::TAU * 3.5 * t);
            growth.take(x, limit_m).map(|size_m| (t, size_m))
        })
    }

    #[test]
    fn hunting_that_runs_away_is_found_before_it_reaches_the_limit() {
        // Grows by 22 % in each cycle: from 3 mm to 50 mm in 4 s.
        let runaway = |t: f64| 3e-3 * libm::exp(0.7 * t);
        let (t, size_m) = found(50e-3, runaway).unwrap();
        assert!(size_m > 0.6 * 50e-3 && runaway(t) < 50e-3, "{t} {size_m}");
    }

    #[test]
    fn hunting_that_settles_below_the_limit_is_a_result() {
        for settled_m in [10e-3, 29e-3, 40e-3, 45e-3] {
            let settles = |t: f64| settled_m / crate::sqrt::sqrt(1.0 + 40.0 * libm::exp(-1.5 * t));
            assert_eq!(found(50e-3, settles), None, "{settled_m}");
        }
    }

    #[test]
    fn a_motion_of_constant_size_near_the_limit_is_none() {
        assert_eq!(found(50e-3, |_| 49e-3), None);
    }

    #[test]
    fn ripples_on_the_motion_are_no_cycles() {
        let mut growth = Growth::default();
        for n in 0..30_000 {
            let t = f64::from(n) * 1e-3;
            let slow = 30e-3 * libm::sin(core::f64::consts::TAU * 1.5 * t);
            let ripple = 0.4e-3 * libm::sin(core::f64::consts::TAU * 40.0 * t);
            assert_eq!(growth.take(slow + ripple, 50e-3), None);
        }
    }

    /// Size at which growth is found in cycles of these sizes, mm, at a limit of 50 mm. The motion
    /// begins in the middle and goes to `sign` first.
    fn found_in(sizes_mm: &[f64], sign: f64) -> Option<f64> {
        let mut growth = Growth::default();
        let cycles = sizes_mm.iter().flat_map(|size| [*size, -size]);
        // The last cycle is whole when the motion has turned.
        let mut way = core::iter::once(0.0).chain(cycles).chain([1.0]);
        let found = way.find_map(|at| growth.take(sign * at * 1e-3, 50e-3));
        found.map(|size_m| libm::round(size_m * 1e7) / 1e4)
    }

    #[test]
    fn three_cycles_grow_and_the_second_from_now_passes_the_limit() {
        assert_eq!(found_in(&[20.0, 26.0, 33.8], 1.0), Some(33.8));
        // Two cycles are too few, and each has to be larger than the one before.
        assert_eq!(found_in(&[20.0, 33.8], 1.0), None);
        assert_eq!(found_in(&[26.0, 26.0, 33.8], 1.0), None);
        assert_eq!(found_in(&[30.0, 26.0, 33.8], 1.0), None);
        assert_eq!(found_in(&[30.0, 40.0, 40.0], 1.0), None);
        // 0.6 of the limit are 30 mm.
        assert_eq!(found_in(&[10.0, 18.0, 29.9], 1.0), None);
        assert_eq!(found_in(&[10.0, 18.0, 30.1], 1.0), Some(30.1));
        // 39 mm grow to 48.4 mm in two cycles, and 40 mm to 52.2 mm.
        assert_eq!(found_in(&[30.0, 35.0, 39.0], 1.0), None);
        assert_eq!(found_in(&[30.0, 35.0, 40.0], 1.0), Some(40.0));
    }

    #[test]
    fn a_motion_that_falls_first_is_judged_from_its_first_whole_cycle() {
        // Cycles begin at a lower turn: their sizes are 21, 28, 34.5 mm here.
        assert_eq!(found_in(&[18.0, 24.0, 32.0, 37.0], -1.0), Some(34.5));
        assert_eq!(found_in(&[24.0, 32.0, 37.0], -1.0), None);
    }

    #[test]
    fn a_step_within_the_ripple_neither_begins_a_motion_nor_turns_it() {
        let found = |way_mm: &[f64]| {
            let mut growth = Growth::default();
            way_mm.iter().find_map(|at| growth.take(at * 1e-3, 50e-3))
        };
        // Ripples of 0.9 mm, where 1 mm counts: at the start, and before each turn.
        let way = [0.0, 0.9, 0.0, 20.0, 19.1, -20.0, -19.1, 26.0, 25.1, -26.0, -25.1];
        let end = [33.8, 32.9, -33.8, -32.9, 0.0];
        assert_eq!(found(&[way.as_slice(), &end].concat()), Some(33.8e-3));
        // A motion may begin anywhere.
        let mut growth = Growth::default();
        growth.take(10e-3, 50e-3);
        growth.take(9.1e-3, 50e-3);
        assert_eq!(growth.rises, None);
        let mut growth = Growth::default();
        growth.take(0.0, 50e-3);
        growth.take(-0.9e-3, 50e-3);
        assert_eq!(growth.rises, None);
        growth.take(-1.1e-3, 50e-3);
        assert_eq!((growth.rises, growth.extreme_m), (Some(false), -1.1e-3));
        growth.take(-0.2e-3, 50e-3);
        assert_eq!((growth.rises, growth.extreme_m), (Some(false), -1.1e-3));
        growth.take(0.0, 50e-3);
        assert_eq!((growth.rises, growth.extreme_m), (Some(true), 0.0));
    }
}
