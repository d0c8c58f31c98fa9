//! What can be mounted in the bench.

use super::excitation::Excitation;
use crate::series_model::outside::{Drive, Outside};
use crate::series_model::{Grid, SeriesModel};
use firmware_core::damper::{Damper, DamperState, Effect, Motion};

/// One test as a specimen meets it.
#[derive(Debug, Clone, Copy)]
pub struct Load<'a> {
    /// What the actuator does.
    pub excitation: &'a Excitation,
    /// Position around which it does so, m.
    pub mean_m: f64,
    /// Steps at which the force is asked for.
    pub grid: Grid,
    /// Where a joint with clearance starts, as a share of half the clearance, -1 to 1.
    pub start: f64,
    /// Temperature of the oil at the start, degrees Celsius.
    pub start_degc: f64,
    /// Temperature around the damper, degrees Celsius.
    pub ambient_degc: f64,
    /// The temperature of the oil is measured.
    pub thermometer: bool,
    /// Seed of what is random in the specimen.
    pub seed: u64,
}

impl Load<'_> {
    /// Displacement and velocity after a number of steps (m, m/s).
    pub fn at(&self, step: usize) -> (f64, f64) {
        let (x, v) = self.excitation.at(step as f64 * self.grid.step_s);
        (self.mean_m + x, v)
    }
}

/// What a specimen answers, one value at the start and after each step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Temperature of the oil, degrees Celsius.
    pub temperature_degc: Vec<f64>,
    /// Steps that the simulation could not solve as it should; none is usual.
    pub doubtful_steps: u32,
}

/// Something with two eyes that a bench can move.
pub trait Specimen: Sync {
    /// The longest step that it needs, s.
    fn longest_step_s(&self) -> f64;

    /// Its force over a test.
    fn respond(&self, load: &Load<'_>) -> Response;
}

/// How the oil of a damper warms: `C T' = |F v| - H (T - T_ambient)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatBalance {
    /// Heat capacity C, J/K.
    pub capacity_j_per_k: f64,
    /// Cooling H, W/K.
    pub cooling_w_per_k: f64,
}

impl HeatBalance {
    /// A yaw damper of some 20 kg in still air (estimated).
    pub const YAW_DAMPER: Self = Self { capacity_j_per_k: 21e3, cooling_w_per_k: 5.0 };

    fn step(&self, degc: f64, power_w: f64, ambient_degc: f64, step_s: f64) -> f64 {
        let rate = (power_w - self.cooling_w_per_k * (degc - ambient_degc)) / self.capacity_j_per_k;
        degc + step_s * rate
    }

    /// The temperature over time, from displacement and force.
    fn over(&self, load: &Load<'_>, force_n: &[f64]) -> Vec<f64> {
        let mut degc = load.start_degc;
        let mut temperatures = Vec::with_capacity(force_n.len());
        for (step, force) in force_n.iter().enumerate() {
            temperatures.push(degc);
            let power_w = force * load.at(step).1;
            degc = self.step(degc, power_w, load.ambient_degc, load.grid.step_s);
        }
        temperatures
    }
}

/// A damper of the core, with whatever effects it has. Its oil warms as its `temperature_fade` says, or
/// as that of a yaw damper; where there is a thermometer, the effect goes by what that shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Modelled {
    /// The damper.
    pub damper: Damper,
}

impl Modelled {
    fn heat(&self) -> HeatBalance {
        let fades = self.damper.effects().iter().find_map(|effect| match effect {
            Effect::TemperatureFade(oil) => Some(HeatBalance {
                capacity_j_per_k: oil.heat_capacity_j_per_k,
                cooling_w_per_k: oil.cooling_w_per_k,
            }),
            _ => None,
        });
        fades.unwrap_or(HeatBalance::YAW_DAMPER)
    }
}

impl Specimen for Modelled {
    fn longest_step_s(&self) -> f64 {
        100e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let step_s = load.grid.step_s;
        let damper = self.damper.clone().prepared(step_s);
        let (x, v) = load.at(0);
        let half_clearance_m = 0.5 * damper.nominal().clearance_2a_m;
        let mut state = DamperState::starting(Motion::new(x, v))
            .with_piston_m(x - load.start * half_clearance_m);
        let (heat, mut degc) = (self.heat(), load.start_degc);
        let mut response = Response::default();
        response.force_n.push(0.0);
        response.temperature_degc.push(degc);
        for step in 1..=load.grid.steps {
            if load.thermometer {
                state.set_temperature_degc(Some(degc));
            }
            let (x, v) = load.at(step);
            let force_n = damper.advance(&mut state, Motion::new(x, v), step_s);
            degc = heat.step(degc, force_n * v, load.ambient_degc, step_s);
            response.force_n.push(force_n);
            response.temperature_degc.push(degc);
        }
        // The first force is not known before the first step; a bench reads it at rest.
        response.force_n[0] = response.force_n.get(1).copied().unwrap_or(0.0);
        response.doubtful_steps = state.fallbacks();
        response
    }
}

/// A series damper apart from the core's, with disturbances that no effect describes.
#[derive(Debug, Clone, PartialEq)]
pub struct NullGenerator {
    /// Its five numbers.
    pub model: SeriesModel,
    /// What is added.
    pub outside: Vec<Outside>,
}

impl Specimen for NullGenerator {
    fn longest_step_s(&self) -> f64 {
        20e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let drive = Drive {
            displacement_m: &|t| load.mean_m + load.excitation.displacement_m(t),
            frequency_hz: load.excitation.frequency_hz(),
            start_m: 0.5 * load.start * self.model.clearance_2a_m,
            seed: load.seed,
        };
        let force_n = self.model.simulate_with(&self.outside, &drive, load.grid).force_n;
        let temperature_degc = HeatBalance::YAW_DAMPER.over(load, &force_n);
        Response { force_n, temperature_degc, doubtful_steps: 0 }
    }
}
