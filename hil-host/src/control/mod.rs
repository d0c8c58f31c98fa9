//! The control loop.
//!
//! ```text
//! receive -> decode -> guard -> vehicle step -> compensate -> encode -> send -> record
//! ```
//! and then the wait for the next slot. [`Session::cycle`] is that line: between receive and send it
//! neither allocates nor locks, logs or calls through a pointer. After the send every watched rig's
//! force is compared with its model ([`watch`]).

pub mod hash;
mod port;
pub mod watch;

pub use port::{Port, PortState};

use crate::bus::{Bus, Sent, WireFrame};
use crate::clock::Pacer;
use crate::record::{BusEvent, Recorder, Row};
use can_protocol::{Frame, MessageId, Pace as WirePace, Profile, RunState, Sync};
use core::num::{NonZeroU8, NonZeroU16};
use firmware_core::guard::ForceInput;
use firmware_core::line::{Line, LineState, Slot};
use firmware_core::vehicle::{AXLES_MAX, DAMPER_SLOTS, LATERAL, VERTICAL};
use heapless::Vec;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Who sets the pace.
#[derive(Debug, Clone, PartialEq)]
pub enum Pace {
    /// Absolute deadlines; missed slots are skipped and counted.
    Realtime(Pacer),
    /// The next cycle comes when every rig has echoed this one.
    LockStep,
    /// Nothing waits.
    Fast,
}

/// A peer that is silent for this long in lock-step is lost.
pub const SILENCE: Duration = Duration::from_secs(1);

/// Cycles of the safe stop before the session ends.
pub const STOP_CYCLES: u64 = 200;

/// Cycles between two frames that tell the residual of a watched rig: 20 Hz.
const RESIDUAL_CYCLES: u64 = 50;

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// All cycles were run.
    Completed,
    /// The operator stopped it.
    Stopped,
    /// A guard tripped or a peer was lost: the rigs were brought to rest.
    Safe,
}

/// Parameters of a session.
#[derive(Debug, Clone, PartialEq)]
pub struct Session<'a> {
    /// The line.
    pub line: Line<'a>,
    /// The ports, in slot order.
    pub ports: Vec<Port, DAMPER_SLOTS>,
    /// The profile on the wire.
    pub profile: Profile,
    /// How many times longer a cycle is on the wall.
    pub slow_down: NonZeroU8,
    /// Bodies whose accelerations are recorded: carbody, front bogie, first wheelset.
    pub watched: [Option<usize>; 3],
}

/// What a session remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionState {
    /// The line's state.
    pub line: LineState,
    /// The ports' states, in slot order.
    pub ports: Vec<PortState, DAMPER_SLOTS>,
    /// The trajectory hash so far.
    pub hash: u64,
    /// Slots of the grid that were skipped.
    pub skipped: u64,
    /// Commands that the bus did not take.
    pub late: u64,
    /// A bus is down or a peer is lost.
    pub lost: bool,
}

impl Session<'_> {
    /// The state at the start.
    pub fn start(&self, line: LineState) -> SessionState {
        SessionState {
            line,
            ports: self.ports.iter().map(|_| PortState::default()).collect(),
            hash: hash::START,
            skipped: 0,
            late: 0,
            lost: false,
        }
    }

    /// The announcement to all rigs.
    pub fn sync(&self, state: &SessionState, pace: &Pace) -> Frame {
        let period_us = (self.line.cycle_s * 1e6).round() as u16;
        Sync {
            version: can_protocol::PROTOCOL_VERSION,
            profile: self.profile,
            pace: match pace {
                Pace::Realtime(_) => WirePace::Clock,
                Pace::LockStep | Pace::Fast => WirePace::LockStep,
            },
            period_us: NonZeroU16::new(period_us).unwrap_or(NonZeroU16::MIN),
            slow_down: self.slow_down,
            time_us: self.time_us(state),
        }
        .encode()
    }

    fn time_us(&self, state: &SessionState) -> u32 {
        // Wraps after 71.6 minutes, as the field on the wire does.
        (state.line.cycle as f64 * self.line.cycle_s * 1e6) as u64 as u32
    }

    /// Announces the session until every rig has sent its heartbeat.
    ///
    /// # Errors
    /// The nodes that did not answer in time.
    pub fn greet<B: Bus>(
        &self,
        state: &SessionState,
        buses: &mut [B],
        pace: &Pace,
        patience: Duration,
    ) -> Result<(), std::vec::Vec<u8>> {
        let begin = Instant::now();
        let mut silent: std::vec::Vec<&Port> = self.ports.iter().collect();
        while !silent.is_empty() {
            for bus in buses.iter_mut() {
                bus.send(&self.sync(state, pace));
            }
            let round = Instant::now();
            while !silent.is_empty() && round.elapsed() < Duration::from_millis(100) {
                for (number, bus) in buses.iter_mut().enumerate() {
                    while let Some(frame) = bus.receive() {
                        silent.retain(|port| {
                            let heartbeat =
                                MessageId::Heartbeat(can_protocol::Sender::Rig(port.node));
                            port.bus != number || frame.id() != heartbeat.raw()
                        });
                    }
                    if !silent.is_empty() {
                        bus.wait(Duration::from_millis(5));
                    }
                }
            }
            if begin.elapsed() > patience {
                return Err(silent.iter().map(|port| port.node.number()).collect());
            }
        }
        // What the rigs said before the first command belongs to no cycle.
        for bus in buses {
            while bus.receive().is_some() {}
        }
        Ok(())
    }

    /// Runs until the cycles are done, the operator stops it, or the safe state has been reached.
    pub fn run<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        pace: &mut Pace,
        cycles: u64,
        recorder: &mut Recorder<'_>,
        stop: &AtomicBool,
    ) -> End {
        recorder.may_wait = !matches!(pace, Pace::Realtime(_));
        if let Pace::Realtime(pacer) = pace {
            pacer.restart();
        }
        let begin = Instant::now();
        let mut safe_since = None;
        let mut lateness_ns = 0;
        let mut skipped = 0;
        let end = loop {
            let slot = Slots { lateness_ns, skipped };
            let row = self.cycle(state, buses, pace, recorder, &begin, slot);
            recorder.row(row);
            if state.line.safe && safe_since.is_none() {
                safe_since = Some(state.line.cycle);
            }
            if let Some(since) = safe_since
                && state.line.cycle >= since + STOP_CYCLES
            {
                break End::Safe;
            }
            if safe_since.is_none() && state.line.cycle >= cycles {
                break End::Completed;
            }
            if safe_since.is_none() && stop.load(Ordering::Relaxed) {
                break End::Stopped;
            }
            match pace {
                Pace::Realtime(pacer) => {
                    let slot = pacer.wait();
                    lateness_ns = u32::try_from(slot.lateness_ns).unwrap_or(u32::MAX);
                    skipped = u32::try_from(slot.skipped).unwrap_or(u32::MAX);
                    state.skipped += slot.skipped;
                }
                Pace::LockStep if safe_since.is_none() => {
                    if !self.wait_for_echoes(state, buses, recorder, &begin) {
                        state.lost = true;
                        state.line.safe = true;
                    }
                }
                Pace::LockStep | Pace::Fast => {}
            }
        };
        self.close(state, buses, recorder, &begin, end);
        end
    }

    /// One cycle: receive, decode, guard, vehicle step, compensate, encode, send. Gives the row.
    pub fn cycle<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        pace: &Pace,
        recorder: &mut Recorder<'_>,
        begin: &Instant,
        slot: Slots,
    ) -> Row {
        let woken = Instant::now();
        self.receive(state, buses, recorder, begin);
        let mut inputs = [ForceInput::Missing; DAMPER_SLOTS];
        let mut row = Row::default();
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let (input, frame) = port.take_input(memory);
            if let (Some(to), Some(kind), Some(bytes)) = (
                inputs.get_mut(port.slot),
                row.input.get_mut(port.slot),
                row.frame.get_mut(port.slot),
            ) {
                *to = input;
                *kind = match input {
                    ForceInput::Fresh(_) => 1,
                    ForceInput::Missing => 2,
                    ForceInput::Invalid => 3,
                };
                *bytes = frame;
            }
        }
        // The first answer comes after the first command.
        if state.line.cycle == 0 {
            for (input, slot) in inputs.iter_mut().zip(&self.line.slots) {
                if matches!(slot, Slot::Rig(_)) && *input == ForceInput::Missing {
                    *input = ForceInput::Fresh(0.0);
                }
            }
        }
        let stepped = Instant::now();
        self.line.step(&mut state.line, &inputs);
        let compute = stepped.elapsed();

        let run = if state.line.safe { RunState::Safe } else { RunState::Run };
        let time_us = self.time_us(state);
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let Some(slot) = state.line.slots.get(port.slot) else { continue };
            let frame = port.command(memory, &slot.command, run, time_us);
            let Some(bus) = buses.get_mut(port.bus) else { continue };
            match bus.send(&frame) {
                Sent::Away => {}
                Sent::Dropped => state.late += 1,
                Sent::Down => {
                    state.late += 1;
                    state.lost = true;
                    state.line.safe = true;
                }
            }
            recorder.event(BusEvent {
                time_ns: begin.elapsed().as_nanos() as u64,
                bus: port.bus as u8,
                frame: WireFrame::from(&frame),
            });
        }
        // Nothing waits for this: the commands are away.
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            if let Some(input) = inputs.get(port.slot) {
                port.watch(memory, *input);
            }
        }
        if state.line.cycle % RESIDUAL_CYCLES == 1 {
            for (port, memory) in self.ports.iter().zip(&mut state.ports) {
                let Some(frame) = port.residual(memory, run) else { continue };
                let Some(bus) = buses.get_mut(port.bus) else { continue };
                bus.send(&frame);
                recorder.event(BusEvent {
                    time_ns: begin.elapsed().as_nanos() as u64,
                    bus: port.bus as u8,
                    frame: WireFrame::from(&frame),
                });
            }
        }
        if state.line.cycle % 100 == 1 {
            let frame = self.sync(state, pace);
            for (number, bus) in buses.iter_mut().enumerate() {
                bus.send(&frame);
                recorder.event(BusEvent {
                    time_ns: begin.elapsed().as_nanos() as u64,
                    bus: number as u8,
                    frame: WireFrame::from(&frame),
                });
            }
        }
        state.hash = hash::add_cycle(state.hash, self.line.vehicle, &state.line);
        row.compute_ns = compute.as_nanos() as u32;
        row.cycle_ns = woken.elapsed().as_nanos() as u32;
        row.lateness_ns = slot.lateness_ns;
        row.skipped = slot.skipped;
        self.fill(&mut row, state);
        row
    }

    /// Drains every bus; each port keeps its newest measurement.
    fn receive<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        recorder: &mut Recorder<'_>,
        begin: &Instant,
    ) {
        for (number, bus) in buses.iter_mut().enumerate() {
            while let Some(frame) = bus.receive() {
                for (port, memory) in self.ports.iter().zip(&mut state.ports) {
                    if port.bus == number && port.take_frame(memory, &frame) {
                        break;
                    }
                }
                recorder.event(BusEvent {
                    time_ns: begin.elapsed().as_nanos() as u64,
                    bus: number as u8,
                    frame,
                });
            }
        }
    }

    /// Waits until every rig has answered the last command; false when one stays silent.
    fn wait_for_echoes<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        recorder: &mut Recorder<'_>,
        begin: &Instant,
    ) -> bool {
        let since = Instant::now();
        loop {
            self.receive(state, buses, recorder, begin);
            let mut waiting = None;
            for (port, memory) in self.ports.iter().zip(&state.ports) {
                if !port.has_echo(memory) {
                    waiting = Some(port.bus);
                }
            }
            let Some(bus) = waiting else { return true };
            if since.elapsed() > SILENCE {
                return false;
            }
            if let Some(bus) = buses.get_mut(bus) {
                bus.wait(SILENCE);
            }
        }
    }

    /// Tells the rigs that the run is over, and takes in what is still on the way.
    fn close<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        recorder: &mut Recorder<'_>,
        begin: &Instant,
        end: End,
    ) {
        if end != End::Safe {
            self.wait_for_echoes(state, buses, recorder, begin);
        }
        let run = if end == End::Safe { RunState::Safe } else { RunState::Standby };
        let time_us = self.time_us(state);
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let Some(slot) = state.line.slots.get(port.slot) else { continue };
            let Some(bus) = buses.get_mut(port.bus) else { continue };
            let mut still = slot.command;
            still.velocity_m_per_s = 0.0;
            let frame = port.command(memory, &still, run, time_us);
            memory.commands -= 1;
            bus.send(&frame);
            recorder.event(BusEvent {
                time_ns: begin.elapsed().as_nanos() as u64,
                bus: port.bus as u8,
                frame: WireFrame::from(&frame),
            });
        }
    }

    fn fill(&self, row: &mut Row, state: &SessionState) {
        let vehicle = &state.line.vehicle;
        row.cycle = state.line.cycle;
        row.time_s = state.line.cycle.saturating_sub(1) as f64 * self.line.cycle_s;
        for (number, slot) in state.line.slots.iter().enumerate() {
            row.extension_m[number] = vehicle.extension_m[number].lane(0) - slot.mid_stroke_m;
            row.extension_m_per_s[number] = vehicle.extension_m_per_s[number].lane(0);
            row.force_n[number] = vehicle.damper_n[number].lane(0);
        }
        for (port, memory) in self.ports.iter().zip(&state.ports) {
            let Some(slot) = state.line.slots.get(port.slot) else { continue };
            let view = memory.watch.view;
            row.residual_n[port.slot] = view.residual_n.unwrap_or(f64::NAN);
            row.residual_rms_n[port.slot] = view.residual_rms_n.unwrap_or(f64::NAN);
            row.residual_limit_n[port.slot] = view.limit_n.unwrap_or(f64::NAN);
            row.drift[port.slot] = view.verdict.code();
            row.command_m[port.slot] = slot.command.displacement_m;
            row.command_m_per_s[port.slot] = slot.command.velocity_m_per_s;
            if let Some(used) = memory.used {
                row.measured_m[port.slot] = used.displacement_m.unwrap_or(f64::NAN);
                row.measured_n[port.slot] = used.force_n.unwrap_or(f64::NAN);
            }
        }
        for (number, body) in self.watched.into_iter().enumerate() {
            let acceleration = body.and_then(|body| vehicle.acceleration.get(body));
            let (lateral, vertical) = acceleration
                .map_or((f64::NAN, f64::NAN), |a| (a[LATERAL].lane(0), a[VERTICAL].lane(0)));
            row.acceleration_m_per_s2[2 * number] = lateral;
            row.acceleration_m_per_s2[2 * number + 1] = vertical;
        }
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let wheel = &vehicle.wheels[0][side][0];
            row.wheel_lateral_n[side] = -sign * wheel.lateral_n;
            row.wheel_vertical_n[side] = -wheel.vertical_n;
        }
        for (number, axle) in self.line.vehicle.axles.iter().enumerate().take(AXLES_MAX) {
            row.wheelset_lateral_m[number] = vehicle.position[axle.body.index()][LATERAL].lane(0);
        }
        row.distance_m = vehicle.distance_m.lane(0);
        row.hash = state.hash;
    }
}

/// How a cycle came about on the clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Slots {
    /// How late it began (ns).
    pub lateness_ns: u32,
    /// Slots of the grid that were skipped before it.
    pub skipped: u32,
}
