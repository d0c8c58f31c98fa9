//! Before anything moves: whether every rig stays stable for the delays that it may have.
//!
//! The largest delay is what the gate before RUN lets through, and as many cycles as a measurement
//! may be old before it is not believed any more. An adaptive compensator is judged by its start
//! values.

use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::{COST_REFUSED, Session};
use crate::linear_vehicle::LinearVehicle;
use crate::stability::{BEYOND_HUNTING, ForceGroup, LEAST_MARGIN, RigLoop, Stability};
use firmware_core::compensation::{Compensator, Series, delay_that_costs};
use firmware_core::line::{KNOWN_DELAY_CYCLES, RigSlot, Sensitivity, Slot};
use firmware_core::supervision::OLDEST_CYCLES;
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::Run;

/// What was found of every rig.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct StabilityCheck {
    rigs: Vec<(String, Stability)>,
}

impl StabilityCheck {
    /// Of the rigs of a session; of none where the vehicle is not known.
    pub(crate) fn of(session: &Session<'_>, run: &Run, vehicle: Option<&LinearVehicle>) -> Self {
        let Some(vehicle) = vehicle else { return Self::default() };
        let rigs = session.line.slots.iter().zip(&run.slots).enumerate();
        let found = rigs.filter_map(|(slot, (kind, place))| {
            let Slot::Rig(rig) = kind else { return None };
            let group = group_of(slot, &session.line.slots);
            Some((place.place.clone(), of_rig(rig, session.line.cycle_s, group, vehicle)))
        });
        Self { rigs: found.collect() }
    }

    /// Every rig by its slot's place, with what was found.
    pub(crate) fn rigs(&self) -> impl Iterator<Item = (&str, &Stability)> {
        self.rigs.iter().map(|(place, found)| (place.as_str(), found))
    }

    /// Prints one line for each rig, and refuses one on a real bus without the margin.
    pub(super) fn pass(&self, real_bus: Option<&BusChoice>) -> Result<(), BenchError> {
        for (place, found) in &self.rigs {
            files::say!("{place}: {}", found.in_words());
        }
        let failing = self.rigs.iter().find(|(_, found)| !found.holds());
        let (Some(bus), Some((place, found))) = (real_bus, failing) else { return Ok(()) };
        Err(BenchError::Unstable {
            bus: bus.to_string(),
            place: place.clone(),
            found: found.in_words(),
            margin: LEAST_MARGIN,
        })
    }
}

/// The slots in which the force of a rig acts.
fn group_of(rig: usize, slots: &[Slot<'_>; DAMPER_SLOTS]) -> ForceGroup {
    let mut group = ForceGroup::alone(rig);
    for (sign, slot) in group.signs.iter_mut().zip(slots) {
        match slot {
            Slot::StandIn(own) if own.of == rig => *sign = if own.is_reversed { -1.0 } else { 1.0 },
            _ => {}
        }
    }
    group
}

fn of_rig(
    rig: &RigSlot<'_>,
    cycle_s: f64,
    group: ForceGroup,
    vehicle: &LinearVehicle,
) -> Stability {
    let series = match rig.compensator {
        Compensator::None => Series::IDENTITY,
        compensator => {
            let own = compensator.series(&compensator.start());
            own.with_delay(KNOWN_DELAY_CYCLES * cycle_s)
        }
    };
    let hunting_hz = vehicle.hunting.frequency_hz;
    let Sensitivity { relaxation_s, .. } = Sensitivity::of(&rig.model, hunting_hz);
    let let_through_s = delay_that_costs(COST_REFUSED, hunting_hz, relaxation_s);
    let delay_s = let_through_s + f64::from(OLDEST_CYCLES) * cycle_s;
    RigLoop::new(vehicle, group, rig.model.nominal(), series).check(
        delay_s,
        BEYOND_HUNTING * hunting_hz,
        vehicle.hunting_pole,
    )
}
