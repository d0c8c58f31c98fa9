//! Spectra of accelerations and strokes.

use super::traces::spectrum;
use crate::statistics::{SEGMENT_S, SPECTRA_OF, Sums};
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Plot, Section};
use scenario::run::Run;

pub(super) fn spectra(run: &Run, shown: &Sums) -> Section {
    let mut lateral = Plot::new("Lateral acceleration")
        .x("frequency", "Hz")
        .y("power spectral density", "(m/s²)²/Hz")
        .log_x()
        .log_y();
    debug_assert_eq!(SPECTRA_OF, [4, 2, 0], "spectra of other bodies");
    for (name, welch) in ["wheelset 1", "bogie, front", "carbody"].into_iter().zip(&shown.spectra) {
        let (frequency, density) = spectrum(welch);
        lateral = lateral.line(name, &frequency, &density);
    }
    let mut strokes = Plot::new("Damper stroke")
        .x("frequency", "Hz")
        .y("power spectral density", "m²/Hz")
        .log_x()
        .log_y();
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let (frequency, density) = spectrum(&shown.slots[slot].spectrum);
        strokes = strokes.line(&place.place, &frequency, &density);
    }
    Section::new("Spectra")
        .text(&format!("Welch's method, Hann window, segments of {SEGMENT_S} s with half overlap."))
        .plot(lateral)
        .plot(strokes)
}
