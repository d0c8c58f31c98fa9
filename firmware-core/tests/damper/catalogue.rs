//! Every effect of the catalogue carries what the campaign and the tests need, so that a new effect
//! needs only its file and its line in the list. These tests go through the catalogue.

use crate::sizes::{catalogue_at, effects_at};
use firmware_core::damper::effects::{CATALOGUE, Draw};
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};
use firmware_core::fnv;

/// Every combination of the ends of the shape, with both signs.
fn draws() -> impl Iterator<Item = Draw> {
    (0..16_u8).map(|bits| Draw {
        nominal: Nominal::NEW,
        scale: Nominal::NEW.scale(),
        shape: [0, 1, 2].map(|bit| f64::from((bits >> bit) & 1)),
        sign: if bits & 8 == 0 { 1.0 } else { -1.0 },
    })
}

#[test]
fn every_effect_makes_a_damper_from_weak_to_strongest() {
    for info in CATALOGUE {
        assert!(info.strongest > 0.0, "{}", info.name);
        for draw in draws() {
            for share in [1e-6, 1e-3, 0.1, 1.0] {
                let strength = share * info.strongest;
                let effect = Effect::drawn(info.name, strength, &draw)
                    .unwrap_or_else(|error| panic!("{} at {strength}: {error}", info.name));
                assert_eq!(effect.name(), info.name);
                let damper = Damper::new(Nominal::NEW, &[effect]);
                assert!(damper.is_ok(), "{} at {strength}: {damper:?}", info.name);
            }
        }
    }
}

#[test]
fn every_effect_in_service_changes_the_force() {
    let force = |effects: &[Effect]| {
        let damper = Damper::new(Nominal::NEW, effects).unwrap();
        let mut state = DamperState::rest();
        (1..=500)
            .map(|i| {
                let (sine, cosine) = libm::sincos(0.022 * f64::from(i));
                damper.advance(&mut state, Motion::new(4e-3 * sine, 88e-3 * cosine), 1e-3)
            })
            .collect::<Vec<_>>()
    };
    let plain = force(&[]);
    for effect in catalogue_at(&Nominal::NEW, 1.0) {
        assert_ne!(force(&[effect]), plain, "{}", effect.name());
    }
}

#[test]
fn page_of_effects_has_a_row_for_each() {
    let page = include_str!("../../../docs/effects.md");
    for info in CATALOGUE {
        let equation = info.equation.replace('|', "\\|");
        let row = format!(
            "| `{}` | {} | `{equation}` | {} |",
            info.name,
            info.place.name(),
            info.shown_by
        );
        assert!(page.contains(&row), "docs/effects.md lacks a row:\n{row}");
    }
}

#[test]
fn unknown_effect_has_no_size() {
    let draw = draws().next().unwrap();
    assert!(Effect::drawn("gremlins", 0.1, &draw).is_err());
    assert!(Effect::in_service("gremlins", &Nominal::NEW, 1.0).is_err());
}

/// The effects in version 0.1.0. This is no list to extend: a later effect has no old bits.
const FIRST: [&str; 21] = [
    "seal_friction",
    "quadratic_orifice",
    "orifice_leakage",
    "second_valve_stage",
    "asymmetric_damping",
    "position_dependent_damping",
    "temperature_fade",
    "gas_preload",
    "stiffening_attachment",
    "rubber_hysteresis",
    "entrained_air",
    "fixture_compliance",
    "stroke_dependent_stiffness",
    "aeration_memory",
    "clearance_growth",
    "cavitation",
    "clearance_impact",
    "moving_mass",
    "bump_stop",
    "force_offset",
    "sensor_delay",
];

#[test]
fn sizes_in_service_keep_their_bits() {
    let worn = Nominal { clearance_2a_m: 0.6e-3, ke_n_per_m: 9e6, ..Nominal::NEW };
    let mut hash = fnv::START;
    for (nominal, size) in [(Nominal::NEW, 1.0), (worn, 3.0), (Nominal::NEW, 0.3)] {
        for value in effects_at(FIRST, &nominal, size).iter().flat_map(Effect::values) {
            hash = fnv::add(hash, value.to_bits());
        }
    }
    assert_eq!(hash, 16_013_042_321_332_900_544);
}
