//! The budget as a table, and what follows from it.

use super::{Budget, RateBudget, STAGES, StageTimes};
use crate::bus::BusChoice;
use hdrhistogram::Histogram;

/// Most that everything around the vehicle step is to take (µs).
const AROUND_STEP_US: f64 = 1.0;

/// Most that receive to send is to take on the clock, over one cycle behind the other.
const PACED_OVER_HOT: f64 = 1.5;

impl Budget {
    /// A Markdown table with a row for each stage and three columns for each rate, and the figures
    /// that have an aim.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.head(), self.rule()];
        for (number, (_, name)) in STAGES.iter().enumerate() {
            lines.push(self.row(name, |times| &times.stages[number]));
        }
        lines.push(self.row("**receive to send**", |times| &times.receive_to_send));
        lines.push(self.row("around the step", |times| &times.around_step));
        lines.push(self.row("lateness", |times| &times.lateness));
        lines.push(self.left());
        lines.push(String::new());
        lines.extend(self.findings());
        lines
    }

    fn head(&self) -> String {
        let rates = self.rates.iter().map(|found| {
            let period_us = 1e-3 * found.rate.cycle_ns() as f64;
            format!(" {} ({period_us} µs): median | p99.9 | worst |", found.rate)
        });
        format!("| µs |{}", rates.collect::<String>())
    }

    fn rule(&self) -> String {
        format!("| --- |{}", " --- |".repeat(3 * self.rates.len()))
    }

    fn row(&self, name: &str, of: impl Fn(&StageTimes) -> &Histogram<u64>) -> String {
        let cells = self.rates.iter().map(|found| {
            let histogram = of(found.shown());
            let [median, p99_9, worst] = [0.5, 0.999, 1.0].map(|share| us(histogram, share));
            format!(" {} | {} | {} |", cell(median), cell(p99_9), cell(worst))
        });
        format!("| {name} |{}", cells.collect::<String>())
    }

    /// What lateness and cycle leave of the period; less than nothing where a tick is skipped.
    fn left(&self) -> String {
        let cells = self.rates.iter().map(|found| {
            let period_us = 1e-3 * found.rate.cycle_ns() as f64;
            let left = [0.5, 0.999, 1.0].map(|share| period_us - us(&found.shown().used, share));
            format!(" {:.0} | {:.0} | {:.0} |", left[0], left[1], left[2])
        });
        format!("| **left of the period** |{}", cells.collect::<String>())
    }

    fn findings(&self) -> Vec<String> {
        let each = |of: &dyn Fn(&RateBudget) -> String| {
            let words = self.rates.iter().map(|found| format!("{} at {}", of(found), found.rate));
            words.collect::<Vec<_>>().join(", ")
        };
        let mut lines = Vec::new();
        if self.rates.iter().all(|found| found.paced.is_some()) {
            let ratio = |found: &RateBudget| {
                let [paced, hot] = [found.shown(), &found.hot];
                let [paced, hot] = [paced, hot].map(|times| us(&times.receive_to_send, 0.5));
                format!("{:.2} ({} over {} µs)", paced / hot, cell(paced), cell(hot))
            };
            lines.push(format!(
                "receive to send, median on the clock over one cycle behind the other (aim \
                 {PACED_OVER_HOT}): {}",
                each(&ratio)
            ));
            lines.push(format!("ticks skipped: {}", each(&|found| found.skipped.to_string())));
        }
        let around = |found: &RateBudget| cell(us(&found.hot.around_step, 0.5));
        lines.push(format!(
            "decode to encode without the vehicle step, median of one cycle behind the other (aim \
             {AROUND_STEP_US} µs): {}",
            each(&around)
        ));
        let medium = match &self.bus {
            BusChoice::Memory => "frames change hands in memory".to_owned(),
            bus @ BusChoice::SocketCan(_) => format!("frames go over {bus}"),
        };
        lines.push(format!(
            "a look at the clock takes {:.3} µs, one for each stage and included; {medium}",
            1e-3 * self.look_ns
        ));
        lines
    }
}

impl RateBudget {
    /// What the table shows: on the clock, where that was measured.
    fn shown(&self) -> &StageTimes {
        self.paced.as_ref().unwrap_or(&self.hot)
    }
}

/// The time that a share of all times does not pass (µs).
fn us(histogram: &Histogram<u64>, share: f64) -> f64 {
    histogram.value_at_quantile(share) as f64 * 1e-3
}

/// Two digits behind the point below ten, none from a hundred on.
fn cell(time_us: f64) -> String {
    match time_us {
        _ if time_us < 10.0 => format!("{time_us:.2}"),
        _ if time_us < 100.0 => format!("{time_us:.1}"),
        _ => format!("{time_us:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Laps, STAGES};
    use super::*;
    use crate::realtime::RealtimeReport;
    use scenario::run::Rate;

    /// Times in which each stage takes one microsecond more than the one before, from one.
    fn times(scale: u64) -> StageTimes {
        let mut times = StageTimes::new();
        let mut laps = Laps::begin();
        for (number, spent_ns) in laps.spent_ns.iter_mut().enumerate() {
            *spent_ns = scale * 1000 * (number as u64 + 1);
        }
        (0..1000).for_each(|_| times.take(&laps, 20_000));
        times
    }

    #[test]
    fn the_table_adds_up_and_says_what_is_left() {
        let rates = Rate::ALL.map(|rate| RateBudget {
            rate,
            paced: Some(times(2)),
            hot: times(1),
            skipped: 3,
        });
        let budget = Budget {
            realtime: RealtimeReport::default(),
            bus: BusChoice::Memory,
            look_ns: 25.0,
            rates: rates.into(),
        };
        let lines = budget.lines();
        // Head, rule, stages, three sums, and the rest.
        assert_eq!(lines.iter().take_while(|line| line.starts_with('|')).count(), STAGES.len() + 6);
        let line = |name: &str| {
            let found = lines.iter().find(|line| line.contains(name));
            found.unwrap_or_else(|| panic!("no {name} in {lines:#?}")).clone()
        };
        assert!(line("| vehicle step |").starts_with("| vehicle step | 8.00 | 8.00 | 8.00 |"));
        // 2 (1 + ... + 7), and 2 (2 + 3 + 5 + 6).
        assert!(line("**receive to send**").contains("| 56.0 | 56.0 | 56.0 |"));
        assert!(line("around the step").contains("| 32.0 | 32.0 | 32.0 |"));
        // 20 of lateness and 2 * 36 of the cycle.
        let left = line("left of the period");
        assert!(
            left.ends_with("| 908 | 908 | 908 | 408 | 408 | 408 | 158 | 158 | 158 |"),
            "{left}"
        );
        assert!(line("(aim 1.5)").contains("2.00 (56.0 over 28.0 µs) at 2 kHz"));
        assert!(line("(aim 1 µs)").contains("16.0 at 4 kHz"));
        assert!(line("ticks skipped").contains("3 at 1 kHz"));
    }
}
