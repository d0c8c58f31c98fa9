//! Motions of an actuator, as smooth functions of time that start from rest.
//!
//! ```text
//! sine        x = x0 + A w(t) sin(2 pi f t)
//! multisine   x = x0 + w(t) sum_i A_i sin(2 pi f_i t + phi_i)
//! enveloped   x = e(t) sum_i A_i sin(2 pi f_i t + phi_i)    tapered, short, earthquake
//! sweep       a sine whose frequency rises exponentially
//! sampled     any of these from a table, cubic between its steps
//! path        moves at constant speed between rests, each speeding up and down over half of tau:
//!             v = V sin(pi s/tau) for s < tau/2,  V in between;  length = V (D - tau) + 2 V tau/pi
//! ```
//!
//! with the window w = 10 u^3 - 15 u^4 + 6 u^5, u = t over the run-in, that has no jump up to the
//! second derivative. A triangle is a path without pauses. Displacement and velocity are closed
//! forms, so that every simulator may take its own steps.

mod envelope;
mod sampled;
mod sweep;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub use envelope::Stretch;
pub use sampled::Sampled;
pub use sweep::Sweep;

/// One tone of a multisine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Amplitude, m.
    pub amplitude_m: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase, rad.
    pub phase_rad: f64,
}

/// One move of a path and the pause after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Where it ends, m, from the test's mean position.
    pub to_m: f64,
    /// Speed between speeding up and slowing down, m/s.
    pub speed_m_per_s: f64,
    /// Pause at the end, s.
    pub hold_s: f64,
}

/// What an actuator does.
#[derive(Debug, Clone, PartialEq)]
pub enum Excitation {
    /// Tones that rise together over the run-in; a single one is a sine.
    Tones {
        /// The tones.
        tones: Vec<Tone>,
        /// Time in which they rise, s.
        run_in_s: f64,
    },
    /// Tones under an envelope.
    Enveloped {
        /// The tones.
        tones: Vec<Tone>,
        /// The envelope, in order of time.
        envelope: Vec<Stretch>,
    },
    /// A sine whose frequency rises.
    Sweep(Sweep),
    /// Moves and pauses, from the mean position at rest.
    Path(Path),
    /// A table of displacement and velocity.
    Sampled(Sampled),
}

/// Moves and pauses with their times.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    timed: Vec<TimedLeg>,
}

/// One move with its times.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TimedLeg {
    start_s: f64,
    move_s: f64,
    hold_s: f64,
    from_m: f64,
    to_m: f64,
    /// Signed.
    speed_m_per_s: f64,
    /// Twice the time for speeding up.
    tau_s: f64,
}

impl Excitation {
    /// A sine of this amplitude and frequency that has risen after one and a half periods.
    pub fn sine(amplitude_m: f64, frequency_hz: f64) -> Self {
        let tone = Tone { amplitude_m, frequency_hz, phase_rad: 0.0 };
        Self::Tones { tones: vec![tone], run_in_s: 1.5 / frequency_hz }
    }

    /// Triangles to `stroke_m` on both sides at constant speed, whole `cycles` from the middle and
    /// back to it; reversals take `rounding_s`.
    pub fn triangle(stroke_m: f64, speed_m_per_s: f64, cycles: usize, rounding_s: f64) -> Self {
        let leg = |to_m| Leg { to_m, speed_m_per_s, hold_s: 0.0 };
        let mut legs = Vec::with_capacity(2 * cycles + 1);
        for _ in 0..cycles {
            legs.extend([leg(stroke_m), leg(-stroke_m)]);
        }
        legs.push(leg(0.0));
        Self::path(&legs, rounding_s)
    }

    /// Moves and pauses; speeding up or slowing down takes half of `rounding_s`, less on moves too
    /// short for it. Legs that lead nowhere are pauses.
    ///
    /// ```
    /// use virtual_bench::excitation::{Excitation, Leg};
    /// let leg = Leg { to_m: 5e-3, speed_m_per_s: 0.02, hold_s: 30.0 };
    /// let ramp = Excitation::path(&[leg], 0.05);
    /// assert_eq!(ramp.at(10.0), (5e-3, 0.0));
    /// assert!((ramp.end_s().unwrap() - 30.268).abs() < 1e-3);
    /// ```
    pub fn path(legs: &[Leg], rounding_s: f64) -> Self {
        let (mut from_m, mut start_s) = (0.0, 0.0);
        let mut timed = Vec::with_capacity(legs.len());
        debug_assert!(rounding_s > 0.0, "rounding of {rounding_s} s");
        for leg in legs {
            debug_assert!(leg.speed_m_per_s > 0.0 && leg.hold_s >= 0.0, "{leg:?}");
            let distance = leg.to_m - from_m;
            let speed = leg.speed_m_per_s;
            let tau_s = rounding_s.min(distance.abs() * FRAC_PI_2 / speed);
            let move_s = distance.abs() / speed + tau_s * (1.0 - 2.0 / PI);
            timed.push(TimedLeg {
                start_s,
                move_s,
                hold_s: leg.hold_s,
                from_m,
                to_m: leg.to_m,
                speed_m_per_s: libm::copysign(speed, distance),
                tau_s,
            });
            start_s += move_s + leg.hold_s;
            from_m = leg.to_m;
        }
        debug_assert!(timed.is_sorted_by(|a: &TimedLeg, b| a.start_s <= b.start_s));
        Self::Path(Path { timed })
    }

    /// Displacement from the mean position and velocity at a time (m, m/s).
    pub fn at(&self, time_s: f64) -> (f64, f64) {
        match self {
            Self::Tones { tones, run_in_s } => {
                under(window(time_s, *run_in_s), sum_of(tones, time_s))
            }
            Self::Enveloped { tones, envelope } => {
                under(envelope::at(envelope, time_s), sum_of(tones, time_s))
            }
            Self::Sweep(sweep) => under(window(time_s, sweep.run_in_s()), sweep.at(time_s)),
            Self::Path(path) => path.at(time_s),
            Self::Sampled(sampled) => sampled.at(time_s),
        }
    }

    /// The same motion from a table: as quick for many tones as for one.
    ///
    /// ```
    /// use virtual_bench::excitation::Excitation;
    /// let sine = Excitation::sine(3.46e-3, 3.5);
    /// let table = sine.sampled(2.0, 1e-3);
    /// let (x, v) = sine.at(1.2345);
    /// let (table_x, table_v) = table.at(1.2345);
    /// assert!((x - table_x).abs() < 1e-11 && (v - table_v).abs() < 1e-7);
    /// ```
    #[must_use]
    pub fn sampled(&self, duration_s: f64, step_s: f64) -> Self {
        let motion = |time_s| self.at(time_s);
        Self::Sampled(Sampled::of(motion, (duration_s, step_s), self.frequency_hz()))
    }

    /// Displacement alone (m).
    pub fn displacement_m(&self, time_s: f64) -> f64 {
        match self {
            Self::Tones { tones, run_in_s } => {
                window(time_s, *run_in_s).0 * displacement_of(tones, time_s)
            }
            Self::Enveloped { tones, envelope } => {
                envelope::at(envelope, time_s).0 * displacement_of(tones, time_s)
            }
            Self::Sweep(_) | Self::Path(_) | Self::Sampled(_) => self.at(time_s).0,
        }
    }

    /// When it ends (s); tones alone have no end.
    pub fn end_s(&self) -> Option<f64> {
        match self {
            Self::Tones { .. } => None,
            Self::Enveloped { envelope, .. } => envelope.last().map(Stretch::end_s),
            Self::Sweep(sweep) => Some(sweep.duration_s),
            Self::Path(path) => path.timed.last().map(|last| last.rest_s() + last.hold_s),
            Self::Sampled(sampled) => Some(sampled.end_s()),
        }
    }

    /// The characteristic frequency of the test (Hz): that of the strongest tone, that in the
    /// middle of a sweep, or one over the mean time of two moves.
    pub fn frequency_hz(&self) -> f64 {
        match self {
            Self::Tones { tones, .. } | Self::Enveloped { tones, .. } => tones
                .iter()
                .max_by(|a, b| a.amplitude_m.total_cmp(&b.amplitude_m))
                .map_or(0.0, |tone| tone.frequency_hz),
            Self::Sweep(sweep) => sweep.middle_hz(),
            Self::Path(path) => {
                let time_s = self.end_s().unwrap_or(0.0);
                if time_s > 0.0 { 0.5 * path.timed.len() as f64 / time_s } else { 0.0 }
            }
            Self::Sampled(sampled) => sampled.frequency_hz,
        }
    }

    /// Greatest speed (m/s) and greatest distance from the mean position (m); upper bounds for
    /// tones.
    pub fn reach(&self) -> (f64, f64) {
        match self {
            Self::Tones { tones, .. } => reach_of(tones, 1.0),
            Self::Enveloped { tones, envelope } => {
                let level = envelope.iter().fold(0.0, |most: f64, one| most.max(one.level.abs()));
                reach_of(tones, level)
            }
            Self::Sweep(Sweep { amplitude_m, to_hz, corner_hz, .. }) => {
                let ratio = to_hz / corner_hz;
                (TAU * to_hz * amplitude_m / (1.0 + ratio * ratio).sqrt(), *amplitude_m)
            }
            Self::Path(path) => path.timed.iter().fold((0.0, 0.0), |(v, x), leg| {
                (leg.speed_m_per_s.abs().max(v), leg.to_m.abs().max(x))
            }),
            Self::Sampled(sampled) => sampled.reach(),
        }
    }
}

impl Path {
    fn at(&self, time_s: f64) -> (f64, f64) {
        let after = self.timed.partition_point(|leg| leg.start_s <= time_s);
        match after.checked_sub(1).and_then(|index| self.timed.get(index)) {
            Some(leg) => leg.at(time_s - leg.start_s),
            None => (0.0, 0.0),
        }
    }
}

impl TimedLeg {
    fn rest_s(&self) -> f64 {
        self.start_s + self.move_s
    }

    fn at(&self, since_s: f64) -> (f64, f64) {
        let left_s = self.move_s - since_s;
        if left_s <= 0.0 {
            return (self.to_m, 0.0);
        }
        // The second half mirrors the first.
        let (near_s, anchor_m, sign) = if since_s < 0.5 * self.move_s {
            (since_s, self.from_m, 1.0)
        } else {
            (left_s, self.to_m, -1.0)
        };
        let speed = self.speed_m_per_s;
        if near_s >= 0.5 * self.tau_s {
            let way = speed * (self.tau_s / PI + near_s - 0.5 * self.tau_s);
            return (anchor_m + sign * way, speed);
        }
        let angle = PI * near_s / self.tau_s;
        let way = speed * self.tau_s / PI * (1.0 - libm::cos(angle));
        (anchor_m + sign * way, speed * libm::sin(angle))
    }
}

/// Displacement and velocity of tones (m, m/s).
fn sum_of(tones: &[Tone], time_s: f64) -> (f64, f64) {
    let (mut x, mut v) = (0.0, 0.0);
    for tone in tones {
        let omega = TAU * tone.frequency_hz;
        let angle = omega * time_s + tone.phase_rad;
        let (sine, cosine) = libm::sincos(angle);
        x += tone.amplitude_m * sine;
        v += tone.amplitude_m * omega * cosine;
    }
    (x, v)
}

/// Displacement of tones (m).
fn displacement_of(tones: &[Tone], time_s: f64) -> f64 {
    let of = |tone: &Tone| {
        let angle = TAU * tone.frequency_hz * time_s + tone.phase_rad;
        tone.amplitude_m * libm::sin(angle)
    };
    tones.iter().map(of).sum()
}

/// A motion under a factor and its rate.
fn under((factor, rate): (f64, f64), (x, v): (f64, f64)) -> (f64, f64) {
    (factor * x, factor * v + rate * x)
}

/// Upper bounds of speed and distance of tones at a level (m/s, m).
fn reach_of(tones: &[Tone], level: f64) -> (f64, f64) {
    tones.iter().fold((0.0, 0.0), |(v, x), tone| {
        let amplitude = level * tone.amplitude_m.abs();
        (v + TAU * tone.frequency_hz * amplitude, x + amplitude)
    })
}

/// The window and its rate of change.
fn window(time_s: f64, run_in_s: f64) -> (f64, f64) {
    if time_s >= run_in_s {
        return (1.0, 0.0);
    }
    let u = (time_s / run_in_s).max(0.0);
    let value = u * u * u * (10.0 + u * (6.0 * u - 15.0));
    let slope = 30.0 * u * u * (1.0 - u) * (1.0 - u) / run_in_s;
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So that a displacement alone is that of the displacement with its velocity.
    #[test]
    fn sine_and_cosine_at_once_have_the_bits_of_each() {
        let angles = (0..200_000).map(|n| f64::from(n) * 0.037 - 1e-9).chain([1e-300, 1e-8, 3e-8]);
        for angle in angles {
            let (sine, cosine) = libm::sincos(angle);
            let of_each = [libm::sin(angle), libm::cos(angle)].map(f64::to_bits);
            assert_eq!([sine, cosine].map(f64::to_bits), of_each, "{angle:e}");
        }
    }

    fn all() -> Vec<Excitation> {
        let tones = [(1e-3, 0.7, 0.3), (0.5e-3, 3.1, 2.0), (0.2e-3, 9.7, 5.0)]
            .map(|(amplitude_m, frequency_hz, phase_rad)| Tone {
                amplitude_m,
                frequency_hz,
                phase_rad,
            })
            .to_vec();
        let leg = |to_m, speed_m_per_s, hold_s| Leg { to_m, speed_m_per_s, hold_s };
        vec![
            Excitation::sine(3.46e-3, 3.5),
            Excitation::Tones { tones: tones.clone(), run_in_s: 1.0 },
            Excitation::Enveloped {
                tones,
                envelope: vec![
                    Stretch { start_s: 0.2, rise_s: 0.4, stay_s: 0.7, fall_s: 0.3, level: 1.0 },
                    Stretch { start_s: 2.0, rise_s: 1.0, stay_s: 0.0, fall_s: 0.6, level: 0.4 },
                ],
            },
            Excitation::Sweep(Sweep {
                amplitude_m: 4e-3,
                from_hz: 0.6,
                to_hz: 12.0,
                corner_hz: 2.0,
                duration_s: 4.0,
            }),
            Excitation::triangle(10e-3, 0.02, 2, 0.1),
            Excitation::path(
                &[leg(0.01, 0.05, 0.5), leg(0.01, 0.05, 0.2), leg(-1e-5, 0.1, 1.0)],
                0.1,
            ),
        ]
    }

    #[test]
    fn velocity_is_the_derivative_of_displacement_and_the_start_is_at_rest() {
        for (index, excitation) in all().iter().enumerate() {
            assert_eq!(excitation.at(0.0), (0.0, 0.0), "{index}");
            let step = 1e-6;
            for n in 1..40_000 {
                let time = 1e-4 * f64::from(n) + 0.37e-4;
                let (x, v) = excitation.at(time);
                assert_eq!(x, excitation.displacement_m(time));
                let before = excitation.displacement_m(time - step);
                let slope = (excitation.displacement_m(time + step) - before) / (2.0 * step);
                assert!((slope - v).abs() < 2e-6, "{index} at {time}: {slope} and {v}");
            }
        }
    }

    #[test]
    fn a_triangle_keeps_its_speed_and_its_stroke() {
        let triangle = Excitation::triangle(10e-3, 0.02, 2, 0.1);
        let end = triangle.end_s().unwrap();
        // Eight strokes of 10 mm at 20 mm/s, and five times what a rounding takes.
        assert!((end - (4.0 + 5.0 * 0.1 * (1.0 - 2.0 / PI))).abs() < 1e-12, "{end}");
        let (mut farthest, mut steady) = (0.0f64, 0);
        let count = 10_000;
        for n in 0..count {
            let (x, v) = triangle.at(end * f64::from(n) / f64::from(count));
            farthest = farthest.max(x.abs());
            steady += u32::from(v.abs() == 0.02);
        }
        assert!((farthest - 10e-3).abs() < 1e-8, "{farthest}");
        assert!(f64::from(steady) > 0.85 * f64::from(count), "{steady}");
        assert!(triangle.at(end + 1.0).0.abs() < 1e-15);
    }

    #[test]
    fn the_characteristic_frequency_is_known() {
        assert_eq!(Excitation::sine(1e-3, 3.5).frequency_hz(), 3.5);
        let (speed, reach) = Excitation::sine(1e-3, 3.5).reach();
        assert!((speed - 0.02199).abs() < 1e-5 && reach == 1e-3);
        assert!((Excitation::triangle(10e-3, 0.02, 5, 1e-3).frequency_hz() - 0.5).abs() < 0.05);
    }
}
