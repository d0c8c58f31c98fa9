//! Spectra of accelerations and strokes.

use super::traces::spectrum;
use crate::columns::Columns;
use crate::summary::SEGMENT_S;
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Plot, Section};
use scenario::run::Run;

pub(super) fn spectra(run: &Run, columns: &Columns, first: usize) -> Section {
    let mut lateral = Plot::new("Lateral acceleration")
        .x("frequency", "Hz")
        .y("power spectral density", "(m/s²)²/Hz")
        .log_x()
        .log_y();
    for (name, index) in [("wheelset 1", 4), ("bogie, front", 2), ("carbody", 0)] {
        let (frequency, density) = spectrum(&columns.acceleration[index][first..]);
        lateral = lateral.line(name, &frequency, &density);
    }
    let mut strokes = Plot::new("Damper stroke")
        .x("frequency", "Hz")
        .y("power spectral density", "m²/Hz")
        .log_x()
        .log_y();
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let (frequency, density) = spectrum(&columns.extension_m[slot][first..]);
        strokes = strokes.line(&place.place, &frequency, &density);
    }
    Section::new("Spectra")
        .text(&format!("Welch's method, Hann window, segments of {SEGMENT_S} s with half overlap."))
        .plot(lateral)
        .plot(strokes)
}
