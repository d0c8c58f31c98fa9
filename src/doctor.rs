//! `yawbench doctor`: what holds a run back on this machine and this bus, and how to change it.

use crate::bench_options::BitRate;
use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::print;
use can_protocol::Profile;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::doctor::{
    BitRates, BusFacts, BusMessage, Check, Machine, Process, ResponseTimes, Wanted,
    asks_for_a_change, judge_bus, judge_machine, lines, messages_of_dbc, messages_of_protocol,
    response_times,
};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct DoctorArgs {
    /// Look at this interface too: socketcan:INTERFACE.
    #[arg(long)]
    bus: Option<BusChoice>,
    /// Bit rate that the bus is to have (bit/s), such as 500k or 1M.
    #[arg(long, value_name = "BITS", default_value = "1M")]
    bitrate: BitRate,
    /// Data bit rate of a bus with FD frames (bit/s), such as 2M or 5M; without it the bus is
    /// classical.
    #[arg(long, value_name = "BITS")]
    data_bitrate: Option<BitRate>,
    /// Judge the response times of the messages of this DBC instead of those of the protocol.
    #[arg(long, value_name = "FILE")]
    dbc: Option<PathBuf>,
    /// Rigs on the bus, for the response times of the protocol.
    #[arg(long, value_name = "1..4", default_value_t = 1, conflicts_with = "dbc",
        value_parser = clap::value_parser!(u8).range(1..=4))]
    rigs: u8,
    /// Print the answer as JSON.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints; the schema is `docs/schema/doctor.schema.json`.
#[derive(Debug, Serialize)]
struct Answer {
    format: u32,
    /// Whether there is something to change.
    change: bool,
    machine: Vec<Check>,
    bus: Option<Interface>,
    response_times: ResponseTimes,
}

#[derive(Debug, Serialize)]
struct Interface {
    interface: String,
    checks: Vec<Check>,
}

/// Runs the command.
///
/// # Errors
/// Options that do not go together; a DBC that cannot be read.
pub(crate) fn command(args: &DoctorArgs) -> Result<ExitCode, CommandError> {
    let interface = match &args.bus {
        None => None,
        Some(BusChoice::SocketCan(name)) => Some(name),
        Some(BusChoice::Memory) => {
            return Err(CommandError::option(
                "--bus memory",
                "socketcan:INTERFACE; without --bus only the machine is looked at",
            ));
        }
    };
    let messages = messages(args)?;
    let rates = BitRates {
        nominal_bits_per_s: args.bitrate.0,
        data_bits_per_s: args.data_bitrate.unwrap_or(args.bitrate).0,
    };
    let wanted = Wanted {
        bits_per_s: args.bitrate.0,
        data_bits_per_s: args.data_bitrate.map(|data_bitrate| data_bitrate.0),
    };
    let machine = judge_machine(&Machine::read(Path::new("/"), Process::this()));
    let bus = interface.map(|name| Interface {
        interface: name.clone(),
        checks: judge_bus(&BusFacts::read(name), &wanted),
    });
    let response_times = response_times(&messages, &rates);
    let checks = bus.iter().flat_map(|bus| &bus.checks).chain(&machine);
    let change =
        asks_for_a_change(&checks.cloned().collect::<Vec<_>>()) || response_times.is_late();
    let answer = Answer { format: 1, change, machine, bus, response_times };
    if args.json {
        print(&serde_json::to_string_pretty(&answer)?)?;
    } else {
        print(&text(args, &answer).join("\n"))?;
    }
    Ok(if answer.change { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

/// The messages whose response times are asked for.
fn messages(args: &DoctorArgs) -> Result<Vec<BusMessage>, CommandError> {
    let Some(dbc) = &args.dbc else {
        let is_fd = args.data_bitrate.is_some();
        let profile = if is_fd { Profile::Fd } else { Profile::Classical };
        return Ok(messages_of_protocol(profile, args.rigs));
    };
    let messages = messages_of_dbc(dbc)?;
    match messages.iter().find(|message| message.switches_rate) {
        Some(message) if args.data_bitrate.is_none() => {
            let expected = format!("one, such as 5M: {} is an FD frame", message.name);
            Err(CommandError::option("no --data-bitrate", expected))
        }
        _ => Ok(messages),
    }
}

/// The text for a terminal.
fn text(args: &DoctorArgs, answer: &Answer) -> Vec<String> {
    let mut text = lines("Machine", &answer.machine);
    if let Some(bus) = &answer.bus {
        text.push(String::new());
        text.extend(lines(&format!("Bus {}", files::quoted(&bus.interface)), &bus.checks));
    }
    let of = match &args.dbc {
        Some(dbc) => files::quoted(&dbc.display().to_string()).to_string(),
        None => format!("the protocol with {} rig(s)", args.rigs),
    };
    let rates = match args.data_bitrate {
        Some(data) => format!("{}/{} kbit/s", args.bitrate.0 / 1e3, data.0 / 1e3),
        None => format!("{} kbit/s", args.bitrate.0 / 1e3),
    };
    text.push(String::new());
    text.extend(answer.response_times.lines(&format!("Messages of {of} at {rates}")));
    text.push(String::new());
    text.push(if answer.change { "There is something to change." } else { "Ready." }.to_owned());
    text
}
