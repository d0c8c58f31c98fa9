//! Deadlines and round trips over the whole record, the cycles before and after RUN included.

use super::trace::Trace;
use crate::record::{InputKind, Row};
use firmware_core::vehicle::DAMPER_SLOTS;

/// How the cycles kept to the clock, and how long measurements took.
#[derive(Debug, Clone)]
pub(crate) struct ClockTraces {
    /// Ticks that were skipped since the first cycle.
    pub(crate) skipped: Trace,
    /// How late a cycle began (ns).
    pub(crate) lateness_ns: Trace,
    /// Cycles from a command to the cycle that has the measurement which answers it, by slot; empty
    /// without a rig.
    pub(crate) round_trip_cycles: [Trace; DAMPER_SLOTS],
    skipped_so_far: u64,
}

impl ClockTraces {
    /// Of a record of so many rows.
    pub(crate) fn of_rows(rows: u64) -> Self {
        Self {
            skipped: Trace::of_rows(rows),
            lateness_ns: Trace::of_rows(rows),
            round_trip_cycles: std::array::from_fn(|_| Trace::of_rows(rows)),
            skipped_so_far: 0,
        }
    }

    pub(crate) fn take(&mut self, row: &Row) {
        self.skipped_so_far += u64::from(row.skipped);
        self.skipped.take(row.time_s, self.skipped_so_far as f64, false);
        self.lateness_ns.take(row.time_s, f64::from(row.lateness_ns), false);
        for (slot, trace) in self.round_trip_cycles.iter_mut().enumerate() {
            if row.input[slot] != InputKind::NoRig {
                trace.take(row.time_s, round_trip_cycles(row, slot), false);
            }
        }
    }

    pub(super) fn finish(&mut self) {
        self.skipped.finish();
        self.lateness_ns.finish();
        self.round_trip_cycles.iter_mut().for_each(Trace::finish);
    }
}

/// A measurement of age 0 answers the command of the cycle before. Not a number in a cycle without
/// a new measurement: its row has the age of the last one.
fn round_trip_cycles(row: &Row, slot: usize) -> f64 {
    match (row.input[slot], row.age_cycles[slot]) {
        (InputKind::Fresh, age) if age < u8::MAX => f64::from(age) + 1.0,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skipped_ticks_add_up_and_a_cycle_without_a_measurement_is_a_gap() {
        let mut traces = ClockTraces::of_rows(4);
        let inputs = [InputKind::Missing, InputKind::Fresh, InputKind::Missing, InputKind::Fresh];
        for (n, input) in (0_u8..).zip(inputs) {
            let mut row = Row { time_s: f64::from(n) - 2.0, ..Row::default() };
            (row.skipped, row.lateness_ns) = (u32::from(n), 1000);
            (row.input[1], row.age_cycles[1]) = (input, if n == 0 { u8::MAX } else { n });
            traces.take(&row);
        }
        traces.finish();
        assert_eq!(traces.skipped.value, [0.0, 1.0, 3.0, 6.0]);
        assert_eq!(traces.skipped.time_s, [-2.0, -1.0, 0.0, 1.0]);
        assert_eq!(traces.lateness_ns.value, [1000.0; 4]);
        let round_trip = &traces.round_trip_cycles[1];
        assert_eq!((round_trip.value[1], round_trip.value[3]), (2.0, 4.0));
        assert_eq!((round_trip.samples().all, round_trip.samples().not_finite), (4, 2));
        assert!(traces.round_trip_cycles[0].value.is_empty());
    }
}
