//! A vehicle under way: on one track at one speed, every damper modelled, seen cycle by cycle.
//!
//! Studies run the very line that drives a rig ([`firmware_core::line`]), in virtual time. A damper
//! that the scenario puts on a rig is modelled in its place, with the wear that was to be injected
//! in software: `2a` adds up, compliances add up. With a clearance of a metre
//! (`damper.clearance_2a_m = 1.0`) a damper never touches: that is a trip with dampers taken off.
//!
//! [`Rigs`] put some of its dampers behind emulated rigs instead, with a compensator or with a
//! [`DiscreteFilter`] of somebody else's.
//!
//! A trip ends early with [`StudyError::Stopped`] when the flag of its vehicle is set
//! ([`Equipped::until`]).
//!
//! Trips of a study share batches of four ([`Together`]).
//!
//! [`signals`] records a trip at 1 kHz, [`track`] are the tracks that studies run on, [`Pace`] is
//! how fast trips are.

mod filter;
mod leg;
mod pace;
mod rigs;
pub mod signals;
#[cfg(test)]
mod tests;
mod together;
pub mod track;

use crate::error::StudyError;
pub use filter::{COEFFICIENTS_MAX, DiscreteFilter};
use firmware_core::command::Command;
use firmware_core::damper::{Damper, DamperError};
use firmware_core::lanes::Lanes;
use firmware_core::line::{DelayBlocks, Fade, Line, LineState, Slot};
use firmware_core::track::Track;
use firmware_core::vehicle::{BodyId, DAMPER_SLOTS, LATERAL, Running, Vehicle};
use firmware_core::wheel_rail::table::ContactTable;
use leg::Traveller;
use pace::Odometer;
pub use pace::Pace;
use rig_emulator::Reading;
pub use rigs::Rigs;
use rigs::{Emulated, RigState};
use scenario::equilibrium::{self, NoEquilibrium};
use scenario::minimum_speed::minimum_speed_m_per_s;
use scenario::run::{CYCLE_S, Run, SlotForce, worn};
use scenario::wheel_rail::Contact;
use signals::Recorder;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
pub use together::Together;

/// Distance at which the vehicle's reference point starts (m): all wheels on perfect track.
pub const START_M: f64 = 15.0;
/// Most substeps of a cycle.
const SUBSTEPS_MAX: u32 = 64;
/// Cycles between two looks at the flag that stops a trip.
const CYCLES_PER_LOOK: u64 = 256;
/// The flag of a vehicle whose trips nothing stops.
static NEVER: AtomicBool = AtomicBool::new(false);

/// A vehicle with its dampers and its contact: what neither speed nor track changes. Copies of it,
/// with other dampers perhaps, count their trips together.
#[derive(Debug, Clone)]
pub struct Equipped<'a> {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Solved profiles, for wheels that run on some.
    pub contact: Option<Contact>,
    /// The damper of every slot.
    pub dampers: Vec<Damper>,
    /// Which of them are behind rigs; none where all are modelled in their places.
    pub rigs: Option<Rigs>,
    odometer: Arc<Odometer>,
    together: Option<Arc<Together>>,
    stop: &'a AtomicBool,
}

impl Equipped<'static> {
    /// The vehicle of a scenario.
    ///
    /// # Errors
    /// Wear on a rig that leaves no damper.
    pub fn of(run: &Run) -> Result<Self, DamperError> {
        let dampers: Result<Vec<Damper>, DamperError> =
            run.slots.iter().map(|slot| modelled(&slot.force, run)).collect();
        Ok(Self {
            vehicle: run.vehicle.clone(),
            contact: run.contact.clone(),
            dampers: dampers?,
            rigs: None,
            odometer: Arc::default(),
            together: None,
            stop: &NEVER,
        })
    }

    /// A vehicle on cones, with no dampers.
    pub fn without_dampers(vehicle: Vehicle) -> Self {
        Self {
            vehicle,
            contact: None,
            dampers: Vec::new(),
            rigs: None,
            odometer: Arc::default(),
            together: None,
            stop: &NEVER,
        }
    }
}

impl Equipped<'_> {
    /// The same vehicle, whose trips end with [`StudyError::Stopped`] once a flag is set.
    #[must_use]
    pub fn until(self, stop: &AtomicBool) -> Equipped<'_> {
        let Self { vehicle, contact, dampers, rigs, odometer, together, .. } = self;
        Equipped { vehicle, contact, dampers, rigs, odometer, together, stop }
    }

    /// The same vehicle, whose trips are under way with those of others.
    #[must_use]
    pub fn with_others(mut self, together: &Arc<Together>) -> Self {
        self.together = Some(Arc::clone(together));
        self
    }

    /// Checks the flag that stops the work on this vehicle.
    ///
    /// # Errors
    /// It is set.
    pub fn check_stop(&self) -> Result<(), StudyError> {
        if self.stop.load(Ordering::Relaxed) { Err(StudyError::Stopped) } else { Ok(()) }
    }

    /// The same vehicle with this damper in every slot.
    #[must_use]
    pub fn with(mut self, damper: &Damper) -> Self {
        self.dampers.fill(damper.clone());
        self
    }

    /// The same vehicle with some of its dampers behind rigs.
    #[must_use]
    pub fn behind(&self, rigs: Rigs) -> Self {
        Self { rigs: Some(rigs), ..self.clone() }
    }

    /// How fast its trips were; none before the first.
    pub fn pace(&self) -> Option<Pace> {
        self.odometer.pace(CYCLE_S)
    }

    /// The contact table, for wheels that run on profiles.
    pub fn table(&self) -> Option<&ContactTable> {
        self.contact.as_ref().map(|contact| &*contact.table)
    }

    /// The body of a wheelset, counted from 0 at the front.
    pub fn wheelset(&self, number: usize) -> Option<BodyId> {
        self.vehicle.axles.get(number).map(|axle| axle.body)
    }

    /// Fewest substeps of a cycle, a power of two and at least `least`, at which creep is stable.
    pub fn substeps(&self, speed_m_per_s: f64, least: u32) -> u32 {
        let mut substeps = least.max(1);
        let stable = |substeps: u32| {
            let substep_s = CYCLE_S / f64::from(substeps);
            speed_m_per_s >= minimum_speed_m_per_s(&self.vehicle, self.table(), substep_s)
        };
        while substeps < SUBSTEPS_MAX && !stable(substeps) {
            substeps *= 2;
        }
        substeps
    }
}

fn modelled(force: &SlotForce, run: &Run) -> Result<Damper, DamperError> {
    let on_rig = &run.rig.damper;
    match force {
        SlotForce::Modelled(damper) => Ok(damper.clone()),
        SlotForce::Rig { virtual_clearance_2a_m, virtual_compliance_m_per_n, .. } => {
            worn(on_rig, *virtual_clearance_2a_m, *virtual_compliance_m_per_n)
        }
        // The damper of its rig, in its own place.
        SlotForce::StandIn { of, .. } => match run.slots.get(*of).map(|slot| &slot.force) {
            Some(rig @ SlotForce::Rig { .. }) => modelled(rig, run),
            _ => Ok(on_rig.clone()),
        },
    }
}

/// A vehicle on a track at a speed.
#[derive(Debug, Clone)]
pub struct Trip<'a> {
    line: Line<'a>,
    rigs: Vec<Emulated>,
    equipped: &'a Equipped<'a>,
}

/// Where a trip is: the vehicle, and the rigs of its dampers. A clone is a snapshot.
#[derive(Debug, Clone)]
pub struct TripState {
    /// The vehicle and its damper slots.
    pub line: LineState,
    rigs: Vec<RigState>,
}

impl TripState {
    /// The delays of the rigs so far, in slot order.
    pub fn delays(&self) -> impl Iterator<Item = &DelayBlocks> {
        self.rigs.iter().map(|rig| &rig.delay)
    }

    /// What the rigs have measured in the last cycle, in slot order; none before the first.
    pub fn readings(&self) -> impl Iterator<Item = Option<Reading>> {
        self.rigs.iter().map(|rig| rig.reading)
    }
}

impl<'a> Trip<'a> {
    /// A trip with as many substeps as the speed needs, at least `least_substeps`.
    pub fn new(
        equipped: &'a Equipped<'a>,
        track: &'a Track<'a>,
        speed_m_per_s: f64,
        least_substeps: u32,
    ) -> Self {
        let substeps = equipped.substeps(speed_m_per_s, least_substeps);
        let substep_s = CYCLE_S / f64::from(substeps);
        debug_assert!(equipped.dampers.len() <= DAMPER_SLOTS, "more dampers than slots");
        #[expect(
            clippy::large_stack_arrays,
            reason = "once per trip, and a line holds it by value"
        )]
        let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
        let mut rigs = Vec::new();
        for (number, (slot, damper)) in slots.iter_mut().zip(&equipped.dampers).enumerate() {
            let model = damper.clone().prepared(substep_s);
            *slot = match &equipped.rigs {
                Some(own) if own.has(number) => {
                    rigs.push(own.emulated(number, damper));
                    Slot::Rig(own.slot(model))
                }
                _ => Slot::Modelled(model),
            };
        }
        let line = Line {
            vehicle: &equipped.vehicle,
            track,
            contact: equipped.table(),
            speed_m_per_s,
            cycle_s: CYCLE_S,
            substeps,
            slots,
            fade: Fade::default(),
        };
        Self { line, rigs, equipped }
    }

    /// Steady running at the beginning of the track, some wheelsets moved to the right by so much
    /// (m).
    ///
    /// # Errors
    /// No steady running was found.
    pub fn begin(&self, offsets_m: &[(BodyId, f64)]) -> Result<TripState, NoEquilibrium> {
        let line = &self.line;
        let mut start = equilibrium::running(line.vehicle, line.contact, line.speed_m_per_s)?;
        start.state.distance_m.0[0] = START_M;
        for (body, offset_m) in offsets_m {
            debug_assert!(body.index() < start.state.position.len(), "no such body");
            if let Some(pose) = start.state.position.get_mut(body.index()) {
                pose[LATERAL].0[0] += offset_m;
            }
        }
        let mut state = line.start(start.state);
        rigs::couple(line, &mut state);
        let rigs = self.rigs.iter().map(Emulated::start).collect();
        Ok(TripState { line: state, rigs })
    }

    /// Runs on for a time and passes every cycle to `see`. False where the vehicle has left the
    /// track, and stands there.
    ///
    /// # Errors
    /// The flag of the vehicle is set ([`StudyError::Stopped`]), the state is somewhere on the way.
    pub fn go(
        &self,
        state: &mut TripState,
        duration_s: f64,
        mut see: impl FnMut(&LineState),
    ) -> Result<bool, StudyError> {
        self.go_with_rigs(state, duration_s, |state| see(&state.line))
    }

    /// Runs on for a time and records it; beside the trips of others where the vehicle has
    /// [company](Equipped::with_others), with the same bits. False where it has left the track.
    ///
    /// # Errors
    /// As for [`Trip::go`].
    pub(crate) fn record(
        &self,
        state: &mut TripState,
        duration_s: f64,
        recorder: &mut Option<Recorder>,
    ) -> Result<bool, StudyError> {
        let cycles = libm::round(duration_s / CYCLE_S) as u64;
        let contact = self.equipped.contact.as_ref().map(|contact| &contact.table);
        let together = self.equipped.together.as_ref().and_then(|together| {
            let own = recorder.clone();
            Some((together, Traveller::of(&self.line, contact, &state.line, cycles, own)?))
        });
        let Some((together, traveller)) = together else {
            return self.go(state, duration_s, |state| {
                if let Some(recorder) = recorder {
                    recorder.see_line(state);
                }
            });
        };
        self.equipped.check_stop()?;
        let ended = together.run(traveller, self.equipped.stop);
        let Traveller { left, busy, .. } = *ended;
        self.equipped.odometer.count(cycles - left, busy);
        state.line = ended.state;
        *recorder = ended.recorder;
        if left > 0 && !state.line.is_safe() { Err(StudyError::Stopped) } else { Ok(left == 0) }
    }

    /// The same, and passes the rigs too.
    ///
    /// # Errors
    /// As for [`Trip::go`].
    pub fn go_with_rigs(
        &self,
        state: &mut TripState,
        duration_s: f64,
        mut see: impl FnMut(&TripState),
    ) -> Result<bool, StudyError> {
        let cycles = libm::round(duration_s / CYCLE_S) as u64;
        let began = Instant::now();
        let mut done = 0;
        let mut stopped = Ok(());
        while done < cycles {
            if done % CYCLES_PER_LOOK == 0 {
                stopped = self.equipped.check_stop();
                if stopped.is_err() {
                    break;
                }
            }
            rigs::step(&self.line, &self.rigs, state);
            if state.line.is_safe() {
                break;
            }
            see(state);
            done += 1;
        }
        self.equipped.odometer.count(done, began.elapsed());
        stopped.map(|()| done == cycles)
    }

    /// Extension of every damper slot from mid-stroke, and its rate, at the end of the last cycle.
    pub fn damper_motions(&self, state: &LineState) -> [Command; DAMPER_SLOTS] {
        let line = &self.line;
        let running = Running {
            speed_m_per_s: Lanes([line.speed_m_per_s]),
            tracks: [line.track],
            contact: line.contact,
            substep_s: line.cycle_s / f64::from(line.substeps),
        };
        let motions = line.vehicle.damper_motions(&state.vehicle, &running);
        let mut found = [Command::default(); DAMPER_SLOTS];
        for ((found, (extension, rate)), slot) in found.iter_mut().zip(motions).zip(&state.slots) {
            *found = Command {
                displacement_m: extension.lane(0) - slot.mid_stroke_m,
                velocity_m_per_s: rate.lane(0),
            };
        }
        found
    }

    /// The vehicle.
    pub fn vehicle(&self) -> &'a Vehicle {
        self.line.vehicle
    }

    /// The track.
    pub fn track(&self) -> &'a Track<'a> {
        self.line.track
    }

    /// The running speed (m/s).
    pub fn speed_m_per_s(&self) -> f64 {
        self.line.speed_m_per_s
    }
}

/// Lateral position of a body (m), to the right.
pub fn lateral_m(state: &LineState, body: BodyId) -> f64 {
    debug_assert!(body.index() < state.vehicle.position.len(), "no such body");
    state.vehicle.position.get(body.index()).map_or(0.0, |pose| pose[LATERAL].lane(0))
}
