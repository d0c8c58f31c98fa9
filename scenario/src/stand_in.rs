//! Dampers for which the rig in another slot stands.
//!
//! ```toml
//! [[slot]]
//! place = "front right"
//! on = "partner"            # opposite on the same bogie: the force of its rig, sign reversed
//! of = "front left"         # a place that is on a rig
//!
//! [[slot]]
//! place = "rear left"
//! on = "other_bogie"        # one measured force on several bogies: no critical speed, no ride
//! of = "front left"
//! ```
//!
//! The sign follows from the places of the two dampers on the vehicle. Two that are each other's
//! image in the plane `y = 0`, between the same two bodies, move oppositely in every motion that
//! the mirror reverses, yaw and sway among them:
//!
//! ```text
//! x_partner = -x,  F_partner = -F          exact for those motions and F(-x) = -F(x)
//! ```
//! A damper of another bogie has the sign of the same yaw of both bogies: the same on the same
//! side, the opposite one on the other. Nothing makes that exact.
//!
//! An asymmetric damper is warned of and not refused: no damper is exactly symmetric, and a refusal
//! would meet only those who have measured by how much. The model stands for the real damper here,
//! of which nobody knows it.

use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::run_file::{On, RunFile, SlotFile, StandsFor};
use crate::slot::{Slot, SlotForce};
use crate::source::Source;
use files::{did_you_mean, quoted};
use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::vehicle::{Anchor, DamperMount, Vehicle};

/// Lengths closer than this are equal (m).
const EQUAL_M: f64 = 1e-9;

/// Share of its force by which a damper may be asymmetric without a word.
const SYMMETRIC: f64 = 1e-3;

/// Puts the rigs into the slots for which they stand.
pub(crate) fn place(
    file: &RunFile,
    vehicle: &Vehicle,
    source: &Source,
    slots: &mut [Slot],
) -> Result<(), ScenarioError> {
    for given in &file.slot {
        let place = quoted(&given.place);
        let fail = |why: String| Err(source.whole_error(format!("slot \"{place}\"{why}")));
        let Some(stands_for) = given.on.stands_for() else {
            if given.of.is_some() {
                return fail(": of is for on = \"partner\" and on = \"other_bogie\"".to_owned());
            }
            if given.on == On::Modelled && given.if_rig_drops_out.is_some() {
                return fail(" is modelled: if_rig_drops_out is for a rig".to_owned());
            }
            continue;
        };
        if has_more(given) {
            return fail(format!(
                " is on = \"{}\": its force is that of the rig of another place; of is its only \
                 further key",
                stands_for.name()
            ));
        }
        let on_rigs = || slots.iter().filter(|slot| matches!(slot.force, SlotForce::Rig { .. }));
        let names: Vec<&str> = on_rigs().map(|slot| slot.place.as_str()).collect();
        let wanted = given.of.as_deref().unwrap_or_default();
        let found = slots.iter().position(|slot| slot.place == wanted);
        let Some((of, SlotForce::Rig { model, .. })) =
            found.and_then(|of| Some((of, &slots.get(of)?.force)))
        else {
            let similar = did_you_mean(wanted, names.iter().copied());
            return fail(match names.as_slice() {
                [] => format!(
                    ": of = \"{}\", expected a place on a rig: there is none",
                    quoted(wanted)
                ),
                names => format!(
                    ": of = \"{}\", expected a place on a rig: {}{similar}",
                    quoted(wanted),
                    names.join(", ")
                ),
            });
        };
        let Some(own) = slots.iter().position(|slot| slot.place == given.place) else { continue };
        let (Some(rig), Some(mount)) = (vehicle.dampers.get(of), vehicle.dampers.get(own)) else {
            continue;
        };
        let is_reversed = match stands_for {
            StandsFor::Partner => are_opposite(rig, mount).then_some(true),
            StandsFor::OtherBogie => reversed_on_other_bogie(rig, mount),
        };
        let Some(is_reversed) = is_reversed else {
            return fail(format!(
                ": on = \"{}\" of \"{}\", expected {}",
                stands_for.name(),
                quoted(wanted),
                match stands_for {
                    StandsFor::Partner => "the place opposite to it on the same bogie",
                    StandsFor::OtherBogie =>
                        "the same place, or the opposite one, on another bogie",
                }
            ));
        };
        let force = SlotForce::StandIn { stands_for, of, is_reversed, model: model.clone() };
        if let Some(slot) = slots.get_mut(own) {
            slot.force = force;
        }
    }
    Ok(())
}

/// Whether a slot has keys that mean nothing where a rig stands for its damper.
fn has_more(given: &SlotFile) -> bool {
    let bare = SlotFile {
        place: given.place.clone(),
        on: given.on,
        of: given.of.clone(),
        node: None,
        bus: None,
        damper: DamperFile::default(),
        virtual_wear: None,
        model: None,
        watch: None,
        accept_delay_error: None,
        compensation: None,
        if_rig_drops_out: None,
    };
    *given != bare
}

fn is_equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= EQUAL_M
}

/// Whether two dampers between the same bodies are each other's image in the plane `y = 0`.
fn are_opposite(one: &DamperMount, other: &DamperMount) -> bool {
    let opposite = |a: &Anchor, b: &Anchor| {
        let (a_m, b_m) = (a.point_m, b.point_m);
        a.body == b.body
            && is_equal(a_m.x, b_m.x)
            && is_equal(a_m.y, -b_m.y)
            && a_m.y.abs() > EQUAL_M
            && is_equal(a_m.z, b_m.z)
    };
    let (a, b) = (one.direction, other.direction);
    opposite(&one.first, &other.first)
        && opposite(&one.second, &other.second)
        && is_equal(a.x, b.x)
        && is_equal(a.y, -b.y)
        && is_equal(a.z, b.z)
}

/// Whether the sign is reversed between the same place of two bogies, or opposite places; none of
/// other places.
fn reversed_on_other_bogie(one: &DamperMount, other: &DamperMount) -> Option<bool> {
    let (a, b) = match (one.first.body == other.first.body, one.second.body == other.second.body) {
        (true, false) => (one.second.point_m, other.second.point_m),
        (false, true) => (one.first.point_m, other.first.point_m),
        _ => return None,
    };
    let is_same = is_equal(a.x.abs(), b.x.abs())
        && is_equal(a.y.abs(), b.y.abs())
        && a.y.abs() > EQUAL_M
        && is_equal(a.z, b.z)
        && is_equal(one.direction.x, other.direction.x);
    is_same.then_some((a.y > 0.0) != (b.y > 0.0))
}

/// What to be warned of where a rig stands for another damper with its sign reversed.
pub(crate) fn warnings(model: &Damper, on_rig: &Damper, is_reversed: bool) -> Vec<String> {
    let line = |(name, damper): (&str, &Damper)| {
        let share = asymmetry(damper);
        (is_reversed && share > SYMMETRIC).then(|| {
            format!(
                "{name} is asymmetric by {:.1} % of its force: the reversed force of its rig is \
                 off by so much from that of a damper of this place",
                100.0 * share
            )
        })
    };
    [
        ("the model of the damper that stands for it", model),
        ("the damper on the emulated rig", on_rig),
    ]
    .into_iter()
    .filter_map(line)
    .collect()
}

/// The largest `|F(x) + F(-x)|` over the largest `|F|`, in two cycles of 5 mm at 2 Hz.
fn asymmetry(damper: &Damper) -> f64 {
    const STEP_S: f64 = 1e-3;
    let rate_per_s = std::f64::consts::TAU * 2.0;
    let motion = |step: u32, sign: f64| {
        let (sin, cos) = libm::sincos(rate_per_s * f64::from(step) * STEP_S);
        Motion::new(sign * 5e-3 * sin, sign * 5e-3 * rate_per_s * cos)
    };
    let damper = damper.clone().prepared(STEP_S);
    let mut states = [1.0, -1.0].map(|sign| (sign, DamperState::starting(motion(0, sign))));
    let (mut most_n, mut sum_n) = (0.0_f64, 0.0_f64);
    for step in 1..=1000 {
        let [one, two] = states
            .each_mut()
            .map(|(sign, state)| damper.advance(state, motion(step, *sign), STEP_S));
        (most_n, sum_n) = (most_n.max(one.abs()), sum_n.max((one + two).abs()));
    }
    if most_n > 0.0 { sum_n / most_n } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Overrides, Run};
    use firmware_core::damper::Nominal;
    use firmware_core::damper::effects::Effect;
    use std::path::Path;

    const RIG: &str = "[[slot]]\nplace = \"front left\"\non = \"rig\"\n";

    /// A scenario in the folder of the others, with these slots.
    fn run(slots: &str) -> Result<Run, ScenarioError> {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/stands.toml"));
        let text = format!(
            "title = \"stands\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 160.0\nduration_s = 1.0\n{slots}"
        );
        Run::from_source(&Source::from_text(path, &text), Overrides::default())
    }

    fn slot(place: &str, on: &str, more: &str) -> String {
        format!("[[slot]]\nplace = \"{place}\"\non = \"{on}\"\n{more}\n")
    }

    const OF: &str = "of = \"front left\"";

    fn refused(slots: &str) -> String {
        let said = run(&format!("{RIG}{slots}")).unwrap_err().to_string();
        assert_eq!(said.lines().count(), 1, "{said}");
        said
    }

    #[test]
    fn signs_follow_from_the_places_on_the_vehicle() {
        let places = [
            ("front right", "partner", Some(true)),
            ("rear left", "other_bogie", Some(false)),
            ("rear right", "other_bogie", Some(true)),
            ("rear left", "partner", None),
            ("front right", "other_bogie", None),
        ];
        for (place, on, sign) in places {
            let found = run(&format!("{RIG}{}", slot(place, on, OF)));
            let Some(sign) = sign else {
                let said = found.unwrap_err().to_string();
                assert!(said.contains(&format!("\"{place}\": on = \"{on}\" of")), "{said}");
                continue;
            };
            let found = found.unwrap();
            let found = found.slots.iter().find(|slot| slot.place == place).unwrap();
            let SlotForce::StandIn { stands_for, of, is_reversed, .. } = &found.force else {
                panic!("{found:?}")
            };
            assert_eq!((stands_for.name(), *of, *is_reversed), (on, 0, sign), "{place}");
        }
    }

    #[test]
    fn a_rig_is_needed_and_keys_of_one_are_not_for_what_it_stands_for() {
        let said = refused(&slot("front right", "partner", "of = \"front lef\""));
        assert!(said.contains("expected a place on a rig: front left; did you mean"), "{said}");
        // Nor does a chain of them stand for one.
        let chain = slot("front right", "partner", OF)
            + &slot("rear right", "other_bogie", "of = \"front right\"");
        assert!(refused(&chain).contains("of = \"front right\", expected a place on a rig"));
        for more in [
            "node = 2",
            "watch = {}",
            "damper = { ke_n_per_m = 9e6 }",
            "if_rig_drops_out = \"model\"",
        ] {
            let said = refused(&slot("front right", "partner", &format!("{OF}\n{more}")));
            assert!(said.contains("of is its only further key"), "{said}");
        }
        assert!(refused(&slot("rear left", "modelled", OF)).contains("of is for"));
        let modelled = refused(&slot("rear left", "modelled", "if_rig_drops_out = \"stop\""));
        assert!(modelled.contains("if_rig_drops_out is for a rig"), "{modelled}");
        assert!(
            run(&slot("front right", "partner", OF))
                .unwrap_err()
                .to_string()
                .contains("there is none")
        );
    }

    #[test]
    fn the_model_is_that_of_the_rig_with_its_wear() {
        let worn = format!("{RIG}virtual_wear = {{ clearance_2a_m = 2e-3 }}\n");
        let found = run(&format!("{worn}{}", slot("front right", "partner", OF))).unwrap();
        let [SlotForce::Rig { model: rig, .. }, SlotForce::StandIn { model, .. }, ..] =
            [0, 1, 2, 3].map(|slot| &found.slots[slot].force)
        else {
            panic!("{:?}", found.slots)
        };
        assert_eq!((model, model.nominal().clearance_2a_m), (rig, 2.2e-3));
        assert_eq!(found.warnings, Vec::<String>::new());
        // The same scenario from the files of its run.
        assert!(found.effective.scenario.contains("on = \"partner\"\nof = \"front left\""));
    }

    #[test]
    fn an_asymmetric_damper_is_warned_of_with_its_share() {
        let new = Damper::new(Nominal::NEW, &[]).unwrap();
        assert!(asymmetry(&new) < 1e-12, "{}", asymmetry(&new));
        let skew = Effect::from_values("asymmetric_damping", &[0.05, 0.05]).unwrap();
        let skew = Damper::new(Nominal::NEW, &[skew]).unwrap();
        // Both Ce and relief are 5 % more one way and 5 % less the other: 10 % of a mean force.
        let share = asymmetry(&skew);
        assert!((0.04..0.2).contains(&share), "{share}");
        assert_eq!(warnings(&new, &new, true), Vec::<String>::new());
        assert_eq!(warnings(&skew, &skew, false), Vec::<String>::new());
        let said = warnings(&skew, &new, true);
        assert!(said.len() == 1 && said[0].starts_with("the model of the damper"), "{said:?}");
    }
}
