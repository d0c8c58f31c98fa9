//! Generated track against the spectra of the SS9 study, its equations (1) and (2).
//!
//! ```text
//! Sv = Sa = 5.7613e-3 / (W^2 (W^2 + 0.6798))               cm2/(rad/m)
//! Sc = Sg = 2.3045e-2 / ((W^2 + 0.6798) (W^2 + 0.1918))    cm2/(rad/m)
//! ```
//! one-sided, `W` in rad/m. A long track is made, its density found by Welch's method and summed
//! band by band; what a band should hold is the integral of the equations by Simpson's rule, apart
//! from the closed integrals that the generator works with. Those are held to the same rule.

use super::check::{Check, Reference};
use crate::error::EvidenceError;
use firmware_core::track::IrregularitySample;
use report::Plot;
use scenario::irregularity::{
    Band, FADE_IN_M, PERFECT_M, SAMPLE_STEP_M, aar6_until, cross_variance_m2, vertical_variance_m2,
};
use signal::spectrum::Spectrum;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

/// Length of the track (m).
const LENGTH_M: f64 = 120e3;
/// Length of the segments of the spectrum (m): lines 1e-4 cycles/m apart.
const SEGMENT_M: f64 = 10e3;
/// The generator's band.
const BAND: Band = Band { seed: 1, shortest: 1.0, longest: 100.0, scale: 1.0 };
/// Bands of equal ratio that are compared.
const BANDS: usize = 12;
/// Cosines of the generator over its band.
const COSINES: f64 = 600.0;

/// A channel: name, how to read it, its equation (m2/(rad/m)) and the generator's closed integral.
type Channel = (&'static str, fn(&IrregularitySample) -> f64, fn(f64) -> f64, fn(f64, f64) -> f64);

const CHANNELS: [Channel; 4] = [
    ("vertical", |s| s.vertical_m, equation_1, vertical_variance_m2),
    ("alignment", |s| s.alignment_m, equation_1, vertical_variance_m2),
    ("cross level", |s| s.cross_level_m, equation_2, cross_variance_m2),
    ("gauge", |s| s.gauge_m, equation_2, cross_variance_m2),
];

fn equation_1(w: f64) -> f64 {
    1e-4 * 5.7613e-3 / (w * w * (w * w + 0.6798))
}

fn equation_2(w: f64) -> f64 {
    1e-4 * 2.3045e-2 / ((w * w + 0.6798) * (w * w + 0.1918))
}

/// The comparison.
///
/// # Errors
/// A spectrum that cannot be formed.
pub(super) fn reference(stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let track = aar6_until(stop, &BAND, 0.0, LENGTH_M).ok_or(EvidenceError::Stopped)?;
    let begin = ((PERFECT_M + FADE_IN_M) / SAMPLE_STEP_M) as usize + 1;
    let (mut checks, mut plots) = (Vec::new(), Vec::new());
    for (name, read, equation, closed) in CHANNELS {
        EvidenceError::check(stop)?;
        let values: Vec<f64> = track.samples[begin..].iter().map(read).collect();
        let spectrum = Spectrum::welch(&values, 1.0 / SAMPLE_STEP_M, SEGMENT_M)?;
        checks.extend(bands(name, &spectrum, equation));
        let (low, high) = (TAU / BAND.longest, TAU / BAND.shortest);
        let whole = simpson(equation, low, high);
        let variance = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        let at = "1 to 100 m";
        let quantity = format!("variance, {name}");
        let beats = beats(COSINES, low / TAU);
        checks.push(Check::within(&quantity, at, [whole, variance], beats).unit("m2"));
        let quantity = format!("closed integral, {name}");
        checks.push(Check::within(&quantity, at, [whole, closed(low, high)], 1e-8).unit("m2"));
        plots.push(plot(name, &spectrum, equation));
    }
    Ok(Reference {
        name: "irregularity",
        title: "Track irregularity, American class 6",
        what: format!(
            "{} km of track by the generator, seed {}, wavelengths 1 to 100 m: variance in {BANDS} bands of \
             equal ratio, all four channels, the whole variance, and the closed integral behind it.",
            LENGTH_M / 1e3,
            BAND.seed
        ),
        source: "Equations (1) and (2) of \"A locomotive's dynamic response to in-service parameter \
                 variations of its hydraulic yaw damper\", Nonlinear Dynamics (2014).",
        tolerance: "The amplitudes of the cosines are exact, so a band has two sources of error \
                    only. Its edges: a line of the spectrum (1e-4 cycles/m) at each may be counted \
                    on the other side. And beats: neighbouring cosines, df apart, average out over \
                    the length L only to 1/(pi df L), with random signs over the N of a band; \
                    three times 1/(pi df L sqrt N). Closed integral: 1e-8, the accuracy of the \
                    rule."
            .to_owned(),
        limits: vec![
            "The generator draws only phases at random; the amplitudes of a real track are random \
             too."
                .to_owned(),
        ],
        checks,
        plots,
    })
}

/// Three times the error of variance from beats of `count` cosines, the lowest at a frequency
/// (cycles/m).
fn beats(count: f64, lowest: f64) -> f64 {
    let ratio = libm::pow(BAND.longest / BAND.shortest, 1.0 / COSINES);
    3.0 / (0.5 * TAU * lowest * (ratio - 1.0) * LENGTH_M * count.sqrt())
}

fn bands(name: &str, spectrum: &Spectrum, equation: fn(f64) -> f64) -> Vec<Check> {
    let edge = |index: usize| {
        let share = index as f64 / BANDS as f64;
        libm::pow(BAND.longest / BAND.shortest, share) / BAND.longest
    };
    let quantity = format!("variance in bands, {name}");
    let line = spectrum.resolution_hz;
    let check = |index: usize| {
        let (low, high) = (edge(index), edge(index + 1));
        let expected = simpson(equation, TAU * low, TAU * high);
        let inside = |f: f64| f >= low - 0.5 * line && f < high - 0.5 * line;
        let ours: f64 =
            spectrum.lines().filter(|(f, _)| inside(*f)).map(|(_, density)| density * line).sum();
        let edges = TAU * line * (equation(TAU * low) + equation(TAU * high)) / expected;
        let share = edges + beats(COSINES / BANDS as f64, low);
        let at = format!("{:.1} to {:.1} m", 1.0 / high, 1.0 / low);
        Check::within(&quantity, &at, [expected, ours], share).unit("m2")
    };
    (0..BANDS).map(check).collect()
}

/// Integral over spatial frequency (rad/m) in logarithmic steps.
fn simpson(density: fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const STEPS: u32 = 2000;
    let width = libm::log(to / from) / f64::from(STEPS);
    let value = |step: u32| {
        let w = from * libm::exp(width * f64::from(step));
        let weight = if step == 0 || step == STEPS { 1.0 } else { f64::from(2 + 2 * (step % 2)) };
        weight * w * density(w)
    };
    (0..=STEPS).map(value).sum::<f64>() * width / 3.0
}

fn plot(name: &str, spectrum: &Spectrum, equation: fn(f64) -> f64) -> Plot {
    // Means over fiftieths of a decade: single lines scatter with the phases that fall on them.
    let mut means: Vec<(f64, f64, f64)> = Vec::new();
    let mut last = i64::MIN;
    for (f, density) in spectrum.lines().filter(|(f, _)| *f > 0.008 && *f < 1.3) {
        let bin = libm::floor(libm::log10(f) * 50.0) as i64;
        if bin != last {
            means.push((0.0, 0.0, 0.0));
            last = bin;
        }
        if let Some((sum_f, sum, count)) = means.last_mut() {
            *sum_f += f;
            *sum += density;
            *count += 1.0;
        }
    }
    let f: Vec<f64> = means.iter().map(|(sum, _, count)| sum / count).collect();
    let ours: Vec<f64> = means.iter().map(|(_, sum, count)| 1e6 * sum / count).collect();
    let theirs: Vec<f64> = f.iter().map(|f| 1e6 * TAU * equation(TAU * f)).collect();
    let top = theirs.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    Plot::new(&format!("Spectrum, {name}"))
        .x("spatial frequency", "1/m")
        .y("density", "mm2 m")
        .log_x()
        .log_y()
        .y_range(1e-6 * top..=3.0 * top)
        .line("generated", &f, &ours)
        .dashed("equation", &f, &theirs)
        .height_px(280)
}
