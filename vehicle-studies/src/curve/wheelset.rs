//! Forces of a wheelset and its wheels over the tracks of several seeds.

use super::forces::{AxleForces, WheelForces};
use crate::over_seeds::OverSeeds;
use serde::{Deserialize, Serialize};

/// A wheelset in a section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WheelsetCurve {
    /// Sum of guiding forces, outward, 0.15 % (N).
    pub sum_low_n: OverSeeds,
    /// Its median: the quasi-static value (N).
    pub sum_quasi_static_n: OverSeeds,
    /// 99.85 % of it (N).
    pub sum_high_n: OverSeeds,
    /// The greater magnitude of both percentiles, which the limit holds for (N).
    pub sum_n: OverSeeds,
    /// Greatest rms over 100 m around the frequency of an instability (N).
    pub stability_rms_n: Option<OverSeeds>,
    /// Lateral axle force of GB/T 5599-2019 (N).
    pub axle_force_gb_n: OverSeeds,
    /// The outer wheel.
    pub outer: WheelCurve,
    /// The inner wheel.
    pub inner: WheelCurve,
}

/// A wheel in a section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WheelCurve {
    /// Y/Q, 99.85 %.
    pub y_over_q: OverSeeds,
    /// Y/Q, median.
    pub y_over_q_quasi_static: OverSeeds,
    /// Guiding force towards the outside of the track, median (N).
    pub y_quasi_static_n: OverSeeds,
    /// Wheel load, median (N).
    pub q_quasi_static_n: OverSeeds,
    /// Wheel load, 99.85 % (N).
    pub q_high_n: OverSeeds,
    /// Q/P of GB/T 5599-2019.
    pub derailment_gb: OverSeeds,
    /// Unloading over the static load.
    pub unloading: OverSeeds,
    /// Mean power lost in the patches (W).
    pub wear_w: OverSeeds,
    /// Mean wear number T gamma (N).
    pub t_gamma_n: OverSeeds,
}

impl WheelsetCurve {
    /// From all tracks.
    pub(super) fn over(tracks: &[&AxleForces]) -> Option<Self> {
        let over =
            |of: &dyn Fn(&AxleForces) -> f64| OverSeeds::of(tracks.iter().map(|axle| of(axle)));
        let wheel = |which: usize| {
            let wheels: Vec<&WheelForces> = tracks.iter().map(|axle| &axle.wheels[which]).collect();
            WheelCurve::over(&wheels)
        };
        Some(Self {
            sum_low_n: over(&|axle| axle.sum_n[0])?,
            sum_quasi_static_n: over(&|axle| axle.sum_n[1])?,
            sum_high_n: over(&|axle| axle.sum_n[2])?,
            sum_n: over(&|axle| axle.sum_n[0].abs().max(axle.sum_n[2].abs()))?,
            stability_rms_n: OverSeeds::of(tracks.iter().filter_map(|axle| axle.stability_rms_n)),
            axle_force_gb_n: over(&|axle| axle.gb_n)?,
            outer: wheel(0)?,
            inner: wheel(1)?,
        })
    }
}

impl WheelCurve {
    fn over(tracks: &[&WheelForces]) -> Option<Self> {
        let over =
            |of: &dyn Fn(&WheelForces) -> f64| OverSeeds::of(tracks.iter().map(|wheel| of(wheel)));
        Some(Self {
            y_over_q: over(&|wheel| wheel.y_over_q[1])?,
            y_over_q_quasi_static: over(&|wheel| wheel.y_over_q[0])?,
            y_quasi_static_n: over(&|wheel| wheel.y_quasi_static_n)?,
            q_quasi_static_n: over(&|wheel| wheel.q_n[0])?,
            q_high_n: over(&|wheel| wheel.q_n[1])?,
            derailment_gb: over(&|wheel| wheel.derailment_gb)?,
            unloading: over(&|wheel| wheel.unloading)?,
            wear_w: over(&|wheel| wheel.wear_w)?,
            t_gamma_n: over(&|wheel| wheel.t_gamma_n)?,
        })
    }
}
