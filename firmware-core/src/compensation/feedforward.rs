//! Compensation with fixed coefficients: extrapolation over a delay, or the inverse of a model.

use super::series::Series;

/// A fixed [`Series`] and the part of the delay that lies outside of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedforward {
    /// The inverse of the rig.
    pub series: Series,
    /// Further delay of the loop that is known, such as that of the force on its way back, s.
    pub known_delay_s: f64,
    /// Whether the third derivative counts.
    pub takes_jerk: bool,
}

impl Feedforward {
    /// Extrapolation over a delay by a Taylor polynomial of order 1 to 3, `a_k = tau^k / k!`.
    /// Another order is taken as the nearest of these.
    ///
    /// A higher order is not better: its gain at the modes of the rig grows with the frequency to
    /// the power of the order.
    ///
    /// ```
    /// use firmware_core::compensation::Feedforward;
    /// let second = Feedforward::polynomial(2, 0.02);
    /// assert_eq!(second.series.0, [1.0, 0.02, 2e-4, 0.0]);
    /// ```
    pub fn polynomial(order: u8, delay_s: f64) -> Self {
        debug_assert!((1..=3).contains(&order), "polynomial of order {order}");
        let square = if order >= 2 { delay_s * delay_s / 2.0 } else { 0.0 };
        let cube = if order >= 3 { delay_s * delay_s * delay_s / 6.0 } else { 0.0 };
        Self { series: Series([1.0, delay_s, square, cube]), known_delay_s: 0.0, takes_jerk: true }
    }

    /// The inverse of a model of the rig, `1 / (a0 + a1 s + a2 s^2 + a3 s^3)`.
    pub const fn inverse(coefficients: [f64; 4]) -> Self {
        Self { series: Series(coefficients), known_delay_s: 0.0, takes_jerk: true }
    }

    /// Compensates a known delay outside of the rig too.
    #[must_use]
    pub const fn with_known_delay(self, known_delay_s: f64) -> Self {
        Self { known_delay_s, ..self }
    }
}
