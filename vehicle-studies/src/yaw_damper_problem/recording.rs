//! What the dampers of a run did, and its work, stroke and phase.
//!
//! ```text
//! cycle k        the motion x[k] leaves, the rig measures y[k] and F[k] at its end
//! cycle k + 1    F[k] acts on the vehicle while x goes from x[k] to x[k+1]
//!
//! work           W = sum of F[k] (x[k+1] - x[k]), all dampers, per cycle of hunting
//! stroke         sqrt(2) rms of y about its mean, all dampers
//! phase          arg(Y / X) - w T / 2 at the frequency of hunting
//! ```
//! `x` is the motion of the vehicle. The work is exactly that which the held forces take from the
//! vehicle. A measurement of cycle `k` acts half a cycle after `x[k]` in the mean, which the phase
//! counts as no delay.
//!
//! In the all-model run `y = x` and the phase is zero. Its forces act within the vehicle's
//! substeps; their work is that of the same damper over the recorded motion, a cubic between two
//! cycles, in quarters of a cycle.
//!
//! In the limit cycle sums go over whole cycles of the first damper. Over irregular track the phase
//! is that of the cross spectrum (Welch, two seconds, Hann).

use super::regime::Regime;
use crate::error::StudyError;
use crate::trip::{Equipped, Trip};
use firmware_core::command::Command;
use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::vehicle::DAMPER_SLOTS;
use nalgebra::Complex;
use scenario::run::CYCLE_S;
use scenario::track::OwnedTrack;
use signal::statistics::{half_cycles, mean};
use std::f64::consts::TAU;
use std::ops::Range;

/// Fewest substeps of a cycle.
const SUBSTEPS: u32 = 2;
/// Steps of the damper in a cycle of the all-model run.
const QUARTERS: u32 = 4;
/// Cycles of a segment of the cross spectrum.
const SEGMENT: usize = 2000;
/// Motion around which half cycles are not counted, as a share of the largest.
const DEAD_BAND: f64 = 0.2;
/// Lateral motion of the dampers that is no limit cycle (m): what is left of the start.
const ALIVE_M: f64 = 0.5e-3;

/// One damper over the cycles of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct DamperRecord {
    /// The motion of the vehicle at its place.
    pub(super) wanted: Vec<Command>,
    /// What its rig measured (m); the motion of the vehicle where it is modelled.
    pub(super) measured_m: Vec<f64>,
    /// Work that it took from the vehicle up to the next cycle (J).
    pub(super) work_j: Vec<f64>,
}

/// All dampers over a run, from its beginning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recording {
    pub(super) dampers: Vec<DamperRecord>,
    regime: Regime,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Observed {
    /// Frequency of the limit cycle, or the one at which the phase is taken (Hz).
    pub(super) frequency_hz: f64,
    /// Work of all dampers per cycle of this frequency (J).
    pub(super) work_j: f64,
    /// Stroke, half the travel (m).
    pub(super) stroke_m: f64,
    /// Phase of the rig, negative where it is late (degrees).
    pub(super) phase_deg: f64,
}

impl Recording {
    /// A run at a speed (m/s); none where the vehicle left the track.
    ///
    /// # Errors
    /// No steady running, or the run is stopped.
    pub(super) fn of(
        equipped: &Equipped<'_>,
        regime: Regime,
        track: &OwnedTrack,
        speed_m_per_s: f64,
    ) -> Result<Option<Self>, StudyError> {
        let track = track.view();
        let trip = Trip::new(equipped, &track, speed_m_per_s, SUBSTEPS);
        let mut state = trip.begin(&[])?;
        let mut dampers = vec![DamperRecord::default(); equipped.dampers.len()];
        let mut forces_n: Vec<Vec<f64>> = vec![Vec::new(); dampers.len()];
        let on_rigs = equipped.rigs.is_some();
        let [before_s, compared_s] = regime.times_s();
        let on_track = trip.go_with_rigs(&mut state, before_s + compared_s, |state| {
            let motions: [Command; DAMPER_SLOTS] = trip.damper_motions(&state.line);
            for (damper, motion) in dampers.iter_mut().zip(motions) {
                damper.wanted.push(motion);
            }
            for ((damper, forces_n), reading) in
                dampers.iter_mut().zip(&mut forces_n).zip(state.readings())
            {
                let Some(reading) = reading else { continue };
                damper.measured_m.push(reading.displacement_m);
                forces_n.push(reading.force_n);
            }
        })?;
        if !on_track {
            return Ok(None);
        }
        for ((damper, forces_n), model) in dampers.iter_mut().zip(&forces_n).zip(&equipped.dampers)
        {
            if on_rigs {
                damper.work_j = held_work_j(&damper.wanted, forces_n);
            } else {
                damper.measured_m = damper.wanted.iter().map(|x| x.displacement_m).collect();
                damper.work_j = modelled_work_j(model, &damper.wanted);
            }
            debug_assert_eq!(damper.measured_m.len(), damper.wanted.len());
        }
        Ok(Some(Self { dampers, regime }))
    }

    /// That of one damper on a rig alone.
    pub(super) fn of_one(damper: DamperRecord, regime: Regime) -> Self {
        Self { dampers: vec![damper], regime }
    }

    /// The same with its first damper only.
    pub(super) fn first(&self) -> Self {
        Self { dampers: self.dampers.iter().take(1).cloned().collect(), regime: self.regime }
    }

    /// What is compared of it; `hunting_hz` is the frequency of the phase over irregular track.
    /// None where there is no limit cycle.
    pub(super) fn observed(&self, hunting_hz: f64) -> Option<Observed> {
        let compared = self.compared();
        let (range, frequency_hz) = match self.regime {
            Regime::Track => (compared, hunting_hz),
            Regime::Hunting => self.whole_cycles(compared)?,
        };
        let count = range.len() as f64;
        let (mut work_j, mut squares_m2, mut cross) = (0.0, 0.0, Complex::new(0.0, 0.0));
        for damper in &self.dampers {
            work_j += damper.work_j[range.clone()].iter().sum::<f64>();
            let measured_m = &damper.measured_m[range.clone()];
            let middle_m = mean(measured_m);
            let square = |y: &f64| (y - middle_m) * (y - middle_m);
            squares_m2 += measured_m.iter().map(square).sum::<f64>() / count;
            let wanted_m: Vec<f64> =
                damper.wanted[range.clone()].iter().map(|x| x.displacement_m).collect();
            cross += match self.regime {
                Regime::Track => welch_cross(&wanted_m, measured_m, frequency_hz),
                Regime::Hunting => cross_at(&wanted_m, measured_m, frequency_hz, |_| 1.0),
            };
        }
        let half_cycle_rad = 0.5 * TAU * frequency_hz * CYCLE_S;
        let known_rad = if self.is_modelled() { 0.0 } else { half_cycle_rad };
        Some(Observed {
            frequency_hz,
            work_j: work_j / (count * CYCLE_S * frequency_hz),
            stroke_m: (2.0 * squares_m2 / self.dampers.len() as f64).sqrt(),
            phase_deg: (cross.arg() - known_rad).to_degrees(),
        })
    }

    /// The cycles that are compared; the last one has no work any more.
    pub(super) fn compared(&self) -> Range<usize> {
        let [before_s, compared_s] = self.regime.times_s();
        let from = (before_s / CYCLE_S) as usize;
        from..from + (compared_s / CYCLE_S) as usize - 1
    }

    /// Whether it is an all-model run.
    fn is_modelled(&self) -> bool {
        let same = |damper: &DamperRecord| {
            let wanted = damper.wanted.iter().map(|x| x.displacement_m);
            wanted.eq(damper.measured_m.iter().copied())
        };
        self.dampers.iter().all(same)
    }

    /// The whole cycles of the first damper among these, and their frequency (Hz).
    fn whole_cycles(&self, range: Range<usize>) -> Option<(Range<usize>, f64)> {
        let first = self.dampers.first()?;
        let wanted_m: Vec<f64> =
            first.wanted[range.clone()].iter().map(|x| x.displacement_m).collect();
        let most_m = wanted_m.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        if most_m < ALIVE_M {
            return None;
        }
        let halves = half_cycles(&wanted_m, DEAD_BAND * most_m);
        let whole = halves.len() / 2;
        let (from, to) = (halves.first()?.start, halves.get((2 * whole).checked_sub(1)?)?.end);
        let frequency_hz = whole as f64 / ((to - from) * CYCLE_S);
        let cycles = range.start + from.round() as usize..range.start + to.round() as usize;
        Some((cycles, frequency_hz))
    }
}

/// Work of forces that are held from one cycle to the next (J).
pub(super) fn held_work_j(wanted: &[Command], forces_n: &[f64]) -> Vec<f64> {
    let ways = wanted.windows(2).map(|pair| pair[1].displacement_m - pair[0].displacement_m);
    ways.zip(forces_n).map(|(way_m, force_n)| force_n * way_m).collect()
}

/// Work of a damper that acts all the time, from cycle to cycle (J).
pub(super) fn modelled_work_j(model: &Damper, wanted: &[Command]) -> Vec<f64> {
    let step_s = CYCLE_S / f64::from(QUARTERS);
    let model = model.clone().prepared(step_s);
    let motion = |at: Command| Motion::new(at.displacement_m, at.velocity_m_per_s);
    let Some(first) = wanted.first() else { return Vec::new() };
    let mut state = DamperState::starting(motion(*first));
    let (mut last_n, mut last_m) = (0.0, first.displacement_m);
    let interval = |pair: &[Command]| {
        let mut work_j = 0.0;
        for quarter in 1..=QUARTERS {
            let at = between(pair[0], pair[1], f64::from(quarter) / f64::from(QUARTERS));
            let force_n = model.advance(&mut state, motion(at), step_s);
            work_j += 0.5 * (force_n + last_n) * (at.displacement_m - last_m);
            (last_n, last_m) = (force_n, at.displacement_m);
        }
        work_j
    };
    wanted.windows(2).map(interval).collect()
}

/// The motion between two cycles, a share of the way: the cubic with their velocities.
fn between(from: Command, to: Command, share: f64) -> Command {
    let (s, rest) = (share, 1.0 - share);
    let [x0, x1] = [from, to].map(|at| at.displacement_m);
    let [v0, v1] = [from, to].map(|at| at.velocity_m_per_s);
    let displacement_m = rest * rest * (1.0 + 2.0 * s) * x0
        + s * s * (3.0 - 2.0 * s) * x1
        + CYCLE_S * s * rest * (rest * v0 - s * v1);
    let mean = (x1 - x0) / CYCLE_S;
    let velocity_m_per_s =
        6.0 * s * rest * mean + rest * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1;
    Command { displacement_m, velocity_m_per_s }
}

/// `Y X*` at a frequency, both about their means and weighted.
fn cross_at(
    wanted_m: &[f64],
    measured_m: &[f64],
    frequency_hz: f64,
    weight: impl Fn(usize) -> f64,
) -> Complex<f64> {
    let (middle_x, middle_y) = (mean(wanted_m), mean(measured_m));
    let zero = Complex::new(0.0, 0.0);
    let (mut x, mut y) = (zero, zero);
    for (n, (wanted, measured)) in wanted_m.iter().zip(measured_m).enumerate() {
        let turn = Complex::from_polar(weight(n), -TAU * frequency_hz * CYCLE_S * n as f64);
        x += turn * (wanted - middle_x);
        y += turn * (measured - middle_y);
    }
    y * x.conj()
}

/// The same over segments that overlap by half, each under a Hann window.
fn welch_cross(wanted_m: &[f64], measured_m: &[f64], frequency_hz: f64) -> Complex<f64> {
    let hann = |n: usize| 0.5 - 0.5 * libm::cos(TAU * n as f64 / SEGMENT as f64);
    let starts = (0..).step_by(SEGMENT / 2).take_while(|from| from + SEGMENT <= wanted_m.len());
    starts
        .map(|from| {
            let of = from..from + SEGMENT;
            cross_at(&wanted_m[of.clone()], &measured_m[of], frequency_hz, hann)
        })
        .sum()
}
