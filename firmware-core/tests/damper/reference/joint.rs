//! The equations of the attachment: clearance, spring, rubber, air and fixture in a row.

use firmware_core::damper::effects::{
    AerationMemory, ClearanceGrowth, EntrainedAir, FixtureCompliance, RubberHysteresis,
    StiffeningAttachment, StrokeDependentStiffness,
};
use firmware_core::damper::{Effect, Nominal};

/// What the attachment remembers, and where the piston is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Worked {
    pub(crate) piston_m: f64,
    pub(crate) maxwell_m: f64,
    pub(crate) travelled_m: f64,
    pub(crate) foam: f64,
}

/// The parts between piston and eye.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joint {
    pub(crate) rubber: Option<RubberHysteresis>,
    stiffening: Option<StiffeningAttachment>,
    air: Option<EntrainedAir>,
    fixture: Option<FixtureCompliance>,
    stroke: Option<StrokeDependentStiffness>,
    pub(crate) foam: Option<AerationMemory>,
    growth: Option<ClearanceGrowth>,
}

impl Joint {
    /// Takes an effect of the attachment; false for any other.
    pub(crate) fn take(&mut self, effect: Effect) -> bool {
        match effect {
            Effect::RubberHysteresis(effect) => self.rubber = Some(effect),
            Effect::StiffeningAttachment(effect) => self.stiffening = Some(effect),
            Effect::EntrainedAir(effect) => self.air = Some(effect),
            Effect::FixtureCompliance(effect) => self.fixture = Some(effect),
            Effect::StrokeDependentStiffness(effect) => self.stroke = Some(effect),
            Effect::AerationMemory(effect) => self.foam = Some(effect),
            Effect::ClearanceGrowth(effect) => self.growth = Some(effect),
            _ => return false,
        }
        true
    }

    /// Half of the clearance with what wear has added.
    pub(crate) fn half_clearance_m(&self, nominal: &Nominal, travelled_m: f64) -> f64 {
        let grown = self.growth.map_or(0.0, |wear| wear.growth_per_travel * travelled_m);
        0.5 * (nominal.clearance_2a_m + grown)
    }

    /// Force at a distance between eye and piston; `guess_n` is one near it.
    pub(crate) fn force_n(
        &self,
        nominal: &Nominal,
        apart_m: f64,
        worked: &Worked,
        guess_n: f64,
    ) -> f64 {
        let half = self.half_clearance_m(nominal, worked.travelled_m);
        let r = self.rubber.map_or(0.0, |rubber| rubber.dynamic_stiffening);
        let e = apart_m - r * worked.maxwell_m / (1.0 + r);
        if e.abs() <= half {
            return 0.0;
        }
        let x = worked.piston_m;
        let mut gain = 1.0;
        if let Some(oil) = self.stroke {
            gain /= 1.0 + oil.gradient_per_m * x + oil.curvature_per_m2 * x * x;
        }
        if let Some(oil) = self.foam {
            gain *= 1.0 + oil.softening * worked.foam;
        }
        let deflection = (e.abs() - half) / gain;
        e.signum() * self.inverted(nominal, deflection, guess_n.abs())
    }

    /// Force at an elastic deflection above zero.
    fn inverted(&self, nominal: &Nominal, deflection_m: f64, guess_n: f64) -> f64 {
        if self.air.is_none() && self.stiffening.is_none() {
            return deflection_m / self.deflection(nominal, 1.0).1;
        }
        let mut force = guess_n;
        for _ in 0..50 {
            let (d, slope) = self.deflection(nominal, force);
            // All parts bend the same way, so Newton closes in from below.
            let step = (deflection_m - d) / slope;
            force = (force + step).max(0.0);
            if step.abs() <= 1e-7 * force {
                break;
            }
        }
        force
    }

    /// Deflection and its slope over force.
    fn deflection(&self, nominal: &Nominal, force_n: f64) -> (f64, f64) {
        let ke = nominal.ke_n_per_m;
        let r = self.rubber.map_or(0.0, |rubber| rubber.dynamic_stiffening);
        let (mut d, mut slope) = match self.stiffening {
            None => (force_n / ke, 1.0 / ke),
            Some(rubber) => {
                // Cardano for d^3 + d/k = F/(Ke k).
                let k = rubber.stiffening_per_m2;
                let half = 0.5 * force_n / (ke * k);
                let root = libm::sqrt(half * half + 1.0 / (27.0 * k * k * k));
                let u = libm::cbrt(half + root);
                let d = u - 1.0 / (3.0 * k * u);
                (d, 1.0 / (ke * (1.0 + 3.0 * k * d * d)))
            }
        };
        d /= 1.0 + r;
        slope /= 1.0 + r;
        if let Some(air) = self.air {
            let pressure = 1.0 + force_n / air.air_force_n;
            let left = libm::pow(pressure, -1.0 / 1.4);
            d += air.toe_m * (1.0 - left);
            slope += air.toe_m * left / (1.4 * pressure * air.air_force_n);
        }
        if let Some(fixture) = self.fixture {
            d += force_n / fixture.fixture_n_per_m;
            slope += 1.0 / fixture.fixture_n_per_m;
        }
        (d, slope)
    }
}
