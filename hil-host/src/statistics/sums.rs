//! Figures of a run, row by row: first everything but half cycles, then those.

use super::SEGMENT_S;
use super::energy::Energy;
use super::liveliest::Liveliest;
use super::pairs::Pairs;
use super::power::Power;
use super::tracking::Tracking;
use crate::record::{ForceSource, InputKind, Row};
use firmware_core::line::DelayBlocks;
use firmware_core::vehicle::DAMPER_SLOTS;
use signal::spectrum::Welch;
use signal::statistics::HalfCycles;

/// The accelerations that have a spectrum: lateral of wheelset 1, front bogie, carbody.
pub(crate) const SPECTRA_OF: [usize; 3] = [4, 2, 0];

/// Up to this length a whole trace is drawn with an enlarged part (s).
pub(super) const ZOOM_S: f64 = 2.0;

/// Figures of some rows of a run.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    /// How many rows.
    pub(crate) rows: u64,
    /// The damper slots.
    pub(crate) slots: [SlotSums; DAMPER_SLOTS],
    /// Lateral and vertical acceleration of carbody, front bogie, first wheelset (m/s2).
    pub(crate) acceleration: [Power; 6],
    /// Spectra of [`SPECTRA_OF`].
    pub(crate) spectra: [Welch; 3],
    /// The strokes of every two damper slots.
    pub(crate) pairs: Pairs,
    /// Lateral position of the leading wheelset against the track (m).
    pub(crate) wheelset_lateral: Power,
    /// Greatest size of it (m).
    pub(crate) wheelset_lateral_max_m: f64,
}

/// Figures of a damper slot.
#[derive(Debug, Clone)]
pub(crate) struct SlotSums {
    /// Length of a cycle (s).
    cycle_s: f64,
    /// Least and greatest force; none of no row (N).
    pub(crate) force_range: Option<(f64, f64)>,
    /// Force (N).
    pub(crate) force: Power,
    stroke_sum_m: f64,
    /// Stroke (m).
    pub(crate) stroke: Power,
    /// Greatest size of it (m).
    pub(crate) stroke_max_m: f64,
    /// Spectrum of it.
    pub(crate) spectrum: Welch,
    /// Work of the force at the rate of the stroke (J).
    pub(crate) work_j: f64,
    /// Energy that the vehicle gave at its own displacement.
    pub(crate) given: Energy,
    /// Energy that the rig took at the displacement that it measured.
    pub(crate) taken: Energy,
    /// Energy that the vehicle gave at the displacement that it wanted of the rig.
    pub(crate) wanted: Energy,
    /// How well the rig follows its command.
    pub(crate) tracking: Tracking,
    /// How well it follows the wanted motion.
    pub(crate) following: Tracking,
    /// The delay of its force.
    pub(crate) delay: DelayBlocks,
    /// Force that the rig measured less that of the slot's model (N); where another rig stands for
    /// the slot, the force of that one.
    pub(crate) residual: Power,
    /// Where the force does most.
    pub(crate) liveliest: Liveliest,
    /// The second pass.
    cycles: HalfCycles,
    extremes_m: f64,
    cycle_count: u64,
    /// Begin of the first and end of the last half cycle, in rows.
    cycle_span: Option<(f64, f64)>,
}

impl Sums {
    /// Those of no row yet, of a loop with cycles of `cycle_s`.
    pub(crate) fn new(cycle_s: f64) -> Self {
        let welch = || Welch::new(1.0 / cycle_s, SEGMENT_S);
        let slot = || SlotSums {
            cycle_s,
            force_range: None,
            force: Power::default(),
            stroke_sum_m: 0.0,
            stroke: Power::default(),
            stroke_max_m: 0.0,
            spectrum: welch(),
            work_j: 0.0,
            given: Energy::default(),
            taken: Energy::default(),
            wanted: Energy::default(),
            tracking: Tracking::new(cycle_s),
            following: Tracking::new(cycle_s),
            delay: DelayBlocks::default(),
            residual: Power::default(),
            liveliest: Liveliest::new((ZOOM_S / cycle_s) as usize),
            cycles: HalfCycles::new(0.0, 0.0),
            extremes_m: 0.0,
            cycle_count: 0,
            cycle_span: None,
        };
        Self {
            rows: 0,
            slots: std::array::from_fn(|_| slot()),
            acceleration: Default::default(),
            spectra: std::array::from_fn(|_| welch()),
            pairs: Pairs::default(),
            wheelset_lateral: Power::default(),
            wheelset_lateral_max_m: 0.0,
        }
    }

    /// The first pass.
    pub(super) fn take(&mut self, row: &Row) {
        self.rows += 1;
        for (slot, sums) in self.slots.iter_mut().enumerate() {
            sums.take(row, slot);
        }
        for (power, value) in self.acceleration.iter_mut().zip(row.acceleration_m_per_s2) {
            power.take(value);
        }
        for (spectrum, index) in self.spectra.iter_mut().zip(SPECTRA_OF) {
            spectrum.push(row.acceleration_m_per_s2[index]);
        }
        self.pairs.take(row.extension_m);
        let [lateral_m, ..] = row.wheelset_lateral_m;
        self.wheelset_lateral.take(lateral_m);
        self.wheelset_lateral_max_m = self.wheelset_lateral_max_m.max(lateral_m.abs());
    }

    /// Between the passes.
    pub(super) fn begin_cycles(&mut self) {
        for slot in &mut self.slots {
            let middle_m = slot.stroke_sum_m / self.rows.max(1) as f64;
            // Small wiggles around the middle are no strokes: a hundredth of the rms.
            slot.cycles = HalfCycles::new(middle_m, 0.01 * slot.stroke.rms());
        }
    }

    /// The second pass, over the same rows.
    pub(super) fn take_cycles(&mut self, row: &Row) {
        for (slot, extension_m) in self.slots.iter_mut().zip(row.extension_m) {
            let Some(cycle) = slot.cycles.push(extension_m) else { continue };
            slot.extremes_m += cycle.extreme.abs();
            slot.cycle_count += 1;
            slot.cycle_span.get_or_insert((cycle.start, cycle.end)).1 = cycle.end;
        }
    }
}

/// The displacement that has arrived in a cycle; not a number where none has.
fn fresh_m(row: &Row, slot: usize) -> f64 {
    if row.input[slot] == InputKind::Fresh { row.measured_m[slot] } else { f64::NAN }
}

impl SlotSums {
    fn take(&mut self, row: &Row, slot: usize) {
        let (force_n, stroke_m) = (row.force_n[slot], row.extension_m[slot]);
        if !force_n.is_nan() {
            let (least, greatest) = self.force_range.unwrap_or((force_n, force_n));
            self.force_range = Some((least.min(force_n), greatest.max(force_n)));
        }
        self.force.take(force_n);
        self.stroke_sum_m += stroke_m;
        self.stroke.take(stroke_m);
        self.stroke_max_m = self.stroke_max_m.max(stroke_m.abs());
        self.spectrum.push(stroke_m);
        self.work_j += force_n * row.extension_m_per_s[slot] * self.cycle_s;
        self.liveliest.take(row.time_s, force_n);
        match row.force_source[slot] {
            ForceSource::StandIn => return self.residual.take(force_n - row.model_n[slot]),
            // What a rig still sends that is lost is not used.
            ForceSource::DroppedOut => return,
            ForceSource::Nothing | ForceSource::Model | ForceSource::Rig => {}
        }
        if row.input[slot] == InputKind::NoRig {
            return;
        }
        self.given.take(force_n, stroke_m);
        self.taken.take(row.measured_n[slot], row.measured_m[slot]);
        self.tracking.take(row.command_m[slot], row.measured_m[slot]);
        self.wanted.take(force_n, row.wanted_m[slot]);
        self.following.take(row.wanted_m[slot], row.measured_m[slot]);
        self.delay.take(row.wanted_m[slot], fresh_m(row, slot), self.cycle_s);
        let residual_n = row.measured_n[slot] - row.model_n[slot];
        if residual_n.is_finite() {
            self.residual.take(residual_n);
        }
    }

    /// Mean of the greatest distances from the mean, one per half cycle (m).
    pub(crate) fn mean_peak_m(&self) -> Option<f64> {
        (self.cycle_count > 0).then(|| self.extremes_m / self.cycle_count as f64)
    }

    /// Half the rate of zero crossings (Hz).
    pub(crate) fn zero_crossing_hz(&self) -> Option<f64> {
        let (start, end) = self.cycle_span?;
        let (rate_hz, span) = (1.0 / self.cycle_s, end - start);
        (span > 0.0).then(|| 0.5 * self.cycle_count as f64 / span * rate_hz)
    }
}
