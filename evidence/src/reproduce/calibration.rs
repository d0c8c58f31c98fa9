//! The three numbers that are public nowhere, each found on the one critical speed that fixes it.
//!
//! | number | fixed on | as |
//! | --- | --- | --- |
//! | conicity of small motions of the JM3-like wheel | 212 km/h at Ke = 3 MN/m | a soft damper does not open its relief before the vehicle hunts |
//! | its conicity of large motions | 170 km/h at 2a = 8 mm | with its dampers inside their clearance the vehicle depends on its wheels alone |
//! | relief force | 250 km/h at Ke = 12.5 MN/m, 2a = 0.2 mm | the cycle is as large as the relieved damper lets it |
//!
//! One after the other, twice, since each moves the others a little. A number stays inside the
//! range that the reduced model found possible; where the speed is not met inside, it is at the end
//! of the range, and that is stated. Three numbers on three speeds: calibration, and no test of
//! anything.

use super::basis::Basis;
use super::locomotive::Locomotive;
use super::null_models::CALIBRATED_ON;
use crate::error::EvidenceError;
use scenario::setting::Setting;
use serde::Serialize;
use vehicle_studies::critical_speed::Ascent;
use vehicle_studies::critical_speed::{Critical, Procedure};

/// How closely a speed is met (km/h).
const RESOLUTION_KMH: f64 = 0.5;
/// Speeds are tried this far around the aim (km/h).
const NEAR_KMH: f64 = 60.0;
/// How often all numbers are found again.
const ROUNDS: usize = 2;
/// Values that are tried for one number, at most.
const TRIES: usize = 8;

/// A number to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    /// Its key in scenario or vehicle.
    pub key: &'static str,
    /// Where it may lie.
    pub range: [f64; 2],
    /// Which of `CALIBRATED_ON` fixes it.
    pub fixed_on: usize,
}

/// What is found, in this order. Ranges: those of the reduced model's good sets.
pub const UNKNOWNS: [Unknown; 3] = [
    Unknown {
        key: "vehicle.wheel_rail.surface.profiles.jm3_like.small_amplitude_conicity",
        range: [0.18, 0.27],
        fixed_on: 0,
    },
    Unknown {
        key: "vehicle.wheel_rail.surface.profiles.jm3_like.large_amplitude_conicity",
        range: [0.30, 0.50],
        fixed_on: 2,
    },
    Unknown { key: "damper.f_relief_n", range: [8e3, 25e3], fixed_on: 1 },
];

/// A number that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibrated {
    /// Its key.
    pub key: &'static str,
    /// Its value, in the unit at the end of the key.
    pub value: f64,
    /// The speed it was to give (km/h).
    pub aim_kmh: f64,
    /// The speed it gives, with the other numbers as they then were (km/h).
    pub reached_kmh: Option<f64>,
    /// It is at the end of its range.
    pub at_end_of_range: bool,
}

/// Finds the numbers; `see` gets every value that is tried, with its speed. Once the flag of
/// the basis is set, what was found before is returned.
///
/// # Errors
/// A scenario that cannot run, or whose files change in the meantime.
pub fn calibrate(
    basis: &Basis<'_>,
    see: &dyn Fn(&str, f64, Option<f64>),
) -> Result<Vec<Calibrated>, EvidenceError> {
    let mut found: Vec<Calibrated> = Vec::new();
    for round in 0..ROUNDS {
        for (index, unknown) in UNKNOWNS.iter().enumerate() {
            let others: Vec<Setting> = found
                .iter()
                .filter(|other| other.key != unknown.key)
                .map(|other| Setting::to(other.key, other.value))
                .collect();
            let calibrated = match one(basis, unknown, &others, see) {
                Err(EvidenceError::Stopped) => return Ok(found),
                other => other?,
            };
            basis.refuse_changed()?;
            if round == 0 {
                found.push(calibrated);
            } else {
                found[index] = calibrated;
            }
        }
    }
    Ok(found)
}

fn one(
    basis: &Basis<'_>,
    unknown: &Unknown,
    others: &[Setting],
    see: &dyn Fn(&str, f64, Option<f64>),
) -> Result<Calibrated, EvidenceError> {
    debug_assert!(unknown.fixed_on < CALIBRATED_ON.len() && unknown.range[0] < unknown.range[1]);
    let (ke_n_per_m, clearance_2a_m, aim_kmh) = CALIBRATED_ON[unknown.fixed_on];
    let near = Procedure {
        from_kmh: aim_kmh - NEAR_KMH,
        to_kmh: aim_kmh + NEAR_KMH,
        ..basis.procedure.clone()
    };
    // How far off the aim, and the speed; beyond the range of speeds the error is that of its end.
    let tried = |value: f64| -> Result<(f64, Option<f64>), EvidenceError> {
        EvidenceError::check(basis.stop)?;
        let mut changes = others.to_vec();
        changes.push(Setting::to(unknown.key, value));
        let locomotive = Locomotive::load(basis.scenario, &changes)?;
        let equipped = locomotive.with(ke_n_per_m, clearance_2a_m).until(basis.stop);
        let ascent = Ascent::of(&equipped, &near)?;
        see(unknown.key, value, ascent.mean_kmh);
        let clipped = ascent.seeds.iter().map(|on| match on.critical {
            Critical::At(kmh) | Critical::Below(kmh) | Critical::Above(kmh) => kmh,
        });
        let mean_kmh = signal::statistics::mean(&clipped.collect::<Vec<_>>());
        Ok((mean_kmh - aim_kmh, ascent.mean_kmh))
    };
    let [low, high] = unknown.range;
    let calibrated = |value: f64, reached_kmh: Option<f64>| Calibrated {
        key: unknown.key,
        value,
        aim_kmh,
        reached_kmh,
        at_end_of_range: value == low || value == high,
    };
    let ((mut below, at_low), (mut above, at_high)) = (tried(low)?, tried(high)?);
    if below * above > 0.0 {
        let nearer = if below.abs() <= above.abs() { (low, at_low) } else { (high, at_high) };
        return Ok(calibrated(nearer.0, nearer.1));
    }
    let (mut left, mut right) = (low, high);
    let mut best = calibrated(low, at_low);
    for _ in 0..TRIES {
        // False position, kept off the ends so that it does not creep.
        let share = (below / (below - above)).clamp(0.1, 0.9);
        let value = left + share * (right - left);
        let (off, kmh) = tried(value)?;
        best = calibrated(value, kmh);
        if off.abs() <= RESOLUTION_KMH {
            break;
        }
        if off * below > 0.0 {
            (left, below) = (value, off);
        } else {
            (right, above) = (value, off);
        }
    }
    Ok(best)
}
