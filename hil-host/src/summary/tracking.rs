//! How the rig of a slot follows the wanted motion, and what the delay of its force costs.

use crate::control::{COST_REFUSED, COST_WARNED};
use crate::linear_vehicle::Hunting;
use crate::statistics::SlotSums;
use firmware_core::line::{ResidualDelay, Sensitivity};
use scenario::run::{CYCLE_S, SlotForce};
use serde::Serialize;

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
    pub(super) fn of(force: &SlotForce, hunting: Option<Hunting>, sums: &SlotSums) -> Option<Self> {
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
        let delay = sums.delay.residual(CYCLE_S).map(|delay| without_delay.measured(delay));
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
        let most =
            measured.filter_map(|delay| delay.damping_lost_at_most_percent).fold(0.0, f64::max);
        let (warned, refused) = (100.0 * COST_WARNED, 100.0 * COST_REFUSED);
        if most <= warned {
            return None;
        }
        let follows = match (most > refused, self.accept_delay_error) {
            (true, true) => {
                "; accepted by accept_delay_error: the result is that of another damper"
            }
            (true, false) => {
                "; [slot.compensation] takes a delay out. On a real bus, at the pace of the clock, \
                 more than 5 % ramps a run out before the force acts"
            }
            (false, _) => "; [slot.compensation] takes a delay out",
        };
        Some(format!(
            "the delay of the force costs up to {most:.1} % of the damping at the hunting \
             frequency, more than {warned:.0} %{follows}"
        ))
    }
}

impl MeasuredDelay {
    /// In words.
    pub fn in_words(&self) -> String {
        let (mean, half) = (1e3 * self.mean_s, 1e3 * self.half_width_s);
        let cost = self.damping_lost_percent.zip(self.damping_lost_at_most_percent);
        let cost = cost.map_or_else(String::new, |(lost, most)| {
            if lost < 0.0 {
                format!(", {:.2} % of damping added, at most {most:.2} % off", -lost)
            } else {
                format!(", {lost:.2} % of the damping lost, at most {most:.2} %")
            }
        });
        format!("delay of the force {mean:.3} ± {half:.3} ms ({} s){cost}", self.blocks)
    }
}
