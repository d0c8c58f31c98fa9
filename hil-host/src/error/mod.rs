//! What can go wrong around a run: input, bus, disk, rigs.
//!
//! Inside the loop nothing is an error. A force that is missing or a rig that falls silent is an
//! input state, and the guard acts on it.

mod from;
mod message;

use crate::bus::{BusError, InvalidBus};
use crate::gateway::GatewayError;
use can_protocol::arming::Refusal;
use can_protocol::{RunState, Sync};
use dbc::DbcError;
use files::{FolderError, InputError};
use firmware_core::damper::DamperError;
use scenario::source::ScenarioError;
use std::io;
use std::path::PathBuf;

/// Why the bench did not run, or a run has no complete result.
#[derive(Debug)]
pub enum BenchError {
    /// The scenario does not fit: file, line, key, found, expected.
    Scenario(ScenarioError),
    /// The bus of a slot in the scenario.
    SlotBus {
        /// The slot's place on the vehicle.
        place: String,
        /// What it names.
        why: InvalidBus,
    },
    /// Something that the protocol does not know, such as a node beyond 4.
    Protocol(can_protocol::Error),
    /// A scenario without a rig where one is needed.
    NoRig {
        /// Its title.
        title: String,
    },
    /// A damper that takes no wear in software.
    Damper(DamperError),
    /// A measurement of the budget that a limit has ended.
    Budget {
        /// The rate (Hz).
        rate_hz: u32,
        /// What has ended it.
        why: String,
    },
    /// Classical frames in a loop that is faster than they are made for.
    ClassicalRate {
        /// The rate (Hz).
        found_hz: u32,
    },
    /// Pace fast with a rig on a real bus.
    FastOnBus {
        /// The bus.
        bus: String,
    },
    /// A host on the bus that was to be measured.
    OtherHost {
        /// The bus.
        bus: String,
        /// Id of a frame that only a host sends.
        id: u16,
    },
    /// More rigs than a bus can carry.
    BusLoad {
        /// The bus.
        bus: String,
        /// Its worst-case load, from 0 to 1.
        load: f64,
    },
    /// A rig whose loop lacks the gain margin at a delay that it may have.
    Unstable {
        /// The bus.
        bus: String,
        /// The slot.
        place: String,
        /// What was found.
        found: String,
        /// The least gain margin.
        margin: f64,
    },
    /// A rig whose measured delay is not compensated.
    MeasuredDelay {
        /// The slot.
        place: String,
        /// What was found.
        found: String,
    },
    /// The delays that were measured before are those of other rigs, or of other motions.
    OtherRams {
        /// What was measured.
        found: String,
        /// That of hunting (Hz).
        frequency_hz: f64,
    },
    /// A disk without room for the run.
    Space {
        /// The result folder.
        folder: PathBuf,
        /// Bytes that are free.
        free: u64,
        /// Bytes that the run needs.
        needed: u64,
        /// Control cycles of the run.
        cycles: u64,
    },
    /// A bus that cannot be opened.
    Bus(BusError),
    /// A message database that cannot be used.
    Dbc(Box<DbcError>),
    /// A rig that cannot be driven by its own messages.
    Gateway(Box<GatewayError>),
    /// Rigs that did not answer before the run.
    SilentRigs {
        /// Their nodes.
        nodes: Vec<u8>,
        /// The bus as it was given.
        bus: String,
    },
    /// Rigs that gave no displacement before the run.
    BlindRigs {
        /// Their nodes.
        nodes: Vec<u8>,
        /// The bus as it was given.
        bus: String,
    },
    /// A rig that speaks another version of the protocol.
    ForeignVersion {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// Its version; none where its heartbeat cannot be read.
        version: Option<u8>,
    },
    /// A rig that refuses the announced session.
    RefusedSync {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// The session that it cannot follow.
        session: Sync,
    },
    /// A rig that is latched in SAFE or FAULT.
    LatchedRig {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// Its state.
        state: RunState,
    },
    /// A rig that another host commands.
    CommandedRig {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// Its state.
        state: RunState,
    },
    /// A rig that was not armed.
    UnarmedRig {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// What stood against it.
        refusal: Refusal,
    },
    /// A rig that was not reset.
    UnresetRig {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// What stood against it.
        refusal: Refusal,
    },
    /// The operating system has no random numbers for a session on a real bus.
    NoRandom {
        /// The system's message.
        why: io::Error,
    },
    /// A ram that stands too far from where the vehicle needs it.
    FarRam {
        /// Its node.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// Where it stands (m).
        ram_m: f64,
    },
    /// A motion in open loop leads beyond the agreed stroke.
    NoRoom {
        /// The node of the rig.
        node: u8,
        /// The bus as it was given.
        bus: String,
        /// Where its ram stands (m).
        ram_m: f64,
        /// The farthest from mid-stroke that the motion leads (m).
        reach_m: f64,
        /// The agreed stroke (m).
        stroke_m: f64,
    },
    /// Ctrl-C before the first cycle.
    Interrupted,
    /// `--require-realtime`, and the system refused a part of it.
    RealtimeRefused,
    /// The result folder.
    Folder(FolderError),
    /// A file that can no longer be written.
    File {
        /// The file.
        file: PathBuf,
        /// The system's message.
        why: io::Error,
    },
    /// The disk took nothing for too long, and the run was ended.
    Unrecorded {
        /// The file.
        file: PathBuf,
        /// The system's message.
        why: io::Error,
        /// Rows and frames that are lost.
        dropped: u64,
    },
    /// A file of a run that is not read.
    Input(InputError),
    /// A file of a run that holds something else.
    Kept {
        /// The file.
        file: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// A run that cannot be set beside others.
    Incomparable {
        /// Its folder.
        run: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The report's parts do not fit each other.
    Report(report::Error),
    /// The summary cannot be written as JSON.
    Summary(serde_json::Error),
    /// A thread of the bench ended by a panic.
    Thread {
        /// What the thread does.
        name: &'static str,
    },
}

impl BenchError {
    /// Whether the user's input is at fault and nothing was written: exit code 2.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Scenario(_)
            | Self::SlotBus { .. }
            | Self::Protocol(_)
            | Self::NoRig { .. }
            | Self::Damper(_)
            | Self::ClassicalRate { .. }
            | Self::FastOnBus { .. }
            | Self::OtherHost { .. }
            | Self::BusLoad { .. }
            | Self::Unstable { .. }
            | Self::MeasuredDelay { .. }
            | Self::OtherRams { .. }
            | Self::Space { .. }
            | Self::Kept { .. }
            | Self::Incomparable { .. }
            | Self::RealtimeRefused => true,
            // The disk is sound: the content is not.
            Self::File { why, .. } => why.kind() == std::io::ErrorKind::InvalidData,
            Self::Bus(why) => why.is_bad_input(),
            Self::Dbc(why) => why.is_bad_input(),
            Self::Gateway(why) => why.is_bad_input(),
            Self::Input(why) => why.is_bad_input(),
            Self::Folder(why) => !matches!(why, FolderError::Disk(..)),
            Self::Budget { .. }
            | Self::SilentRigs { .. }
            | Self::BlindRigs { .. }
            | Self::ForeignVersion { .. }
            | Self::RefusedSync { .. }
            | Self::LatchedRig { .. }
            | Self::CommandedRig { .. }
            | Self::UnarmedRig { .. }
            | Self::UnresetRig { .. }
            | Self::NoRandom { .. }
            | Self::FarRam { .. }
            | Self::NoRoom { .. }
            | Self::Interrupted
            | Self::Unrecorded { .. }
            | Self::Report(_)
            | Self::Summary(_)
            | Self::Thread { .. } => false,
        }
    }

    /// Whether the bench stays in its safe state because of a rig: exit code 3.
    pub const fn is_safe_state(&self) -> bool {
        matches!(
            self,
            Self::SilentRigs { .. }
                | Self::BlindRigs { .. }
                | Self::FarRam { .. }
                | Self::NoRoom { .. }
                | Self::ForeignVersion { .. }
                | Self::RefusedSync { .. }
                | Self::LatchedRig { .. }
                | Self::CommandedRig { .. }
                | Self::UnarmedRig { .. }
                | Self::UnresetRig { .. }
        )
    }

    /// Whether the user ended it: exit code 130.
    pub const fn is_interrupted(&self) -> bool {
        matches!(self, Self::Interrupted)
    }
}

// No source: the message holds that of the wrapped error already.
impl std::error::Error for BenchError {}

#[cfg(test)]
mod tests {
    use super::*;
    use can_protocol::ArmItem;

    #[test]
    fn every_kind_has_one_exit_code_and_one_line() {
        let disk = || io::Error::from(io::ErrorKind::StorageFull);
        let path = PathBuf::from("runs/a-1");
        let bus = || "socketcan:can\n0".to_owned();
        let safe = [false, true, false];
        let by_rig = Refusal::ByRig(ArmItem::State);
        // Bad input, safe state, interrupted, or none of them.
        let cases = [
            (
                BenchError::Protocol(can_protocol::Error::NodeRange { value: 9 }),
                [true, false, false],
            ),
            (BenchError::Budget { rate_hz: 4000, why: String::new() }, [false, false, false]),
            (BenchError::ClassicalRate { found_hz: 2000 }, [true, false, false]),
            (BenchError::FastOnBus { bus: bus() }, [true, false, false]),
            (BenchError::OtherHost { bus: bus(), id: 0x80 }, [true, false, false]),
            (BenchError::BusLoad { bus: bus(), load: 1.08 }, [true, false, false]),
            (
                BenchError::Unstable {
                    bus: bus(),
                    place: "front left".to_owned(),
                    found: "stable for delays up to 0.5 ms".to_owned(),
                    margin: 2.0,
                },
                [true, false, false],
            ),
            (
                BenchError::Space { folder: path.clone(), free: 1, needed: 2, cycles: 3 },
                [true, false, false],
            ),
            (
                BenchError::MeasuredDelay {
                    place: "front left".to_owned(),
                    found: "tracking.json: a ram that is 9 ms late".to_owned(),
                },
                [true, false, false],
            ),
            (
                BenchError::OtherRams { found: "node 3 at 0.4 Hz".to_owned(), frequency_hz: 3.4 },
                [true, false, false],
            ),
            (BenchError::Bus(BusError::NoCan), [true, false, false]),
            (
                BenchError::Bus(BusError::Refused { interface: bus(), error: disk() }),
                [false, false, false],
            ),
            (BenchError::RealtimeRefused, [true, false, false]),
            (BenchError::Folder(FolderError::Occupied(path.clone())), [true, false, false]),
            (BenchError::Folder(FolderError::Disk(path.clone(), disk())), [false, false, false]),
            (BenchError::File { file: path.clone(), why: disk() }, [false, false, false]),
            (BenchError::Unrecorded { file: path, why: disk(), dropped: 9 }, [false, false, false]),
            (BenchError::SilentRigs { nodes: vec![1, 3], bus: bus() }, [false, true, false]),
            (BenchError::BlindRigs { nodes: vec![2], bus: bus() }, [false, true, false]),
            (BenchError::FarRam { node: 1, bus: bus(), ram_m: 0.09 }, [false, true, false]),
            (
                BenchError::NoRoom {
                    node: 1,
                    bus: bus(),
                    ram_m: 0.09,
                    reach_m: 0.11,
                    stroke_m: 0.1,
                },
                safe,
            ),
            (BenchError::ForeignVersion { node: 1, bus: bus(), version: Some(1) }, safe),
            (BenchError::LatchedRig { node: 1, bus: bus(), state: RunState::Safe }, safe),
            (BenchError::CommandedRig { node: 1, bus: bus(), state: RunState::Run }, safe),
            (BenchError::UnarmedRig { node: 1, bus: bus(), refusal: by_rig }, safe),
            (BenchError::UnresetRig { node: 1, bus: bus(), refusal: by_rig }, safe),
            (BenchError::NoRandom { why: disk() }, [false, false, false]),
            (BenchError::Interrupted, [false, false, true]),
            (BenchError::Thread { name: "records the run" }, [false, false, false]),
        ];
        for (error, kind) in cases {
            let found = [error.is_bad_input(), error.is_safe_state(), error.is_interrupted()];
            assert_eq!(found, kind, "{error:?}");
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
        }
    }
}
