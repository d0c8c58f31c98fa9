//! The controllers that are compared: one line each.

use crate::simulation::{Controller, STEP_S};
use firmware_core::compensation::{Adaptive, Compensator, Feedforward, Series};

/// A controller with its name.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// The name.
    pub name: &'static str,
    new: fn() -> Controller,
}

/// The benchmark's own controller.
pub(crate) const BASELINE: Candidate =
    Candidate { name: "PI + lead", new: || Controller::Baseline };

const NONE: Candidate = candidate("none", || Controller::Compensator(Compensator::None));
const POLYNOMIAL_18_MS: Candidate = candidate("polynomial 2, 18 ms", || polynomial(18e-3));
const POLYNOMIAL_20_MS: Candidate = candidate("polynomial 2, 20 ms", || polynomial(20e-3));

/// The inverse of the nominal plant.
pub(crate) const INVERSE: Candidate = candidate("inverse", || inverse(0.0));
const INVERSE_OF_LOOP: Candidate = candidate("inverse, force delay", || inverse(FORCE_DELAY_S));

/// The compensator that the aims are asked of.
pub(crate) const ADAPTIVE: Candidate = candidate("adaptive", || adaptive(0.0));
const ADAPTIVE_OF_LOOP: Candidate = candidate("adaptive, force delay", || adaptive(FORCE_DELAY_S));

/// All compensators.
pub const COMPENSATORS: [Candidate; 7] = [
    NONE,
    POLYNOMIAL_18_MS,
    POLYNOMIAL_20_MS,
    INVERSE,
    INVERSE_OF_LOOP,
    ADAPTIVE,
    ADAPTIVE_OF_LOOP,
];

/// What runs on perturbed plants.
pub(crate) const ON_PLANTS: [Candidate; 5] =
    [BASELINE, INVERSE, INVERSE_OF_LOOP, ADAPTIVE, ADAPTIVE_OF_LOOP];

/// The inverse of the nominal plant up to its third order.
const SERIES: [f64; 4] = [0.9925, 0.024_89, 1.066e-4, 3.86e-7];
/// A mode of the plant, at which a large second-order coefficient makes the loop chatter, Hz.
const PLANT_MODE_HZ: f64 = 68.0;
/// The mean delay of the force on its way to the simulated frame, s: a sample.
const FORCE_DELAY_S: f64 = STEP_S;

const fn candidate(name: &'static str, new: fn() -> Controller) -> Candidate {
    Candidate { name, new }
}

impl Candidate {
    /// A new controller.
    pub(crate) fn controller(self) -> Controller {
        (self.new)()
    }
}

fn polynomial(delay_s: f64) -> Controller {
    Controller::Compensator(Compensator::Feedforward(Feedforward::polynomial(2, delay_s)))
}

fn inverse(known_delay_s: f64) -> Controller {
    let inverse = Feedforward::inverse(SERIES).with_known_delay(known_delay_s);
    Controller::Compensator(Compensator::Feedforward(inverse))
}

fn adaptive(known_delay_s: f64) -> Controller {
    let [a0, a1, a2, _] = SERIES;
    let adaptive = Adaptive::new(Series([a0, a1, a2, 0.0]), PLANT_MODE_HZ);
    Controller::Compensator(Compensator::Adaptive(adaptive.with_known_delay(known_delay_s)))
}
