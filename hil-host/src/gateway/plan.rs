//! How a rig is driven by its own messages: every signal with its bits and its scale.

use super::loss::{Loss, loss_lines};
use super::map::LimitsMap;
use can_protocol::arming::Limits;
use dbc::{CanId, Message, Signal};
use std::path::{Path, PathBuf};

/// How a rig is driven by its own messages.
#[derive(Debug, Clone, PartialEq)]
pub struct GatewayPlan {
    pub(super) dbc: PathBuf,
    pub(super) map: PathBuf,
    pub(super) command: CommandPlan,
    pub(super) measurement: MeasurementPlan,
    pub(super) state: Option<StatePlan>,
    pub(super) temperature: Option<Placed>,
    /// The rig stops by itself after this time without a command (s).
    pub(super) time_out_s: Option<f64>,
    pub(super) limits: LimitsMap,
    pub(super) accepted: Vec<Loss>,
}

/// The messages that carry a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandPlan {
    pub(super) messages: Vec<Message>,
    pub(super) displacement: Command,
    pub(super) velocity: Option<Command>,
    pub(super) enable: Option<Enable>,
    pub(super) counter: Option<Command>,
    /// Signals that never change, with their raw numbers.
    pub(super) constants: Vec<(Command, u64)>,
}

/// A signal in one of the messages of a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Command {
    /// Number of the message.
    pub(super) message: usize,
    pub(super) signal: Signal,
    /// SI units in one physical unit of the DBC, with the sign.
    pub(super) scale: f64,
}

/// A signal that starts and stops the rig, with its raw numbers for both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Enable {
    pub(super) at: Command,
    pub(super) armed: u64,
    pub(super) stopped: u64,
}

/// The signals of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeasurementPlan {
    pub(super) force: Placed,
    pub(super) displacement: Placed,
    pub(super) counter: Option<Placed>,
    pub(super) echo: Option<Placed>,
    /// And the raw number that says that the sensors are sound.
    pub(super) valid: Option<(Placed, u64)>,
    pub(super) messages: Vec<Message>,
}

/// A signal in a message of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) id: CanId,
    pub(super) signal: Signal,
    /// SI units in one physical unit of the DBC, with the sign.
    pub(super) scale: f64,
}

/// The state of the rig, with its raw numbers for running and fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StatePlan {
    pub(super) at: Placed,
    pub(super) running: u64,
    pub(super) fault: u64,
}

impl GatewayPlan {
    /// What the rig's messages lack.
    pub fn losses(&self) -> Vec<Loss> {
        let (command, measurement) = (&self.command, &self.measurement);
        let lacks = |loss: &Loss| match loss {
            Loss::NoSession | Loss::NoCrc | Loss::NoReadiness | Loss::NoPressureOff => true,
            Loss::NoEcho => measurement.echo.is_none(),
            Loss::NoCounter => measurement.counter.is_none(),
            Loss::NoCommandCounter => command.counter.is_none(),
            Loss::NoVelocity => command.velocity.is_none(),
            Loss::NoState => self.state.is_none(),
            Loss::NoValidity => measurement.valid.is_none(),
            Loss::NoStop => command.enable.is_none(),
            Loss::NoLimits => self.limits.stroke_m.is_none(),
            Loss::NoTimeOut => self.time_out_s.is_none(),
        };
        Loss::ALL.iter().copied().filter(lacks).collect()
    }

    /// What the run does without, for the terminal.
    pub(crate) fn loss_lines(&self) -> Vec<String> {
        loss_lines(&self.losses(), &self.accepted)
    }

    /// DBC and map.
    pub fn files(&self) -> [&Path; 2] {
        [&self.dbc, &self.map]
    }

    /// Identifiers of the frames that the rig sends, and of commands: another node may send some.
    pub(crate) fn received(&self) -> impl Iterator<Item = CanId> + '_ {
        let measurement = &self.measurement;
        let placed = [Some(measurement.force), Some(measurement.displacement)].into_iter();
        placed
            .chain([measurement.counter, measurement.echo, self.temperature])
            .chain([measurement.valid.map(|(at, _)| at), self.state.map(|state| state.at)])
            .flatten()
            .map(|placed| placed.id)
            .chain(self.command.messages.iter().map(|message| message.id))
    }

    /// Whether a frame with this identifier is a command, or a part of one.
    pub(super) fn is_command(&self, id: CanId) -> bool {
        self.command.messages.iter().any(|message| message.id == id)
    }

    /// Whether any of its messages is a CAN FD frame.
    pub(crate) fn needs_fd(&self) -> bool {
        self.messages().any(|message| message.is_fd)
    }

    /// The messages of commands and measurements.
    pub(super) fn messages(&self) -> impl Iterator<Item = &Message> {
        self.command.messages.iter().chain(&self.measurement.messages)
    }

    /// The limits of the rig; what it does not say is no limit.
    pub(super) fn rig_limits(&self) -> Limits {
        let LimitsMap { stroke_m, velocity_m_per_s, acceleration_m_per_s2, force_n } = self.limits;
        // A conversion saturates.
        let limit = |value: Option<f64>, per_unit: f64| {
            value.map_or(u32::MAX, |value| (value * per_unit).round() as u32)
        };
        Limits {
            stroke_um: limit(stroke_m, 1e6),
            velocity_um_per_s: limit(velocity_m_per_s, 1e6),
            acceleration_mm_per_s2: limit(acceleration_m_per_s2, 1e3),
            force_n: limit(force_n, 1.0),
        }
    }
}
