//! One check of a rehearsal: what was reached, the limit, and what is left of it.

use crate::control::COST_REFUSED;
use crate::linear_vehicle::LinearVehicle;
use crate::run::StabilityCheck;
use crate::stability::{LEAST_MARGIN, Stability};
use crate::summary::is_worn;
use firmware_core::line::{DelayBlocks, Sensitivity, SlotState};
use firmware_core::supervision::Reached;
use firmware_core::virtual_wear::{FORCE_ERROR_MAX, LOOP_GAIN_MAX, WearFound};
use scenario::run::{Slot, SlotForce};
use serde::Serialize;

/// Share of a limit that is to be left.
const SMALL: f64 = 0.2;

/// What a limit belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LimitOf {
    /// In `[motion]` of the scenario.
    Motion,
    /// In `[plausibility]`.
    Plausibility,
    /// The gate on the delay before RUN.
    Delay,
    /// The gain margin of the loop.
    Stability,
    /// Room on the disk.
    Disk,
}

/// What a margin says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// A fifth of the limit is left, or more.
    Enough,
    /// Less is left, or the limit was passed for fewer cycles than its debounce has.
    Small,
    /// The limit was passed, and a run would act on it.
    Beyond,
    /// Commands are cut on purpose: the limits round the contacts of wear in software.
    Cut,
    /// Nothing was measured.
    NotMeasured,
}

impl Verdict {
    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Enough => "enough",
            Self::Small => "small",
            Self::Beyond => "beyond",
            Self::Cut => "cut on purpose",
            Self::NotMeasured => "not measured",
        }
    }
}

/// A check with its margin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckMargin {
    /// Place of the damper slot; null for what belongs to the whole run.
    pub place: Option<String>,
    /// What the limit belongs to.
    pub limit_of: LimitOf,
    /// Its key.
    pub check: &'static str,
    /// Unit of both values; null for a share or a gain.
    pub unit: Option<&'static str>,
    /// The largest value of the rehearsal; null where nothing was measured.
    pub reached: Option<f64>,
    /// The limit; null where none acts.
    pub limit: Option<f64>,
    /// What is left, %; null where it has no meaning.
    pub margin_percent: Option<f64>,
    /// What that says.
    pub verdict: Verdict,
}

impl CheckMargin {
    /// A check, and whether a run would act on it.
    fn new(place: Option<&str>, limit_of: LimitOf, reached: &Reached) -> Self {
        let limit = Some(reached.limit).filter(|limit| limit.is_finite());
        let margin = reached.margin();
        let verdict = match (reached.largest, margin) {
            (None, _) => Verdict::NotMeasured,
            _ if reached.has_tripped => Verdict::Beyond,
            (Some(_), Some(margin)) if margin < SMALL => Verdict::Small,
            (Some(_), _) => Verdict::Enough,
        };
        Self {
            place: place.map(str::to_owned),
            limit_of,
            check: reached.key,
            unit: reached.unit,
            reached: reached.largest,
            limit,
            margin_percent: margin.map(|margin| 100.0 * margin),
            verdict,
        }
    }
}

/// A value that acts as soon as it is beyond its limit.
fn value(
    key: &'static str,
    unit: Option<&'static str>,
    largest: Option<f64>,
    limit: f64,
) -> Reached {
    let has_tripped = largest.is_some_and(|largest| largest > limit);
    Reached { key, unit, largest, limit, has_tripped, action: None }
}

/// What the commands have asked of the limits of `[motion]`, or of tighter ones of the rig.
pub(super) fn of_motion(slot: &Slot, memory: &SlotState, cycle_s: f64) -> [CheckMargin; 3] {
    let (demand, limits) = (memory.demand, memory.limits);
    let acceleration = demand.speed_change_m_per_s / cycle_s;
    [
        value("stroke_m", Some("m"), Some(demand.stroke_m), limits.stroke_m),
        value(
            "velocity_m_per_s",
            Some("m/s"),
            Some(demand.velocity_m_per_s),
            limits.velocity_m_per_s,
        ),
        value(
            "acceleration_m_per_s2",
            Some("m/s2"),
            Some(acceleration),
            limits.acceleration_m_per_s2,
        ),
    ]
    .map(|reached| {
        let check = CheckMargin::new(Some(&slot.place), LimitOf::Motion, &reached);
        let is_cut = check.verdict == Verdict::Beyond && is_worn(slot);
        let verdict = if is_cut { Verdict::Cut } else { check.verdict };
        CheckMargin { verdict, ..check }
    })
}

/// What the supervision has seen of a rig.
pub(super) fn of_plausibility(slot: &Slot, reached: &[Reached]) -> Vec<CheckMargin> {
    let of = |reached| CheckMargin::new(Some(&slot.place), LimitOf::Plausibility, reached);
    reached.iter().map(of).collect()
}

/// The damping that the delay of the force costs at most, as the gate before RUN judges it.
pub(super) fn of_delay(
    slot: &Slot,
    delays: &DelayBlocks,
    cycle_s: f64,
    linear: Option<&LinearVehicle>,
) -> Option<CheckMargin> {
    let SlotForce::Rig { model, accept_delay_error, .. } = &slot.force else { return None };
    let sensitivity = Sensitivity::of(model, linear?.hunting.frequency_hz);
    let cost = delays.residual(cycle_s).map(|delay| delay.worst_cost(sensitivity));
    let limit = if *accept_delay_error { f64::INFINITY } else { COST_REFUSED };
    let reached = value("damping_lost", None, cost, limit);
    Some(CheckMargin::new(Some(&slot.place), LimitOf::Delay, &reached))
}

/// The gain of every rig's loop where it crosses the negative real axis: the inverse of the margin.
pub(super) fn of_stability(found: &StabilityCheck) -> Vec<CheckMargin> {
    let of = |(place, found): (&str, &Stability)| {
        let reached = value("loop_gain", None, Some(1.0 / found.margin), 1.0 / LEAST_MARGIN);
        CheckMargin::new(Some(place), LimitOf::Stability, &reached)
    };
    found.rigs().map(of).collect()
}

/// What the gate before RUN judges of wear in software.
pub(super) fn of_wear(slot: &Slot, found: Option<WearFound>) -> Vec<CheckMargin> {
    let Some(WearFound { loop_gain, force_error, .. }) = found else { return Vec::new() };
    let checks = [
        value("wear_loop_gain", None, Some(loop_gain), LOOP_GAIN_MAX),
        value("wear_force_error", None, Some(force_error), FORCE_ERROR_MAX),
    ];
    let margin = |reached| CheckMargin::new(Some(&slot.place), LimitOf::Stability, reached);
    checks.iter().map(margin).collect()
}

/// The room that a run needs, of what is free on the disk (MB).
pub(super) fn of_disk(needed_bytes: u64, free_bytes: Option<u64>) -> CheckMargin {
    let needed = 1e-6 * needed_bytes as f64;
    let free = free_bytes.map_or(f64::INFINITY, |free| 1e-6 * free as f64);
    CheckMargin::new(None, LimitOf::Disk, &value("disk_space", Some("MB"), Some(needed), free))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(largest: f64, has_tripped: bool) -> Verdict {
        let reached = value("force", None, Some(largest), 10.0);
        let reached = Reached { has_tripped, ..reached };
        CheckMargin::new(None, LimitOf::Plausibility, &reached).verdict
    }

    #[test]
    fn a_fifth_of_the_limit_is_enough_and_a_spike_below_the_debounce_is_not_beyond() {
        assert_eq!(verdict(7.9, false), Verdict::Enough);
        assert_eq!(verdict(8.1, false), Verdict::Small);
        assert_eq!(verdict(12.0, false), Verdict::Small);
        assert_eq!(verdict(12.0, true), Verdict::Beyond);
    }

    #[test]
    fn a_disk_of_unknown_room_refuses_nothing() {
        let unknown = of_disk(1_000_000, None);
        assert_eq!((unknown.limit, unknown.verdict), (None, Verdict::Enough));
        assert_eq!(of_disk(1_000_000, Some(1_000_001)).verdict, Verdict::Small);
        assert_eq!(of_disk(1_000_001, Some(1_000_000)).verdict, Verdict::Beyond);
    }
}
