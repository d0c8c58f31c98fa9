//! An independent damper: the equations as they are written in the literature, integrated by Heun's
//! rule in steps of some microseconds, with the exact motion. It shares no code with the damper
//! under test: smooth laws are evaluated, not sampled; friction is inverted by Newton's rule, the
//! rubber is a spring with a Maxwell branch instead of a creep, and what changes slowly is
//! evaluated all the time.

mod body;
mod joint;
mod outside;

pub(crate) use body::{Body, Piston};
pub(crate) use joint::{Joint, Worked};
pub(crate) use outside::Outside;

use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};

/// A sum of sines: amplitude m, frequency Hz, phase.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excitation {
    pub(crate) name: &'static str,
    pub(crate) tones: &'static [(f64, f64, f64)],
    pub(crate) duration_s: f64,
}

/// The motion between the eyes at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instant {
    pub(crate) displacement_m: f64,
    pub(crate) velocity_m_per_s: f64,
    pub(crate) acceleration_m_per_s2: f64,
}

impl Excitation {
    pub(crate) fn at(&self, time_s: f64) -> Instant {
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        for &(amplitude, hz, phase) in self.tones {
            let w = 2.0 * std::f64::consts::PI * hz;
            let (sine, cosine) = libm::sincos(w * time_s + phase);
            x += amplitude * (sine - libm::sin(phase));
            v += amplitude * w * cosine;
            a -= amplitude * w * w * sine;
        }
        Instant { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: a }
    }

    pub(crate) fn motion(&self, time_s: f64) -> Motion {
        let at = self.at(time_s);
        Motion::new(at.displacement_m, at.velocity_m_per_s)
    }

    /// The motion at every step of a reference, the start included.
    pub(crate) fn path(&self, step_us: usize) -> Path {
        let steps = (self.duration_s * 1e6) as usize / step_us;
        let instants = (0..=steps).map(|i| self.at((i * step_us) as f64 * 1e-6)).collect();
        Path { excitation: *self, step_us, instants }
    }
}

/// A motion prepared for many references.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) excitation: Excitation,
    step_us: usize,
    instants: Vec<Instant>,
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

/// A damper in the form of the written equations, and what it remembers.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    nominal: Nominal,
    body: Body,
    joint: Joint,
    outside: Outside,
    inner: Inner,
    sliding: bool,
    void_m: f64,
    force_n: f64,
}

/// Position of the piston, deflection of the Maxwell branch, travel, foam, warmth.
type Inner = [f64; 5];

impl Reference {
    pub(crate) fn new(nominal: Nominal, effects: &[Effect]) -> Self {
        let mut reference = Self {
            nominal,
            body: Body::default(),
            joint: Joint::default(),
            outside: Outside::default(),
            inner: [0.0; 5],
            sliding: false,
            void_m: 0.0,
            force_n: 0.0,
        };
        for &effect in effects {
            let known = reference.body.take(effect)
                || reference.joint.take(effect)
                || reference.outside.take(effect);
            assert!(known, "the reference does not know {}", effect.name());
        }
        reference
    }

    /// Whether the equations here hold an effect.
    pub(crate) fn knows(effect: Effect) -> bool {
        Body::default().take(effect)
            || Joint::default().take(effect)
            || Outside::default().take(effect)
    }

    /// Force at the ends of steps of `step_us` microseconds, integrated at one.
    pub(crate) fn forces(self, excitation: &Excitation, step_us: usize) -> Vec<f64> {
        self.forces_along(&excitation.path(1), step_us)
    }

    /// The same with the step of the path.
    pub(crate) fn forces_along(mut self, path: &Path, step_us: usize) -> Vec<f64> {
        let h = path.step_us as f64 * 1e-6;
        let every = step_us / path.step_us;
        let mut forces = Vec::with_capacity(path.instants.len() / every);
        for (i, pair) in path.instants.windows(2).enumerate() {
            let next_x = pair[1].displacement_m;
            self.switch();
            let begin = self.inner;
            // The force is still that of the end of the last step.
            let rate = self.rates(&begin);
            let euler = along(&begin, h, &rate);
            self.force_n = self.attachment_n(next_x, &euler);
            let rate2 = self.rates(&euler);
            self.inner = along(&along(&begin, 0.5 * h, &rate), 0.5 * h, &rate2);
            self.fill_void(next_x, begin[0], h);
            self.force_n = self.attachment_n(next_x, &self.inner);
            let strikes = self.outside.strikes();
            let piston_m_per_s = if strikes { self.velocity(&self.inner) } else { 0.0 };
            let tight = self.joint.half_clearance_m(&self.nominal, self.inner[2]) == 0.0;
            let read = self.outside.read(h, &pair[1], self.force_n, piston_m_per_s, tight);
            if (i + 1) % every == 0 {
                forces.push(read);
            }
        }
        forces
    }

    fn attachment_n(&self, x: f64, inner: &Inner) -> f64 {
        let [piston_m, maxwell_m, travelled_m, foam, _] = *inner;
        let worked = Worked { piston_m, maxwell_m, travelled_m, foam };
        self.joint.force_n(&self.nominal, x - piston_m, &worked, self.force_n)
    }

    fn piston(&self, inner: &Inner) -> Piston {
        let [position_m, .., warmth_k] = *inner;
        Piston { position_m, warmth_k, void_m: self.void_m, sliding: self.sliding }
    }

    /// Velocity of the piston under the force of the chain.
    fn velocity(&self, inner: &Inner) -> f64 {
        self.body.velocity(&self.nominal, self.force_n, &self.piston(inner))
    }

    fn rates(&self, inner: &Inner) -> Inner {
        let force = self.force_n;
        let v = self.velocity(inner);
        let [_, maxwell, _, foam, warmth] = *inner;
        let creep = self.joint.rubber.map_or(0.0, |rubber| {
            let slow = rubber.relaxation_time_s * (1.0 + rubber.dynamic_stiffening);
            (force / self.nominal.ke_n_per_m - maxwell) / slow
        });
        let foaming = self
            .joint
            .foam
            .map_or(0.0, |oil| v.abs() / oil.travel_m * (1.0 - foam) - foam / oil.recovery_s);
        let warming = self.body.fade.map_or(0.0, |oil| {
            ((force * v).abs() - oil.cooling_w_per_k * warmth) / oil.heat_capacity_j_per_k
        });
        [v, creep, v.abs(), foaming, warming]
    }

    /// Whether the piston breaks away or comes to rest.
    fn switch(&mut self) {
        if self.body.friction.is_none() {
            return;
        }
        let piston = self.piston(&self.inner);
        let net = self.body.net_n(self.force_n, piston.position_m);
        let (dry, breakaway) = self.body.dry_n();
        if net.abs() >= breakaway {
            self.sliding = true;
        } else if self.body.in_void(net, &piston) {
            // It slides as long as the dry force is met.
            self.sliding &= net.abs() > (1.0 - 1e-6) * dry;
        } else if self.velocity(&self.inner) == 0.0 {
            self.sliding = false;
        }
    }

    /// In a void the piston follows until the attachment carries dry friction only; then the void
    /// has grown or closed by the way of the piston since `before`, and by the refill.
    fn fill_void(&mut self, x: f64, before: f64, h: f64) {
        let Some(cavitation) = self.body.cavitation else { return };
        let side = if cavitation.refill_m_per_s < 0.0 { -1.0 } else { 1.0 };
        let (dry, breakaway) = self.body.dry_n();
        let net = |position: f64| {
            let mut inner = self.inner;
            inner[0] = position;
            -side * self.body.net_n(self.attachment_n(x, &inner), position)
        };
        let holds = if self.sliding { dry } else { breakaway };
        if self.void_m > 0.0 && net(self.inner[0]) > holds {
            let (mut carries, mut slack) = (self.inner[0], self.inner[0] - side * 0.1);
            for _ in 0..45 {
                let middle = 0.5 * (carries + slack);
                if net(middle) > dry { carries = middle } else { slack = middle }
            }
            self.sliding = true;
            // What travels with the piston: wear, foam, the heat of the seal.
            let way = (slack - self.inner[0]).abs();
            self.inner[2] += way;
            self.inner[3] +=
                self.joint.foam.map_or(0.0, |oil| way / oil.travel_m * (1.0 - self.inner[3]));
            self.inner[4] +=
                self.body.fade.map_or(0.0, |oil| dry * way / oil.heat_capacity_j_per_k);
            self.inner[0] = slack;
        }
        let way = side * (self.inner[0] - before);
        self.void_m = (self.void_m + way - h * cavitation.refill_m_per_s.abs()).max(0.0);
    }
}

fn along(from: &Inner, h: f64, rate: &Inner) -> Inner {
    std::array::from_fn(|i| from[i] + h * rate[i])
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
