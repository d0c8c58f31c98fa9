//! Figure 6 and conclusion (4): from a physical damper over its estimated parameters to the
//! locomotive.
//!
//! The study does not put its full damper model into the vehicle: it estimates Ce, Ke, 2a and
//! relief from it and gives these to the locomotive. Here a hydraulic damper of the class visits a
//! virtual bench at several oil temperatures and shares of free air, the nominal damper is fitted
//! to the records as `identify` does it, and critical speeds follow. The study says that neither
//! matters much in normal running.
//!
//! Limits: the physical damper is illustrative, not a product; every fit states its residual force.

use super::basis::Basis;
use super::row::{Figure, Row};
use crate::error::EvidenceError;
use firmware_core::damper::Nominal;
use identification::{Control, TestSet, nominal_fit};
use rayon::prelude::*;
use report::Plot;
use scenario::source::Source;
use std::path::Path;
use vehicle_studies::critical_speed::Ascent;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::bench_visit::{RawRecord, measurements, protocol, record_from};
use virtual_bench::hydraulic::HydraulicDamper;

/// Oil temperature (degrees Celsius) and share of free air at one bar: from cold to hot at the
/// usual share, then over the share at the usual temperature.
const OIL: [(f64, f64); 6] =
    [(0.0, 0.005), (20.0, 0.005), (40.0, 0.005), (60.0, 0.005), (40.0, 0.015), (40.0, 0.03)];
/// Sampling of the virtual bench (Hz).
const RATE_HZ: f64 = 1000.0;
const SEED: u64 = 1;

/// A physical damper in the terms of the study.
struct Estimated {
    degc: f64,
    air_share: f64,
    nominal: Nominal,
    /// Residual force of the nominal damper, as a share of the force.
    left: f64,
    critical_kmh: Option<f64>,
    range: String,
}

/// The physical damper at several temperatures and air shares.
///
/// # Errors
/// No damper follows the records, or the vehicle does not run steadily.
pub(super) fn temperature_and_air(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let found: Result<Vec<Estimated>, EvidenceError> =
        OIL.par_iter().map(|(degc, air_share)| estimated(basis, *degc, *air_share)).collect();
    let found = found?;
    let mut rows: Vec<Row> = found.iter().flat_map(rows_of).collect();
    let speeds: Option<Vec<f64>> = found.iter().map(|found| found.critical_kmh).collect();
    let spread = speeds.and_then(|speeds| signal::statistics::min_max(&speeds));
    let percent = spread.map(|(low, high)| 100.0 * (high / low - 1.0));
    rows.push(Row::new("6", "critical_speed_change_over_oil", [], "%", percent).note(
        "greatest minus smallest, relative to the smallest; the study: not obvious, limited",
    ));
    let of = |pick: fn(&Estimated) -> f64| -> (Vec<f64>, Vec<f64>) {
        let usual = found.iter().filter(|found| found.air_share == OIL[0].1);
        usual.map(|found| (found.degc, pick(found))).unzip()
    };
    let (degc, speed) = of(|found| found.critical_kmh.unwrap_or(f64::NAN));
    Ok(Figure {
        number: "6",
        title: "Physical damper, estimated parameters, locomotive: oil temperature and entrained air",
        said: "oil temperature and entrained air act through Ce and Ke; in normal running they have no obvious effect \
               on the critical speed",
        plots: vec![
            Plot::new("Critical speed over oil temperature, 0.5 % of air")
                .x("oil temperature", "degC")
                .y("critical speed", "km/h")
                .points("hunts from", &degc, &speed),
        ],
        rows,
        remarks: vec![
            "The hydraulic damper is illustrative (scenarios/dampers/hydraulic-yaw-damper.toml), \
             not a product."
                .to_owned(),
        ],
        ..Figure::default()
    })
}

fn estimated(basis: &Basis<'_>, degc: f64, air_share: f64) -> Result<Estimated, EvidenceError> {
    let text = include_str!("../../../scenarios/dampers/hydraulic-yaw-damper.toml");
    let source = Source::from_text(Path::new("hydraulic-yaw-damper.toml"), text);
    let mut damper = HydraulicDamper::from_source(&source)?;
    damper.oil.air_share = air_share;
    let sensors = Sensors::exact(RATE_HZ);
    let tests = protocol::short();
    let fitted = tests.iter().filter(|test| !test.test_only);
    let record = |test: &Test| -> Result<RawRecord, EvidenceError> {
        EvidenceError::check(basis.stop)?;
        Ok(record_from(&damper, test, &sensors, SEED, degc))
    };
    let records: Result<Vec<RawRecord>, EvidenceError> = fitted.map(record).collect();
    let tests = TestSet::new(measurements(&records?)?);
    let control = Control { stop: basis.stop, ..Control::QUIET };
    let fit = nominal_fit(&tests, None, control);
    EvidenceError::check(basis.stop)?;
    let fit = fit.ok_or(EvidenceError::NoFit("follows the physical one"))?.fit;
    let fitted =
        fit.model.damper(&fit.values).ok_or(EvidenceError::NoFit("has the fitted values"))?;
    let nominal = *fitted.nominal();
    let equipped = basis.locomotive.with_dampers(nominal).until(basis.stop);
    let ascent = Ascent::of(&equipped, basis.procedure)?;
    Ok(Estimated {
        degc,
        air_share,
        nominal,
        left: fit.rms_n(&tests) / tests.rms_force_n(),
        critical_kmh: ascent.mean_kmh,
        range: ascent.range(),
    })
}

fn rows_of(found: &Estimated) -> Vec<Row> {
    let at = || [("oil_degc", found.degc), ("air_share_at_one_bar", found.air_share)];
    let row = |quantity, unit, value| Row::new("6", quantity, at(), unit, Some(value));
    let left =
        format!("the residual of the nominal damper is {:.1} % of the force", 100.0 * found.left);
    vec![
        row("ce", "kN s/m", 1e-3 * found.nominal.ce_n_s_per_m).note(left),
        row("ke", "MN/m", 1e-6 * found.nominal.ke_n_per_m),
        row("clearance_2a", "mm", 1e3 * found.nominal.clearance_2a_m),
        row("f_relief", "kN", 1e-3 * found.nominal.f_relief_n),
        Row::new("6", "critical_speed", at(), "km/h", found.critical_kmh)
            .note(format!("{} over seeds", found.range)),
    ]
}
