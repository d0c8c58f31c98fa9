//! Deviation of both rails from the ideal track, sampled at even distance.
//!
//! Four channels as track recording cars give them: vertical, alignment, cross level, gauge. The
//! samples are made or read off-line; a step looks four of them up and joins them by a Catmull-Rom
//! cubic, which is smooth in its first derivative. Outside the samples the track is perfect.

/// The four channels at one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IrregularitySample {
    /// Mean of both rails, positive down (m).
    pub vertical_m: f64,
    /// Mean of both rails, positive right (m).
    pub alignment_m: f64,
    /// Right rail lower than left (m).
    pub cross_level_m: f64,
    /// Wider than nominal (m).
    pub gauge_m: f64,
}

impl IrregularitySample {
    /// Displacement of one rail, (right, down) in metres; `side` is +1 for right, -1 for left.
    pub fn rail(&self, side: f64) -> (f64, f64) {
        debug_assert!(side.abs() == 1.0, "side {side}, expected 1 or -1");
        (
            self.alignment_m + 0.5 * side * self.gauge_m,
            self.vertical_m + 0.5 * side * self.cross_level_m,
        )
    }
}

/// Samples of irregularity along the track.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Irregularity<'a> {
    /// The samples.
    pub samples: &'a [IrregularitySample],
    /// Distance of the first sample (m).
    pub first_m: f64,
    /// Distance between samples (m); ignored when there are none.
    pub step_m: f64,
}

impl Irregularity<'_> {
    /// The irregularity at a distance.
    pub fn at(&self, distance_m: f64) -> IrregularitySample {
        debug_assert!(
            self.samples.is_empty() || (self.step_m > 0.0 && self.first_m.is_finite()),
            "samples every {} m from {} m",
            self.step_m,
            self.first_m
        );
        let place = (distance_m - self.first_m) / self.step_m.max(f64::MIN_POSITIVE);
        if !(place >= 1.0 && place < self.samples.len() as f64) {
            return IrregularitySample::default();
        }
        let index = place as usize;
        let t = place - index as f64;
        let Some([before, from, to, after]) = self.samples.get(index - 1..index + 3) else {
            return IrregularitySample::default();
        };
        let join = |channel: fn(&IrregularitySample) -> f64| {
            let (y0, y1, y2, y3) = (channel(before), channel(from), channel(to), channel(after));
            y1 + 0.5
                * t
                * (y2 - y0
                    + t * (2.0 * y0 - 5.0 * y1 + 4.0 * y2 - y3 + t * (3.0 * (y1 - y2) + y3 - y0)))
        };
        IrregularitySample {
            vertical_m: join(|s| s.vertical_m),
            alignment_m: join(|s| s.alignment_m),
            cross_level_m: join(|s| s.cross_level_m),
            gauge_m: join(|s| s.gauge_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(value: f64) -> IrregularitySample {
        IrregularitySample { vertical_m: value, alignment_m: 2.0 * value, ..Default::default() }
    }

    #[test]
    fn samples_are_met_and_a_parabola_is_exact() {
        let samples: [_; 8] = core::array::from_fn(|i| sample((i * i) as f64));
        let track = Irregularity { samples: &samples, first_m: 10.0, step_m: 0.5 };
        assert_eq!(track.at(11.5).vertical_m, 9.0);
        let between = track.at(10.0 + 0.5 * 3.25);
        assert!((between.vertical_m - 3.25 * 3.25).abs() < 1e-12);
        assert!((between.alignment_m - 2.0 * 3.25 * 3.25).abs() < 1e-12);
    }

    #[test]
    fn outside_the_samples_the_track_is_perfect() {
        let samples = [sample(1.0); 8];
        let track = Irregularity { samples: &samples, first_m: 0.0, step_m: 1.0 };
        for distance in [-1e9, -0.1, 0.5, 6.5, 7.5, 1e9, f64::NAN] {
            assert_eq!(track.at(distance), IrregularitySample::default(), "{distance}");
        }
        assert_eq!(Irregularity::default().at(3.0), IrregularitySample::default());
    }

    #[test]
    fn a_wider_gauge_moves_the_rails_apart() {
        let wide =
            IrregularitySample { gauge_m: 0.004, cross_level_m: 0.002, ..Default::default() };
        assert_eq!(wide.rail(1.0), (0.002, 0.001));
        assert_eq!(wide.rail(-1.0), (-0.002, -0.001));
    }
}
