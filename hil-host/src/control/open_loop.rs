//! Rigs in open loop: a motion of their own in place of the vehicle's.
//!
//! ```text
//! receive -> decode -> judge -> motion -> limits -> encode -> send -> record
//! ```
//! Everything else is that of a run: arming, limits, what is believed, what stops it, the record.

use super::buses::Buses;
use super::no_answer::NoAnswer;
use super::notices::Notices;
use super::pacing::{End, Ending, Pace};
use super::requests::Requests;
use super::session::{Session, SessionState};
use crate::bus::Bus;
use crate::clock::Tick;
use crate::record::Row;
use firmware_core::command::Command;
use firmware_core::supervision::{Event, State};
use firmware_core::vehicle::DAMPER_SLOTS;
use std::time::Instant;

/// A motion that rigs follow. It is asked in every cycle of the loop: it neither allocates nor
/// waits.
pub trait Motion {
    /// The farthest from mid-stroke that a slot's ram is sent which stands at `ram_m` (m).
    fn reach_m(&self, slot: usize, ram_m: f64) -> f64;

    /// The commands of the next cycle, by slot; none when the motion is over.
    fn next(&mut self, seen: &Seen) -> Option<[Command; DAMPER_SLOTS]>;
}

/// What a motion may depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Number of the cycle that is asked for, from one.
    pub cycle: u64,
    /// The last commands, by slot; where the rams stand before the first cycle.
    pub commands: [Command; DAMPER_SLOTS],
    /// Temperatures that the rigs report, by slot (degrees Celsius).
    pub temperature_degc: [Option<f64>; DAMPER_SLOTS],
}

impl Session<'_> {
    /// Arms every rig and opens the loop: the next cycle is the first of `OPEN_LOOP`.
    ///
    /// # Errors
    /// A rig that refuses or is refused, or does not measure, a motion that leads beyond the agreed
    /// stroke from where a ram stands, or a stop. Rigs that were armed are disarmed.
    pub fn arm_open_loop<B: Bus, M: Motion>(
        &self,
        motion: &M,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        let armed = self.exchange(state, buses, requests);
        let fits = armed.and_then(|rams_m| self.has_room(motion, state, rams_m).map(|()| rams_m));
        let rams_m = fits.inspect_err(|_| self.disarm(state, buses))?;
        state.line.on(Event::Arm);
        self.line.open(&mut state.line, rams_m);
        self.begin_ports(state);
        Ok(())
    }

    /// Checks that a motion stays within the agreed stroke. Limits would cut it otherwise, or fetch
    /// a ram that stands beyond them, at a speed that is meant for the motion.
    fn has_room<M: Motion>(
        &self,
        motion: &M,
        state: &SessionState,
        rams_m: [f64; DAMPER_SLOTS],
    ) -> Result<(), NoAnswer> {
        for port in &self.ports {
            let (node, ram_m) = (port.node.number(), rams_m[port.slot]);
            let stroke_m = state.line.slots[port.slot].limits.stroke_m;
            let reach_m = motion.reach_m(port.slot, ram_m);
            if reach_m > stroke_m {
                return Err(NoAnswer::NoRoom { node, ram_m, reach_m, stroke_m });
            }
        }
        Ok(())
    }

    /// Follows a motion to its end, or until an operator or a cause ends it. Rams come to rest.
    pub fn open_loop<B: Bus, M: Motion>(
        &self,
        motion: &mut M,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        requests: &Requests,
    ) -> End {
        self.begin_pace(buses, pace);
        let (mut ending, mut notices) = (Ending::default(), Notices::default());
        let mut tick = Tick::default();
        let end = loop {
            let is_open = state.line.state == State::OpenLoop;
            let wanted = is_open.then(|| motion.next(&self.seen(state))).flatten();
            let row = self.open_loop_cycle(wanted, state, buses, tick);
            self.notify(state, &mut notices, buses.recorder());
            buses.recorder().row(row);
            if requests.is_stopping() {
                self.stop_by_operator(state);
            }
            let is_stopped = requests.is_ending() || buses.recorder().is_overrun();
            let is_over = is_open && wanted.is_none();
            if let Some(end) = ending.take_open(self, state, is_over, is_stopped) {
                break end;
            }
            tick = self.wait(state, buses, pace);
        };
        self.notify(state, &mut notices, buses.recorder());
        self.close(state, buses, end);
        end
    }

    fn seen(&self, state: &SessionState) -> Seen {
        let mut temperature_degc = [None; DAMPER_SLOTS];
        for (port, memory) in self.ports.iter().zip(&state.ports) {
            temperature_degc[port.slot] = memory.temperature_degc;
        }
        let commands = state.line.slots.map(|slot| slot.command);
        Seen { cycle: state.line.cycle + 1, commands, temperature_degc }
    }

    fn open_loop_cycle<B: Bus>(
        &self,
        wanted: Option<[Command; DAMPER_SLOTS]>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        tick: Tick,
    ) -> Row {
        self.cycle_of((state, buses), tick, &mut (), |session, state, _, ()| {
            let begin = Instant::now();
            // Past the end of the motion the rams stay where they were sent.
            let held = std::array::from_fn(|slot| Command {
                displacement_m: state.line.slots[slot].command.displacement_m,
                velocity_m_per_s: 0.0,
            });
            session.line.follow(&mut state.line, &wanted.unwrap_or(held));
            begin.elapsed()
        })
    }
}
