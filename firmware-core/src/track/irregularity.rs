//! Deviation of both rails from the ideal track, sampled at even distance.
//!
//! Four channels as track recording cars give them: vertical, alignment, cross level, gauge. The
//! samples are made or read off-line; a step looks four of them up and joins them by a Catmull-Rom
//! cubic, which is smooth in its first derivative. Outside the track that has samples the rails are
//! perfect. Of a long track a step sees a stretch that holds the whole vehicle.

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

/// Samples of irregularity along the track, or along a stretch of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Irregularity<'a> {
    /// The samples.
    pub samples: &'a [IrregularitySample],
    /// Samples of the whole track before the first of these.
    pub before: usize,
    /// Samples of the whole track behind the last of these.
    pub behind: usize,
    /// Distance of the whole track's first sample (m).
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
        // A place counts from the first sample of the whole track, so that every stretch gives the
        // same bits.
        let place = (distance_m - self.first_m) / self.step_m.max(f64::MIN_POSITIVE);
        let index = place as usize;
        debug_assert!(self.is_held(index), "{distance_m} m is outside the stretch");
        let start = index.checked_sub(self.before + 1);
        let held = start.and_then(|start| self.samples.get(start..));
        let Some([before, from, to, after]) = held.and_then(|held| held.first_chunk()) else {
            return IrregularitySample::default();
        };
        let t = place - index as f64;
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

    /// Whether the stretch holds the four samples around an index of the whole track, or the whole
    /// track does not.
    fn is_held(&self, index: usize) -> bool {
        let end = index.saturating_add(3);
        let is_within = |from: usize, to: usize| index > from && end <= to;
        let to = self.before + self.samples.len();
        is_within(self.before, to) || !is_within(0, to + self.behind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(value: f64) -> IrregularitySample {
        IrregularitySample { vertical_m: value, alignment_m: 2.0 * value, ..Default::default() }
    }

    fn whole(samples: &[IrregularitySample], first_m: f64, step_m: f64) -> Irregularity<'_> {
        Irregularity { samples, first_m, step_m, ..Irregularity::default() }
    }

    #[test]
    fn samples_are_met_and_a_parabola_is_exact() {
        let samples: [_; 8] = core::array::from_fn(|i| sample((i * i) as f64));
        let track = whole(&samples, 10.0, 0.5);
        assert_eq!(track.at(11.5).vertical_m, 9.0);
        let between = track.at(10.0 + 0.5 * 3.25);
        assert!((between.vertical_m - 3.25 * 3.25).abs() < 1e-12);
        assert!((between.alignment_m - 2.0 * 3.25 * 3.25).abs() < 1e-12);
    }

    #[test]
    fn outside_the_samples_the_track_is_perfect() {
        let samples = [sample(1.0); 8];
        let track = whole(&samples, 0.0, 1.0);
        for distance in [-1e9, -0.1, 0.5, 6.5, 7.5, 1e9, f64::NAN] {
            assert_eq!(track.at(distance), IrregularitySample::default(), "{distance}");
        }
        assert_eq!(Irregularity::default().at(3.0), IrregularitySample::default());
    }

    #[test]
    fn a_stretch_gives_the_bits_of_the_whole_track() {
        let samples: [_; 40] = core::array::from_fn(|i| sample(libm::sin(i as f64)));
        let track = whole(&samples, 0.7, 0.1);
        let stretch = Irregularity { samples: &samples[16..32], before: 16, behind: 8, ..track };
        // Four samples are needed: from 17 up to 29.
        for distance_m in (0..130).map(|n| 0.7 + 0.1 * (17.05 + 0.0923 * f64::from(n))) {
            assert_eq!(stretch.at(distance_m), track.at(distance_m), "{distance_m}");
            assert!(track.at(distance_m).vertical_m != 0.0);
        }
        // Outside the whole track it is perfect all the same.
        for distance_m in [-1.0, 0.75, 4.6, 1e9, f64::NAN] {
            assert_eq!(stretch.at(distance_m), IrregularitySample::default(), "{distance_m}");
        }
    }

    #[test]
    #[cfg(debug_assertions)]
    #[should_panic(expected = "outside the stretch")]
    fn a_stretch_that_does_not_hold_the_place_stops_a_debug_build() {
        let samples = [sample(1.0); 8];
        let track = Irregularity { behind: 8, ..whole(&samples, 0.0, 1.0) };
        track.at(6.5);
    }

    #[test]
    fn a_wider_gauge_moves_the_rails_apart() {
        let wide =
            IrregularitySample { gauge_m: 0.004, cross_level_m: 0.002, ..Default::default() };
        assert_eq!(wide.rail(1.0), (0.002, 0.001));
        assert_eq!(wide.rail(-1.0), (-0.002, -0.001));
    }
}
