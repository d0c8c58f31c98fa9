//! The moving mass of a modelled damper belongs to the bodies that it is fixed to.
//!
//! ```text
//! m -> m + m_d/2        I -> I + (m_d/2) (|r|^2 - r_i^2)        at either end, r the mount
//! ```
//!
//! On a bench the mass `m_d` between load cell and damper is read as a force m x''. In a vehicle
//! that force would need the acceleration that it causes: an algebraic loop. So half of the mass
//! goes to each end as a mass point fixed to the body there, and the damper of the vehicle step has
//! no such effect any more. A damper on a rig keeps it: there it is measured.
//!
//! Limits: the centre of gravity of the body stays where it is, and a half on the track is lost.

use firmware_core::damper::{Damper, DamperError, Effect};
use firmware_core::vehicle::{Anchor, BodyId, Vehicle};

/// Moves the mass of the damper in a slot to the bodies; gives the damper without it.
///
/// # Errors
/// None in practice: a valid damper stays valid without its mass.
pub(crate) fn give_to_bodies(
    vehicle: &mut Vehicle,
    slot: usize,
    damper: Damper,
) -> Result<Damper, DamperError> {
    let (Some(mass_kg), Some(mount)) = (mass_kg(&damper), vehicle.dampers.get(slot).copied())
    else {
        return Ok(damper);
    };
    for end in [&mount.first, &mount.second] {
        add_point_mass(vehicle, end, 0.5 * mass_kg);
    }
    without(damper)
}

/// The moving mass of a damper (kg), if it has the effect.
pub fn mass_kg(damper: &Damper) -> Option<f64> {
    damper.effects().iter().find_map(|effect| match effect {
        Effect::MovingMass(effect) => Some(effect.mass_kg),
        _ => None,
    })
}

/// The damper without its moving mass.
///
/// # Errors
/// None in practice, as above.
pub fn without(damper: Damper) -> Result<Damper, DamperError> {
    let has_mass = |effect: &Effect| matches!(effect, Effect::MovingMass(_));
    if !damper.effects().iter().any(has_mass) {
        return Ok(damper);
    }
    let others = |effect: &&Effect| !has_mass(effect);
    let left: Vec<Effect> = damper.effects().iter().filter(others).copied().collect();
    let lighter = Damper::new(*damper.nominal(), &left)?;
    Ok(match damper.empirical() {
        Some(map) => lighter.with_empirical(map.clone()),
        None => lighter,
    })
}

/// Fixes a mass point to a body.
fn add_point_mass(vehicle: &mut Vehicle, at: &Anchor, mass_kg: f64) {
    if at.body == BodyId::GROUND {
        return;
    }
    if let Some(body) = vehicle.bodies.get_mut(at.body.index()) {
        body.mass_kg += mass_kg;
        for (axis, inertia) in body.inertia_kg_m2.iter_mut().enumerate() {
            *inertia += mass_kg * (at.point_m.norm_squared() - at.point_m[axis] * at.point_m[axis]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::run::{Overrides, Run, SlotForce};
    use crate::source::Source;
    use std::path::Path;

    /// A scenario in the folder of the others, with something changed.
    fn run(more: &str) -> Run {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/mass.toml"));
        let text = format!(
            "title = \"mass\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 100.0\nduration_s = 1.0\n{more}"
        );
        Run::from_source(&Source::from_text(path, &text), Overrides::default()).unwrap()
    }

    const MASS: &str = "[[damper.effect]]\nname = \"moving_mass\"\nmass_kg = 24.0\n";
    const SEAL: &str = "[[damper.effect]]\nname = \"seal_friction\"\ncoulomb_n = 200.0\n\
        breakaway_ratio = 1.2\nstribeck_m_per_s = 0.001\n";

    fn body<'a>(run: &'a Run, name: &str) -> &'a firmware_core::vehicle::Body {
        &run.vehicle.bodies[run.body_names.iter().position(|known| known == name).unwrap()]
    }

    #[test]
    fn halves_go_to_both_ends_with_their_lever_arms() {
        let (plain, heavy) = (run(SEAL), run(&format!("{SEAL}{MASS}")));
        for (name, dampers) in [("carbody", 4.0), ("bogie_front", 2.0), ("bogie_rear", 2.0)] {
            let (before, after) = (body(&plain, name), body(&heavy, name));
            let close =
                |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * a.abs().max(1.0), "{a} {b}");
            close(after.mass_kg - before.mass_kg, dampers * 12.0);
            // Mounted 1.40 m off the centre line, at 0.775 m above the rail, at the bogies'
            // stations.
            let z = 0.775 - before.height_m;
            let x = if name == "carbody" { body(&plain, "bogie_front").station_m } else { 0.0 };
            let expected = [1.4 * 1.4 + z * z, x * x + z * z, x * x + 1.4 * 1.4];
            for (axis, radius2_m2) in expected.into_iter().enumerate() {
                let added = after.inertia_kg_m2[axis] - before.inertia_kg_m2[axis];
                let expected = dampers * 12.0 * radius2_m2;
                assert!((added - expected).abs() < 1e-6, "{name} {axis}: {added} {expected}");
            }
        }
        let wheelset =
            run(MASS).body_names.iter().position(|name| name.contains("wheelset")).unwrap();
        assert_eq!(plain.vehicle.bodies[wheelset], heavy.vehicle.bodies[wheelset]);
    }

    #[test]
    fn modelled_dampers_lose_the_mass_and_nothing_else() {
        let (plain, heavy) = (run(SEAL), run(&format!("{SEAL}{MASS}")));
        assert_eq!(plain.slots, heavy.slots);
        assert_eq!(plain.vehicle.dampers, heavy.vehicle.dampers);
    }

    #[test]
    fn a_rig_keeps_the_mass() {
        let on_rig = "[[slot]]\nplace = \"front left\"\non = \"rig\"\nnode = 1\n";
        let (plain, heavy) = (run(on_rig), run(&format!("{MASS}{on_rig}")));
        assert_eq!(heavy.rig.damper.effects().len(), 1);
        let modelled =
            heavy.slots.iter().filter(|slot| matches!(slot.force, SlotForce::Modelled(_)));
        assert_eq!(modelled.count(), 3);
        let added = |name: &str| body(&heavy, name).mass_kg - body(&plain, name).mass_kg;
        assert!((added("carbody") - 36.0).abs() < 1e-9, "{}", added("carbody"));
        assert!((added("bogie_front") - 12.0).abs() < 1e-9);
        assert!((added("bogie_rear") - 24.0).abs() < 1e-9);
    }
}
