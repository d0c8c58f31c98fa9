//! What a report draws over time, and the loops.

use super::clock::ClockTraces;
use super::sums::{Sums, ZOOM_S};
use super::trace::{Trace, WHOLE_ROWS};
use crate::record::{InputKind, Row};
use firmware_core::vehicle::DAMPER_SLOTS;
use std::ops::RangeInclusive;

/// The traces of a run.
#[derive(Debug, Clone)]
pub(crate) struct Traces {
    /// Lateral and vertical acceleration of carbody, front bogie, first wheelset (m/s2).
    pub(crate) acceleration: [Trace; 6],
    /// Force of each damper slot (N).
    pub(crate) force: [Trace; DAMPER_SLOTS],
    /// The seconds in which the force of a slot does most, for both slots of a bogie: they hold
    /// every sample.
    pub(crate) zoom: [Option<RangeInclusive<f64>>; DAMPER_SLOTS],
    /// What each rig did; empty without one.
    pub(crate) rigs: [RigTraces; DAMPER_SLOTS],
    /// Running rms of the residual of each watched rig, from the start of the run (N).
    pub(crate) residual_rms: [Trace; DAMPER_SLOTS],
    /// Where drift is raised (N).
    pub(crate) residual_limit: [Trace; DAMPER_SLOTS],
    /// Deadlines and round trips, from the first row of the record.
    pub(crate) clock: ClockTraces,
    /// Force over stroke and velocity of each slot.
    pub(crate) loops: [Loop; DAMPER_SLOTS],
    /// Where the loops begin if they do not hold the whole run (s).
    pub(crate) loops_from_s: Option<f64>,
}

/// Command, measurement and model of a rig.
#[derive(Debug, Clone)]
pub(crate) struct RigTraces {
    pub(crate) command_m: Trace,
    pub(crate) measured_m: Trace,
    pub(crate) error_m: Trace,
    pub(crate) measured_n: Trace,
    pub(crate) model_n: Trace,
}

/// Every sample of a stretch of a run.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loop {
    pub(crate) extension_m: Vec<f64>,
    pub(crate) rate_m_per_s: Vec<f64>,
    pub(crate) force_n: Vec<f64>,
}

impl Traces {
    /// Before the second pass over rows whose figures are known, of so many rows in all and of RUN.
    pub(super) fn new(shown: &Sums, all_rows: u64, run_rows: u64) -> Self {
        let trace = || Trace::of_rows(shown.rows);
        let rig = || RigTraces {
            command_m: trace(),
            measured_m: trace(),
            error_m: trace(),
            measured_n: trace(),
            model_n: trace(),
        };
        let zoom = |slot: usize| {
            // Left and right of a bogie are drawn together.
            let begin_s = shown.slots.get(slot / 2 * 2)?.liveliest.begin_s()?;
            Some(begin_s..=begin_s + ZOOM_S)
        };
        let is_long = shown.rows > WHOLE_ROWS;
        let loops_from_s = shown.slots[0].liveliest.begin_s().filter(|_| is_long);
        Self {
            acceleration: std::array::from_fn(|_| trace()),
            force: std::array::from_fn(|_| trace()),
            zoom: std::array::from_fn(zoom),
            rigs: std::array::from_fn(|_| rig()),
            residual_rms: std::array::from_fn(|_| Trace::of_rows(run_rows)),
            residual_limit: std::array::from_fn(|_| Trace::of_rows(run_rows)),
            clock: ClockTraces::of_rows(all_rows),
            loops: Default::default(),
            loops_from_s,
        }
    }

    /// Takes in a row of those that are shown.
    pub(super) fn take(&mut self, row: &Row) {
        let time_s = row.time_s;
        for (trace, value) in self.acceleration.iter_mut().zip(row.acceleration_m_per_s2) {
            trace.take(time_s, value, false);
        }
        let is_in_loops = self.loops_from_s.is_none_or(|from_s| time_s >= from_s)
            && (self.loops[0].force_n.len() as u64) < WHOLE_ROWS;
        for slot in 0..DAMPER_SLOTS {
            let is_enlarged = self.zoom[slot].as_ref().is_some_and(|zoom| zoom.contains(&time_s));
            self.force[slot].take(time_s, row.force_n[slot], is_enlarged);
            if is_in_loops {
                let drawn = &mut self.loops[slot];
                drawn.extension_m.push(row.extension_m[slot]);
                drawn.rate_m_per_s.push(row.extension_m_per_s[slot]);
                drawn.force_n.push(row.force_n[slot]);
            }
            if row.input[slot] == InputKind::NoRig {
                continue;
            }
            let (rig, command_m, measured_m) =
                (&mut self.rigs[slot], row.command_m[slot], row.measured_m[slot]);
            rig.command_m.take(time_s, command_m, false);
            rig.measured_m.take(time_s, measured_m, false);
            rig.error_m.take(time_s, measured_m - command_m, false);
            rig.measured_n.take(time_s, row.measured_n[slot], false);
            rig.model_n.take(time_s, row.model_n[slot], false);
        }
    }

    /// Takes in the residuals of any row of RUN, from the first one that is known.
    pub(super) fn take_residual(&mut self, row: &Row) {
        for slot in 0..DAMPER_SLOTS {
            for (trace, value) in [
                (&mut self.residual_rms[slot], row.residual_rms_n[slot]),
                (&mut self.residual_limit[slot], row.residual_limit_n[slot]),
            ] {
                let is_watched = row.drift[slot] != can_protocol::Watch::None;
                if !trace.value.is_empty() || is_watched && value.is_finite() {
                    trace.take(row.time_s, value, trace.value.is_empty());
                }
            }
        }
    }

    pub(super) fn finish(&mut self) {
        let rigs = self.rigs.iter_mut().flat_map(|rig| {
            let RigTraces { command_m, measured_m, error_m, measured_n, model_n } = rig;
            [command_m, measured_m, error_m, measured_n, model_n]
        });
        let all = self.acceleration.iter_mut().chain(&mut self.force).chain(rigs);
        let all = all.chain(&mut self.residual_rms).chain(&mut self.residual_limit);
        all.for_each(Trace::finish);
        self.clock.finish();
    }
}
