//! A body with laws as a vector of numbers that a solver may choose freely.

use super::body::Body;
use super::law::{Kind, Law, LawInfo, Sizes, nominal};
use super::linear::Linear;
use super::record::Record;
use firmware_core::damper::Damper;

/// Names and units of the numbers of the body itself.
pub(crate) const BODY: [(&str, &str); 3] =
    [("mass_kg", "kg"), ("k0_n_per_m", "N/m"), ("c0_n_s_per_m", "N s/m")];

/// The laws of a body and the sizes of its numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    /// The laws, in order of acceptance.
    pub(crate) laws: Vec<&'static LawInfo>,
    /// Sizes of the records.
    pub(crate) sizes: Sizes,
    mass_kg: f64,
}

impl Model {
    /// A body on a spring and a dashpot.
    pub(super) fn linear(start: Linear, sizes: Sizes) -> Self {
        Self { laws: Vec::new(), sizes, mass_kg: start.mass_kg }
    }

    /// This model with another law.
    #[must_use]
    pub(super) fn with(&self, law: &'static LawInfo) -> Self {
        let mut wider = self.clone();
        wider.laws.push(law);
        wider
    }

    /// Scale of every parameter, and whether it is above zero.
    fn coordinates(&self) -> Vec<(f64, bool)> {
        let Sizes { stiffness_n_per_m, damping_n_s_per_m, .. } = self.sizes;
        let body = [(self.mass_kg, true), (stiffness_n_per_m, false), (damping_n_s_per_m, false)];
        let laws = self.laws.iter().flat_map(|law| law.parameters);
        let laws = laws.map(|row| ((row.scale)(&self.sizes), row.positive));
        body.into_iter().chain(laws).collect()
    }

    /// Number of parameters, starts of the records not counted.
    pub(crate) fn parameters(&self) -> usize {
        BODY.len() + self.laws.iter().map(|law| law.parameters.len()).sum::<usize>()
    }

    /// Parameters from free numbers.
    pub(crate) fn values(&self, free: &[f64]) -> Vec<f64> {
        let pairs = self.coordinates().into_iter().zip(free);
        let value = |((scale, positive), u): ((f64, bool), &f64)| {
            if positive { scale * libm::exp(u.clamp(-40.0, 40.0)) } else { scale * u }
        };
        pairs.map(value).collect()
    }

    /// Free numbers of parameters.
    pub(super) fn free(&self, values: &[f64]) -> Vec<f64> {
        let pairs = self.coordinates().into_iter().zip(values);
        let free = |((scale, positive), value): ((f64, bool), &f64)| {
            if positive {
                libm::log((value / scale).max(f64::MIN_POSITIVE)).clamp(-40.0, 40.0)
            } else {
                value / scale
            }
        };
        pairs.map(free).collect()
    }

    /// Standard deviations of parameters from those of free numbers.
    pub(super) fn deviations(&self, values: &[f64], free: &[f64]) -> Vec<f64> {
        let rows = self.coordinates().into_iter().zip(values).zip(free);
        rows.map(|(((scale, positive), value), std)| std * if positive { *value } else { scale })
            .collect()
    }

    /// The body, if these values make one.
    pub(super) fn body(&self, values: &[f64], step_s: f64) -> Option<Body> {
        let [mass_kg, k0_n_per_m, c0_n_s_per_m] = *values.first_chunk::<3>()?;
        let mut rest = &values[BODY.len()..];
        let mut laws = Vec::with_capacity(self.laws.len());
        let mut damper = None;
        for law in &self.laws {
            let (own, other) = rest.split_at_checked(law.parameters.len())?;
            if law.kind == Kind::SeriesDamper {
                damper = Some(Damper::new(nominal(own)?, &[]).ok()?.prepared(step_s));
            } else {
                laws.push(Law::new(law.kind, own, step_s)?);
            }
            rest = other;
        }
        let Sizes { displacement_m, velocity_m_per_s, .. } = self.sizes;
        let finite = values.iter().all(|value| value.is_finite());
        (finite && mass_kg > 0.0).then_some(Body {
            mass_kg,
            k0_n_per_m,
            c0_n_s_per_m,
            laws,
            damper,
            step_s,
            velocity_m_per_s,
            displacement_m,
        })
    }

    /// The motion of a record, and from which displacement and velocity it starts.
    pub(super) fn simulate(
        &self,
        values: &[f64],
        record: &Record,
        start: [f64; 2],
    ) -> Option<Vec<f64>> {
        record.simulate(&self.body(values, record.simulation_step_s())?, start)
    }
}
