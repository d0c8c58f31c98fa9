//! The title of a run that gives none: vehicle, speed, and the state of its dampers.
//!
//! It is computed, so that it cannot be wrong about a damper that was edited.

use crate::slot::{Slot, SlotForce};
use firmware_core::damper::{Damper, Nominal};

/// A clearance up to here counts as new (m): twice that of a new damper.
const NEW_2A_MAX_M: f64 = 2.0 * Nominal::NEW.clearance_2a_m;

/// A series stiffness down to this share of a new damper's counts as new.
const NEW_KE_SHARE: f64 = 0.8;

/// The title of a vehicle that runs at a speed (km/h) with these dampers; `on_rig` is the damper of
/// an emulated rig.
pub(crate) fn title(vehicle: &str, speed_kmh: f64, slots: &[Slot], on_rig: &Damper) -> String {
    let running = format!("{vehicle} at {speed_kmh} km/h");
    // Places by the state of their damper, in the order of the slots.
    let mut states: Vec<(String, Vec<&str>)> = Vec::new();
    for slot in slots {
        // Where a rig stands for a damper, it is the one on the rig.
        let force = match &slot.force {
            SlotForce::StandIn { of, .. } => slots.get(*of).map_or(&slot.force, |rig| &rig.force),
            own => own,
        };
        let state = force.state(on_rig);
        match states.iter_mut().find(|(other, _)| *other == state) {
            Some((_, places)) => places.push(&slot.place),
            None => states.push((state, vec![&slot.place])),
        }
    }
    // The state of most dampers first.
    states.sort_by_key(|(_, places)| std::cmp::Reverse(places.len()));
    let dampers = match states.as_slice() {
        [] => return running,
        [(state, _)] => format!("all yaw dampers {state}"),
        [(state, _), others @ ..] => {
            let others: Vec<String> = others
                .iter()
                .map(|(state, places)| format!("{} {state}", places.join(" and ")))
                .collect();
            format!("yaw dampers {state}, {}", others.join(", "))
        }
    };
    format!("{running}, {dampers}")
}

impl SlotForce {
    /// The state of the damper in words.
    fn state(&self, on_rig: &Damper) -> String {
        match self {
            Self::Modelled(damper) => state(damper),
            Self::StandIn { .. } => state(on_rig),
            Self::Rig { virtual_clearance_2a_m, virtual_compliance_m_per_n, .. } => {
                let mut wear = Vec::new();
                if *virtual_clearance_2a_m > 0.0 {
                    let more_mm = virtual_clearance_2a_m * 1e3;
                    wear.push(format!("{more_mm} mm of clearance"));
                }
                if *virtual_compliance_m_per_n > 0.0 {
                    let stiffness = 1e-6 / virtual_compliance_m_per_n;
                    wear.push(format!("a spring of {stiffness:.3} MN/m"));
                }
                match wear.as_slice() {
                    [] => state(on_rig),
                    wear => format!("{} plus {} in software", state(on_rig), wear.join(" and ")),
                }
            }
        }
    }
}

/// The state of a damper in words that follow "yaw damper".
fn state(damper: &Damper) -> String {
    let nominal = damper.nominal();
    let mut parts = Vec::new();
    if nominal.clearance_2a_m > NEW_2A_MAX_M {
        // Three digits are enough for a title, and no trailing zeros.
        let clearance_mm = (nominal.clearance_2a_m * 1e6).round() * 1e-3;
        parts.push(format!("2a = {} mm", (clearance_mm * 1e3).round() / 1e3));
    }
    if nominal.ke_n_per_m < NEW_KE_SHARE * Nominal::NEW.ke_n_per_m {
        parts.push(format!("Ke = {:.1} MN/m", nominal.ke_n_per_m * 1e-6));
    }
    parts.extend(damper.effects().iter().map(|effect| effect.name().replace('_', " ")));
    parts.extend(damper.empirical().map(|_| "an empirical map".to_owned()));
    if parts.is_empty() { "as new".to_owned() } else { format!("with {}", parts.join(", ")) }
}
