//! The damper slots of a run: modelled, or on a rig.

use crate::cycle::Rate;
use crate::damper::DamperFile;
use crate::damper_mass;
use crate::error::ScenarioError;
use crate::motion::Motion;
use crate::run_file::{IfRigDropsOut, On, RunFile, SlotFile, StandsFor};
use crate::source::Source;
use crate::vehicle::VehicleFile;
use crate::watch::WatchSetup;
use files::{did_you_mean, quoted};
use firmware_core::compensation::Compensator;
use firmware_core::damper::{Damper, DamperError, Nominal};
use firmware_core::line::RigSlot;
use firmware_core::supervision::CommandLimits;
use firmware_core::vehicle::DAMPER_SLOTS;
use firmware_core::virtual_wear::{MOST_AHEAD_CYCLES, MOST_ROUNDING_CYCLES};

/// One slot, ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Slot {
    /// Its place on the vehicle.
    pub place: String,
    /// Where its force comes from.
    pub force: SlotForce,
}

/// Where the force of a slot comes from.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "four of them, made once")]
pub enum SlotForce {
    /// The model.
    Modelled(Damper),
    /// A rig.
    Rig {
        /// Its node.
        node: u8,
        /// Its bus, when it is not the run's.
        bus: Option<String>,
        /// Extra total clearance in software (m).
        virtual_clearance_2a_m: f64,
        /// Extra series compliance in software (m/N).
        virtual_compliance_m_per_n: f64,
        /// The damper on the rig, as the host knows it: the model without wear in software.
        specimen: Box<Damper>,
        /// The damper that acts on the vehicle while the measured force is faded in and out.
        model: Box<Damper>,
        /// The model that its force is compared with.
        watch: Option<Box<WatchSetup>>,
        /// How its delay is compensated, what is known outside of it left out.
        compensator: Compensator,
        /// Whether a run goes on whose delay costs more than is allowed.
        accept_delay_error: bool,
        /// What follows where it is lost in RUN.
        if_drops_out: IfRigDropsOut,
    },
    /// The rig in another slot.
    StandIn {
        /// For which damper it stands.
        stands_for: StandsFor,
        /// Number of the rig's slot.
        of: usize,
        /// Whether the sign of its force is reversed.
        is_reversed: bool,
        /// The damper that acts on the vehicle while the measured force is faded in and out.
        model: Box<Damper>,
    },
}

impl SlotForce {
    /// Its name in results.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Modelled(_) => "modelled",
            Self::Rig { .. } => "rig",
            Self::StandIn { stands_for, .. } => stands_for.name(),
        }
    }
}

/// The slots of a vehicle as a scenario fills them.
pub(crate) fn slots(
    file: &RunFile,
    vehicle: &VehicleFile,
    source: &Source,
    rate: Rate,
) -> Result<Vec<Slot>, ScenarioError> {
    let places: Vec<&str> = vehicle.damper_slot.iter().map(|slot| slot.place.as_str()).collect();
    debug_assert!(places.len() <= DAMPER_SLOTS);
    if let Some(unknown) = file.slot.iter().find(|slot| !places.contains(&slot.place.as_str())) {
        let expected = match places.as_slice() {
            [] => "expected none: the vehicle has no damper".to_owned(),
            places => {
                let similar = did_you_mean(&unknown.place, places.iter().copied());
                format!("expected one of {}{similar}", quoted(&places.join(", ")))
            }
        };
        let place = quoted(&unknown.place);
        return Err(
            source.whole_error(format!("slot place \"{place}\" does not exist, {expected}"))
        );
    }
    for slot in &file.slot {
        let place = quoted(&slot.place);
        let of_a_rig = slot.virtual_wear.is_some() || slot.watch.is_some() || slot.model.is_some();
        let of_its_delay = slot.compensation.is_some() || slot.accept_delay_error.is_some();
        let on_a_rig = [slot.node.is_some(), slot.bus.is_some(), of_a_rig, of_its_delay];
        if slot.on == On::Modelled && on_a_rig.contains(&true) {
            return Err(source.whole_error(format!(
                "slot \"{place}\" is modelled: node, bus, virtual_wear, model, watch, compensation \
                 and accept_delay_error are for a rig"
            )));
        }
    }
    let mut nodes = Vec::new();
    let mut built = Vec::new();
    for place in places {
        let given = file.slot.iter().find(|slot| slot.place == place);
        let force = match given {
            Some(slot) if slot.on == On::Rig => slot.rig(file, (source, rate), &mut nodes)?,
            given => {
                let own = given.map(|slot| slot.damper.clone()).unwrap_or_default();
                SlotForce::Modelled(own.over(&file.damper).build(source)?)
            }
        };
        built.push(Slot { place: quoted(place).to_string(), force });
    }
    Ok(built)
}

impl SlotFile {
    fn rig(
        &self,
        file: &RunFile,
        (source, rate): (&Source, Rate),
        nodes: &mut Vec<(Option<String>, u8)>,
    ) -> Result<SlotForce, ScenarioError> {
        let node = self.node.unwrap_or(1);
        let place = quoted(&self.place);
        if !(1..=4).contains(&node) {
            return Err(
                source.whole_error(format!("slot \"{place}\": node = {node}, expected 1 to 4"))
            );
        }
        let address = (self.bus.clone(), node);
        if nodes.contains(&address) {
            return Err(source
                .whole_error(format!("slot \"{place}\": node {node} is taken by another slot")));
        }
        nodes.push(address);
        if self.damper != DamperFile::default() {
            return Err(source.whole_error(format!(
                "slot \"{place}\" is on a rig: its damper stands under [rig.damper]"
            )));
        }
        let (mut clearance, mut compliance) = (0.0, 0.0);
        if let Some(wear) = &self.virtual_wear {
            if let Some(given) = &wear.clearance_2a_m {
                clearance = given.not_negative(source, "clearance_2a_m")?;
            }
            if let Some(given) = &wear.stiffness_n_per_m {
                let stiffness = given.positive(source, "stiffness_n_per_m")?;
                compliance = 1.0 / stiffness;
            }
        }
        let model = self.model.clone().unwrap_or_default().over(&file.damper).build(source)?;
        let refused =
            |error: DamperError| source.whole_error(format!("slot \"{place}\": model: {error}"));
        let specimen = damper_mass::without(model).map_err(refused)?.prepared(rate.cycle_s());
        let model = worn(&specimen, clearance, compliance).map_err(refused)?;
        let watch = match &self.watch {
            Some(watch) => Some(Box::new(watch.build(source, &file.damper)?)),
            None => None,
        };
        Ok(SlotForce::Rig {
            node,
            bus: self.bus.clone(),
            virtual_clearance_2a_m: clearance,
            virtual_compliance_m_per_n: compliance,
            specimen: Box::new(specimen),
            model: Box::new(model),
            watch,
            compensator: match &self.compensation {
                Some(compensation) => compensation.build(source)?,
                None => Compensator::None,
            },
            accept_delay_error: self.accept_delay_error.unwrap_or(false),
            if_drops_out: self.if_rig_drops_out.unwrap_or_default(),
        })
    }
}

/// Refuses wear in software that a faster loop cannot compute far enough ahead, or not round: both
/// are bounded in cycles, which are shorter there.
pub(crate) fn refuse_clipped_wear(
    slots: &[Slot],
    motion: &Motion,
    rate: Rate,
    source: &Source,
) -> Result<(), ScenarioError> {
    let limits = CommandLimits {
        stroke_m: motion.stroke_m,
        velocity_m_per_s: motion.velocity_m_per_s,
        acceleration_m_per_s2: motion.acceleration_m_per_s2,
    };
    for Slot { place, force } in slots.iter().filter(|_| rate > Rate::Usual) {
        let SlotForce::Rig {
            virtual_clearance_2a_m: clearance_2a_m,
            virtual_compliance_m_per_n: compliance_m_per_n,
            specimen,
            model,
            compensator,
            ..
        } = force
        else {
            continue;
        };
        if *clearance_2a_m == 0.0 && *compliance_m_per_n == 0.0 {
            continue;
        }
        let cycle_s = rate.cycle_s();
        let rig = RigSlot::new((**model).clone(), *compensator, limits, cycle_s);
        let rig = rig.behind_wear(*clearance_2a_m, *compliance_m_per_n, specimen, cycle_s);
        let cycles = rig.wear.map_or((0, 0), |wear| (wear.ahead_cycles, wear.rounding_cycles));
        let (found, most, of) = match cycles {
            (MOST_AHEAD_CYCLES, _) => ("the delay that is compensated", MOST_AHEAD_CYCLES, "ahead"),
            (_, MOST_ROUNDING_CYCLES) => ("acceleration_m_per_s2", MOST_ROUNDING_CYCLES, "round"),
            _ => continue,
        };
        return Err(source.whole_error(format!(
            "slot \"{place}\": virtual_wear at {rate}: {found} takes {most} cycles or more {of}, \
             expected fewer: a slower rate"
        )));
    }
    Ok(())
}

/// A damper with wear in series: the damper that a vehicle feels when a rig carries the first and
/// software adds the second.
///
/// # Errors
/// Wear that no damper can have.
pub fn worn(
    damper: &Damper,
    clearance_2a_m: f64,
    compliance_m_per_n: f64,
) -> Result<Damper, DamperError> {
    if clearance_2a_m == 0.0 && compliance_m_per_n == 0.0 {
        return Ok(damper.clone());
    }
    let new = *damper.nominal();
    let nominal = Nominal {
        clearance_2a_m: new.clearance_2a_m + clearance_2a_m,
        ke_n_per_m: 1.0 / (1.0 / new.ke_n_per_m + compliance_m_per_n),
        ..new
    };
    let worn = Damper::new(nominal, damper.effects())?;
    Ok(match damper.empirical() {
        Some(map) => worn.with_empirical(map.clone()),
        None => worn,
    })
}
