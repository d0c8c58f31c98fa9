//! The line that is said of each error.

use super::BenchError;
use can_protocol::arming::Refusal;
use can_protocol::{ArmItem, PROTOCOL_VERSION};
use files::quoted;
use std::fmt;
use std::path::Path;

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scenario(why) => why.fmt(f),
            Self::SlotBus { place, why } => write!(f, "slot \"{}\": bus: {why}", quoted(place)),
            Self::Protocol(why) => why.fmt(f),
            Self::NoRig { title } => {
                write!(f, "{}: found no slot on a rig, expected on = \"rig\"", quoted(title))
            }
            Self::Damper(why) => write!(f, "the damper on the rig: {why}"),
            Self::Budget { rate_hz, why } => {
                write!(f, "the loop at {rate_hz} Hz has ended before all was measured: {why}")
            }
            Self::ClassicalRate { found_hz } => write!(
                f,
                "--profile: found classical at {found_hz} Hz, expected fd: classical CAN is the \
                 profile of 1 kHz"
            ),
            Self::FastOnBus { bus } => write!(
                f,
                "--pace: found pace fast on {}, expected lockstep or realtime: pace fast runs on \
                 the memory bus only",
                quoted(bus)
            ),
            Self::OtherHost { bus, id } => write!(
                f,
                "{}: found the frame {id:03X} of another host, expected a bus without one: a run \
                 goes on there, and a second host would end it",
                quoted(bus)
            ),
            Self::Unstable { bus, place, found, margin } => {
                unstable(f, [bus, place, found], *margin)
            }
            Self::MeasuredDelay { place, found } => not_compensated(f, place, found),
            Self::OtherRams { found, frequency_hz } => other_rams(f, found, *frequency_hz),
            Self::BusLoad { bus, load } => write!(
                f,
                "bus {}: found a load of {:.0} %, expected at most 80 %: use --profile fd, or \
                 several buses",
                quoted(bus),
                load * 100.0
            ),
            Self::Space { folder, free, needed, cycles } => {
                no_space(f, folder, [*free, *needed], *cycles)
            }
            Self::Bus(why) => why.fmt(f),
            Self::Dbc(why) => why.fmt(f),
            Self::Gateway(why) => why.fmt(f),
            Self::SilentRigs { nodes, bus } => {
                let nodes: Vec<String> = nodes.iter().map(u8::to_string).collect();
                write!(
                    f,
                    "no answer from rig node {} on {} within 10 s; is `yawbench rig` running \
                     there?",
                    nodes.join(", "),
                    quoted(bus)
                )
            }
            Self::BlindRigs { nodes, bus } => {
                let nodes: Vec<String> = nodes.iter().map(u8::to_string).collect();
                write!(
                    f,
                    "rig node {} on {} gives no displacement: its ram cannot be coupled",
                    nodes.join(", "),
                    quoted(bus)
                )
            }
            Self::FarRam { node, bus, ram_m } => far_ram(f, *node, bus, *ram_m),
            Self::NoRoom { node, bus, ram_m, reach_m, stroke_m } => {
                no_room(f, *node, bus, [*ram_m, *reach_m, *stroke_m])
            }
            Self::ForeignVersion { .. }
            | Self::RefusedSync { .. }
            | Self::LatchedRig { .. }
            | Self::CommandedRig { .. }
            | Self::UnarmedRig { .. }
            | Self::UnresetRig { .. } => self.fmt_of_rig(f),
            Self::NoRandom { why } => {
                write!(f, "the system gives no random numbers for the session: {why}")
            }
            Self::Interrupted => f.write_str("interrupted before the first cycle"),
            Self::RealtimeRefused => f.write_str("--require-realtime: not everything was granted"),
            Self::Folder(why) => why.fmt(f),
            Self::File { file, why } => {
                write!(f, "{}: {why}", quoted(&file.display().to_string()))
            }
            Self::Unrecorded { file, why, dropped } => write!(
                f,
                "{}: {why}: the run was ended because it could no longer be recorded; {dropped} \
                 rows and frames are lost",
                quoted(&file.display().to_string())
            ),
            Self::Input(why) => why.fmt(f),
            Self::Kept { file, found, expected } => unexpected(f, file, [found, expected]),
            Self::Incomparable { run, found, expected } => unexpected(f, run, [found, expected]),
            Self::Report(why) => write!(f, "report.html: {why}"),
            Self::Summary(why) => write!(f, "summary.json: {why}"),
            Self::Thread { name } => write!(f, "the thread that {name} failed"),
        }
    }
}

impl BenchError {
    /// What is said of a rig that does not take part.
    fn fmt_of_rig(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ForeignVersion { node, bus, version } => {
                write!(f, "rig node {node} on {}: found ", quoted(bus))?;
                match version {
                    Some(version) => write!(f, "protocol version {version}")?,
                    None => f.write_str("a heartbeat of another protocol version")?,
                }
                write!(f, ", expected protocol version {PROTOCOL_VERSION}")
            }
            Self::RefusedSync { node, bus, session } => write!(
                f,
                "rig node {node} on {} refuses the session (CONFIGURATION_MISMATCH), expected one \
                 that it can follow; found {session}",
                quoted(bus)
            ),
            Self::LatchedRig { node, bus, state } => write!(
                f,
                "rig node {node} on {} is latched in {state}: reset it by the key at the rig, or by \
                 `yawbench rig-reset --bus {} --node {node}`",
                quoted(bus),
                quoted(bus)
            ),
            Self::CommandedRig { node, bus, state } => write!(
                f,
                "rig node {node} on {} is not armed: it is in {state}, so another host commands it: \
                 end that session, and start again when the rig is in STANDBY",
                quoted(bus)
            ),
            Self::UnarmedRig { node, bus, refusal } => {
                write!(f, "rig node {node} on {} is not armed: {refusal}", quoted(bus))?;
                match refusal {
                    Refusal::ByRig(ArmItem::State) => write!(
                        f,
                        "; one that is latched is reset by the key at the rig, or by `yawbench \
                         rig-reset --bus {} --node {node}`",
                        quoted(bus)
                    ),
                    _ => Ok(()),
                }
            }
            Self::UnresetRig { node, bus, refusal } => {
                write!(f, "rig node {node} on {} is not reset: {refusal}", quoted(bus))?;
                match refusal {
                    Refusal::ByRig(ArmItem::State) => {
                        f.write_str("; only a rig in SAFE or FAULT is reset")
                    }
                    Refusal::ByRig(ArmItem::Reset) => {
                        f.write_str("; its ram still moves, or it is reset by its key alone")
                    }
                    _ => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }
}

/// Where a ram stands (m) that is too far away.
fn far_ram(f: &mut fmt::Formatter<'_>, node: u8, bus: &str, ram_m: f64) -> fmt::Result {
    write!(
        f,
        "the ram of rig node {node} on {} stands at {:.1} mm, too far from the vehicle for the \
         limits in [motion]: centre it first",
        quoted(bus),
        ram_m * 1e3
    )
}

/// Where a ram stands, where it would be sent, and the agreed stroke (m).
fn no_room(f: &mut fmt::Formatter<'_>, node: u8, bus: &str, places_m: [f64; 3]) -> fmt::Result {
    let [ram_mm, reach_mm, stroke_mm] = places_m.map(|place_m| 1e3 * place_m);
    write!(
        f,
        "the ram of rig node {node} on {} stands at {ram_mm:.2} mm and would be sent to \
         {reach_mm:.2} mm from mid-stroke, beyond the agreed stroke of {stroke_mm:.2} mm: jog it \
         first",
        quoted(bus)
    )
}

/// A file or folder that holds something else than was expected.
fn unexpected(
    f: &mut fmt::Formatter<'_>,
    place: &Path,
    [found, expected]: [&str; 2],
) -> fmt::Result {
    let place = place.display().to_string();
    write!(f, "{}: found {found}, expected {expected}", quoted(&place))
}

/// A disk without room for a run.
fn no_space(
    f: &mut fmt::Formatter<'_>,
    folder: &Path,
    [free, needed]: [u64; 2],
    cycles: u64,
) -> fmt::Result {
    write!(
        f,
        "{}: found {} free on its disk, expected at least {} for {cycles} cycles: shorten the run \
         or free space",
        quoted(&folder.display().to_string()),
        bytes(free),
        bytes(needed)
    )
}

/// A size on a disk, as tools show it.
fn bytes(count: u64) -> String {
    let count = count as f64;
    if count < 1e9 { format!("{:.1} MB", count * 1e-6) } else { format!("{:.1} GB", count * 1e-9) }
}

fn not_compensated(f: &mut fmt::Formatter<'_>, place: &str, found: &str) -> fmt::Result {
    write!(
        f,
        "{place}: found {found}, expected at most 5 %: set delay_s of its compensation, or \
         accept_delay_error = true"
    )
}

fn other_rams(f: &mut fmt::Formatter<'_>, found: &str, frequency_hz: f64) -> fmt::Result {
    write!(
        f,
        "--measured: found delays of {found}, expected one of a rig of this run at about \
         {frequency_hz:.1} Hz"
    )
}

fn unstable(
    f: &mut fmt::Formatter<'_>,
    [bus, place, found]: [&str; 3],
    margin: f64,
) -> fmt::Result {
    write!(
        f,
        "{place} on {}: found {found}, expected a gain margin of {margin:.0} at every delay: \
         compensate less, or use a faster rig",
        quoted(bus)
    )
}
