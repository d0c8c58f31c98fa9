//! A few hundred cycles of trips side by side, in the lanes of one batch.
//!
//! Each vehicle has its own speed, track and dampers; what they share are bodies, links, contact
//! and the length of a substep. A lane has the bits of a vehicle that runs alone, so whoever else
//! is under way changes no answer.
//!
//! Limits: straight tracks, and every damper modelled in its place.

use super::signals::Recorder;
use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::lanes::Lanes;
use firmware_core::line::{Line, LineState, Slot, is_plausible};
use firmware_core::supervision::Event;
use firmware_core::track::{Irregularity, IrregularitySample, Layout, Track};
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use scenario::run::CYCLE_S;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Lanes of a batch: as many as fill a vector register.
pub(super) const LANES: usize = 4;
/// Most cycles of a leg: long against handing it over, short against a trip.
const CYCLES_MAX: u64 = 256;

/// A trip that owns all it needs, so that any thread can run its next leg.
#[derive(Debug)]
pub(super) struct Traveller {
    vehicle: Vehicle,
    contact: Option<Arc<ContactTable>>,
    layout: Layout,
    /// Irregularity without its samples, which follow.
    irregularity: Irregularity<'static>,
    samples: Vec<IrregularitySample>,
    speed_m_per_s: f64,
    substeps: u32,
    dampers: Vec<Damper>,
    /// Where it is.
    pub(super) state: LineState,
    /// Cycles that are left of the way.
    pub(super) left: u64,
    /// What records it.
    pub(super) recorder: Option<Recorder>,
    /// Time that its legs have taken.
    pub(super) busy: Duration,
}

impl Traveller {
    /// The trip of a line for so many cycles; none of a line on a curve or with rigs.
    pub(super) fn of(
        line: &Line<'_>,
        contact: Option<&Arc<ContactTable>>,
        state: &LineState,
        cycles: u64,
        recorder: Option<Recorder>,
    ) -> Option<Self> {
        debug_assert_eq!(line.contact.is_some(), contact.is_some(), "another contact");
        let modelled = |slot: &Slot<'_>| match slot {
            Slot::Modelled(damper) => Some(damper.clone()),
            Slot::Empty | Slot::Rig(_) | Slot::StandIn(_) => None,
        };
        let dampers: Vec<Damper> = line.slots.iter().map_while(modelled).collect();
        let rest_is_empty = line.slots.iter().skip(dampers.len()).all(|slot| *slot == Slot::Empty);
        let Track { layout, irregularity } = line.track;
        let fits = rest_is_empty && layout.is_tangent() && !state.is_safe();
        fits.then(|| Self {
            vehicle: line.vehicle.clone(),
            contact: contact.cloned(),
            layout: layout.clone(),
            irregularity: Irregularity { samples: &[], ..*irregularity },
            samples: irregularity.samples.to_vec(),
            speed_m_per_s: line.speed_m_per_s,
            substeps: line.substeps,
            dampers,
            state: state.clone(),
            left: cycles,
            recorder,
            busy: Duration::ZERO,
        })
    }

    /// Whether it has arrived, or has left the track.
    pub(super) fn has_ended(&self) -> bool {
        self.left == 0 || self.state.is_safe()
    }

    /// Whether both can be under way in one batch.
    pub(super) fn can_join(&self, other: &Self) -> bool {
        let same_contact = match (&self.contact, &other.contact) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other) || own == other,
            (None, None) => true,
            _ => false,
        };
        self.substeps == other.substeps && same_contact && self.vehicle == other.vehicle
    }

    fn track(&self) -> Track<'_> {
        let irregularity = Irregularity { samples: &self.samples, ..self.irregularity };
        Track { layout: self.layout.clone(), irregularity }
    }
}

/// One leg of up to four trips that can join each other. Two take turns: a batch that is half empty
/// costs more.
pub(super) fn run(together: &mut [Box<Traveller>]) {
    debug_assert!(together.len() <= LANES, "{} in {LANES} lanes", together.len());
    debug_assert!(together.iter().all(|trip| !trip.has_ended()), "nothing is left to run");
    if together.len() + 1 < LANES {
        for trip in together.chunks_mut(1) {
            leg::<1>(trip);
        }
    } else {
        leg::<LANES>(together);
    }
}

/// Runs until the first has arrived or has left the track. Lanes to spare repeat the last trip.
fn leg<const L: usize>(together: &mut [Box<Traveller>]) {
    let began = Instant::now();
    let Some(last) = together.len().checked_sub(1) else { return };
    let cycles = together.iter().map(|trip| trip.left).min().unwrap_or(0).min(CYCLES_MAX);
    let mut vehicles = VehicleState::<L>::default();
    let mut memory = [[DamperState::rest(); L]; DAMPER_SLOTS];
    let mut mid_stroke_m = [[0.0; L]; DAMPER_SLOTS];
    for lane in 0..L {
        let state = &together[lane.min(last)].state;
        vehicles.put(lane, &state.vehicle);
        for ((slot, memory), mid_m) in state.slots.iter().zip(&mut memory).zip(&mut mid_stroke_m) {
            memory[lane] = slot.damper;
            mid_m[lane] = slot.mid_stroke_m;
        }
    }
    // Cycles done, and who is still on the track.
    let (mut done, mut on_track) = (0, [true; L]);
    let mut records: [Option<Recorder>; L] =
        std::array::from_fn(|lane| together.get_mut(lane).and_then(|trip| trip.recorder.take()));
    {
        let of = |lane: usize| &together[lane.min(last)];
        let tracks: [Track<'_>; L] = std::array::from_fn(|lane| of(lane).track());
        let running = Running {
            speed_m_per_s: Lanes(std::array::from_fn(|lane| of(lane).speed_m_per_s)),
            tracks: tracks.each_ref(),
            contact: of(0).contact.as_deref(),
            substep_s: CYCLE_S / f64::from(of(0).substeps),
        };
        let dampers = std::array::from_fn(|lane| of(lane).dampers.as_slice());
        let mut forces = Modelled { dampers, memory: &mut memory, mid_stroke_m: &mid_stroke_m };
        let (vehicle, substeps) = (&of(0).vehicle, of(0).substeps);
        let is_seen = records.iter().flatten().any(Recorder::sees_wheels);
        while done < cycles && on_track == [true; L] {
            // The last cycle leaves the state of one that runs alone.
            if is_seen || done + 1 == cycles {
                vehicle.step(&mut vehicles, &running, &mut forces, substeps);
            } else {
                vehicle.step_unseen(&mut vehicles, &running, &mut forces, substeps);
            }
            let motions = vehicle.damper_motions(&vehicles, &running);
            done += 1;
            for (lane, (record, on_track)) in records.iter_mut().zip(&mut on_track).enumerate() {
                *on_track = is_plausible(vehicle, &vehicles, &motions, &of(lane).state.slots, lane);
                if let (Some(record), true) = (record, *on_track) {
                    record.see(&vehicles, lane, &mid_stroke_m.map(|each| each[lane]));
                }
            }
        }
    }
    let share = began.elapsed() / together.len() as u32;
    for (lane, trip) in together.iter_mut().enumerate() {
        vehicles.take(lane, &mut trip.state.vehicle);
        for (slot, memory) in trip.state.slots.iter_mut().zip(&memory) {
            slot.damper = memory[lane];
        }
        trip.state.cycle += done;
        trip.left -= done;
        if !on_track[lane] {
            // The cycle in which it left the track does not count.
            trip.left += 1;
            trip.state.on(Event::Stop);
        }
        trip.recorder = records[lane].take();
        trip.busy += share;
    }
}

/// Forces of modelled dampers, slot by slot and lane by lane.
struct Modelled<'a, const L: usize> {
    dampers: [&'a [Damper]; L],
    memory: &'a mut [[DamperState; L]; DAMPER_SLOTS],
    mid_stroke_m: &'a [[f64; L]; DAMPER_SLOTS],
}

impl<const L: usize> DamperForces for Modelled<'_, L> {
    #[inline]
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        let Some(damper) = self.dampers[lane].get(slot) else { return 0.0 };
        let motion = Motion::new(extension_m - self.mid_stroke_m[slot][lane], rate_m_per_s);
        damper.advance(&mut self.memory[slot][lane], motion, substep_s)
    }
}
