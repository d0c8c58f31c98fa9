//! A low-pass filter whose states are the derivatives of its output.

/// Coefficients of the Butterworth polynomial of fourth order, lowest first.
const BUTTERWORTH: [f64; 4] =
    [1.0, 2.613_125_929_752_753, 3.414_213_562_373_095, 2.613_125_929_752_753];

/// The state-variable filter `y'''' = w^4 u - ...` in the time `w t`: output and its first three
/// derivatives, each divided by its power of `w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filter {
    states: [f64; 4],
    input: f64,
}

impl Filter {
    /// The filter at rest on an input.
    pub(super) const fn resting(input: f64) -> Self {
        Self { states: [input, 0.0, 0.0, 0.0], input }
    }

    /// The input before the next one.
    pub(super) const fn input(&self) -> f64 {
        self.input
    }

    /// Output, first and second derivative.
    pub(super) const fn output(&self) -> [f64; 3] {
        let [y, dy, ddy, _] = self.states;
        [y, dy, ddy]
    }

    /// One classical Runge-Kutta step to the next input, linear in between; `angle` is the cut-off
    /// in radians per step.
    pub(super) fn step(&mut self, input: f64, angle: f64) {
        let mean = 0.5 * (self.input + input);
        let k1 = slope(self.states, self.input);
        let k2 = slope(along(self.states, k1, 0.5 * angle), mean);
        let k3 = slope(along(self.states, k2, 0.5 * angle), mean);
        let k4 = slope(along(self.states, k3, angle), input);
        let sum = along(along(along(k1, k2, 2.0), k3, 2.0), k4, 1.0);
        self.states = along(self.states, sum, angle / 6.0);
        self.input = input;
    }
}

/// Derivatives of the states with respect to `w t`.
fn slope([y0, y1, y2, y3]: [f64; 4], input: f64) -> [f64; 4] {
    let [c0, c1, c2, c3] = BUTTERWORTH;
    [y1, y2, y3, input - c0 * y0 - c1 * y1 - c2 * y2 - c3 * y3]
}

/// `from + by * direction`.
fn along([a, b, c, d]: [f64; 4], direction: [f64; 4], by: f64) -> [f64; 4] {
    let [e, f, g, h] = direction;
    [a + by * e, b + by * f, c + by * g, d + by * h]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_states_are_the_derivatives_of_a_filtered_sine() {
        let (cut_off_hz, hz, step_s) = (20.0, 4.0, 1e-3);
        let angle = core::f64::consts::TAU * cut_off_hz * step_s;
        let mut filter = Filter::resting(0.0);
        let ratio = hz / cut_off_hz;
        let (mut largest, mut slopes) = (0.0_f64, 0.0_f64);
        for k in 0..2000 {
            let phase = core::f64::consts::TAU * hz * step_s * f64::from(k);
            filter.step(libm::sin(phase), angle);
            if k > 1000 {
                let [y, dy, ddy] = filter.output();
                largest = largest.max(y.abs());
                slopes = slopes.max(dy.abs());
                assert!((ddy + ratio * ratio * y).abs() < 2e-4, "{k}: {ddy} {y}");
            }
        }
        let expected = 1.0 / crate::sqrt::sqrt(1.0 + libm::pow(ratio, 8.0));
        assert!((largest - expected).abs() < 1e-3, "{largest}");
        assert!((slopes - ratio * expected).abs() < 1e-3, "{slopes}");
    }
}
