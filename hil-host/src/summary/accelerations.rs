//! Accelerations of three bodies.

use crate::columns::Columns;
use serde::Serialize;
use signal::statistics;

/// Accelerations of three bodies; null where the vehicle has none of that name.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Accelerations {
    pub carbody: Option<Acceleration>,
    pub bogie_front: Option<Acceleration>,
    pub wheelset_1: Option<Acceleration>,
}

/// Rms acceleration of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Acceleration {
    pub lateral_rms_m_per_s2: f64,
    pub vertical_rms_m_per_s2: f64,
}

/// Accelerations of the bodies that were watched, from the row `first` on.
pub(crate) fn accelerations(
    watched: [Option<usize>; 3],
    columns: &Columns,
    first: usize,
) -> Accelerations {
    let rms = |index: usize| statistics::rms(&columns.acceleration[index][first..]);
    let body = |index: usize| {
        watched[index].map(|_| Acceleration {
            lateral_rms_m_per_s2: rms(2 * index),
            vertical_rms_m_per_s2: rms(2 * index + 1),
        })
    };
    Accelerations { carbody: body(0), bogie_front: body(1), wheelset_1: body(2) }
}
