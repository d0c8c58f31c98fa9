//! The equations of the body: valves side by side and in a row, dry friction, gas, oil that thins.

use firmware_core::damper::effects::{
    AsymmetricDamping, Cavitation, GasPreload, OrificeLeakage, PositionDependentDamping,
    QuadraticOrifice, SealFriction, SecondValveStage, SoftYield, TemperatureFade,
};
use firmware_core::damper::{Effect, Nominal};

/// What acts on the piston in addition to the force.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Piston {
    pub(crate) position_m: f64,
    pub(crate) warmth_k: f64,
    pub(crate) void_m: f64,
    pub(crate) sliding: bool,
}

/// The parts between piston and cylinder.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    pub(crate) friction: Option<SealFriction>,
    asymmetry: Option<AsymmetricDamping>,
    quadratic: Option<QuadraticOrifice>,
    leakage: Option<OrificeLeakage>,
    stage: Option<SecondValveStage>,
    soft: Option<SoftYield>,
    position: Option<PositionDependentDamping>,
    pub(crate) fade: Option<TemperatureFade>,
    gas: Option<GasPreload>,
    pub(crate) cavitation: Option<Cavitation>,
}

impl Body {
    /// Takes an effect of the body; false for any other.
    pub(crate) fn take(&mut self, effect: Effect) -> bool {
        match effect {
            Effect::SealFriction(effect) => self.friction = Some(effect),
            Effect::AsymmetricDamping(effect) => self.asymmetry = Some(effect),
            Effect::QuadraticOrifice(effect) => self.quadratic = Some(effect),
            Effect::OrificeLeakage(effect) => self.leakage = Some(effect),
            Effect::SecondValveStage(effect) => self.stage = Some(effect),
            Effect::SoftYield(effect) => self.soft = Some(effect),
            Effect::PositionDependentDamping(effect) => self.position = Some(effect),
            Effect::TemperatureFade(effect) => self.fade = Some(effect),
            Effect::GasPreload(effect) => self.gas = Some(effect),
            Effect::Cavitation(effect) => self.cavitation = Some(effect),
            _ => return false,
        }
        true
    }

    /// The force of the chain without the one that stands on the piston, N.
    pub(crate) fn net_n(&self, force_n: f64, position_m: f64) -> f64 {
        self.gas.map_or(force_n, |gas| force_n - gas.rate_n_per_m * position_m + gas.preload_n)
    }

    /// Sliding and breakaway force of the seal, N.
    pub(crate) fn dry_n(&self) -> (f64, f64) {
        self.friction
            .map_or((0.0, 0.0), |seal| (seal.coulomb_n, seal.coulomb_n * seal.breakaway_ratio))
    }

    /// True when a net force of this sign finds a void instead of oil.
    pub(crate) fn in_void(&self, net_n: f64, piston: &Piston) -> bool {
        let side = self.cavitation.is_some_and(|effect| effect.refill_m_per_s * net_n < 0.0);
        side && piston.void_m > 0.0
    }

    /// Velocity of the piston under a force of the chain.
    pub(crate) fn velocity(&self, nominal: &Nominal, force_n: f64, piston: &Piston) -> f64 {
        let net = self.net_n(force_n, piston.position_m);
        let (sign, size) = (if net < 0.0 { -1.0 } else { 1.0 }, net.abs());
        if self.in_void(net, piston) {
            // It stands, or the void moves it.
            return 0.0;
        }
        let x = piston.position_m;
        let bore = self.position.map_or(1.0, |effect| {
            1.0 + effect.gradient_per_m * x + effect.curvature_per_m2 * x * x
        });
        let thin = self.fade.map_or(1.0, |oil| libm::exp(oil.fade_per_k * piston.warmth_k));
        let oil = |carried: f64| {
            let (v, slope) = self.through(nominal, carried / bore, sign);
            (thin * v, thin * slope / bore)
        };
        let Some(seal) = self.friction else { return sign * oil(size).0 };
        let (dry, breakaway) = self.dry_n();
        let mut carried = size - dry;
        if carried <= 0.0 || (!piston.sliding && size < breakaway) {
            return 0.0;
        }
        // Oil and seal together, from the outside: the seal's part beyond the sliding force.
        let more = dry * (seal.breakaway_ratio - 1.0);
        for _ in 0..60 {
            let (v, slope) = oil(carried);
            if v >= seal.stribeck_m_per_s {
                break;
            }
            let miss = carried + more * (1.0 - v / seal.stribeck_m_per_s) + dry - size;
            let rate = 1.0 - more * slope / seal.stribeck_m_per_s;
            if rate <= 0.0 {
                // Past the lowest sum: no velocity carries this force, the piston comes to rest.
                return 0.0;
            }
            let step = miss / rate;
            carried -= step;
            if carried <= 0.0 {
                return 0.0;
            }
            if step.abs() < 1e-13 * size {
                break;
            }
        }
        sign * oil(carried).0
    }

    /// Velocity, and its slope over force, that the oil lets through at a force above zero.
    fn through(&self, nominal: &Nominal, force_n: f64, sign: f64) -> (f64, f64) {
        let (g, gr) = self
            .asymmetry
            .map_or((0.0, 0.0), |effect| (effect.damping_asymmetry, effect.relief_asymmetry));
        let relief = 1.0 + gr * sign;
        let damping = 1.0 + g * sign;
        let (v, slope) = self.oil(nominal, force_n / relief);
        (v * relief / damping, slope / damping)
    }

    /// The same of the oil in one direction: its valves, and a yield force parallel to them.
    fn oil(&self, nominal: &Nominal, force_n: f64) -> (f64, f64) {
        let Some(soft) = self.soft else { return self.stages(nominal, force_n) };
        // The part that the valves carry: bracketed, for the slope jumps at their knees.
        let (mut low, mut high) = ((force_n - soft.yield_n).max(0.0), force_n);
        let mut carried = 0.5 * (low + high);
        for _ in 0..100 {
            let (v, slope) = self.stages(nominal, carried);
            let share = libm::tanh(v / soft.knee_m_per_s);
            let per_velocity = soft.yield_n * (1.0 - share * share) / soft.knee_m_per_s;
            let miss = carried + soft.yield_n * share - force_n;
            if miss > 0.0 {
                high = carried;
            } else {
                low = carried;
            }
            let rate = 1.0 + per_velocity * slope;
            let next = carried - miss / rate;
            if (next - carried).abs() <= 1e-12 * force_n {
                return (v, slope / rate);
            }
            carried = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        let (v, slope) = self.stages(nominal, carried);
        let share = libm::tanh(v / soft.knee_m_per_s);
        let per_velocity = soft.yield_n * (1.0 - share * share) / soft.knee_m_per_s;
        (v, slope / (1.0 + per_velocity * slope))
    }

    /// The same of the valve with its leak and its second stage.
    fn stages(&self, nominal: &Nominal, force: f64) -> (f64, f64) {
        let (mut v, mut slope) = self.valves(nominal, force);
        if let Some(stage) = self.stage
            && force > stage.knee_force_n
        {
            let knee = stage.knee_force_n;
            let end = if knee < nominal.f_relief_n { nominal.f_relief_n } else { f64::INFINITY };
            let more = 1.0 / stage.slope_ratio - 1.0;
            let reached = if force < end { v } else { self.valves(nominal, end).0 };
            v += more * (reached - self.valves(nominal, knee).0);
            slope *= if force < end { 1.0 + more } else { 1.0 };
        }
        (v, slope)
    }

    /// The same of the valve with its leak.
    fn valves(&self, nominal: &Nominal, force_n: f64) -> (f64, f64) {
        let (ce, opens) = (nominal.ce_n_s_per_m, nominal.f_relief_n);
        let below = |force: f64| match self.quadratic {
            None => (force / ce, 1.0 / ce),
            Some(orifice) => {
                let b = orifice.quadratic_n_s2_per_m2;
                let root = libm::sqrt(ce * ce + 4.0 * b * force);
                ((root - ce) / (2.0 * b), 1.0 / root)
            }
        };
        let (mut v, mut slope) = if force_n <= opens {
            below(force_n)
        } else {
            let c2 = nominal.c2_n_s_per_m;
            (below(opens).0 + (force_n - opens) / c2, 1.0 / c2)
        };
        if let Some(leak) = self.leakage {
            let scale = if opens.is_finite() { opens } else { 0.1 * ce };
            let share = leak.leakage_m_per_s * libm::sqrt(force_n / scale);
            v += share;
            slope += 0.5 * share / force_n.max(1e-12 * scale);
        }
        (v, slope)
    }
}
