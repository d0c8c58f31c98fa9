//! How the rig of a slot follows the wanted motion, and what the delay of its force costs.

use crate::control::{COST_REFUSED, COST_WARNED};
use crate::linear_vehicle::Hunting;
use crate::statistics::SlotSums;
use firmware_core::line::{ResidualDelay, Sensitivity};
use scenario::run::SlotForce;
use serde::Serialize;

/// A share of the damping that prints as nothing, %.
const UNSEEN_PERCENT: f64 = 0.005;

/// How a rig follows, over the time of the statistics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrackingSummary {
    /// The delay of the force; null in less than four seconds, or without motion.
    pub delay: Option<MeasuredDelay>,
    /// The same between the fades, before RUN; null where it was not measured there.
    pub before_run: Option<MeasuredDelay>,
    /// Delay of the measured displacement against the command of the cycle in which it arrives, s:
    /// what a compensator has to make up for; null without motion.
    pub ram_delay_s: Option<f64>,
    /// Whether the slot accepts a delay whatever it costs.
    pub accept_delay_error: bool,
    /// Rms of measured less wanted displacement over the standard deviation of the latter.
    pub nrmse: Option<f64>,
    /// Largest error, m.
    pub peak_error_m: f64,
    /// Energy that the vehicle gave at the wanted displacement less energy that the rig took, over
    /// the latter.
    pub exchanged_energy_error: Option<f64>,
    /// What the damper makes of a delay.
    #[serde(skip)]
    sensitivity: Option<Sensitivity>,
}

/// A delay of the force, and the damping that it costs at the hunting frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeasuredDelay {
    /// Mean, s; negative for a lead.
    pub mean_s: f64,
    /// Half of the interval of 95 %, s.
    pub half_width_s: f64,
    /// Blocks of a second behind it.
    pub blocks: u32,
    /// Share of the damping that the mean costs, %; null where the hunting frequency is not known.
    pub damping_lost_percent: Option<f64>,
    /// Size of the cost at the worse end of the interval, %.
    pub damping_lost_at_most_percent: Option<f64>,
}

impl TrackingSummary {
    /// That of a slot; none without a rig.
    pub(super) fn of(
        force: &SlotForce,
        hunting: Option<Hunting>,
        sums: &SlotSums,
        cycle_s: f64,
    ) -> Option<Self> {
        let SlotForce::Rig { model, accept_delay_error, .. } = force else { return None };
        let (asked, taken) = (sums.wanted.sum(), sums.taken.sum());
        let finite = |value: f64| value.is_finite().then_some(value);
        let without_delay = Self {
            delay: None,
            before_run: None,
            ram_delay_s: finite(sums.tracking.delay_s()),
            accept_delay_error: *accept_delay_error,
            nrmse: finite(sums.following.nrmse()),
            peak_error_m: sums.following.most_m(),
            exchanged_energy_error: finite((asked - taken) / taken),
            sensitivity: hunting.map(|hunting| Sensitivity::of(model, hunting.frequency_hz)),
        };
        let delay = sums.delay.residual(cycle_s).map(|delay| without_delay.measured(delay));
        Some(Self { delay, ..without_delay })
    }

    /// A delay with its cost for this slot.
    pub(super) fn measured(&self, delay: ResidualDelay) -> MeasuredDelay {
        let ResidualDelay { mean_s, half_width_s, blocks } = delay;
        let percent = |cost: fn(&ResidualDelay, Sensitivity) -> f64| {
            self.sensitivity.map(|sensitivity| 100.0 * cost(&delay, sensitivity))
        };
        MeasuredDelay {
            mean_s,
            half_width_s,
            blocks,
            damping_lost_percent: percent(ResidualDelay::cost),
            damping_lost_at_most_percent: percent(ResidualDelay::worst_cost),
        }
    }

    /// What is to be said of the delay of a run that went on, if anything.
    pub fn warning(&self) -> Option<String> {
        let measured = [self.before_run, self.delay].into_iter().flatten();
        let costs = measured.filter_map(|delay| Some((delay, delay.damping_lost_at_most_percent?)));
        let (delay, most) = costs.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (warned, refused) = (100.0 * COST_WARNED, 100.0 * COST_REFUSED);
        if most <= warned {
            return None;
        }
        let is_early = delay.mean_s < 0.0;
        let way_out = if is_early {
            "[slot.compensation] compensates too much, or the rig is faster than it says"
        } else {
            "[slot.compensation] takes a delay out"
        };
        let follows = match (most > refused, self.accept_delay_error) {
            (true, true) => {
                "; accepted by accept_delay_error: the result is that of another damper".to_owned()
            }
            (true, false) => format!(
                "; {way_out}. On a real bus, at the pace of the clock, more than {refused:.0} % ramps \
                 a run out before the force acts"
            ),
            (false, _) => format!("; {way_out}"),
        };
        let does = if is_early {
            "the force is too early, which puts the damping off by up to"
        } else {
            "the delay of the force costs up to"
        };
        let of = if is_early { "" } else { " of the damping" };
        Some(format!(
            "{does} {most:.1} %{of} at the hunting frequency, more than {warned:.0} %{follows}"
        ))
    }
}

impl MeasuredDelay {
    /// In words.
    pub fn in_words(&self) -> String {
        let (mean, half) = (1e3 * self.mean_s, 1e3 * self.half_width_s);
        // What prints as zero has no sign.
        let is = if mean <= -5e-4 { "lead" } else { "delay" };
        let cost = self.damping_lost_percent.zip(self.damping_lost_at_most_percent);
        let cost = cost.map_or_else(String::new, |(lost, most)| {
            if most < UNSEEN_PERCENT {
                ", the damping is right".to_owned()
            } else if lost < 0.0 {
                format!(", the damping is {:.2} % too high, at most {most:.2} % off", -lost)
            } else {
                format!(", {lost:.2} % of the damping lost, at most {most:.2} %")
            }
        });
        format!("{is} of the force {:.3} ± {half:.3} ms ({} s){cost}", mean.abs(), self.blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn delay(mean_s: f64, lost: f64, most: f64) -> MeasuredDelay {
        MeasuredDelay {
            mean_s,
            half_width_s: 2e-5,
            blocks: 12,
            damping_lost_percent: Some(lost),
            damping_lost_at_most_percent: Some(most),
        }
    }

    fn warning(delay: MeasuredDelay, accept_delay_error: bool) -> String {
        let tracking = TrackingSummary {
            delay: Some(delay),
            before_run: None,
            ram_delay_s: None,
            accept_delay_error,
            nrmse: None,
            peak_error_m: 0.0,
            exchanged_energy_error: None,
            sensitivity: None,
        };
        tracking.warning().unwrap_or_default()
    }

    #[test]
    fn a_force_that_is_early_is_not_told_to_be_late() {
        let (late, early) = (delay(6e-3, 24.0, 25.1), delay(-6e-3, -24.0, 25.1));
        assert!(warning(late, false).contains("delay of the force costs up to 25.1 % of the damp"));
        assert!(warning(late, false).contains("takes a delay out. On a real bus"));
        let said = warning(early, false);
        assert!(said.contains("too early") && said.contains("compensates too much"), "{said}");
        assert!(!said.contains("takes a delay out") && !said.contains("costs"), "{said}");
        assert!(warning(early, true).contains("accepted by accept_delay_error"));
        assert_eq!(warning(delay(1e-5, 0.04, 0.12), false), "");
    }

    #[test]
    fn signs_are_words() {
        for (delay, expected) in [
            (delay(1e-3, 4.0, 4.1), "delay of the force 1.000 ± 0.020 ms (12 s), 4.00 % of the"),
            (delay(-1.61e-4, -0.6, 0.7), "lead of the force 0.161 ± 0.020 ms (12 s), the damping"),
            (delay(-1.61e-4, -0.6, 0.7), "damping is 0.60 % too high, at most 0.70 % off"),
            (
                delay(-1e-7, -4e-4, 4e-3),
                "delay of the force 0.000 ± 0.020 ms (12 s), the damping is",
            ),
        ] {
            assert!(delay.in_words().contains(expected), "{}", delay.in_words());
        }
    }
}
