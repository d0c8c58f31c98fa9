//! A map, resolved against its DBC and checked: from the names of signals to a plan.

use super::capacity::{self, Bounds};
use super::error::GatewayError;
use super::key::MapKey;
use super::look_up::{Found, LookUp};
use super::loss::Loss;
use super::map::{CommandMap, MapFile, Mapped};
use super::placement;
use super::plan::{Command, CommandPlan, Enable, GatewayPlan, MeasurementPlan, Placed, StatePlan};
use super::unit::Dimension;
use dbc::{Database, Message};
use scenario::source::Source;
use std::path::Path;

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
        let time_out_s = capacity::time_out_s(map, file.status.timeout_s)?;
        if file.measurement.counter.is_none() && time_out_s.is_none() {
            return Err(GatewayError::OpenLoopOnly { file: map.path().to_owned() });
        }
        let look_up = LookUp { database, map };
        let command = CommandSignals::find(look_up, &file.command)?;
        let rig = RigSignals::find(look_up, &file, command.counter.as_ref())?;
        placement::check(map, &command.changing(), &command.constants, &rig.all())?;
        let bounds = Bounds {
            displacements: [&command.displacement, &rig.displacement],
            velocity: command.velocity.as_ref(),
            force: &rig.force,
        };
        capacity::limits(map, &file.limits, bounds)?;
        let plan = Self {
            dbc: database.path().to_owned(),
            map: map.path().to_owned(),
            command: command.plan(),
            measurement: rig.measurement(),
            state: rig.state.as_ref().map(|(found, [running, fault])| StatePlan {
                at: placed(found),
                running: *running,
                fault: *fault,
            }),
            temperature: rig.temperature.as_ref().map(placed),
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
}

/// What a map names in `[command]`.
struct CommandSignals {
    displacement: Found,
    velocity: Option<Found>,
    /// And the raw numbers for armed and stopped.
    enable: Option<(Found, [u64; 2])>,
    counter: Option<Found>,
    /// And their raw numbers.
    constants: Vec<(Found, u64)>,
}

impl CommandSignals {
    fn find(look_up: LookUp<'_>, map: &CommandMap) -> Result<Self, GatewayError> {
        let (source, key) = (look_up.map, |name| MapKey::new("command", name));
        if map.crc.is_some() {
            let expected = "no such key: it is not supported";
            return Err(key("crc").refuse(source, "a CRC of the rig's own", expected));
        }
        let quantity = |name, mapped, dimension| quantity(look_up, key(name), mapped, dimension);
        let displacement = quantity("displacement", &map.displacement, Dimension::Displacement)?;
        let velocity = map.velocity.as_ref();
        let velocity =
            velocity.map(|mapped| quantity("velocity", mapped, Dimension::Velocity)).transpose()?;
        let enable = match &map.enable {
            Some(enable) => {
                let found = look_up.code(key("enable"), &enable.signal)?;
                let named = [("armed", enable.armed), ("stopped", enable.stopped)];
                let raw = capacity::codes(source, &found, named)?;
                Some((found, raw))
            }
            None => None,
        };
        let counter = map.counter.as_ref();
        let counter = counter.map(|name| look_up.counter(key("counter"), name)).transpose()?;
        let constant = |(name, value): (&String, &f64)| {
            let found = look_up.code(MapKey::constant(name), name)?;
            let raw = capacity::raw(source, &found, *value)?;
            Ok((found, raw))
        };
        let constants = map.constants.iter().map(constant).collect::<Result<_, GatewayError>>()?;
        Ok(Self { displacement, velocity, enable, counter, constants })
    }

    /// Those that are written in every cycle, in this order.
    fn changing(&self) -> Vec<&Found> {
        let enable = self.enable.as_ref().map(|(found, _)| found);
        let rest = [self.velocity.as_ref(), enable, self.counter.as_ref()];
        std::iter::once(&self.displacement).chain(rest.into_iter().flatten()).collect()
    }

    fn plan(&self) -> CommandPlan {
        let mut messages: Vec<Message> = Vec::new();
        let mut place = |found: &Found| Command {
            message: number_of(&mut messages, &found.message),
            signal: found.signal,
            scale: found.scale,
        };
        let displacement = place(&self.displacement);
        let velocity = self.velocity.as_ref().map(&mut place);
        let enable = self.enable.as_ref().map(|(found, [armed, stopped])| Enable {
            at: place(found),
            armed: *armed,
            stopped: *stopped,
        });
        let counter = self.counter.as_ref().map(&mut place);
        let constants = self.constants.iter().map(|(found, raw)| (place(found), *raw)).collect();
        CommandPlan { messages, displacement, velocity, enable, counter, constants }
    }
}

/// What a map names in `[measurement]` and `[status]`.
struct RigSignals {
    force: Found,
    displacement: Found,
    counter: Option<Found>,
    echo: Option<Found>,
    /// And the raw number of sound sensors.
    valid: Option<(Found, u64)>,
    /// And the raw numbers for running and fault.
    state: Option<(Found, [u64; 2])>,
    temperature: Option<Found>,
}

impl RigSignals {
    fn find(
        look_up: LookUp<'_>,
        file: &MapFile,
        commands: Option<&Found>,
    ) -> Result<Self, GatewayError> {
        let (source, map) = (look_up.map, &file.measurement);
        let key = |name| MapKey::new("measurement", name);
        let quantity = |key, mapped, dimension| quantity(look_up, key, mapped, dimension);
        let force = quantity(key("force"), &map.force, Dimension::Force)?;
        let displacement =
            quantity(key("displacement"), &map.displacement, Dimension::Displacement)?;
        let counter = map.counter.as_ref();
        let counter = counter.map(|name| look_up.counter(key("counter"), name)).transpose()?;
        let echo = map.echo.as_ref();
        let echo = echo.map(|name| echo_of(look_up, key("echo"), name, commands)).transpose()?;
        let valid = match &map.valid {
            Some(valid) => {
                let found = look_up.code(key("valid"), &valid.signal)?;
                let raw = capacity::code(source, &found, valid.value)?;
                Some((found, raw))
            }
            None => None,
        };
        let key = |name| MapKey::new("status", name);
        let state = match &file.status.state {
            Some(state) => {
                let found = look_up.code(key("state"), &state.signal)?;
                let named = [("running", state.running), ("fault", state.fault)];
                let raw = capacity::codes(source, &found, named)?;
                Some((found, raw))
            }
            None => None,
        };
        let temperature = file.status.temperature.as_ref();
        let temperature = temperature
            .map(|mapped| quantity(key("temperature"), mapped, Dimension::Temperature))
            .transpose()?;
        Ok(Self { force, displacement, counter, echo, valid, state, temperature })
    }

    fn all(&self) -> Vec<&Found> {
        let valid = self.valid.as_ref().map(|(found, _)| found);
        let state = self.state.as_ref().map(|(found, _)| found);
        let rest = [self.counter.as_ref(), self.echo.as_ref(), valid, state];
        let rest = rest.into_iter().chain([self.temperature.as_ref()]).flatten();
        [&self.force, &self.displacement].into_iter().chain(rest).collect()
    }

    fn measurement(&self) -> MeasurementPlan {
        let mut messages: Vec<Message> = Vec::new();
        let mut place = |found: &Found| {
            number_of(&mut messages, &found.message);
            placed(found)
        };
        let (force, displacement) = (place(&self.force), place(&self.displacement));
        let counter = self.counter.as_ref().map(&mut place);
        let echo = self.echo.as_ref().map(&mut place);
        let valid = self.valid.as_ref().map(|(found, raw)| (place(found), *raw));
        MeasurementPlan { force, displacement, counter, echo, valid, messages }
    }
}

/// A signal with a unit, and with a range that is of use.
fn quantity(
    look_up: LookUp<'_>,
    key: MapKey,
    mapped: &Mapped,
    dimension: Dimension,
) -> Result<Found, GatewayError> {
    let found = look_up.quantity(key, mapped, dimension)?;
    capacity::useful(look_up.map, &found, dimension).map(|()| found)
}

/// The signal that repeats the counter of the command.
fn echo_of(
    look_up: LookUp<'_>,
    key: MapKey,
    name: &str,
    commands: Option<&Found>,
) -> Result<Found, GatewayError> {
    let Some(commands) = commands else {
        let expected = "[command] counter as well: an echo repeats it";
        return Err(key.refuse(look_up.map, "an echo alone", expected));
    };
    let echo = look_up.counter(key, name)?;
    let (found, needed) = (echo.signal.modulus(), commands.signal.modulus());
    if found < needed {
        let found = format!("{} with {found} values", echo.name);
        let expected = format!("at least {needed}, those of [command] counter");
        return Err(echo.key.refuse(look_up.map, found, expected));
    }
    Ok(echo)
}

fn placed(found: &Found) -> Placed {
    Placed { id: found.message.id, signal: found.signal, scale: found.scale }
}

/// The number of a message, which is kept where it is new.
fn number_of(messages: &mut Vec<Message>, message: &Message) -> usize {
    let known = messages.iter().position(|known| known.id == message.id);
    known.unwrap_or_else(|| {
        messages.push(message.clone());
        messages.len() - 1
    })
}
