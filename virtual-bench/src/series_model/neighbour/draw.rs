//! Neighbours of a drawn shape, whose strength is still open.
//!
//! One number grows with the strength from vanishing to [`Draw::STRONGEST`]; the others are the
//! shape, drawn once by a seed. What is drawn is pinned by a test, so that a campaign over these
//! cases can be repeated.

use super::{NEIGHBOURS, Neighbour, NeighbourInfo};
use crate::series_model::SeriesModel;
use firmware_core::damper::HeatBalance;
use signal::random::Random;

/// How far the tests reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Greatest speed, m/s.
    pub speed_m_per_s: f64,
    /// Greatest stroke of a sine, m.
    pub stroke_m: f64,
    /// The farthest position in extension, m.
    pub extension_m: f64,
    /// The farthest position in compression, m.
    pub compression_m: f64,
}

/// A neighbour of a drawn shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Which one.
    pub info: NeighbourInfo,
    model: SeriesModel,
    reach: Reach,
    shape: [f64; 3],
    sign: f64,
}

impl Draw {
    /// The largest strength at which a damper is still a damper.
    pub const STRONGEST: f64 = 0.5;

    /// Draws the shape of the neighbour of this place in [`NEIGHBOURS`].
    pub fn new(which: usize, model: SeriesModel, reach: Reach, random: &mut Random) -> Self {
        debug_assert!(which < NEIGHBOURS.len(), "no neighbour {which}");
        let shape = [random.uniform(), random.uniform(), random.uniform()];
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        Self { info: NEIGHBOURS[which % NEIGHBOURS.len()], model, reach, shape, sign }
    }

    /// The neighbour at a strength.
    ///
    /// ```
    /// use signal::random::Random;
    /// use virtual_bench::series_model::SeriesModel;
    /// use virtual_bench::series_model::neighbour::{Draw, NEIGHBOURS, Reach};
    /// # let model = SeriesModel {
    /// #     ce_n_s_per_m: 1e6, ke_n_per_m: 12.5e6, clearance_2a_m: 1e-3,
    /// #     f_relief_n: 15e3, c2_n_s_per_m: 60e3,
    /// # };
    /// # let reach = Reach {
    /// #     speed_m_per_s: 0.176, stroke_m: 8e-3, extension_m: 43e-3, compression_m: 20e-3,
    /// # };
    /// for which in 0..NEIGHBOURS.len() {
    ///     let neighbour = Draw::new(which, model, reach, &mut Random::new(7, 0)).at(0.1);
    ///     assert_eq!(neighbour.name(), NEIGHBOURS[which].name);
    /// }
    /// ```
    pub fn at(&self, strength: f64) -> Neighbour {
        let Reach { speed_m_per_s: speed, stroke_m, extension_m, compression_m } = self.reach;
        let [a, b, c] = self.shape;
        let (sign, force) = (self.sign, self.model.f_relief_n);
        match self.info.name {
            "void_by_force" => {
                // From the largest force of the tests downwards.
                let peak_n = force + self.model.c2_n_s_per_m * speed;
                Neighbour::VoidByForce { opening_n: sign * peak_n * libm::exp(-4.0 * strength) }
            }
            "fading_relief" => Neighbour::FadingRelief {
                fade_per_k: 0.2 * strength,
                heat: HeatBalance {
                    capacity_j_per_k: force * stroke_m * decades(a, 30.0, 500.0),
                    cooling_w_per_k: force * speed * between(b, 0.0, 0.02),
                },
            },
            "progressive_stop" => Neighbour::ProgressiveStop {
                extension_m: extension_m * (1.0 - strength),
                compression_m: compression_m * (1.0 - strength * between(b, 0.8, 1.0)),
                progression_n_per_m2: force / (stroke_m * stroke_m) * decades(a, 0.5, 5.0),
            },
            "one_sided_stop" => {
                let far_m = if sign > 0.0 { extension_m } else { compression_m };
                Neighbour::OneSidedStop {
                    from_m: sign * far_m * (1.0 - strength),
                    stiffness_n_per_m: force / stroke_m * decades(a, 0.5, 5.0),
                }
            }
            "exponential_friction" => {
                let (coulomb_n, ratio) = (strength * force, between(a, 1.1, 1.6));
                // The oil rises at least twice as fast as the friction falls, below relief and
                // beyond it.
                let least = 2.0 * coulomb_n * (ratio - 1.0) / self.model.ce_n_s_per_m;
                let opens = force / self.model.ce_n_s_per_m;
                Neighbour::ExponentialFriction {
                    coulomb_n,
                    breakaway_n: ratio * coulomb_n,
                    stribeck_m_per_s: least.max(opens * decades(b, 0.03, 0.15)),
                }
            }
            "air_of_exponent" => Neighbour::AirOfExponent {
                toe_m: strength * stroke_m,
                air_force_n: force * decades(a, 0.02, 0.3),
                exponent: if sign > 0.0 { between(b, 1.0, 1.15) } else { between(b, 1.8, 3.0) },
            },
            "power_orifice" => {
                let power = if sign > 0.0 { between(b, 1.4, 1.7) } else { between(b, 2.5, 3.5) };
                let opens = force / self.model.ce_n_s_per_m;
                // At the relief velocity of the plain damper, up to five times its force.
                let force_n = 10.0 * strength * force / libm::pow(opens, power);
                Neighbour::PowerOrifice { force_n, power }
            }
            "algebraic_yield" => Neighbour::AlgebraicYield {
                yield_n: strength * force,
                knee_m_per_s: speed * decades(a, 0.03, 0.5),
            },
            "dahl_of_exponent" => Neighbour::DahlOfExponent {
                capacity_n: strength * force,
                travel_m: stroke_m * decades(a, 3e-3, 0.3),
                exponent: if sign > 0.0 { between(b, 0.4, 0.7) } else { between(b, 1.5, 2.5) },
            },
            "switching_valve" => {
                Neighbour::SwitchingValve { share: strength, dwell_s: decades(a, 0.1, 3.0) }
            }
            "ripple_over_position" => Neighbour::RippleOverPosition {
                amplitude_n: strength * force,
                period_m: stroke_m * decades(a, 0.1, 0.6),
            },
            // Up to 5 ms over ten seconds at 0.5.
            _ => Neighbour::ClockSkew { rate: sign * strength * 1e-3 * between(c, 0.5, 1.0) },
        }
    }
}

fn between(share: f64, from: f64, to: f64) -> f64 {
    from + share * (to - from)
}

/// Evenly over decades.
fn decades(share: f64, from: f64, to: f64) -> f64 {
    from * libm::pow(to / from, share)
}
