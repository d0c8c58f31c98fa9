//! A second stage of the valve, inboard: from a knee force on, another slope.
//!
//! ```text
//! dF/dv -> r dF/dv        from the knee force to the next knee of the nominal law, on both sides
//! ```
//!
//! A shim that lifts, or a bleed that closes, below relief: the slope Ce changes from the knee
//! force to the relief force, which stays. A knee above relief changes the slope C2 for good.
//! Nothing happens where there is no slope, above a hard cap. Exact: the law stays piecewise
//! linear.
//!
//! Limits: the same stage in extension and compression; stages open and close at the same force.
//! Source: shim and poppet valves as in any text on oil hydraulics.

use super::draw::{Draw, between};
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::curve::{CURVE_KNOTS, Curve, Knot};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;
use heapless::Vec;

effect_parameters! {
    /// A knee in the law of the valve.
    SecondValveStage {
        knee_force_n: Newton in 0.0 to 3.0, typical 0.5, "Force at which the stage opens, N.";
        slope_ratio: One in 0.01 to 100.0, typical 0.6,
            "Slope of the force over velocity beyond the knee over the slope without the stage.";
    }
}

impl DamperEffect for SecondValveStage {
    const NAME: &'static str = "second_valve_stage";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "dF/dv -> r dF/dv from the knee force to the next knee";
    const SHOWN_BY: &'static str =
        "Slow triangles over a wide stroke at six or more speeds on both sides of the knee.";
    const STARTS: &'static [&'static [f64]] =
        &[&[0.25, 0.6], &[0.75, 0.6], &[0.3, 1.6], &[0.6, 1.6], &[1.1, 0.6], &[1.1, 2.0]];
    const STRONGEST: f64 = 30.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let (knee, relief) = (self.knee_force_n, nominal.f_relief_n);
        let more = 1.0 / self.slope_ratio - 1.0;
        let capped = relief.is_finite() && nominal.c2_n_s_per_m == 0.0;
        if more == 0.0 || (capped && knee >= relief) {
            return;
        }
        let end = if knee < relief { relief } else { f64::INFINITY };
        // Velocity over force, from which the velocity that the stage adds is read.
        let mut law = parts.hydraulic.clone();
        law.invert();
        let start = law.at(knee);
        let mut above: Vec<Knot, CURVE_KNOTS> = Vec::new();
        let _ = above.push(Knot { x: 0.0, y: 0.0 });
        if knee > 0.0 {
            let _ = above.push(Knot { x: knee, y: 0.0 });
        }
        for knot in law.knots().iter().filter(|knot| knot.x > knee && knot.x <= end) {
            let _ = above.push(Knot { x: knot.x, y: more * (knot.y - start) });
        }
        let slope = if end.is_finite() { 0.0 } else { more * law.slope_after() };
        parts.hydraulic.add_across(&Curve::odd(&above, slope));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let [a, ..] = draw.shape;
        // Another slope than the one before: steeper or flatter.
        let slope_ratio = if draw.sign > 0.0 { 1.0 + strength } else { 1.0 / (1.0 + strength) };
        Self { knee_force_n: draw.scale.force_n * between(a, 0.25, 0.8), slope_ratio }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        Self { knee_force_n: 0.4 * nominal.f_relief_n, slope_ratio: 1.0 / (1.0 + 0.7 * size) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::Damper;

    fn force(nominal: Nominal, knee_force_n: f64, slope_ratio: f64, v: f64) -> f64 {
        let stage = SecondValveStage { knee_force_n, slope_ratio };
        let damper = Damper::new(nominal, &[stage.into()]).unwrap();
        let force = damper.steady_force_n(v);
        assert!((damper.steady_force_n(-v) + force).abs() <= 1e-12 * force);
        force
    }

    #[test]
    fn three_slopes_with_a_knee_below_relief() {
        let nominal = Nominal::NEW;
        for ratio in [0.5, 2.0] {
            // Ce to 6 kN, ratio Ce to 18 kN, C2 beyond.
            let opens = 6e-3 + 12e-3 / ratio;
            for (v, expected) in [
                (3e-3, 3e3),
                (6e-3, 6e3),
                (7e-3, 6e3 + ratio * 1e3),
                (opens, 18e3),
                (opens + 0.05, 22e3),
            ] {
                let force = force(nominal, 6e3, ratio, v);
                assert!((force / expected - 1.0).abs() < 1e-12, "{ratio} {v}: {force}");
            }
        }
    }

    #[test]
    fn knee_above_relief_changes_the_second_slope() {
        let at = |v: f64| force(Nominal::NEW, 22e3, 0.25, v);
        assert!((at(0.068) - 22e3).abs() < 1e-8);
        assert!((at(0.168) - 24e3).abs() < 1e-8);
        // Without a relief the one slope there is.
        let open = Nominal { f_relief_n: f64::INFINITY, ..Nominal::NEW };
        assert!((force(open, 22e3, 0.25, 0.026) - 23e3).abs() < 1e-8);
        // A hard cap stays one.
        let capped = Nominal { c2_n_s_per_m: 0.0, ..Nominal::NEW };
        assert_eq!(force(capped, 22e3, 0.25, 0.5), 18e3);
        assert!((force(capped, 9e3, 0.5, 0.5) - 18e3).abs() < 1e-9);
    }

    #[test]
    fn equal_slopes_are_the_nominal_damper() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        for v in [1e-4, 0.01, 0.018, 0.2] {
            assert_eq!(force(Nominal::NEW, 9e3, 1.0, v), plain.steady_force_n(v));
            let nearly = force(Nominal::NEW, 9e3, 1.0 + 1e-12, v);
            assert!((nearly / plain.steady_force_n(v) - 1.0).abs() < 1e-11);
        }
    }
}
