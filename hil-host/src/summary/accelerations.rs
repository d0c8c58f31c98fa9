//! Accelerations of three bodies.

use crate::statistics::Sums;
use serde::Serialize;

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

/// Accelerations of the bodies that were watched.
pub(crate) fn accelerations(watched: [Option<usize>; 3], sums: &Sums) -> Accelerations {
    let rms = |index: usize| sums.acceleration[index].rms();
    let body = |index: usize| {
        watched[index].map(|_| Acceleration {
            lateral_rms_m_per_s2: rms(2 * index),
            vertical_rms_m_per_s2: rms(2 * index + 1),
        })
    };
    Accelerations { carbody: body(0), bogie_front: body(1), wheelset_1: body(2) }
}
