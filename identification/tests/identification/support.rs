//! A damper, its twin without any code of the core, and sines to record on them.

use firmware_core::damper::Nominal;
use identification::{Control, Identification, Question, identify};
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::bench_visit::{Specimen, record};
use virtual_bench::series_model::SeriesModel;

pub(crate) const NOMINAL: Nominal = Nominal {
    ce_n_s_per_m: 0.9e6,
    ke_n_per_m: 10.5e6,
    clearance_2a_m: 0.6e-3,
    f_relief_n: 14e3,
    c2_n_s_per_m: 55e3,
};

/// The same damper for the generator that shares nothing with the core.
pub(crate) const SERIES: SeriesModel = SeriesModel {
    ce_n_s_per_m: NOMINAL.ce_n_s_per_m,
    ke_n_per_m: NOMINAL.ke_n_per_m,
    clearance_2a_m: NOMINAL.clearance_2a_m,
    f_relief_n: NOMINAL.f_relief_n,
    c2_n_s_per_m: NOMINAL.c2_n_s_per_m,
};

/// Amplitude and frequency of each, mm and Hz.
pub(crate) const SINES: [(f64, f64); 6] =
    [(1.0, 3.5), (3.46, 3.5), (7.0, 3.5), (1.5, 1.2), (1.0, 8.0), (2.5, 2.5)];

pub(crate) fn sensors() -> Sensors {
    Sensors::of_range(50e3, 0.05)
}

/// Five sines to fit, one to hold out; an empirical map is asked for and changes no finding.
pub(crate) fn investigate(specimen: &dyn Specimen, sensors: &Sensors) -> Identification {
    investigate_with(&SINES, specimen, sensors)
}

pub(crate) fn investigate_with(
    sines: &[(f64, f64)],
    specimen: &dyn Specimen,
    sensors: &Sensors,
) -> Identification {
    identify(question(sines, specimen, sensors), Control::QUIET).unwrap()
}

pub(crate) fn question(
    sines: &[(f64, f64)],
    specimen: &dyn Specimen,
    sensors: &Sensors,
) -> Question {
    let mut records: Vec<_> = sines
        .iter()
        .enumerate()
        .map(|(index, (amplitude_mm, frequency_hz))| {
            let sine = Excitation::sine(amplitude_mm * 1e-3, *frequency_hz);
            let name = format!("{amplitude_mm}mm-{frequency_hz}hz");
            let test = Test::new(name, sine, 5.0_f64.max(6.0 / frequency_hz));
            record(specimen, &test, sensors, 40 + index as u64).measurement().unwrap()
        })
        .collect();
    let holdout = vec![records.pop().unwrap()];
    Question {
        train: records,
        holdout,
        datasheet: None,
        empirical: true,
        thorough: false,
        notes: Vec::new(),
    }
}

pub(crate) fn names(found: &Identification) -> Vec<&str> {
    found.result.effects.iter().map(|effect| effect.name).collect()
}
