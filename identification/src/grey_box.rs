//! A grey-box model: the nominal damper and named effects as a vector of parameters.

use super::coordinate::Coordinate;
use firmware_core::damper::effects::{EffectInfo, Scale};
use firmware_core::damper::{Damper, Nominal};

/// Names and units of the nominal parameters, in the order of the vector.
pub(crate) const NOMINAL: [(&str, &str); 5] = [
    ("ce_n_s_per_m", "N s/m"),
    ("ke_n_per_m", "N/m"),
    ("clearance_2a_m", "m"),
    ("f_relief_n", "N"),
    ("c2_n_s_per_m", "N s/m"),
];

/// Place of the damping among them.
pub(crate) const CE: usize = 0;
/// Of the stiffness.
pub(crate) const KE: usize = 1;
/// Of the clearance.
pub(crate) const CLEARANCE: usize = 2;
/// Of the relief force.
pub(crate) const RELIEF: usize = 3;
/// Of the slope beyond relief.
pub(crate) const C2: usize = 4;

/// The effects of a model and the bounds of its parameters.
#[derive(Debug, Clone)]
pub struct GreyBox {
    /// The effects, in order of acceptance.
    pub effects: Vec<&'static EffectInfo>,
    coordinates: Vec<Coordinate>,
}

impl GreyBox {
    /// The nominal damper for records of this size.
    pub fn nominal(scale: &Scale) -> Self {
        let Scale { force_n, velocity_m_per_s, displacement_m, .. } = *scale;
        let ce = force_n / velocity_m_per_s;
        let ke = force_n / displacement_m;
        let coordinates = vec![
            Coordinate::new(1e-3 * ce, 1e4 * ce, ce),
            Coordinate::new(1e-2 * ke, 1e4 * ke, ke),
            Coordinate::new(0.0, 4.0 * displacement_m, 0.02 * displacement_m),
            Coordinate::new(1e-3 * force_n, 5.0 * force_n, force_n),
            Coordinate::new(1e-5 * ce, 1e2 * ce, ce),
        ];
        Self { effects: Vec::new(), coordinates }
    }

    /// This model with another effect.
    #[must_use]
    pub fn with(&self, effect: &'static EffectInfo, scale: &Scale) -> Self {
        debug_assert!(
            self.effects.iter().all(|known| known.name != effect.name),
            "{} is in the model already",
            effect.name
        );
        let mut wider = self.clone();
        wider.effects.push(effect);
        for row in effect.parameters {
            let (lower, upper) = row.bounds(scale);
            wider.coordinates.push(Coordinate::new(lower, upper, row.usual(scale)));
        }
        wider
    }

    /// Parameters of the given effect in the vector.
    pub fn range_of(&self, effect: usize) -> std::ops::Range<usize> {
        let before: usize = self.effects[..effect].iter().map(|e| e.parameters.len()).sum();
        let start = NOMINAL.len() + before;
        start..start + self.effects[effect].parameters.len()
    }

    /// Coordinates of the parameters.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Parameters from free coordinates.
    pub fn values(&self, free: &[f64]) -> Vec<f64> {
        debug_assert_eq!(free.len(), self.coordinates.len(), "one coordinate per parameter");
        self.coordinates.iter().zip(free).map(|(coordinate, u)| coordinate.value(*u)).collect()
    }

    /// Free coordinates of parameters.
    pub fn free(&self, values: &[f64]) -> Vec<f64> {
        debug_assert_eq!(values.len(), self.coordinates.len(), "one value per parameter");
        self.coordinates.iter().zip(values).map(|(coordinate, v)| coordinate.at(*v)).collect()
    }

    /// Start values with every value lifted off zero.
    pub fn lifted(&self, values: &[f64]) -> Vec<f64> {
        self.coordinates.iter().zip(values).map(|(coordinate, v)| coordinate.lifted(*v)).collect()
    }

    /// The same for values stuck at zero only; none where no value is.
    pub fn freed(&self, values: &[f64]) -> Option<Vec<f64>> {
        let pairs = self.coordinates.iter().zip(values);
        let freed: Vec<f64> = pairs.map(|(coordinate, v)| coordinate.freed(*v)).collect();
        (freed != values).then_some(freed)
    }

    /// The damper, if these values make one.
    pub fn damper(&self, values: &[f64]) -> Option<Damper> {
        let [ce, ke, two_a, f_relief, c2] = *values.first_chunk::<5>()?;
        let nominal = Nominal {
            ce_n_s_per_m: ce,
            ke_n_per_m: ke,
            clearance_2a_m: two_a,
            f_relief_n: f_relief,
            c2_n_s_per_m: c2,
        };
        let mut effects = Vec::with_capacity(self.effects.len());
        for (index, info) in self.effects.iter().enumerate() {
            effects.push(info.effect(&values[self.range_of(index)]).ok()?);
        }
        Damper::new(nominal, &effects).ok()
    }
}

/// The vector of a nominal damper.
pub fn vector_of(nominal: &Nominal) -> Vec<f64> {
    let Nominal { ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m } = *nominal;
    vec![ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m]
}
