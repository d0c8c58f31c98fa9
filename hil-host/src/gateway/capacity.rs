//! What a signal can hold: codes, quantities, and the limits of the rig.
//!
//! A code is one raw number. Where "armed" and "stopped" were the same one after scaling, rounding
//! and limits, a rig that is to stop would stay armed. A quantity that its signal cuts, or rounds
//! to nothing, is of no use either: the least ranges and largest steps are in [`Dimension::least`].
//! They only sort out what cannot be meant, and do not say that a resolution is good enough for a
//! test.

use super::error::GatewayError;
use super::key::MapKey;
use super::look_up::Found;
use super::map::LimitsMap;
use super::unit::{Dimension, Least};
use files::number;
use scenario::run::CYCLE_S;
use scenario::source::Source;

/// Longest time-out that a rig may have (s).
const MOST_TIME_OUT_S: f64 = 1.0;

/// Part of a step by which a code may miss a value of its signal: its author's digits.
const CODE_TOLERANCE: f64 = 1e-3;

/// Relative error of a calculation.
const ROUNDING: f64 = 1e-9;

/// The raw number of a code, which has to be one of the values of its signal.
pub(super) fn code(map: &Source, found: &Found, value: f64) -> Result<u64, GatewayError> {
    let raw = raw(map, found, value)?;
    let step = found.signal.resolution();
    // A float has no steps, and as many digits as it likes.
    let tolerance = if step > 0.0 { CODE_TOLERANCE * step } else { 1e-6 * value.abs() };
    if (found.signal.value_of(raw) - value).abs() <= tolerance {
        Ok(raw)
    } else {
        Err(found.key.refuse(map, number(value).to_string(), values(found)))
    }
}

/// The raw numbers of two codes with different meanings.
pub(super) fn codes(
    map: &Source,
    found: &Found,
    named: [(&str, f64); 2],
) -> Result<[u64; 2], GatewayError> {
    let [(one, one_value), (other, other_value)] = named;
    let raw = [code(map, found, one_value)?, code(map, found, other_value)?];
    if raw[0] == raw[1] {
        let said = format!("{} for {one} and {other}", number(one_value));
        return Err(found.key.refuse(map, said, "two values"));
    }
    Ok(raw)
}

/// The raw number nearest to a constant value.
pub(super) fn raw(map: &Source, found: &Found, value: f64) -> Result<u64, GatewayError> {
    let refused = || found.key.refuse(map, number(value).to_string(), values(found));
    found.signal.raw_of(value).ok_or_else(refused)
}

/// The values of a signal in its own unit, in words.
fn values(found: &Found) -> String {
    let (low, high) = found.signal.range();
    let step = match found.signal.resolution() {
        0.0 => String::new(),
        step => format!(" in steps of {}", number(step)),
    };
    format!("a value of {}: {} to {}{step}", found.name, number(low), number(high))
}

/// Refuses a signal that does not hold the least range of its dimension, or only in coarse steps.
pub(super) fn useful(
    map: &Source,
    found: &Found,
    dimension: Dimension,
) -> Result<(), GatewayError> {
    let Least { low, high, step } = dimension.least();
    let holds = |value: f64| {
        let raw = found.signal.raw_of(value / found.scale);
        raw.is_some_and(|raw| (found.signal.value_of(raw) * found.scale - value).abs() <= step)
    };
    let own_step = found.signal.resolution() * found.scale.abs();
    if holds(low) && holds(high) && own_step <= step * (1.0 + ROUNDING) {
        return Ok(());
    }
    let (unit, (own_low, own_high)) = (dimension.si_unit(), si_range(found));
    let said = format!(
        "{} with {} to {} {unit} in steps of {} {unit}",
        found.name,
        number(own_low),
        number(own_high),
        number(own_step)
    );
    let expected = format!(
        "at least {} to {} {unit} in steps of at most {} {unit}",
        number(low),
        number(high),
        number(step)
    );
    Err(found.key.refuse(map, said, expected))
}

/// The range of a signal in SI units.
fn si_range(found: &Found) -> (f64, f64) {
    let (low, high) = found.signal.range();
    let (one, other) = (low * found.scale, high * found.scale);
    (one.min(other), one.max(other))
}

/// Signals that bound the limits of the rig.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds<'a> {
    pub(super) displacements: [&'a Found; 2],
    pub(super) velocity: Option<&'a Found>,
    pub(super) force: &'a Found,
}

/// Refuses limits that no rig has, or that lie beyond what the signals hold: every command up to
/// them would be cut, and every measurement be invalid.
pub(super) fn limits(
    map: &Source,
    limits: &LimitsMap,
    bounds: Bounds<'_>,
) -> Result<(), GatewayError> {
    let [commanded, measured] = bounds.displacements;
    let stroke = [Some(commanded), Some(measured)];
    let all = [
        ("stroke_m", limits.stroke_m, (1e-3, 10.0), stroke),
        ("velocity_m_per_s", limits.velocity_m_per_s, (0.01, 100.0), [bounds.velocity, None]),
        ("acceleration_m_per_s2", limits.acceleration_m_per_s2, (0.1, 1e4), [None, None]),
        ("force_n", limits.force_n, (100.0, 1e7), [Some(bounds.force), None]),
    ];
    for (name, limit, (least, most), signals) in all {
        let Some(limit) = limit else { continue };
        let key = MapKey::new("limits", name);
        if !(least..=most).contains(&limit) {
            let expected = format!("{} to {}", number(least), number(most));
            return Err(key.refuse(map, number(limit).to_string(), expected));
        }
        for found in signals.into_iter().flatten() {
            let (low, high) = si_range(found);
            let held = high.min(-low);
            if limit > held * (1.0 + ROUNDING) {
                let expected = format!(
                    "at most {}, which {} holds to either side ({})",
                    number(held),
                    found.name,
                    found.key
                );
                return Err(key.refuse(map, number(limit).to_string(), expected));
            }
        }
    }
    Ok(())
}

/// The declared time-out of the rig (s).
pub(super) fn time_out_s(map: &Source, declared: Option<f64>) -> Result<Option<f64>, GatewayError> {
    match declared {
        Some(time_s) if !(CYCLE_S..=MOST_TIME_OUT_S).contains(&time_s) => {
            let found = format!("{} s", number(time_s));
            let expected = format!("one cycle ({CYCLE_S} s) to {MOST_TIME_OUT_S} s");
            Err(MapKey::new("status", "timeout_s").refuse(map, found, expected))
        }
        declared => Ok(declared),
    }
}
