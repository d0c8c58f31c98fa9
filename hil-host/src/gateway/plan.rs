//! A map, resolved against its DBC: every signal with its bits and its scale.

use super::error::GatewayError;
use super::loss::Loss;
use super::map::{LimitsMap, MapFile, Mapped};
use super::unit::Dimension;
use can_protocol::arming::Limits;
use dbc::{CanId, Database, Message, NamedSignal, Signal};
use scenario::source::Source;
use std::path::{Path, PathBuf};

/// Longest time-out that a rig may have (s).
const MOST_TIME_OUT_S: f64 = 1.0;

/// How a rig is driven by its own messages.
#[derive(Debug, Clone, PartialEq)]
pub struct GatewayPlan {
    dbc: PathBuf,
    map: PathBuf,
    pub(super) command: CommandPlan,
    pub(super) measurement: MeasurementPlan,
    pub(super) state: Option<StatePlan>,
    pub(super) temperature: Option<Placed>,
    /// The rig stops by itself after this time without a command (s).
    pub(super) time_out_s: Option<f64>,
    pub(super) limits: LimitsMap,
    accepted: Vec<Loss>,
}

/// The messages that carry a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandPlan {
    pub(super) messages: Vec<Message>,
    pub(super) displacement: Command,
    pub(super) velocity: Option<Command>,
    pub(super) enable: Option<Enable>,
    pub(super) counter: Option<Command>,
    /// Signals that never change, with their values (physical).
    pub(super) constants: Vec<(Command, f64)>,
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

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Enable {
    pub(super) at: Command,
    pub(super) armed: f64,
    pub(super) stopped: f64,
}

/// The signals of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeasurementPlan {
    pub(super) force: Placed,
    pub(super) displacement: Placed,
    pub(super) counter: Option<Placed>,
    pub(super) echo: Option<Placed>,
    /// And the value that says that the sensors are sound.
    pub(super) valid: Option<(Placed, f64)>,
    messages: Vec<Message>,
}

/// A signal in a message of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) id: CanId,
    pub(super) signal: Signal,
    /// SI units in one physical unit of the DBC, with the sign.
    pub(super) scale: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StatePlan {
    pub(super) at: Placed,
    pub(super) running: f64,
    pub(super) fault: f64,
}

impl GatewayPlan {
    /// Reads a DBC and a map of it. Losses are accepted by name.
    ///
    /// # Errors
    /// A file that does not fit; a rig that may only be moved in `OPEN_LOOP`; a loss that is not
    /// accepted.
    pub fn read(dbc: &Path, map: &Path, accepted: &[Loss]) -> Result<Self, GatewayError> {
        Self::new(&Database::read(dbc)?, &Source::read(map)?, accepted)
    }

    /// The same of files in memory.
    ///
    /// # Errors
    /// Those of [`GatewayPlan::read`].
    pub fn new(database: &Database, map: &Source, accepted: &[Loss]) -> Result<Self, GatewayError> {
        let file: MapFile = map.parse()?;
        let look_up = LookUp { database, map: map.path() };
        let time_out_s = look_up.time_out_s(file.status.timeout_s)?;
        if file.measurement.counter.is_none() && time_out_s.is_none() {
            return Err(GatewayError::OpenLoopOnly { file: map.path().to_owned() });
        }
        look_up.limits(&file.limits)?;
        let state = match &file.status.state {
            None => None,
            Some(state) if state.running == state.fault => {
                let found = format!("{} for running and fault", state.running);
                return Err(look_up.key("[status] state", found, "two values"));
            }
            Some(state) => Some(StatePlan {
                at: look_up.code(&state.signal)?.0,
                running: state.running,
                fault: state.fault,
            }),
        };
        let temperature = match &file.status.temperature {
            Some(mapped) => Some(look_up.placed(mapped, Dimension::Temperature)?.0),
            None => None,
        };
        let plan = Self {
            dbc: database.path().to_owned(),
            map: map.path().to_owned(),
            command: look_up.command(&file)?,
            measurement: look_up.measurement(&file)?,
            state,
            temperature,
            time_out_s,
            limits: file.limits,
            accepted: accepted.to_vec(),
        };
        let all = plan.losses();
        let missing: Vec<Loss> =
            all.iter().copied().filter(|loss| !accepted.contains(loss)).collect();
        if missing.is_empty() {
            Ok(plan)
        } else {
            Err(GatewayError::Unaccepted { file: plan.map, all, missing })
        }
    }

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

    /// The losses that were accepted.
    pub fn accepted(&self) -> &[Loss] {
        &self.accepted
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

/// Finds the signals of a map.
struct LookUp<'a> {
    database: &'a Database,
    map: &'a Path,
}

impl LookUp<'_> {
    fn command(&self, file: &MapFile) -> Result<CommandPlan, GatewayError> {
        let map = &file.command;
        if map.crc.is_some() {
            let found = "a CRC of the rig's own";
            return Err(self.key("[command] crc", found, "no such key: it is not supported"));
        }
        let mut messages: Vec<Message> = Vec::new();
        let mut place = |message: Message, signal: Signal, scale: f64| {
            let known = messages.iter().position(|known| known.id == message.id);
            let number = known.unwrap_or(messages.len());
            if known.is_none() {
                messages.push(message);
            }
            Command { message: number, signal, scale }
        };
        let (message, named, scale) = self.scaled(&map.displacement, Dimension::Displacement)?;
        let displacement = place(message, named.signal, scale);
        let velocity = match &map.velocity {
            Some(mapped) => {
                let (message, named, scale) = self.scaled(mapped, Dimension::Velocity)?;
                Some(place(message, named.signal, scale))
            }
            None => None,
        };
        let enable = match &map.enable {
            Some(enable) if enable.armed == enable.stopped => {
                let found = format!("{} for armed and stopped", enable.armed);
                return Err(self.key("[command] enable", found, "two values"));
            }
            Some(enable) => {
                let (message, named) = self.database.signal(&enable.signal)?;
                let at = place(message, named.signal, 1.0);
                Some(Enable { at, armed: enable.armed, stopped: enable.stopped })
            }
            None => None,
        };
        let counter = match &map.counter {
            Some(name) => {
                let (message, named) = self.counter("[command] counter", name)?;
                Some(place(message, named.signal, 1.0))
            }
            None => None,
        };
        let mut constants = Vec::new();
        for (name, value) in &map.constants {
            let (message, named) = self.database.signal(name)?;
            constants.push((place(message, named.signal, 1.0), *value));
        }
        Ok(CommandPlan { messages, displacement, velocity, enable, counter, constants })
    }

    fn measurement(&self, file: &MapFile) -> Result<MeasurementPlan, GatewayError> {
        let map = &file.measurement;
        let mut messages: Vec<Message> = Vec::new();
        let mut keep = |(placed, message): (Placed, Message)| {
            if messages.iter().all(|known| known.id != message.id) {
                messages.push(message);
            }
            placed
        };
        let force = keep(self.placed(&map.force, Dimension::Force)?);
        let displacement = keep(self.placed(&map.displacement, Dimension::Displacement)?);
        let counter = match &map.counter {
            Some(name) => {
                let (message, named) = self.counter("[measurement] counter", name)?;
                let placed = Placed { id: message.id, signal: named.signal, scale: 1.0 };
                Some(keep((placed, message)))
            }
            None => None,
        };
        let echo = match &map.echo {
            Some(_) if file.command.counter.is_none() => {
                let expected = "[command] counter as well: an echo repeats it";
                return Err(self.key("[measurement] echo", "an echo alone", expected));
            }
            Some(name) => {
                let (message, named) = self.counter("[measurement] echo", name)?;
                let placed = Placed { id: message.id, signal: named.signal, scale: 1.0 };
                Some(keep((placed, message)))
            }
            None => None,
        };
        let valid = match &map.valid {
            Some(valid) => Some((keep(self.code(&valid.signal)?), valid.value)),
            None => None,
        };
        Ok(MeasurementPlan { force, displacement, counter, echo, valid, messages })
    }

    /// A signal whose value is a code, without a unit.
    fn code(&self, name: &str) -> Result<(Placed, Message), GatewayError> {
        let (message, named) = self.database.signal(name)?;
        Ok((Placed { id: message.id, signal: named.signal, scale: 1.0 }, message))
    }

    /// A signal that counts.
    fn counter(
        &self,
        key: &'static str,
        name: &str,
    ) -> Result<(Message, NamedSignal), GatewayError> {
        let (message, named) = self.database.signal(name)?;
        if !named.signal.is_whole() || named.signal.modulus() < 3 {
            let found = format!("signal {}", named.name);
            return Err(self.key(key, found, "an unsigned signal of 2 bits or more"));
        }
        Ok((message, named))
    }

    fn placed(
        &self,
        mapped: &Mapped,
        dimension: Dimension,
    ) -> Result<(Placed, Message), GatewayError> {
        let (message, named, scale) = self.scaled(mapped, dimension)?;
        Ok((Placed { id: message.id, signal: named.signal, scale }, message))
    }

    /// A signal and the SI units in one unit of it.
    fn scaled(
        &self,
        mapped: &Mapped,
        dimension: Dimension,
    ) -> Result<(Message, NamedSignal, f64), GatewayError> {
        let (message, named) = self.database.signal(&mapped.signal)?;
        let unit = mapped.unit.as_ref().unwrap_or(&named.unit);
        let Some(scale) = mapped.scale.or_else(|| dimension.scale(unit)) else {
            return Err(GatewayError::Unit {
                file: self.database.path().to_owned(),
                line: named.line,
                signal: named.name,
                unit: unit.clone(),
                expected: dimension.units(),
            });
        };
        Ok((message, named, scale * mapped.sign))
    }

    fn time_out_s(&self, declared: Option<f64>) -> Result<Option<f64>, GatewayError> {
        match declared {
            Some(time_s) if !(time_s > 0.0 && time_s <= MOST_TIME_OUT_S) => {
                let (found, expected) = (format!("{time_s} s"), "a time over 0 and up to 1 s");
                Err(self.key("[status] timeout_s", found, expected))
            }
            declared => Ok(declared),
        }
    }

    fn limits(&self, limits: &LimitsMap) -> Result<(), GatewayError> {
        let all = [
            ("[limits] stroke_m", limits.stroke_m),
            ("[limits] velocity_m_per_s", limits.velocity_m_per_s),
            ("[limits] acceleration_m_per_s2", limits.acceleration_m_per_s2),
            ("[limits] force_n", limits.force_n),
        ];
        let is_wrong = |limit: f64| !(limit.is_finite() && limit > 0.0);
        match all.into_iter().find(|(_, limit)| limit.is_some_and(is_wrong)) {
            Some((key, limit)) => {
                let found = limit.unwrap_or_default().to_string();
                Err(self.key(key, found, "a number over 0"))
            }
            None => Ok(()),
        }
    }

    fn key(
        &self,
        key: &'static str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> GatewayError {
        let (file, found, expected) = (self.map.to_owned(), found.into(), expected.into());
        GatewayError::Key { file, key, found, expected }
    }
}
