//! Valves: the flow from one chamber to another over the difference of their pressures.
//!
//! ```text
//! orifice   Q = Cd A sqrt(2/rho) dp/(dp^2 + dp_t^2)^(1/4)        smooth through zero
//! slot      Q = w d^3 dp/(12 mu L)                               linear, falls with warmth
//! check     orifice law of <dp - p_c>                            one way, <> zero below zero
//! shim      orifice law with A = min(pi d y, A_max), y = <A_e dp - F_0>/k
//! relief    orifice law with A = pi d sin(th) y, y = min(A_v <dp - p_s>/(k + k_f), y_max),
//!           k_f = 2 Cd^2 pi d sin(th) cos(th) dp                 the flow closes the poppet
//! ```
//!
//! (textbook hydraulics). Valves have no mass: a poppet's 200 to 600 Hz are left out. Flows count
//! liquid at one bar; at 50 bar that is 0.4 % less than what passes.

use super::oil::OilAt;

/// Which chamber.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chamber {
    /// Around the rod; it shrinks in extension.
    Rod,
    /// Below the piston; it grows in extension.
    Cap,
    /// The reservoir with the gas cushion.
    Reservoir,
}

/// What throttles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Throttle {
    /// A sharp-edged hole, both ways.
    Orifice {
        /// Discharge coefficient.
        discharge: f64,
        /// Area, m2.
        area_m2: f64,
        /// Pressure difference of transition to laminar flow, Pa.
        transition_pa: f64,
    },
    /// A flat slot with laminar flow, both ways.
    Slot {
        /// Width, m.
        width_m: f64,
        /// Height, m.
        height_m: f64,
        /// Length along the flow, m.
        length_m: f64,
    },
    /// A check valve: open one way.
    Check {
        /// Discharge coefficient.
        discharge: f64,
        /// Area, m2.
        area_m2: f64,
        /// Pressure at which it opens, Pa.
        crack_pa: f64,
        /// Pressure difference of transition to laminar flow, Pa.
        transition_pa: f64,
    },
    /// A stack of discs that bends open, one way.
    Shim {
        /// Discharge coefficient.
        discharge: f64,
        /// Diameter of its edge, m.
        edge_m: f64,
        /// Area on which the pressure acts, m2.
        pressed_m2: f64,
        /// Stiffness, N/m.
        stiffness_n_per_m: f64,
        /// Preload, N.
        preload_n: f64,
        /// Largest open area, m2.
        area_max_m2: f64,
    },
    /// A conical poppet on a spring, one way.
    Relief {
        /// Discharge coefficient.
        discharge: f64,
        /// Diameter of the seat, m.
        seat_m: f64,
        /// Half angle of the cone, rad.
        half_angle_rad: f64,
        /// Pressure at which it opens, Pa.
        set_pa: f64,
        /// Stiffness of its spring, N/m.
        stiffness_n_per_m: f64,
        /// Largest lift, m.
        lift_max_m: f64,
    },
}

/// A valve in its place; one-way valves open from `from` to `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Valve {
    /// Upstream chamber.
    pub from: Chamber,
    /// Downstream chamber.
    pub to: Chamber,
    /// What throttles.
    pub throttle: Throttle,
}

/// Flow and its slope over the pressure difference (m3/s, m3/s/Pa).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flow {
    /// Flow, m3/s.
    pub m3_per_s: f64,
    /// Its change per pressure, m3/s/Pa.
    pub per_pa: f64,
}

/// Pressure at which poppets and discs leave the laminar range, Pa.
const TRANSITION_PA: f64 = 10e3;

impl Throttle {
    /// The flow at a pressure difference.
    ///
    /// ```
    /// use virtual_bench::hydraulic::{Oil, Throttle};
    /// # let oil = Oil {
    /// #     bulk_modulus_pa: 1.5e9, bulk_modulus_pa_per_k: -6e6, air_share: 0.01,
    /// #     air_exponent: 1.4, density_kg_per_m3: 870.0, expansion_per_k: 7e-4,
    /// #     viscosity_pa_s: 0.02, viscosity_per_k: 0.025, reference_degc: 40.0, vapour_pa: 2e3,
    /// # }.at(40.0);
    /// let hole = Throttle::Orifice { discharge: 0.7, area_m2: 2e-6 / 0.7, transition_pa: 10e3 };
    /// // Cd A = 2 mm2 at 5.2 MPa: 2e-6 * sqrt(2 * 5.2e6 / 870) = 0.22 litres a second.
    /// assert!((hole.flow(5.2e6, &oil).m3_per_s - 0.2187e-3).abs() < 1e-7);
    /// ```
    pub fn flow(&self, dp_pa: f64, oil: &OilAt) -> Flow {
        let per_root = |discharge: f64| discharge * (2.0 / oil.density_kg_per_m3).sqrt();
        match *self {
            Self::Orifice { discharge, area_m2, transition_pa } => {
                through(per_root(discharge) * area_m2, 0.0, dp_pa, transition_pa)
            }
            Self::Slot { width_m, height_m, length_m } => {
                let per_pa = width_m * height_m * height_m * height_m
                    / (12.0 * oil.viscosity_pa_s * length_m);
                Flow { m3_per_s: per_pa * dp_pa, per_pa }
            }
            Self::Check { discharge, area_m2, crack_pa, transition_pa } => {
                if dp_pa <= crack_pa {
                    return Flow::default();
                }
                through(per_root(discharge) * area_m2, 0.0, dp_pa - crack_pa, transition_pa)
            }
            Self::Shim {
                discharge,
                edge_m,
                pressed_m2,
                stiffness_n_per_m,
                preload_n,
                area_max_m2,
            } => {
                let lift_n = pressed_m2 * dp_pa - preload_n;
                if lift_n <= 0.0 {
                    return Flow::default();
                }
                let per_pa = std::f64::consts::PI * edge_m * pressed_m2 / stiffness_n_per_m;
                let area = per_pa * lift_n / pressed_m2;
                let (area, per_pa) =
                    if area < area_max_m2 { (area, per_pa) } else { (area_max_m2, 0.0) };
                let root = per_root(discharge);
                through(root * area, root * per_pa, dp_pa, TRANSITION_PA)
            }
            Self::Relief {
                discharge,
                seat_m,
                half_angle_rad,
                set_pa,
                stiffness_n_per_m,
                lift_max_m,
            } => {
                if dp_pa <= set_pa {
                    return Flow::default();
                }
                let (sine, cosine) = (libm::sin(half_angle_rad), libm::cos(half_angle_rad));
                let edge = std::f64::consts::PI * seat_m * sine;
                let pressed = 0.25 * std::f64::consts::PI * seat_m * seat_m;
                let closing_per_pa = 2.0 * discharge * discharge * edge * cosine;
                let stiffness = stiffness_n_per_m + closing_per_pa * dp_pa;
                let lift = pressed * (dp_pa - set_pa) / stiffness;
                let slope = (pressed - lift * closing_per_pa) / stiffness;
                let (lift, slope) =
                    if lift < lift_max_m { (lift, slope) } else { (lift_max_m, 0.0) };
                let root = per_root(discharge);
                through(root * edge * lift, root * edge * slope, dp_pa, TRANSITION_PA)
            }
        }
    }
}

/// `area` times the smoothed root of `dp`; `area_per_pa` is how fast it opens.
fn through(area: f64, area_per_pa: f64, dp_pa: f64, transition_pa: f64) -> Flow {
    let square = dp_pa * dp_pa + transition_pa * transition_pa;
    let fourth_root = square.sqrt().sqrt();
    let root = dp_pa / fourth_root;
    let slope = (1.0 - 0.5 * dp_pa * dp_pa / square) / fourth_root;
    Flow { m3_per_s: area * root, per_pa: area * slope + area_per_pa * root }
}

/// The gap between piston and bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leakage {
    /// Radial gap c, m.
    pub gap_m: f64,
    /// Length along the piston, m.
    pub length_m: f64,
    /// Eccentricity, 0 to 1.
    pub eccentricity: f64,
}

impl Leakage {
    /// Flow from rod to cap side, `pi D c^3 (1 + 1.5 e^2) dp/(12 mu L) + pi D c v/2`; the second
    /// term is oil dragged along by the wall. Also its change per velocity, m2.
    pub fn flow(&self, bore_m: f64, dp_pa: f64, v_m_per_s: f64, oil: &OilAt) -> (Flow, f64) {
        let c = self.gap_m;
        let round = std::f64::consts::PI * bore_m;
        let per_pa = round * c * c * c * (1.0 + 1.5 * self.eccentricity * self.eccentricity)
            / (12.0 * oil.viscosity_pa_s * self.length_m);
        let dragged_m2 = 0.5 * round * c;
        (Flow { m3_per_s: per_pa * dp_pa + dragged_m2 * v_m_per_s, per_pa }, dragged_m2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::oil::tests::OIL;
    use super::*;

    fn all() -> [Throttle; 5] {
        [
            Throttle::Orifice { discharge: 0.7, area_m2: 1e-6, transition_pa: 10e3 },
            Throttle::Slot { width_m: 5e-3, height_m: 50e-6, length_m: 5e-3 },
            Throttle::Check { discharge: 0.7, area_m2: 1e-4, crack_pa: 5e3, transition_pa: 10e3 },
            Throttle::Shim {
                discharge: 0.7,
                edge_m: 20e-3,
                pressed_m2: 2e-4,
                stiffness_n_per_m: 2e6,
                preload_n: 200.0,
                area_max_m2: 2e-5,
            },
            Throttle::Relief {
                discharge: 0.65,
                seat_m: 8e-3,
                half_angle_rad: 0.785,
                set_pa: 5e6,
                stiffness_n_per_m: 4e5,
                lift_max_m: 1e-3,
            },
        ]
    }

    #[test]
    fn slopes_are_derivatives_and_flows_rise() {
        let oil = OIL.at(30.0);
        for throttle in all() {
            for step in -400..400 {
                let dp = 25e3 * f64::from(step) + 317.0;
                let flow = throttle.flow(dp, &oil);
                assert!(flow.per_pa >= 0.0 && flow.m3_per_s * dp >= 0.0, "{throttle:?} at {dp}");
                let width = 1e-3 * dp.abs().max(100.0);
                let (low, high) =
                    (throttle.flow(dp - width, &oil), throttle.flow(dp + width, &oil));
                if low.per_pa == 0.0 || (high.per_pa / low.per_pa - 1.0).abs() > 0.1 {
                    continue; // a kink, or the foot of the root
                }
                let slope = (high.m3_per_s - low.m3_per_s) / (2.0 * width);
                assert!((slope / flow.per_pa - 1.0).abs() < 1e-2, "{throttle:?} at {dp}: {slope}");
            }
        }
    }

    #[test]
    fn one_way_valves_stay_shut_and_limits_hold() {
        let oil = OIL.at(40.0);
        for throttle in &all()[2..] {
            assert_eq!(throttle.flow(-5e6, &oil).m3_per_s, 0.0);
        }
        // Shut below (200 N over 2 cm2 = 1 MPa), wide open far above.
        let shim = all()[3];
        assert_eq!(shim.flow(0.99e6, &oil).m3_per_s, 0.0);
        let open = 0.7 * 2e-5 * (2.0 * 50e6 / 870.0f64).sqrt();
        assert!((shim.flow(50e6, &oil).m3_per_s / open - 1.0).abs() < 1e-6);
        let relief = all()[4];
        assert_eq!(relief.flow(4.99e6, &oil).m3_per_s, 0.0);
    }

    #[test]
    fn slots_discs_and_poppets_have_their_closed_forms() {
        let (oil, root) = (OIL.at(40.0), (2.0 / 870.0f64).sqrt());
        // Slot: w d^3 dp/(12 mu L), and 20 K thin it by exp(0.5).
        let slot = 5e-3 * 125e-15 * 3e6 / (12.0 * 0.02 * 5e-3);
        let warm = all()[1].flow(3e6, &OIL.at(60.0)).m3_per_s;
        assert!((all()[1].flow(3e6, &oil).m3_per_s / slot - 1.0).abs() < 1e-12);
        assert!((warm / slot - libm::exp(0.5)).abs() < 1e-12);
        // Discs at 1.2 MPa: 240 N less 200 N over 2 MN/m lift them by 20 um around 20 mm.
        let area = std::f64::consts::PI * 20e-3 * 20e-6;
        let discs = 0.7 * area * root * 1.2e6f64.sqrt();
        assert!((all()[3].flow(1.2e6, &oil).m3_per_s / discs - 1.0).abs() < 1e-4);
        // Poppet at 5.5 MPa: 50.27 mm2 * 0.5 MPa over the spring and what the flow adds to it.
        let (sine, cosine) = (libm::sin(0.785), libm::cos(0.785));
        let edge = std::f64::consts::PI * 8e-3 * sine;
        let stiffness = 4e5 + 2.0 * 0.65 * 0.65 * edge * cosine * 5.5e6;
        let lift = 0.25 * std::f64::consts::PI * 64e-6 * 0.5e6 / stiffness;
        let poppet = 0.65 * edge * lift * root * 5.5e6f64.sqrt();
        assert!((all()[4].flow(5.5e6, &oil).m3_per_s / poppet - 1.0).abs() < 1e-5);
    }

    #[test]
    fn leakage_is_poiseuille_and_couette() {
        let leakage = Leakage { gap_m: 30e-6, length_m: 30e-3, eccentricity: 0.0 };
        let (flow, dragged) = leakage.flow(70e-3, 5e6, 0.1, &OIL.at(40.0));
        let poiseuille = std::f64::consts::PI * 0.07 * 27e-15 * 5e6 / (12.0 * 0.02 * 0.03);
        let couette = std::f64::consts::PI * 0.07 * 30e-6 * 0.5 * 0.1;
        assert!((flow.m3_per_s - poiseuille - couette).abs() < 1e-15);
        assert!((dragged - couette / 0.1).abs() < 1e-15);
    }
}
