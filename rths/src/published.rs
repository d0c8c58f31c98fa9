//! The published table of the baseline controller (Table 3), and how close a run must come.

use crate::criteria::Criteria;

/// J1 to J9 of cases 1 to 4, record of El Centro.
pub const TABLE_3: [Criteria; 4] = [
    Criteria([4.6, 10.4, 11.5, 36.1, 19.0, 32.3, 32.4, 14.8, 14.8]),
    Criteria([4.6, 9.8, 11.1, 33.1, 17.1, 30.5, 30.5, 15.3, 15.2]),
    Criteria([4.6, 9.1, 10.2, 49.9, 36.7, 49.8, 49.8, 35.5, 35.6]),
    Criteria([4.6, 10.5, 11.3, 72.6, 35.2, 68.5, 68.7, 33.4, 33.3]),
];

/// Largest difference of each criterion: one sample for J1, half a point for J5, 0.2 points for
/// the others.
pub const TOLERANCE: Criteria =
    Criteria([1e3 / crate::simulation::SAMPLES_PER_S, 0.2, 0.2, 0.2, 0.5, 0.2, 0.2, 0.2, 0.2]);

/// What the benchmark asks of a compensator: J4 in all cases, and its mean over perturbed plants of
/// case 1, %.
pub const AIM_J4_PERCENT: [f64; 2] = [4.0, 3.2];
