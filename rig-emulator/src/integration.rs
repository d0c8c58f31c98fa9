//! The integration of the benchmark: classical Runge-Kutta with a fixed step.

/// One step; `slope` gets a state and the time since the start of the step.
///
/// ```
/// use rig_emulator::runge_kutta;
/// // x' = -x for 0.1 s.
/// let [x] = runge_kutta(&[1.0], 0.1, |[x], _| [-x]);
/// assert!((x - 0.904_837_5).abs() < 1e-15);
/// ```
pub fn runge_kutta<const N: usize>(
    state: &[f64; N],
    step_s: f64,
    slope: impl Fn(&[f64; N], f64) -> [f64; N],
) -> [f64; N] {
    let along = |direction: &[f64; N], by: f64| -> [f64; N] {
        std::array::from_fn(|n| state[n] + by * direction[n])
    };
    let half_s = 0.5 * step_s;
    let k1 = slope(state, 0.0);
    let k2 = slope(&along(&k1, half_s), half_s);
    let k3 = slope(&along(&k2, half_s), half_s);
    let k4 = slope(&along(&k3, step_s), step_s);
    let mean = |n: usize| (k1[n] + 2.0 * (k2[n] + k3[n]) + k4[n]) / 6.0;
    std::array::from_fn(|n| state[n] + step_s * mean(n))
}
