//! Frames of the rig to values, and commands to frames of the rig.
//!
//! A measurement is whole with the frame that carries the force. What other frames say of it must
//! have come since the last one. Everything here works on fixed numbers of frames: nothing is
//! allocated once the encoder is made.

use super::plan::{Command as CommandSignal, CommandPlan, GatewayPlan, Placed};
use crate::bus::RawFrame;
use dbc::{Fit, Value};
use firmware_core::command::Command;

/// What a rig has measured, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RigReading {
    /// None where the value is out of range, or did not come.
    pub(super) force_n: Option<f64>,
    pub(super) displacement_m: Option<f64>,
    /// The rig's own counter; none without one.
    pub(super) counter: Option<u64>,
    /// Counter of the command that it answers; none without one.
    pub(super) echo: Option<u64>,
    /// Whether the rig calls its sensors sound; true where it says nothing of them.
    pub(super) is_sound: bool,
}

/// What the rig says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RigState {
    Running,
    Fault,
    /// Any other raw number.
    Other(u16),
}

/// Collects what the frames of a rig say.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Decoder {
    /// Come since the last measurement.
    displacement: Option<Value>,
    counter: Option<u64>,
    echo: Option<u64>,
    validity: Option<u64>,
    /// The newest of each.
    pub(super) state: Option<RigState>,
    pub(super) temperature_degc: Option<f64>,
}

impl Decoder {
    /// Takes in a frame; a measurement, where it is whole with it.
    pub(super) fn take(&mut self, plan: &GatewayPlan, frame: &RawFrame) -> Option<RigReading> {
        let measurement = &plan.measurement;
        if let Some(state) = plan.state
            && let Some(code) = raw_in(&state.at, frame)
        {
            self.state = Some(match code {
                _ if code == state.running => RigState::Running,
                _ if code == state.fault => RigState::Fault,
                _ => RigState::Other(u16::try_from(code).unwrap_or(u16::MAX)),
            });
        }
        if let Some(placed) = plan.temperature
            && let Some(value) = value_in(&placed, frame)
        {
            self.temperature_degc = si(value, placed.scale);
        }
        self.displacement = value_in(&measurement.displacement, frame).or(self.displacement);
        let raw = |placed: Placed| raw_in(&placed, frame);
        self.counter = measurement.counter.and_then(raw).or(self.counter);
        self.echo = measurement.echo.and_then(raw).or(self.echo);
        let validity = measurement.valid.and_then(|(placed, _)| raw_in(&placed, frame));
        self.validity = validity.or(self.validity);

        let force = value_in(&measurement.force, frame)?;
        let validity = self.validity.take();
        let is_sound = measurement.valid.is_none_or(|(_, sound)| validity == Some(sound));
        let displacement = self.displacement.take();
        Some(RigReading {
            force_n: si(force, measurement.force.scale),
            displacement_m: displacement
                .and_then(|value| si(value, measurement.displacement.scale)),
            counter: self.counter.take(),
            echo: self.echo.take(),
            is_sound,
        })
    }
}

/// The value of a signal in a frame; `None` where the frame does not have it.
fn value_in(placed: &Placed, frame: &RawFrame) -> Option<Value> {
    if placed.id != frame.id() {
        return None;
    }
    let value = placed.signal.read(frame.data());
    (value != Value::Absent).then_some(value)
}

fn raw_in(placed: &Placed, frame: &RawFrame) -> Option<u64> {
    if placed.id == frame.id() { placed.signal.read_raw(frame.data()) } else { None }
}

fn si(value: Value, scale: f64) -> Option<f64> {
    match value {
        Value::Valid(value) => Some(value * scale),
        Value::Invalid | Value::Absent => None,
    }
}

/// Writes commands.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Encoder {
    /// The messages of a command, with what never changes in them.
    frames: Vec<RawFrame>,
    /// Counter of the next command.
    counter: u64,
}

impl Encoder {
    pub(super) fn new(plan: &CommandPlan) -> Self {
        let empty = [0; 64];
        let blank = |message: &dbc::Message| {
            let data = empty.get(..message.len).unwrap_or(&empty);
            RawFrame::new(message.id, message.is_fd, data)
        };
        let mut frames: Vec<RawFrame> = plan.messages.iter().filter_map(blank).collect();
        debug_assert_eq!(frames.len(), plan.messages.len(), "a message that is no frame");
        for (at, code) in &plan.constants {
            write_code(&mut frames, at, *code);
        }
        Self { frames, counter: 0 }
    }

    /// Writes a command; its counter, where it has one, and whether it was cut to what its signals
    /// hold.
    pub(super) fn write(
        &mut self,
        plan: &CommandPlan,
        command: Command,
        is_enabled: bool,
    ) -> (Option<u64>, bool) {
        let mut is_cut = false;
        let frames = &mut self.frames;
        is_cut |= write(frames, &plan.displacement, command.displacement_m) != Fit::Fits;
        if let Some(at) = &plan.velocity {
            is_cut |= write(frames, at, command.velocity_m_per_s) != Fit::Fits;
        }
        if let Some(enable) = &plan.enable {
            let code = if is_enabled { enable.armed } else { enable.stopped };
            write_code(frames, &enable.at, code);
        }
        let counter = plan.counter.as_ref().map(|at| {
            let counter = self.counter % at.signal.modulus();
            write_code(frames, at, counter);
            counter
        });
        self.counter = self.counter.wrapping_add(1);
        (counter, is_cut)
    }

    /// The frames of the command that was written last.
    pub(super) fn frames(&self) -> &[RawFrame] {
        &self.frames
    }
}

/// Writes a value in SI units, or in units of the DBC where its scale is one.
fn write(frames: &mut [RawFrame], at: &CommandSignal, value: f64) -> Fit {
    match frames.get_mut(at.message) {
        Some(frame) => at.signal.write(frame.data_mut(), value / at.scale),
        None => Fit::NotANumber,
    }
}

/// Writes a raw number, which cannot fail: the plan has checked that its signal holds it.
fn write_code(frames: &mut [RawFrame], at: &CommandSignal, code: u64) {
    let frame = frames.get_mut(at.message);
    debug_assert!(frame.is_some(), "a signal of no frame");
    if let Some(frame) = frame {
        at.signal.write_raw(frame.data_mut(), code);
        let written = at.signal.read_raw(frame.data());
        debug_assert!(written == Some(code), "found {written:?}, expected {code} to be written");
    }
}
