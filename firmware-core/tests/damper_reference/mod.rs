//! An independent damper: the equations as they are written in the literature, integrated by Heun's
//! rule in steps of one microsecond, with the exact motion. It shares no code with the damper under
//! test: friction is inverted piece by piece, the rubber is a spring with a Maxwell branch instead
//! of a creep, position factors are evaluated all the time.

#![allow(dead_code, unused_imports, reason = "each test uses a part of it")]

mod outside;

pub(crate) use outside::{Outside, outside_effects_at};

use firmware_core::damper::effects::{
    AsymmetricDamping, Cavitation, PositionDependentDamping, RubberHysteresis, SealFriction,
};
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};

/// A sum of sines: amplitude m, frequency Hz, phase.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excitation {
    pub(crate) name: &'static str,
    pub(crate) tones: &'static [(f64, f64, f64)],
    pub(crate) duration_s: f64,
}

impl Excitation {
    pub(crate) fn motion(&self, time_s: f64) -> Motion {
        let (mut x, mut v) = (0.0, 0.0);
        for &(amplitude, hz, phase) in self.tones {
            let w = 2.0 * std::f64::consts::PI * hz;
            x += amplitude * (libm::sin(w * time_s + phase) - libm::sin(phase));
            v += amplitude * w * libm::cos(w * time_s + phase);
        }
        Motion::new(x, v)
    }

    pub(crate) fn acceleration(&self, time_s: f64) -> f64 {
        let tones = self.tones.iter().map(|&(amplitude, hz, phase)| {
            let w = 2.0 * std::f64::consts::PI * hz;
            -amplitude * w * w * libm::sin(w * time_s + phase)
        });
        tones.sum()
    }
}

/// The working point, a small fast one, a large slow one, two tones.
pub(crate) const EXCITATIONS: [Excitation; 4] = [
    Excitation { name: "3.5 Hz 3.46 mm", tones: &[(3.46e-3, 3.5, 0.0)], duration_s: 0.7 },
    Excitation { name: "8 Hz 0.5 mm", tones: &[(0.5e-3, 8.0, 0.0)], duration_s: 0.35 },
    Excitation { name: "0.3 Hz 20 mm", tones: &[(20e-3, 0.3, 0.0)], duration_s: 3.5 },
    Excitation {
        name: "two tones",
        tones: &[(2.5e-3, 1.3, 0.4), (0.8e-3, 7.1, 1.9)],
        duration_s: 1.3,
    },
];

/// Parameters in the form of the written equations.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    pub(crate) nominal: Nominal,
    pub(crate) friction: Option<SealFriction>,
    pub(crate) asymmetry: Option<AsymmetricDamping>,
    pub(crate) position: Option<PositionDependentDamping>,
    pub(crate) rubber: Option<RubberHysteresis>,
    pub(crate) cavitation: Option<Cavitation>,
    outside: Outside,
    void_m: f64,
    sliding: bool,
    piston_m: f64,
    maxwell_m: f64,
}

impl Reference {
    pub(crate) fn new(nominal: Nominal, effects: &[Effect]) -> Self {
        let mut reference = Self {
            nominal,
            friction: None,
            asymmetry: None,
            position: None,
            rubber: None,
            cavitation: None,
            outside: Outside::default(),
            void_m: 0.0,
            sliding: false,
            piston_m: 0.0,
            maxwell_m: 0.0,
        };
        for effect in effects {
            match *effect {
                Effect::SealFriction(effect) => reference.friction = Some(effect),
                Effect::AsymmetricDamping(effect) => reference.asymmetry = Some(effect),
                Effect::PositionDependentDamping(effect) => reference.position = Some(effect),
                Effect::RubberHysteresis(effect) => reference.rubber = Some(effect),
                Effect::Cavitation(effect) => reference.cavitation = Some(effect),
                other => {
                    let known = reference.outside.take(other);
                    assert!(known, "the reference does not know {}", other.name());
                }
            }
        }
        reference
    }

    /// Force at the ends of steps of `step_us` microseconds.
    pub(crate) fn forces(mut self, excitation: &Excitation, step_us: usize) -> Vec<f64> {
        let h = 1e-6;
        let steps = (excitation.duration_s * 1e6) as usize;
        let mut forces = Vec::with_capacity(steps / step_us);
        let mut x = excitation.motion(0.0).displacement_m;
        for i in 0..steps {
            let next_x = excitation.motion((i + 1) as f64 * h).displacement_m;
            self.switch(x);
            let (rate, creep) = self.rates(x, self.piston_m, self.maxwell_m);
            let (piston, maxwell) = (self.piston_m + h * rate, self.maxwell_m + h * creep);
            let (rate2, creep2) = self.rates(next_x, piston, maxwell);
            self.piston_m += 0.5 * h * (rate + rate2);
            self.maxwell_m += 0.5 * h * (creep + creep2);
            x = next_x;
            self.fill_void(x, self.piston_m - 0.5 * h * (rate + rate2));
            let force = self.attachment(x, self.piston_m, self.maxwell_m).0;
            let velocity = || self.velocity(force, self.piston_m);
            let piston_m_per_s = if self.outside.strikes() { velocity() } else { 0.0 };
            let read = self.outside.read(excitation, (i + 1) as f64 * h, force, piston_m_per_s);
            if (i + 1) % step_us == 0 {
                forces.push(read);
            }
        }
        forces
    }

    /// In a void the piston follows until the attachment carries dry friction only; then the void
    /// has grown or closed by the way of the piston since `before`, and by the refill.
    fn fill_void(&mut self, x: f64, before: f64) {
        let Some(cavitation) = self.cavitation else { return };
        let side = if cavitation.refill_m_per_s < 0.0 { -1.0 } else { 1.0 };
        let force = |piston: f64| -side * self.attachment(x, piston, self.maxwell_m).0;
        let [dry, breakaway] = self.friction.map_or([0.0; 2], |friction| {
            [friction.coulomb_n, friction.coulomb_n * friction.breakaway_ratio]
        });
        let holds = if self.sliding { dry } else { breakaway };
        if self.void_m > 0.0 && force(self.piston_m) > holds {
            let (mut carries, mut slack) = (self.piston_m, self.piston_m - side * 0.1);
            for _ in 0..45 {
                let middle = 0.5 * (carries + slack);
                if force(middle) > dry { carries = middle } else { slack = middle }
            }
            self.sliding = true;
            self.piston_m = slack;
        }
        let way = side * (self.piston_m - before);
        self.void_m = (self.void_m + way - 1e-6 * cavitation.refill_m_per_s.abs()).max(0.0);
    }

    /// Force and deflection of the rubber.
    fn attachment(&self, x: f64, piston: f64, maxwell: f64) -> (f64, f64) {
        let (e, a) = (x - piston, 0.5 * self.nominal.clearance_2a_m);
        let ke = self.nominal.ke_n_per_m;
        let r = self.rubber.map_or(0.0, |rubber| rubber.dynamic_stiffening);
        let free = r * maxwell / (1.0 + r);
        let force = |d: f64| ke * d + r * ke * (d - maxwell);
        if e - a > free {
            (force(e - a), e - a)
        } else if e + a < free {
            (force(e + a), e + a)
        } else {
            (0.0, free)
        }
    }

    fn rates(&self, x: f64, piston: f64, maxwell: f64) -> (f64, f64) {
        let (force, d) = self.attachment(x, piston, maxwell);
        let creep = self.rubber.map_or(0.0, |rubber| (d - maxwell) / rubber.relaxation_time_s);
        (self.velocity(force, piston), creep)
    }

    /// Whether the piston breaks away or comes to rest.
    fn switch(&mut self, x: f64) {
        let Some(friction) = self.friction else { return };
        let force = self.attachment(x, self.piston_m, self.maxwell_m).0;
        let breakaway = friction.coulomb_n * friction.breakaway_ratio;
        if force.abs() >= breakaway {
            self.sliding = true;
        } else if self.in_void(force) {
            // It slides as long as the dry force is met.
            self.sliding &= force.abs() > (1.0 - 1e-6) * friction.coulomb_n;
        } else if self.velocity(force, self.piston_m) == 0.0 {
            self.sliding = false;
        }
    }

    /// True when a force of this sign finds a void instead of oil.
    fn in_void(&self, sign: f64) -> bool {
        let side = self.cavitation.is_some_and(|effect| effect.refill_m_per_s * sign < 0.0);
        side && self.void_m > 0.0
    }

    /// Hydraulic and dry force at a velocity whose sign is `sign`.
    fn body(&self, speed: f64, sign: f64, piston: f64) -> f64 {
        let (g, gr) = self
            .asymmetry
            .map_or((0.0, 0.0), |effect| (effect.damping_asymmetry, effect.relief_asymmetry));
        let ce = self.nominal.ce_n_s_per_m * (1.0 + g * sign);
        let relief = self.nominal.f_relief_n * (1.0 + gr * sign);
        let c2 = self.nominal.c2_n_s_per_m * (1.0 + g * sign);
        let opens = relief / ce;
        let hydraulic = if speed < opens { ce * speed } else { relief + c2 * (speed - opens) };
        let factor = self.position.map_or(1.0, |effect| {
            1.0 + effect.gradient_per_m * piston + effect.curvature_per_m2 * piston * piston
        });
        let dry = self.friction.map_or(0.0, |f| {
            let stribeck = (1.0 - speed / f.stribeck_m_per_s).max(0.0);
            f.coulomb_n * (1.0 + (f.breakaway_ratio - 1.0) * stribeck)
        });
        factor * hydraulic + dry
    }

    /// Velocity of the piston under a force: the outermost rising piece that carries it.
    fn velocity(&self, force: f64, piston: f64) -> f64 {
        let sign = if force < 0.0 { -1.0 } else { 1.0 };
        let force = force.abs();
        if self.in_void(sign) {
            // It stands, or `fill_void` moves it.
            return 0.0;
        }
        if let Some(friction) = self.friction {
            let breakaway = friction.coulomb_n * friction.breakaway_ratio;
            if !self.sliding && force < breakaway {
                return 0.0;
            }
        }
        let (g, gr) = self
            .asymmetry
            .map_or((0.0, 0.0), |effect| (effect.damping_asymmetry, effect.relief_asymmetry));
        let opens = self.nominal.f_relief_n * (1.0 + gr * sign)
            / (self.nominal.ce_n_s_per_m * (1.0 + g * sign));
        let falls = self.friction.map_or(opens, |friction| friction.stribeck_m_per_s);
        let (first, second) = if falls < opens { (falls, opens) } else { (opens, falls) };
        let far = second + 10.0;
        for (low, high) in [(second, far), (first, second), (0.0, first)] {
            let (f_low, f_high) = (self.body(low, sign, piston), self.body(high, sign, piston));
            if f_high > f_low && force >= f_low {
                return sign * (low + (high - low) * (force - f_low) / (f_high - f_low));
            }
        }
        0.0
    }
}

/// Forces of the damper under test at the ends of its steps.
pub(crate) fn simulate(damper: &Damper, excitation: &Excitation, step_us: usize) -> Vec<f64> {
    let step_s = step_us as f64 * 1e-6;
    let mut state = DamperState::starting(excitation.motion(0.0));
    let steps = (excitation.duration_s * 1e6) as usize / step_us;
    let forces = (1..=steps)
        .map(|i| damper.advance(&mut state, excitation.motion(i as f64 * step_s), step_s))
        .collect();
    assert_eq!(state.fallbacks(), 0, "{}: backward Euler was needed", excitation.name);
    forces
}

/// Root mean square.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Error over root mean square of the reference.
pub(crate) fn relative_error(forces: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(forces.len(), reference.len());
    let miss: Vec<f64> = forces.iter().zip(reference).map(|(a, b)| a - b).collect();
    rms(&miss) / rms(reference)
}

/// The four effects of a damper with the given relief point, at sizes seen in service.
pub(crate) fn effects_at(nominal: &Nominal, size: f64) -> [Effect; 4] {
    let f = nominal.f_relief_n;
    let v = nominal.v_relief_m_per_s();
    [
        SealFriction {
            coulomb_n: 0.03 * size * f,
            breakaway_ratio: 1.5,
            stribeck_m_per_s: 0.1 * v,
        }
        .into(),
        AsymmetricDamping { damping_asymmetry: 0.1 * size, relief_asymmetry: 0.06 * size }.into(),
        PositionDependentDamping { gradient_per_m: 6.0 * size, curvature_per_m2: 800.0 * size }
            .into(),
        RubberHysteresis { dynamic_stiffening: 0.15 * size, relaxation_time_s: 5e-3 }.into(),
    ]
}
