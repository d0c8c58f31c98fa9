//! A trace that is drawn, with a bounded number of points.

use report::Samples;

/// Rows up to which a trace holds every sample.
pub(super) const WHOLE_ROWS: u64 = 60_000;

/// Steps of a longer trace, each with its smallest and largest sample.
const STEPS: u64 = 10_000;

/// A value over time. A long one holds of every step the smallest and the largest sample at their
/// true places: no peak is lost and none is invented.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    pub(crate) time_s: Vec<f64>,
    pub(crate) value: Vec<f64>,
    /// What was taken in, drawn or not.
    samples: Samples,
    /// Rows of a step.
    step_rows: u64,
    /// Rows of the present step, and its smallest and largest sample with their times.
    rows: u64,
    least: Option<(f64, f64)>,
    greatest: Option<(f64, f64)>,
}

impl Trace {
    /// A trace of so many rows.
    pub(super) fn of_rows(rows: u64) -> Self {
        let step_rows = if rows <= WHOLE_ROWS { 1 } else { rows.div_ceil(STEPS) };
        Self { step_rows, ..Self::default() }
    }

    /// How many samples were taken in; those that it holds are fewer in a long trace.
    pub(crate) const fn samples(&self) -> Samples {
        self.samples
    }

    /// Takes in the next sample; `whole` keeps it in any case.
    pub(super) fn take(&mut self, time_s: f64, value: f64, whole: bool) {
        self.samples.all += 1;
        self.samples.not_finite += u64::from(!value.is_finite());
        if whole || self.step_rows <= 1 {
            self.finish();
            self.put((time_s, value));
            return;
        }
        let sample = (time_s, value);
        // What is not a number is drawn where nothing else is there.
        if self.least.is_none_or(|(_, least)| value < least || least.is_nan()) {
            self.least = Some(sample);
        }
        if self.greatest.is_none_or(|(_, greatest)| value > greatest || greatest.is_nan()) {
            self.greatest = Some(sample);
        }
        self.rows += 1;
        if self.rows >= self.step_rows {
            self.finish();
        }
    }

    /// Ends the present step.
    pub(super) fn finish(&mut self) {
        self.rows = 0;
        let (Some(least), Some(greatest)) = (self.least.take(), self.greatest.take()) else {
            return;
        };
        let (first, second) =
            if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
        self.put(first);
        if second.0 > first.0 {
            self.put(second);
        }
    }

    fn put(&mut self, (time_s, value): (f64, f64)) {
        self.time_s.push(time_s);
        self.value.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(rows: u64, value: impl Fn(u64) -> f64, whole: impl Fn(u64) -> bool) -> Trace {
        let mut trace = Trace::of_rows(rows);
        for n in 0..rows {
            trace.take(n as f64, value(n), whole(n));
        }
        trace.finish();
        trace
    }

    #[test]
    fn a_short_trace_is_whole_and_a_long_one_keeps_every_peak_in_bounded_memory() {
        let short = trace(WHOLE_ROWS, |n| n as f64, |_| false);
        assert_eq!(short.value.len() as u64, WHOLE_ROWS);
        for rows in [WHOLE_ROWS + 1, 1_000_000] {
            let peak = |n| match n {
                777 => 5.0,
                778 => f64::NAN,
                40_000 => -7.0,
                _ => libm::sin(n as f64),
            };
            let long = trace(rows, peak, |n| (500..600).contains(&n));
            assert!(long.value.len() as u64 <= 2 * STEPS + 300, "{}", long.value.len());
            assert!(long.time_s.is_sorted());
            assert_eq!(long.samples(), Samples { all: rows, not_finite: 1 });
            for time_s in [777.0, 40_000.0, 500.0, 555.0, 599.0] {
                assert!(long.time_s.contains(&time_s), "{time_s}");
            }
        }
    }
}
