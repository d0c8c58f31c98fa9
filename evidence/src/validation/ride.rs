//! Sperling index on pure sines, and EN 12299's weightings against published factors.
//!
//! A sine of amplitude `A` on a line of the window's Fourier series has the index `3.57 (A^3 F(f) /
//! f)^(1/10)` ([`vehicle_studies::ride::sperling`]); `F` is written out here once more. The
//! weightings Wb and Wd ([`vehicle_studies::ride::Weighting`]) are tabulated as factors in third
//! octaves, at nominal frequencies in ISO 2631-1 and at true ones in ISO 8041-1.

use super::check::{Check, Reference};
use crate::error::EvidenceError;
use report::Plot;
use signal::statistics;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use vehicle_studies::ride::Weighting;
use vehicle_studies::ride::sperling::{Direction, WINDOW_1985_S, WINDOW_2019_S, index};

const RATE_HZ: f64 = 1000.0;
/// Amplitude of the sines (m/s2).
const AMPLITUDE: f64 = 0.3;

/// ISO 2631-1:1997, table 3: nominal third octave (Hz), and Wd in thousandths. At 10 Hz the table
/// has 212, a misprint that its neighbours and its formula show; it is left out.
const WD: [(f64, f64); 30] = [
    (0.1, 62.4),
    (0.125, 97.3),
    (0.16, 158.0),
    (0.2, 243.0),
    (0.25, 365.0),
    (0.315, 530.0),
    (0.4, 713.0),
    (0.5, 853.0),
    (0.63, 944.0),
    (0.8, 992.0),
    (1.0, 1011.0),
    (1.25, 1008.0),
    (1.6, 968.0),
    (2.0, 890.0),
    (2.5, 776.0),
    (3.15, 642.0),
    (4.0, 512.0),
    (5.0, 409.0),
    (6.3, 323.0),
    (8.0, 253.0),
    (12.5, 161.0),
    (16.0, 125.0),
    (20.0, 100.0),
    (25.0, 80.0),
    (31.5, 63.2),
    (40.0, 49.4),
    (50.0, 38.8),
    (63.0, 29.5),
    (80.0, 21.1),
    (100.0, 14.1),
];
/// ISO 8041-1:2017, table B.1: true third octave, `10^(n/10)` Hz, and Wb with four digits.
const WB: [(i32, f64); 3] = [(0, 0.3853), (8, 1.054), (20, 0.1154)];

/// The comparison.
///
/// # Errors
/// A signal that cannot be assessed.
pub(super) fn reference(_stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let mut checks = sines()?;
    checks.extend(factors());
    checks.extend(weighted_sines()?);
    Ok(Reference {
        name: "ride",
        title: "Sperling index and ride weightings",
        what: "The index of sines on lines of the window, both editions' windows, both directions, in every \
               piece of the frequency factor; factors of Wd in 30 third octaves and of Wb in three; and both \
               weightings on sines in the time domain."
            .to_owned(),
        source: "Sperling: GB/T 5599-2019, annex E. Wd: ISO 2631-1:1997, table 3; Wb: ISO 8041-1:2017, table \
                 B.1 (the weightings of EN 12299), as quoted in the open library phonometry.",
        tolerance: "Sines on a line: 1e-9, rounding. Factors: half a printed digit. Sines in the time domain: \
                    2e-3, the error in the middle of the record from fading a weighting in and out."
            .to_owned(),
        limits: vec![
            "A sine between two lines reads up to 4 % low: no window is applied, as the standards \
             specify none."
                .to_owned(),
            "Wd at 10 Hz, a misprint of the table, and the other third octaves of Wb are not \
             compared: only three published factors of Wb were available."
                .to_owned(),
        ],
        checks,
        plots: vec![plot()],
    })
}

fn third_octave_hz(number: i32) -> f64 {
    libm::pow(10.0, f64::from(number) / 10.0)
}

fn sine(amplitude: f64, hz: f64, seconds: f64) -> Vec<f64> {
    let count = libm::round(seconds * RATE_HZ) as u32;
    (0..count).map(|n| amplitude * libm::sin(TAU * hz * f64::from(n) / RATE_HZ)).collect()
}

fn sines() -> Result<Vec<Check>, EvidenceError> {
    // Frequency, vertical and lateral factor; in 5 s lines are 0.2 Hz apart.
    let factors = [
        (1.0, 0.325, 0.8),
        (3.4, 0.325 * 3.4 * 3.4, 0.8 * 3.4 * 3.4),
        (5.6, 0.325 * 5.6 * 5.6, 650.0 / (5.6 * 5.6)),
        (12.0, 400.0 / 144.0, 650.0 / 144.0),
        (22.0, 1.0, 650.0 / 484.0),
        (35.0, 1.0, 1.0),
    ];
    let mut checks = Vec::new();
    for (hz, vertical, lateral) in factors {
        for (direction, factor) in [(Direction::Vertical, vertical), (Direction::Lateral, lateral)]
        {
            let expected = 3.57 * libm::pow(AMPLITUDE * AMPLITUDE * AMPLITUDE * factor / hz, 0.1);
            for window_s in [WINDOW_2019_S, WINDOW_1985_S] {
                let ours = index(&sine(AMPLITUDE, hz, window_s), RATE_HZ, direction)?;
                let at = format!("{hz} Hz, window {window_s} s");
                let quantity = format!("Sperling index, {}", direction.name());
                checks.push(Check::near(&quantity, &at, [expected, ours], 1e-9));
            }
        }
    }
    Ok(checks)
}

fn factors() -> Vec<Check> {
    let mut checks = Vec::new();
    for (hz, thousandths) in WD {
        // Below 100 the table has tenths of a thousandth.
        let digit = if thousandths < 100.0 { 0.1e-3 } else { 1e-3 };
        let values = [1e-3 * thousandths, Weighting::WD.response(hz).norm()];
        checks.push(Check::near("Wd", &format!("{hz} Hz"), values, 0.5 * digit));
    }
    for (number, factor) in WB {
        let hz = third_octave_hz(number);
        let digit = if factor > 1.0 { 1e-3 } else { 1e-4 };
        let values = [factor, Weighting::WB.response(hz).norm()];
        checks.push(Check::near("Wb", &format!("{hz:.3} Hz"), values, 0.5 * digit));
    }
    checks
}

/// A sine through the weighting against the factor of its frequency.
fn weighted_sines() -> Result<Vec<Check>, EvidenceError> {
    let mut checks = Vec::new();
    for (name, weighting) in [("Wb", Weighting::WB), ("Wd", Weighting::WD)] {
        for hz in [0.8, 2.0, 3.5, 8.0, 20.0] {
            let weighted = weighting.apply(&sine(1.0, hz, 30.0), RATE_HZ)?;
            let rms = statistics::rms(weighted.get(10_000..25_000).unwrap_or_default());
            let values = [weighting.response(hz).norm(), f64::sqrt(2.0) * rms];
            let quantity = format!("{name}, sine in the time domain");
            checks.push(Check::within(&quantity, &format!("{hz} Hz"), values, 2e-3));
        }
    }
    Ok(checks)
}

fn plot() -> Plot {
    let fine: Vec<f64> = (-50..=100).map(|n| libm::pow(10.0, f64::from(n) / 50.0)).collect();
    let ours = |weighting: Weighting| -> Vec<f64> {
        fine.iter().map(|hz| weighting.response(*hz).norm()).collect()
    };
    let (wd_hz, wd): (Vec<f64>, Vec<f64>) =
        WD.iter().map(|(hz, thousandths)| (*hz, 1e-3 * thousandths)).unzip();
    let (wb_hz, wb): (Vec<f64>, Vec<f64>) =
        WB.iter().map(|(number, factor)| (third_octave_hz(*number), *factor)).unzip();
    Plot::new("Weightings of EN 12299")
        .x("frequency", "Hz")
        .y("factor", "")
        .log_x()
        .log_y()
        .line("Wb, ours", &fine, &ours(Weighting::WB))
        .line("Wd, ours", &fine, &ours(Weighting::WD))
        .scatter("Wb, published", &wb_hz, &wb)
        .scatter("Wd, published", &wd_hz, &wd)
}
