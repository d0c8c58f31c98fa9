//! A window on the irregularity of a long track, which moves along with the vehicle.
//!
//! A board has no memory for a day of track. Whoever makes the samples hands them over one by one
//! ([`Window::push`]), as far ahead as there is room; what the vehicle has passed is forgotten
//! ([`Window::pass`]). Every sample is kept twice, `N` places apart, so that the window lies in one
//! piece wherever it begins, and no step ever has to move it.
//!
//! ```text
//! places   0 ........ N-1 | N ....... 2N-1
//!                 [first .... first + held)
//! ```

use super::{Irregularity, IrregularitySample};

/// The last samples that were handed over, at most `N`.
#[derive(Debug, Clone, PartialEq)]
pub struct Window<const N: usize> {
    kept: [[IrregularitySample; N]; 2],
    /// Number in the whole track of the first sample that is held.
    first: usize,
    held: usize,
    /// Samples of the whole track.
    total: usize,
    first_m: f64,
    step_m: f64,
}

impl<const N: usize> Window<N> {
    /// An empty window before a track of so many samples.
    ///
    /// ```
    /// use firmware_core::track::{IrregularitySample, Window};
    /// let mut window = Window::<8>::new(1000, 0.0, 0.1);
    /// while window.push(IrregularitySample::default()) {}
    /// // The vehicle's rearmost wheel is at 0.42 m: three samples lie behind what it needs.
    /// window.pass(0.42);
    /// assert_eq!(window.room(), 3);
    /// ```
    pub const fn new(total: usize, first_m: f64, step_m: f64) -> Self {
        const { assert!(N >= 4, "a place lies between four samples") };
        let none = IrregularitySample {
            vertical_m: 0.0,
            alignment_m: 0.0,
            cross_level_m: 0.0,
            gauge_m: 0.0,
        };
        Self { kept: [[none; N]; 2], first: 0, held: 0, total, first_m, step_m }
    }

    /// Forgets everything, before a track of so many samples.
    pub fn restart(&mut self, total: usize, first_m: f64, step_m: f64) {
        (self.first, self.held) = (0, 0);
        (self.total, self.first_m, self.step_m) = (total, first_m, step_m);
    }

    /// Lets an empty window begin where a vehicle stands, by the distance of its rearmost wheel
    /// (m); the number of the sample that is to be handed over first.
    pub fn begin_at(&mut self, distance_m: f64) -> usize {
        debug_assert!(self.held == 0, "a window that holds {} samples", self.held);
        self.first = self.first_needed(distance_m).min(self.total);
        self.first
    }

    /// How many samples can be handed over now.
    pub fn room(&self) -> usize {
        (N - self.held).min(self.missing())
    }

    /// How many samples of the track were not handed over yet.
    pub fn missing(&self) -> usize {
        self.total.saturating_sub(self.first + self.held)
    }

    /// Takes the next sample of the track; false where there is no room, or no more track.
    pub fn push(&mut self, sample: IrregularitySample) -> bool {
        if self.room() == 0 {
            return false;
        }
        let place = (self.first + self.held) % N;
        for half in &mut self.kept {
            if let Some(kept) = half.get_mut(place) {
                *kept = sample;
            }
        }
        self.held += 1;
        debug_assert!(self.held <= N, "{} samples in {N} places", self.held);
        true
    }

    /// Forgets what lies behind the four samples around a distance: that of the rearmost wheel (m).
    pub fn pass(&mut self, distance_m: f64) {
        let needed = self.first_needed(distance_m);
        let passed = needed.saturating_sub(self.first).min(self.held);
        (self.first, self.held) = (self.first + passed, self.held - passed);
    }

    /// Whether a vehicle may go as far as a distance: that of its foremost wheel (m). Behind the
    /// end of the track it may.
    pub fn reaches(&self, distance_m: f64) -> bool {
        let end = self.first + self.held;
        end == self.total || self.place(distance_m) + 3.0 <= end as f64
    }

    /// The samples as a step sees them.
    pub fn view(&self) -> Irregularity<'_> {
        let start = self.first % N;
        let samples = self.kept.as_flattened().get(start..start + self.held);
        debug_assert!(samples.is_some(), "{} samples from place {start} of {N}", self.held);
        Irregularity {
            samples: samples.unwrap_or_default(),
            before: self.first,
            behind: self.total.saturating_sub(self.first + self.held),
            first_m: self.first_m,
            step_m: self.step_m,
        }
    }

    /// The first of the four samples around a distance (m).
    fn first_needed(&self, distance_m: f64) -> usize {
        (self.place(distance_m) as usize).saturating_sub(1)
    }

    /// A distance (m) in samples of the whole track.
    fn place(&self, distance_m: f64) -> f64 {
        (distance_m - self.first_m) / self.step_m.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(number: usize) -> IrregularitySample {
        let value = libm::sin(number as f64);
        IrregularitySample { vertical_m: value, gauge_m: 2.0 * value, ..Default::default() }
    }

    #[test]
    fn a_window_that_moves_gives_the_bits_of_the_whole_track() {
        let samples: [_; 500] = core::array::from_fn(sample);
        let whole =
            Irregularity { samples: &samples, first_m: 0.7, step_m: 0.1, ..Default::default() };
        let mut window = Window::<64>::new(samples.len(), 0.7, 0.1);
        let mut next = 0;
        // A vehicle of 5 m, from before the track to behind it.
        for rear_m in (0..700).map(|n| f64::from(n) * 0.0787) {
            window.pass(rear_m);
            while samples.get(next).is_some_and(|sample| window.push(*sample)) {
                next += 1;
            }
            for distance_m in [rear_m, rear_m + 2.503, rear_m + 5.0] {
                assert!(window.reaches(distance_m), "{distance_m}");
                assert_eq!(window.view().at(distance_m), whole.at(distance_m), "{distance_m}");
            }
        }
        assert_eq!((next, window.room()), (samples.len(), 0));
    }

    #[test]
    fn a_window_that_is_not_filled_does_not_reach() {
        let mut window = Window::<8>::new(100, 0.0, 1.0);
        assert!(!window.reaches(0.0) && window.room() == 8);
        while window.push(sample(0)) {}
        assert!(window.reaches(5.0) && !window.reaches(5.1));
        window.pass(3.5);
        assert_eq!(window.room(), 2);
        window.pass(-1e9);
        window.pass(f64::NAN);
        assert_eq!(window.room(), 2, "a window does not move back");
        window.pass(1e9);
        assert_eq!(window.room(), 8, "it forgets what it holds, and no more");
        window.restart(100, 0.0, 1.0);
        assert_eq!(window.begin_at(40.5), 39);
        while window.push(sample(0)) {}
        window.pass(40.5);
        assert!(window.room() == 0 && window.reaches(44.0));
        window.restart(5, -1.0, 0.5);
        assert_eq!((window.room(), window), (5, Window::new(5, -1.0, 0.5)));
    }
}
