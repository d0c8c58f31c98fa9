//! The run that a comparison asks for: the same once more with the other damper.

use crate::compare::CompareSetup;
use crate::damper_mass;
use crate::error::ScenarioError;
use crate::rig::RigSetup;
use crate::run::Run;
use crate::slot::SlotForce;

impl Run {
    /// The same run with the other damper in every slot; none without a comparison. `emulated` says
    /// of a slot on a rig whether the rig can be run again; it is modelled where it cannot.
    ///
    /// # Errors
    /// The vehicle cannot run with the mass of these dampers.
    pub fn compared(
        &self,
        emulated: impl Fn(usize) -> bool,
    ) -> Result<Option<Self>, ScenarioError> {
        let Some(CompareSetup { damper, bare, source, .. }) = &self.compare else {
            return Ok(None);
        };
        let refused = |error| source.whole_error(format!("[compare]: {error}"));
        let mut vehicle = bare.clone();
        let mut slots = self.slots.clone();
        for (number, slot) in slots.iter_mut().enumerate() {
            slot.force = match &slot.force {
                SlotForce::Rig {
                    node, bus, compensator, accept_delay_error, if_drops_out, ..
                } if emulated(number) => {
                    let damper = damper_mass::without(damper.clone()).map_err(refused)?;
                    SlotForce::Rig {
                        node: *node,
                        bus: bus.clone(),
                        virtual_clearance_2a_m: 0.0,
                        virtual_compliance_m_per_n: 0.0,
                        specimen: Box::new(damper.clone()),
                        model: Box::new(damper),
                        watch: None,
                        compensator: *compensator,
                        accept_delay_error: *accept_delay_error,
                        if_drops_out: *if_drops_out,
                    }
                }
                SlotForce::StandIn { stands_for, of, is_reversed, .. } if emulated(*of) => {
                    SlotForce::StandIn {
                        stands_for: *stands_for,
                        of: *of,
                        is_reversed: *is_reversed,
                        model: Box::new(damper_mass::without(damper.clone()).map_err(refused)?),
                    }
                }
                _ => damper_mass::give_to_bodies(&mut vehicle, number, damper.clone())
                    .map(SlotForce::Modelled)
                    .map_err(refused)?,
            };
        }
        let start =
            Self::steady(&vehicle, self.contact.as_ref(), self.speed_m_per_s).map_err(|error| {
                ScenarioError::Equilibrium {
                    file: source.path().to_owned(),
                    part: Some("[compare]"),
                    error,
                }
            })?;
        Ok(Some(Self {
            vehicle,
            slots,
            start,
            rig: RigSetup { damper: damper.clone(), ..self.rig.clone() },
            compare: None,
            ..self.clone()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::CompareFile;
    use crate::inputs::Inputs;
    use crate::run::Overrides;
    use crate::source::Source;
    use std::path::Path;

    /// A scenario in the folder of the others, with something more.
    fn run(more: &str) -> Result<Run, ScenarioError> {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/compare.toml"));
        let text = format!(
            "title = \"two\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 100.0\nduration_s = 1.0\n{more}"
        );
        Run::from_source(&Source::from_text(path, &text), Overrides::default())
    }

    const RIG: &str = "[[slot]]\nplace = \"front left\"\non = \"rig\"\n\
        virtual_wear = { clearance_2a_m = 0.001 }\nwatch = {}\n";
    const SLOT: &str = "[[slot]]\nplace = \"rear left\"\non = \"modelled\"\n\
        damper = { ke_n_per_m = 5e6 }\n";
    const HEAVY: &str = "[[compare.damper.effect]]\nname = \"moving_mass\"\nmass_kg = 24.0\n";

    #[test]
    fn the_other_damper_is_in_every_slot_and_on_the_emulated_rig() {
        let main =
            run(&format!("[compare]\ndamper = {{ ke_n_per_m = 9e6 }}\n{RIG}{SLOT}")).unwrap();
        let other = main.compared(|_| true).unwrap().unwrap();
        assert_eq!(other.rig.damper.nominal().ke_n_per_m, 9e6);
        assert_eq!(RigSetup { damper: main.rig.damper.clone(), ..other.rig.clone() }, main.rig);
        for slot in &other.slots {
            match &slot.force {
                SlotForce::Modelled(damper) => assert_eq!(*damper, other.rig.damper),
                SlotForce::Rig { virtual_clearance_2a_m, watch, .. } => {
                    assert_eq!((slot.place.as_str(), watch), ("front left", &None));
                    assert_eq!(*virtual_clearance_2a_m, 0.0);
                }
                SlotForce::StandIn { .. } => panic!("{}", slot.place),
            }
        }
        assert_eq!((other.track, other.vehicle, other.compare), (main.track, main.vehicle, None));
        // On a bus of its own the rig cannot be run again.
        let real = run(&format!("[compare]\n{RIG}")).unwrap().compared(|_| false).unwrap().unwrap();
        assert!(real.slots.iter().all(|slot| matches!(slot.force, SlotForce::Modelled(_))));
        assert_eq!(run("").unwrap().compared(|_| true).unwrap(), None);
    }

    #[test]
    fn each_run_carries_the_mass_of_its_own_dampers() {
        let light = run("").unwrap();
        let main = run(&format!("[compare]\n{HEAVY}")).unwrap();
        assert_eq!(main.vehicle, light.vehicle);
        let other = main.compared(|_| true).unwrap().unwrap();
        assert!((other.vehicle.mass_kg() - light.vehicle.mass_kg() - 4.0 * 24.0).abs() < 1e-6);
        // As if it stood in the scenario itself, to the last bit.
        let plain = run(&HEAVY.replace("compare.damper", "damper")).unwrap();
        assert_eq!(
            (other.vehicle, other.slots, other.start),
            (plain.vehicle, plain.slots, plain.start)
        );
        // And the other way round: the heavy damper first, a light one compared.
        let heavy =
            run(&format!("{}[compare]\n", HEAVY.replace("compare.damper", "damper"))).unwrap();
        assert_eq!(heavy.compared(|_| true).unwrap().unwrap().vehicle, light.vehicle);
    }

    #[test]
    fn the_name_is_the_one_given_or_that_of_the_file() {
        let folder = std::env::temp_dir().join(format!("yawbench-compare-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("maker.toml"), "[damper]\nke_n_per_m = 9e6\n").unwrap();
        let named = |text: &str| {
            let source = Source::from_text(&folder.join("run.toml"), text);
            source
                .parse::<CompareFile>()
                .unwrap()
                .resolved(&source, &mut Inputs::default())
                .unwrap()
                .name
                .unwrap()
        };
        assert_eq!(named(""), "the other damper");
        assert_eq!(named("damper = { file = \"maker.toml\" }"), "maker");
        assert_eq!(named("name = \"sheet\"\ndamper = { file = \"maker.toml\" }"), "sheet");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn the_effective_scenario_has_the_comparison_written_out() {
        let main = run("[compare]\nname = \"sheet\"\ndamper = { ke_n_per_m = 9e6 }\n").unwrap();
        for part in ["[compare]", "name = \"sheet\"", "[compare.damper]", "ke_n_per_m = 9000000.0"]
        {
            assert!(main.effective.scenario.contains(part), "{part}: {}", main.effective.scenario);
        }
        assert_eq!(main.effective.scenario.matches("f_relief_n = 18000.0").count(), 3);
    }
}
