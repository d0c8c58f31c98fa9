//! The candidates of motion: what a spring and a dashpot lack, as forces on the body.

use super::travel::Travel;
use firmware_core::damper::Nominal;

/// Which law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    QuadraticStiffness,
    CubicStiffness,
    QuadraticDamping,
    DampingOverPosition,
    Stop,
    DryFriction,
    Offset,
    RelaxingSpring,
    PreslidingFriction,
    BoucWen,
    SeriesDamper,
}

/// One law of the catalogue.
#[derive(Debug)]
pub(crate) struct LawInfo {
    pub(crate) kind: Kind,
    /// Name in results.
    pub(crate) name: &'static str,
    /// Its force, for people.
    pub(crate) equation: &'static str,
    pub(crate) parameters: &'static [Parameter],
}

/// One parameter of a law.
#[derive(Debug)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    /// Only above zero.
    pub(crate) positive: bool,
    /// Its size from those of force, displacement and velocity.
    pub(crate) scale: fn(&Sizes) -> f64,
    /// Start values, as multiples of the size.
    pub(crate) starts: &'static [f64],
}

/// Sizes of a record: rms of the force, displacement and velocity of the linear model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sizes {
    pub(crate) force_n: f64,
    pub(crate) displacement_m: f64,
    pub(crate) velocity_m_per_s: f64,
    pub(crate) stiffness_n_per_m: f64,
    pub(crate) damping_n_s_per_m: f64,
}

const fn free(
    name: &'static str,
    unit: &'static str,
    scale: fn(&Sizes) -> f64,
    starts: &'static [f64],
) -> Parameter {
    Parameter { name, unit, positive: false, scale, starts }
}

const fn positive(
    name: &'static str,
    unit: &'static str,
    scale: fn(&Sizes) -> f64,
    starts: &'static [f64],
) -> Parameter {
    Parameter { name, unit, positive: true, scale, starts }
}

/// Ratio of force to displacement in the record.
fn stiffness(of: &Sizes) -> f64 {
    of.stiffness_n_per_m.max(of.force_n / of.displacement_m)
}

/// All candidates. The start values of one law belong together: the first of every parameter, then
/// the second.
pub(crate) const LAWS: &[LawInfo] = &[
    LawInfo {
        kind: Kind::QuadraticStiffness,
        name: "quadratic_stiffness",
        equation: "k2 y^2",
        parameters: &[free(
            "k2_n_per_m2",
            "N/m2",
            |of| of.stiffness_n_per_m / of.displacement_m,
            &[0.02, -0.02],
        )],
    },
    LawInfo {
        kind: Kind::CubicStiffness,
        name: "cubic_stiffness",
        equation: "k3 y^3",
        parameters: &[free(
            "k3_n_per_m3",
            "N/m3",
            |of| of.stiffness_n_per_m / (of.displacement_m * of.displacement_m),
            &[0.02, -0.02],
        )],
    },
    LawInfo {
        kind: Kind::QuadraticDamping,
        name: "quadratic_damping",
        equation: "c2 v |v|",
        parameters: &[free(
            "c2_n_s2_per_m2",
            "N s2/m2",
            |of| of.damping_n_s_per_m / of.velocity_m_per_s,
            &[0.1],
        )],
    },
    LawInfo {
        kind: Kind::DampingOverPosition,
        name: "damping_over_position",
        equation: "cy y^2 v",
        parameters: &[free(
            "cy_n_s_per_m3",
            "N s/m3",
            |of| of.damping_n_s_per_m / (of.displacement_m * of.displacement_m),
            &[0.1],
        )],
    },
    LawInfo {
        kind: Kind::Stop,
        name: "clearance_or_stop",
        equation: "ks (|y| - g) sgn(y) beyond |y| = g: a stop for ks > 0, a spring that lets go \
            for ks < 0",
        parameters: &[
            free("ks_n_per_m", "N/m", |of| of.stiffness_n_per_m, &[0.3, 0.3, -0.2, -0.2]),
            positive("g_m", "m", |of| of.displacement_m, &[0.5, 1.5, 0.5, 1.5]),
        ],
    },
    LawInfo {
        kind: Kind::DryFriction,
        name: "dry_friction",
        equation: "Fc tanh(v / vs)",
        parameters: &[
            positive("fc_n", "N", |of| of.force_n, &[0.02, 0.02, 0.2, 0.2]),
            positive("vs_m_per_s", "m/s", |of| of.velocity_m_per_s, &[0.03, 0.3, 0.03, 0.3]),
        ],
    },
    LawInfo {
        kind: Kind::Offset,
        name: "force_offset",
        equation: "F0",
        parameters: &[free("f0_n", "N", |of| of.force_n, &[0.01])],
    },
    LawInfo {
        kind: Kind::RelaxingSpring,
        name: "relaxing_spring",
        equation: "z, z' = kr v - z / tau",
        parameters: &[
            positive("kr_n_per_m", "N/m", stiffness, &[0.1, 0.1, 0.1]),
            positive("tau_s", "s", |of| of.displacement_m / of.velocity_m_per_s, &[0.2, 1.0, 5.0]),
        ],
    },
    LawInfo {
        kind: Kind::PreslidingFriction,
        name: "presliding_friction",
        equation: "z, dz/dx = (Fc sgn(dx) - z) / xd",
        parameters: &[
            positive("fc_n", "N", |of| of.force_n, &[0.05, 0.3, 0.3]),
            positive("xd_m", "m", |of| of.displacement_m, &[0.3, 0.3, 2.0]),
        ],
    },
    LawInfo {
        kind: Kind::BoucWen,
        name: "bouc_wen",
        equation: "z, z' = A v - B1 |v| z - B2 v |z|",
        parameters: &[
            free("a_n_per_m", "N/m", stiffness, &[0.3, 0.3, 0.3]),
            free("b1_per_m", "1/m", |of| 1.0 / of.displacement_m, &[0.4, 0.4, 0.4]),
            free("b2_per_m", "1/m", |of| 1.0 / of.displacement_m, &[-0.4, 0.02, 0.3]),
        ],
    },
    SERIES_DAMPER,
];

/// The damper of the core: clearance and stiffness in series with a dashpot that has a relief.
pub(crate) const SERIES_DAMPER: LawInfo = LawInfo {
    kind: Kind::SeriesDamper,
    name: "series_damper",
    equation: "clearance 2a and stiffness Ke in series with a dashpot Ce that opens at Fr",
    parameters: &[
        positive("ce_n_s_per_m", "N s/m", |of| of.force_n / of.velocity_m_per_s, &[0.3, 0.3]),
        positive("ke_n_per_m", "N/m", stiffness, &[3.0, 1.0]),
        positive("clearance_2a_m", "m", |of| of.displacement_m, &[0.05, 0.5]),
        positive("f_relief_n", "N", |of| of.force_n, &[1.0, 0.3]),
        positive("c2_n_s_per_m", "N s/m", |of| of.force_n / of.velocity_m_per_s, &[0.1, 0.05]),
    ],
};

impl PartialEq for LawInfo {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl LawInfo {
    /// What a law in parallel to the spring adds to its stiffness at small motion, N/m.
    pub(super) fn stiffness_of_start(&self, values: &[f64]) -> Option<f64> {
        match (self.kind, values) {
            (Kind::BoucWen, [a, ..]) => Some(*a),
            (Kind::PreslidingFriction, [capacity, length]) => Some(0.5 * capacity / length),
            _ => None,
        }
    }

    /// Number of start values.
    pub(super) fn starts(&self) -> usize {
        self.parameters.iter().map(|row| row.starts.len()).max().unwrap_or(0)
    }
}

/// A law with its numbers, for steps of one length.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Law {
    QuadraticStiffness { k2: f64 },
    CubicStiffness { k3: f64 },
    QuadraticDamping { c2: f64 },
    DampingOverPosition { cy: f64 },
    Stop { ks: f64, gap: f64 },
    DryFriction { fc: f64, per_vs: f64 },
    Offset { force_n: f64 },
    RelaxingSpring { decay: f64, gain: f64 },
    Travel(Travel),
}

/// A try of the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trial {
    /// Displacement at its end, m.
    pub(super) y: f64,
    /// Velocity at its end, m/s.
    pub(super) v: f64,
    /// Displacement from its beginning, m.
    pub(super) travel: f64,
}

impl Law {
    /// A law from its parameters; none where they make none. The series damper is no law but the
    /// damper of the core.
    pub(super) fn new(kind: Kind, values: &[f64], step_s: f64) -> Option<Self> {
        let at = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        let law = match kind {
            Kind::QuadraticStiffness => Self::QuadraticStiffness { k2: at(0) },
            Kind::CubicStiffness => Self::CubicStiffness { k3: at(0) },
            Kind::QuadraticDamping => Self::QuadraticDamping { c2: at(0) },
            Kind::DampingOverPosition => Self::DampingOverPosition { cy: at(0) },
            Kind::Stop => Self::Stop { ks: at(0), gap: at(1) },
            Kind::DryFriction => Self::DryFriction { fc: at(0), per_vs: 1.0 / at(1) },
            Kind::Offset => Self::Offset { force_n: at(0) },
            Kind::RelaxingSpring => {
                let (stiffness, tau_s) = (at(0), at(1));
                let gain = stiffness * tau_s * -libm::expm1(-step_s / tau_s) / step_s;
                Self::RelaxingSpring { decay: libm::exp(-step_s / tau_s), gain }
            }
            Kind::PreslidingFriction => {
                let (capacity, length) = (at(0), at(1));
                Self::Travel(Travel {
                    stiffness_n_per_m: capacity / length,
                    b1: 1.0 / length,
                    b2: 0.0,
                })
            }
            Kind::BoucWen => {
                Self::Travel(Travel { stiffness_n_per_m: at(0), b1: at(1), b2: at(2) })
            }
            Kind::SeriesDamper => return None,
        };
        values.iter().all(|value| value.is_finite()).then_some(law)
    }

    /// The force at the end of a step, N, and its change per change of the displacement there (N/m)
    /// and of the velocity (N s/m). `memory` is the force of a law with a memory, N.
    #[inline]
    pub(super) fn force(&self, memory: &mut f64, trial: &Trial) -> (f64, f64, f64) {
        let Trial { y, v, travel } = *trial;
        match self {
            Self::QuadraticStiffness { k2 } => (k2 * y * y, 2.0 * k2 * y, 0.0),
            Self::CubicStiffness { k3 } => (k3 * y * y * y, 3.0 * k3 * y * y, 0.0),
            Self::QuadraticDamping { c2 } => (c2 * v * v.abs(), 0.0, 2.0 * c2 * v.abs()),
            Self::DampingOverPosition { cy } => (cy * y * y * v, 2.0 * cy * y * v, cy * y * y),
            Self::Stop { ks, gap } => match y.abs() - gap {
                beyond if beyond > 0.0 => (ks * beyond * y.signum(), *ks, 0.0),
                _ => (0.0, 0.0, 0.0),
            },
            Self::DryFriction { fc, per_vs } => {
                let part = libm::tanh(v * per_vs);
                (fc * part, 0.0, fc * per_vs * (1.0 - part * part))
            }
            Self::Offset { force_n } => (*force_n, 0.0, 0.0),
            Self::RelaxingSpring { decay, gain } => {
                *memory = decay * *memory + gain * travel;
                (*memory, *gain, 0.0)
            }
            Self::Travel(law) => {
                let (end, slope) = law.after(*memory, travel);
                *memory = end;
                (end, slope, 0.0)
            }
        }
    }
}

/// The damper of the core from the parameters of `series_damper`.
pub(crate) fn nominal(values: &[f64]) -> Option<Nominal> {
    let [ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m] =
        *values.first_chunk::<5>()?;
    Some(Nominal { ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m })
}
