//! The control plant of the virtual benchmark of real-time hybrid simulation of Silva, Gomez,
//! Maghareh, Dyke and Spencer (2020): servo-valve, actuator and specimen.
//!
//! ```text
//! u - x -> a1b0 / (s^2 + b1 s + b2) -> 1 / (s + a3) -> force -> 1 / (me s^2 + ce s + ke) -> x
//!                                   ^ - a2 x'  (the specimen's velocity acts on the actuator)
//! ```
//!
//! Units are SI. Limits: linear, so without the saturation of a real valve; the numbers are those
//! of the publication, identified on one machine with one specimen.
//!
//! ```
//! use rig_emulator::BenchmarkPlant;
//! let gain = BenchmarkPlant::nominal().static_gain();
//! assert!((gain - 1.0075).abs() < 1e-4, "{gain}");
//! ```

/// The part of the frame that is a specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Viscous damping, N s/m.
    pub damping_n_s_per_m: f64,
    /// Stiffness, N/m.
    pub stiffness_n_per_m: f64,
}

/// A plant, nominal or with other numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BenchmarkPlant {
    /// What it carries.
    pub specimen: Specimen,
    /// Gain of valve and actuator, `a1b0`.
    pub loop_gain: f64,
    /// Damping of the valve, `b1`, 1/s.
    pub valve_damping_per_s: f64,
    /// Stiffness of the valve, `b2`, 1/s2.
    pub valve_stiffness_per_s2: f64,
    /// Velocity feedback, `a2`, N/m.
    pub velocity_feedback_n_per_m: f64,
    /// Leakage of the actuator, `a3`, 1/s.
    pub leakage_per_s: f64,
    /// Gain of the measured displacement and force.
    pub output_gain: f64,
}

/// Displacement, velocity, force of the actuator, output of the valve and its derivative.
pub type PlantState = [f64; 5];

impl BenchmarkPlant {
    /// The nominal plant.
    pub fn nominal() -> Self {
        let (mass_kg, stiffness_n_per_m) = (29.13, 1.190e6_f64);
        let damping_n_s_per_m = 2.0 * 0.0097 * mass_kg * (stiffness_n_per_m / mass_kg).sqrt();
        Self {
            specimen: Specimen { mass_kg, damping_n_s_per_m, stiffness_n_per_m },
            loop_gain: 2.1283e13,
            valve_damping_per_s: 425.0,
            valve_stiffness_per_s2: 9.9976e4,
            velocity_feedback_n_per_m: 4.2297e6,
            leakage_per_s: 3.3,
            output_gain: 1.0261,
        }
    }

    /// Measured displacement over command, at rest.
    pub fn static_gain(&self) -> f64 {
        self.output_gain / self.command_per_displacement()
    }

    /// The state at rest under a command, m.
    pub fn resting_under(&self, command_m: f64) -> PlantState {
        let displacement_m = command_m / self.command_per_displacement();
        let force_n = self.specimen.stiffness_n_per_m * displacement_m;
        [displacement_m, 0.0, force_n, self.leakage_per_s * force_n, 0.0]
    }

    /// What the loop has to ask for so that the valve makes up for the leakage under the force of
    /// the specimen.
    fn command_per_displacement(&self) -> f64 {
        let valve_per_m = self.leakage_per_s * self.specimen.stiffness_n_per_m;
        1.0 + self.valve_stiffness_per_s2 * valve_per_m / self.loop_gain
    }

    /// Derivative of the state under a command, m.
    pub fn slope(&self, state: &PlantState, command_m: f64) -> PlantState {
        let [x, v, force_n, valve, valve_rate] = *state;
        let Specimen { mass_kg, damping_n_s_per_m, stiffness_n_per_m } = self.specimen;
        [
            v,
            (force_n - damping_n_s_per_m * v - stiffness_n_per_m * x) / mass_kg,
            valve - self.velocity_feedback_n_per_m * v - self.leakage_per_s * force_n,
            valve_rate,
            self.loop_gain * (command_m - x)
                - self.valve_damping_per_s * valve_rate
                - self.valve_stiffness_per_s2 * valve,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runge_kutta;
    use std::f64::consts::TAU;

    /// Delay and gain of the plant at a frequency, from the steady part of a run.
    fn response(hz: f64) -> (f64, f64) {
        let (plant, step_s) = (BenchmarkPlant::nominal(), 1.0 / 8192.0);
        let mut state = [0.0; 5];
        let (mut sine, mut cosine, mut count) = (0.0, 0.0, 0.0);
        let periods = (6.0 / (hz * step_s)) as u32;
        for k in 0..2 * periods {
            let t = f64::from(k) * step_s;
            if k >= periods {
                let measured = plant.output_gain * state[0];
                sine += measured * libm::sin(TAU * hz * t);
                cosine += measured * libm::cos(TAU * hz * t);
                count += 0.5;
            }
            let command = |h: f64| libm::sin(TAU * hz * (t + h));
            state = runge_kutta(&state, step_s, |y, h| plant.slope(y, command(h)));
        }
        let phase = libm::atan2(cosine, sine);
        (-phase / (TAU * hz), libm::hypot(sine, cosine) / count)
    }

    #[test]
    fn it_rests_under_a_constant_command() {
        let plant = BenchmarkPlant::nominal();
        let state = plant.resting_under(2e-3);
        let slope = plant.slope(&state, 2e-3);
        assert_eq!(slope[..3], [0.0; 3]);
        // The valve's own terms are of the size 2e-3 times the gain of the loop.
        assert!(slope[4].abs() < 1e-12 * 2e-3 * plant.loop_gain, "{slope:?}");
        assert!((plant.output_gain * state[0] / 2e-3 - plant.static_gain()).abs() < 1e-15);
        // It is no rest under any other command.
        assert!(plant.slope(&state, 2.1e-3)[4].abs() > 1e-3 * plant.loop_gain * 1e-4);
    }

    #[test]
    fn delay_and_gain_are_the_published_ones() {
        for (hz, delay_ms, gain) in
            [(1.0, 24.96, 0.999), (3.6, 23.7, 0.916), (10.0, 19.0, 0.633), (16.0, 15.8, 0.471)]
        {
            let (found_s, found_gain) = response(hz);
            assert!((found_s * 1e3 - delay_ms).abs() < 0.06, "{hz} Hz: {found_s} s");
            assert!((found_gain - gain).abs() < 0.002, "{hz} Hz: {found_gain}");
        }
    }
}
