//! What a session is: parameters and state.

use super::delay_gate::{DelayGate, DelayGateState};
use super::port::{Agreed, Port, PortState};
use super::recent_skips::RecentSkips;
use super::stop::{NotedSummary, PressureRequest, Stop};
use super::terms::Arming;
use can_protocol::arming::Quiet;
use can_protocol::{Frame, Heartbeat, Pace as WirePace, Profile, Sender, Sync};
use core::num::{NonZeroU8, NonZeroU16};
use firmware_core::fnv;
use firmware_core::line::{Fade, Line, LineState, Slot};
use firmware_core::supervision::{Action, Cause, Event, Noted};
use firmware_core::vehicle::DAMPER_SLOTS;
use heapless::Vec;
use nodes::locomotive::Overheard;
use nodes::wire_state;

/// Parameters of a session.
#[derive(Debug, Clone, PartialEq)]
pub struct Session<'a> {
    /// The line: guard, vehicle, compensation.
    pub line: Line<'a>,
    /// The ports, in slot order.
    pub ports: Vec<Port, DAMPER_SLOTS>,
    /// The profile on the wire.
    pub profile: Profile,
    /// The pace that the rigs are given: their own clock, or one cycle per command.
    pub pace: WirePace,
    /// How many times longer a cycle takes than in the model.
    pub slow_down: NonZeroU8,
    /// What the host brings into the arming exchange.
    pub arming: Arming,
    /// The gate before RUN; none where the delay is not judged.
    pub delay_gate: Option<DelayGate>,
    /// Bodies whose accelerations are recorded: carbody, front bogie, first wheelset.
    pub watched: [Option<usize>; 3],
    /// The rear bogie.
    pub rear_bogie: Option<usize>,
}

/// What a session remembers. A clone is a snapshot.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionState {
    /// The line's state.
    pub line: LineState,
    /// The ports' states, in slot order.
    pub ports: Vec<PortState, DAMPER_SLOTS>,
    /// What the gate before RUN has measured.
    pub gate: DelayGateState,
    /// The trajectory hash so far.
    pub hash: u64,
    /// Ticks of the clock that were skipped.
    pub skipped: u64,
    /// Those of the last cycles.
    pub(super) skips: RecentSkips,
    /// Commands that the bus did not take.
    pub late: u64,
    /// Cycles in a row in which a bus did not take a command.
    pub late_in_a_row: u32,
    /// What stopped the session: the first cause.
    pub stop: Option<Stop>,
    /// Whether the rigs were sent it.
    pub(super) is_announced: bool,
    /// What is still to be sent to a rig that is to drop its pressure.
    pub(super) pressure_off: Option<PressureRequest>,
    /// Sequence number of the next heartbeat.
    pub(super) heartbeat_counter: u8,
    /// Before arming, by bus: how long nobody else was heard.
    pub(super) quiet: Vec<Quiet, DAMPER_SLOTS>,
    /// In motion, by bus: frames of another host.
    pub(super) overheard: [Overheard; DAMPER_SLOTS],
}

impl SessionState {
    /// Has the next heartbeat carry this counter.
    pub(crate) const fn go_on_with_heartbeat(&mut self, counter: u8) {
        self.heartbeat_counter = counter;
    }
}

impl Session<'_> {
    /// The state at the start.
    pub fn start(&self, line: LineState) -> SessionState {
        debug_assert!(self.is_consistent(), "ports, slots and bodies do not fit each other");
        SessionState {
            line,
            ports: self.ports.iter().map(|_| PortState::default()).collect(),
            gate: DelayGateState::default(),
            hash: fnv::START,
            skipped: 0,
            skips: RecentSkips::default(),
            late: 0,
            late_in_a_row: 0,
            stop: None,
            is_announced: false,
            pressure_off: None,
            heartbeat_counter: 0,
            quiet: Vec::new(),
            overheard: [Overheard::default(); DAMPER_SLOTS],
        }
    }

    /// Ends the motion as an action asks for, and keeps the first cause.
    pub(super) fn stop(
        &self,
        state: &mut SessionState,
        node: Option<u8>,
        cause: Cause,
        action: Action,
    ) {
        // Without a ramp the only way to rest is a stop.
        let is_orderly = action == Action::RampOut && self.has_ramps(state);
        state.line.on(if is_orderly { Event::End } else { Event::Stop });
        let stop = self.found(state, node, cause);
        if action == Action::PowerOff {
            state.pressure_off.get_or_insert(PressureRequest::new(stop));
        }
        state.stop.get_or_insert(stop);
    }

    /// A cause that is found in this cycle.
    pub(super) fn found(&self, state: &SessionState, node: Option<u8>, cause: Cause) -> Stop {
        let (cycle, time_s) = (state.line.cycle, state.line.time_s(self.line.cycle_s));
        Stop { cycle, time_s, node, cause, skipped: state.skips.just_before(cycle) }
    }

    /// What was beyond a limit of a rig and ended nothing.
    pub fn noted(&self, state: &SessionState) -> std::vec::Vec<NotedSummary> {
        let ports = self.ports.iter().zip(&state.ports);
        let noted = ports.flat_map(|(port, memory)| {
            let node = port.node.number();
            memory
                .belief
                .noted()
                .map(move |noted| NotedSummary::of(&noted, self.first_of(state, node, &noted)))
        });
        noted.collect()
    }

    /// The first time that something was noted of a rig.
    pub(super) fn first_of(&self, state: &SessionState, node: u8, noted: &Noted) -> Stop {
        let cycle = noted.first_cycle;
        let time_s = state.line.time_of_s(cycle, self.line.cycle_s);
        Stop { cycle, time_s, node: Some(node), cause: noted.first, skipped: 0 }
    }

    /// What holds for the rig of every slot that has one.
    pub(crate) fn agreed(&self, state: &SessionState) -> [Option<Agreed>; DAMPER_SLOTS] {
        let mut agreed = [None; DAMPER_SLOTS];
        for (port, memory) in self.ports.iter().zip(&state.ports) {
            agreed[port.slot] = Some(port.agreed(memory, state.line.slots[port.slot].limits));
        }
        agreed
    }

    /// Whether there is anything to fade in and out.
    pub(super) fn has_ramps(&self, state: &SessionState) -> bool {
        !self.ports.is_empty() && state.line.fade != Fade::default()
    }

    /// Every rig slot has one port, in slot order, and every recorded body is one of the vehicle's.
    fn is_consistent(&self) -> bool {
        let slots = self.line.slots.iter().enumerate();
        let on_rigs = slots.filter(|(_, slot)| matches!(slot, Slot::Rig(_)));
        on_rigs.map(|(slot, _)| slot).eq(self.ports.iter().map(|port| port.slot))
            && self.watched.iter().flatten().all(|body| *body < self.line.vehicle.bodies.len())
    }

    /// The announcement to all rigs.
    pub fn sync(&self, state: &SessionState) -> Frame {
        self.sync_message(state).encode()
    }

    pub(super) fn sync_message(&self, state: &SessionState) -> Sync {
        Sync {
            version: can_protocol::PROTOCOL_VERSION,
            profile: self.profile,
            pace: self.pace,
            period_us: self.period_us(),
            slow_down: self.slow_down,
            time_us: self.time_us(state),
        }
    }

    /// The next heartbeat.
    pub(super) fn heartbeat(&self, state: &mut SessionState) -> Frame {
        let (counter, run) = (state.heartbeat_counter, wire_state(state.line.state));
        state.heartbeat_counter = Profile::Classical.next_counter(counter);
        Heartbeat::new(Sender::Host, counter, run, self.arming.boot).encode().0
    }

    /// Whole cycles in a time of the model (s), to the nearest.
    pub(crate) fn cycles(&self, time_s: f64) -> u64 {
        libm::round(time_s / self.line.cycle_s) as u64
    }

    /// Length of a cycle in the model.
    pub(super) fn period_us(&self) -> NonZeroU16 {
        let period_us = (self.line.cycle_s * 1e6).round() as u16;
        debug_assert!(period_us > 0, "a cycle of {} s", self.line.cycle_s);
        NonZeroU16::new(period_us).unwrap_or(NonZeroU16::MIN)
    }

    pub(super) fn time_us(&self, state: &SessionState) -> u32 {
        // Wraps after 71.6 minutes, as the field on the wire does.
        (state.line.cycle as f64 * self.line.cycle_s * 1e6) as u64 as u32
    }
}
