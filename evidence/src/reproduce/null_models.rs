//! What a critical speed would be without any model of a locomotive.
//!
//! An error says little alone: over the study's range a constant is right within a quarter. Two
//! null models are compared with ours, both made from nothing but the speeds that ours was
//! calibrated on: their mean, and straight lines through them, over stiffness at the small
//! clearance and over clearance at the good stiffness.

use super::locomotive::{CLEARANCE_2A_M, KE_N_PER_M};

/// Critical speeds that the model is calibrated on: stiffness (N/m), clearance 2a (m), speed
/// (km/h).
pub(super) const CALIBRATED_ON: [(f64, f64, f64); 3] =
    [(3e6, CLEARANCE_2A_M, 212.0), (KE_N_PER_M, CLEARANCE_2A_M, 250.0), (KE_N_PER_M, 8e-3, 170.0)];

/// The mean of the calibrated speeds (km/h).
pub(super) fn constant_kmh() -> f64 {
    CALIBRATED_ON.iter().map(|(_, _, kmh)| kmh).sum::<f64>() / CALIBRATED_ON.len() as f64
}

/// The plane through the calibrated speeds (km/h): a line over stiffness and one over clearance.
pub(super) fn line_kmh(ke_n_per_m: f64, clearance_2a_m: f64) -> f64 {
    let [soft, good, worn] = CALIBRATED_ON;
    let over_stiffness = (good.2 - soft.2) / (good.0 - soft.0);
    let over_clearance = (worn.2 - good.2) / (worn.1 - good.1);
    good.2 + over_stiffness * (ke_n_per_m - good.0) + over_clearance * (clearance_2a_m - good.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_goes_through_the_calibrated_speeds() {
        assert!((constant_kmh() - 210.67).abs() < 0.01);
        assert!((line_kmh(3e6, 0.2e-3) - 212.0).abs() < 1e-9);
        assert!((line_kmh(15e6, 0.2e-3) - 260.0).abs() < 1e-9);
        assert!((line_kmh(12.5e6, 1e-3) - 241.8).abs() < 0.05);
    }
}
