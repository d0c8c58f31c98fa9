//! The servo-valve: a spool that follows its command, and the flow that it lets through.
//!
//! ```text
//! u'' + 2 z w u' + w^2 u = w^2 c,  |u| <= 1        Q = Qn u sqrt(max(0, (ps - sign(u) pL) / ps))
//! ```
//!
//! `c` is the command and `u` the opening, both as a share of the full opening; `pL` is the load
//! pressure, `ps` that of the supply. `Qn` is the flow of the open valve without load. The pump
//! limits the flow. The root is the orifice equation for two equal edges in series (Merritt,
//! Hydraulic Control Systems, 1967); a valve never lets oil back into the supply. Limits: no
//! overlap, no hysteresis, no leakage of the spool; the supply pressure does not fall.

use scenario::rig::ServoSetup;
use std::f64::consts::TAU;

/// A servo-valve for one length of substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Valve {
    /// Change of the spool's rate by the command in a substep (1/s).
    push_per_s: f64,
    /// Half of the share of its rate that the spool loses in a substep.
    loss: f64,
    rated_flow_m3_per_s: f64,
    pump_flow_m3_per_s: f64,
    supply_pa: f64,
    step_s: f64,
}

/// The spool.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Spool {
    /// Opening at the end of the substep, from -1 to 1.
    pub(crate) opening: f64,
    /// Its rate in the middle of the substep (1/s).
    pub(crate) rate_per_s: f64,
}

impl Valve {
    /// A valve for substeps of this length (s).
    pub(crate) fn new(setup: &ServoSetup, step_s: f64) -> Self {
        let natural_per_s = TAU * setup.valve_hz;
        debug_assert!(natural_per_s * step_s < 1.0, "a spool faster than the substeps");
        Self {
            push_per_s: natural_per_s * natural_per_s * step_s,
            loss: setup.valve_damping_ratio * natural_per_s * step_s,
            rated_flow_m3_per_s: setup.rated_flow_m3_per_s,
            pump_flow_m3_per_s: setup.pump_flow_m3_per_s,
            supply_pa: setup.supply_pa,
            step_s,
        }
    }

    /// The spool over a substep; its mean opening.
    pub(crate) fn advance(&self, spool: &mut Spool, command: f64) -> f64 {
        let before = spool.opening;
        let pushed = spool.rate_per_s * (1.0 - self.loss) + self.push_per_s * (command - before);
        spool.rate_per_s = pushed / (1.0 + self.loss);
        let opening = before + self.step_s * spool.rate_per_s;
        spool.opening = opening.clamp(-1.0, 1.0);
        if spool.opening != opening {
            spool.rate_per_s = 0.0;
        }
        0.5 * (before + spool.opening)
    }

    /// Flow into the cylinder (m3/s) at a load pressure (Pa).
    pub(crate) fn flow_m3_per_s(&self, opening: f64, load_pa: f64) -> f64 {
        debug_assert!(opening.abs() <= 1.0, "opening of {opening}");
        let drop = (self.supply_pa - opening.signum() * load_pa) / self.supply_pa;
        let flow = self.rated_flow_m3_per_s * opening * libm::sqrt(drop.max(0.0));
        flow.clamp(-self.pump_flow_m3_per_s, self.pump_flow_m3_per_s)
    }
}
