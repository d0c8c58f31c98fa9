//! Tests in open loop on a rig: what a laboratory does before it couples anything.
//!
//! [`open_loop`] reads like [`run`](super::run): plan, open, meet, arm, follow and record. Record,
//! bus log and events are those of a run; the samples of each test are read back from the record.

use super::handshake::Epoch;
use super::measured_test::{MeasuredTest, Reading};
use super::recording::{self, Output, Task};
use super::sequence::{Origin, Sequence};
use super::setup::{arming, pace, sent_by};
use super::work::OpenLoop;
use super::{COLUMNS, EVENTS, FILES, InFolder, LOG, RECORD, clear_unbegun, meet, space};
use crate::BenchError;
use crate::bus::{AnyBus, Bus, BusChoice, BusCounters, MemoryBus, SocketCanBus};
use crate::control::{Arming, End, MOST_FORCE_N, Port, Requests, Session, StopSummary};
use crate::options::RunOptions;
use crate::record::{PART_CYCLES, Row, RowReader, column_reference};
use crate::rig::RigNode;
use can_protocol::{MessageId, Node, Profile};
use files::ResultFolder;
use firmware_core::command::Command;
use firmware_core::compensation::Compensator;
use firmware_core::line::{Fade, Line, RigSlot, Slot};
use firmware_core::supervision::{Checks, CommandLimits};
use firmware_core::track::Track;
use firmware_core::vehicle::{DAMPER_SLOTS, Vehicle, VehicleState};
use scenario::rig::RigSetup;
use scenario::run::{BeyondLimits, CYCLE_S, Rate, Readiness};
use std::ops::RangeInclusive;

/// The damper slot of the only rig.
const SLOT: usize = 0;

/// What is to be done in open loop.
#[derive(Debug, Clone)]
pub struct OpenLoopPlan<'a> {
    /// The rig on the memory bus.
    pub rig: &'a RigSetup,
    /// The node of the rig.
    pub node: Node,
    /// The tests, in order.
    pub tests: Vec<PlannedTest>,
    /// Limits of the commands.
    pub limits: CommandLimits,
    /// The largest force that is believed, and asked of the rig as a limit (N).
    pub force_n: f64,
    /// What is required of the rig.
    pub readiness: Readiness,
    /// Oil temperatures at which a test may begin (degrees Celsius).
    pub window_degc: Option<RangeInclusive<f64>>,
    /// What the displacements of the tests count from.
    pub origin: Origin,
    /// Whether the ram goes back to where it stood, or rests where the last test has left it.
    pub returns: bool,
    /// Whether a rig with tighter limits of motion is refused, and does not rule.
    pub needs_its_limits: bool,
}

/// A test before it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTest {
    /// Its name.
    pub name: String,
    /// Displacement and velocity of every cycle.
    pub commands: Vec<Command>,
}

/// What an open loop has given.
#[derive(Debug)]
pub struct OpenLoopRecord {
    /// The tests that were run to their end.
    pub tests: Vec<MeasuredTest>,
    /// How it ended.
    pub end: End,
    /// What stopped it.
    pub cause: Option<StopSummary>,
    /// Ticks of the clock that were skipped.
    pub skipped: u64,
    /// Commands that a limit has changed.
    pub limited: u64,
    /// What went over the bus.
    pub bus: BusCounters,
    /// Rows and frames that were not recorded.
    pub unrecorded: u64,
    /// Temperature that the rig has reported last (degrees Celsius).
    pub temperature_degc: Option<f64>,
    /// Where the ram was sent last (m).
    pub rests_at_m: f64,
}

/// The files that an open loop writes into its folder.
pub const OPEN_LOOP_FILES: [&str; 4] = [RECORD, LOG, EVENTS, COLUMNS];

/// Runs tests on a rig and records them into a folder, which is made once the rig has answered.
///
/// # Errors
/// A bus that is refused; a rig that does not answer or is not armed, or whose limits are tighter
/// than the tests; a disk that fails.
pub fn open_loop(
    plan: &OpenLoopPlan<'_>,
    options: &RunOptions,
    folder: &mut ResultFolder,
    requests: &Requests,
) -> Result<OpenLoopRecord, BenchError> {
    debug_assert!(FILES.iter().filter(|name| OPEN_LOOP_FILES.contains(name)).count() == 4);
    let mut sequence = Sequence::new(
        SLOT,
        plan.tests.iter().map(|test| test.commands.clone()).collect(),
        plan.window_degc.clone(),
    )
    .counting_from(plan.origin)
    .returning(plan.returns);
    let cycles = sequence.expected_cycles();
    space::check(folder.path(), folder.free_bytes(), cycles * Row::size() as u64 * 2, cycles)?;
    let mut buses = vec![open_bus(plan, options)?];
    let (vehicle, track) = (Vehicle::of_one_damper(), Track::default());
    let mut pace = pace(Rate::Usual, options);
    let session = Session {
        line: line(plan, &vehicle, &track),
        ports: [port(plan, options.profile)?].into_iter().collect(),
        profile: options.profile,
        pace: pace.on_the_wire(),
        slow_down: options.slow_down,
        arming: Arming {
            needs_what_it_asks: plan.needs_its_limits,
            ..arming(std::slice::from_ref(&options.bus), Rate::Usual, options)?
                .requiring(&plan.readiness)
        },
        watched: [None; 3],
        rear_bogie: None,
        delay_gate: None,
    };
    let mut state = session.start(session.line.start(VehicleState::default()));
    let epoch = Epoch::now();
    let handshake = meet(&session, &mut state, &mut buses, &options.bus, epoch, requests)?;
    let is_new = !folder.path().exists();
    folder.create()?;
    folder.write(COLUMNS, &column_reference())?;
    folder.settle()?;
    let output = Output {
        place: InFolder(folder),
        part_cycles: PART_CYCLES,
        lost_cycles_max: Some(1000),
        bus_names: vec![options.bus.interface().to_owned()],
        epoch,
        handshake,
        feed: None,
    };
    let task = Task {
        session: &session,
        work: OpenLoop(&mut sequence),
        state: &mut state,
        buses: &mut buses,
        bus: &options.bus,
        pace: &mut pace,
        cycles,
    };
    let recorded = recording::record(task, &options.realtime, output, requests);
    let recording = recorded.inspect_err(|why| clear_unbegun(folder, is_new, why))?;
    if let Some(failure) = recording.failure {
        return Err(failure);
    }
    let tests = measured(plan, sequence.cycles(), folder)?;
    Ok(OpenLoopRecord {
        tests,
        end: recording.end,
        cause: state.stop.map(|stop| stop.summary()),
        skipped: state.skipped,
        limited: state.line.slots[SLOT].limited,
        temperature_degc: state.ports.first().and_then(|port| port.temperature_degc),
        rests_at_m: state.line.slots[SLOT].command.displacement_m,
        bus: buses[0].counters(),
        unrecorded: recording.dropped,
    })
}

/// The line of a rig that is not coupled.
#[expect(clippy::large_stack_arrays, reason = "made once, before the loop")]
fn line<'a>(plan: &OpenLoopPlan<'_>, vehicle: &'a Vehicle, track: &'a Track<'a>) -> Line<'a> {
    let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
    // The model acts in no cycle: nothing is coupled.
    let model = plan.rig.damper.clone();
    slots[SLOT] = Slot::Rig(RigSlot {
        model,
        wear: None,
        compensator: Compensator::None,
        limits: plan.limits,
    });
    Line {
        vehicle,
        track,
        contact: None,
        speed_m_per_s: 1.0,
        cycle_s: CYCLE_S,
        substeps: 1,
        slots,
        // An end is orderly: the ram comes to rest.
        fade: Fade { motion_cycles: 1, ..Fade::default() },
    }
}

/// The host's end of the rig, with the usual checks.
fn port(plan: &OpenLoopPlan<'_>, profile: Profile) -> Result<Port, can_protocol::Error> {
    let force_n = plan.force_n.min(MOST_FORCE_N);
    let checks = Checks::usual(profile.counter_modulus(), CYCLE_S, force_n);
    Ok(Port::new(plan.node, 0, SLOT, profile)?.checked(checks, BeyondLimits::Saturate))
}

fn open_bus(plan: &OpenLoopPlan<'_>, options: &RunOptions) -> Result<AnyBus, BenchError> {
    Ok(match &options.bus {
        BusChoice::Memory => {
            let rig = RigNode::new(plan.rig, plan.node, options.profile);
            AnyBus::Memory(MemoryBus::new(std::iter::once(rig)))
        }
        BusChoice::SocketCan(name) => {
            let of_hosts = MessageId::all().filter(|message| message.is_of_host());
            let of_rig = sent_by(plan.node, options.profile).into_iter();
            let accept: Vec<_> = of_rig.chain(of_hosts).collect();
            AnyBus::SocketCan(SocketCanBus::open(name, &accept, options.profile)?)
        }
    })
}

/// The samples of every test that was run, from the record.
fn measured(
    plan: &OpenLoopPlan<'_>,
    cycles: &[Option<(u64, u64)>],
    folder: &ResultFolder,
) -> Result<Vec<MeasuredTest>, BenchError> {
    let file = folder.file(RECORD);
    let mut rows = RowReader::open(&file)?;
    let failed = |why| BenchError::File { file: file.clone(), why };
    let mut row = rows.next().map_err(failed)?;
    let mut tests = Vec::new();
    for (test, cycles) in plan.tests.iter().zip(cycles) {
        let Some((first, last)) = *cycles else { continue };
        let mut found = Reading::new(&test.name, SLOT);
        while let Some(next) = row.filter(|row| row.cycle <= last) {
            if next.cycle >= first {
                found.take(&next, first);
            }
            row = rows.next().map_err(failed)?;
        }
        tests.push(found.test());
    }
    Ok(tests)
}
