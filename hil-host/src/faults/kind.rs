//! The faults: what each is, and what it does to commands, to the rig and to the bus.

use crate::bus::WireFrame;
use crate::draw::Draw;
use can_protocol::{
    Command, Fault as FaultFrame, FaultCode, Frame, Heartbeat, MeasurementFlags, Mode, Node,
    Pressure, Profile, RunState, Sender, Telemetry, Trips,
};

/// A fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Measurements are lost: the first so many of every period.
    LoseMeasurements {
        /// How many.
        lost: u64,
        /// Of so many; `u64::MAX`: once.
        of: u64,
    },
    /// Commands are lost in the same way.
    LoseCommands {
        /// How many.
        lost: u64,
        /// Of so many.
        of: u64,
    },
    /// Frames are lost at random, each by itself.
    LoseAtRandom {
        /// Share of the measurements.
        measurements: f64,
        /// Share of the commands.
        commands: f64,
    },
    /// Measurements arrive so many cycles late.
    Delay(usize),
    /// Measurements arrive one cycle later after every so many cycles.
    Creep(u64),
    /// Every measurement arrives at random in its cycle or in the next.
    Jitter,
    /// Every measurement comes twice.
    Duplicate,
    /// Nothing comes but copies of one measurement.
    OnlyDuplicates,
    /// Every two measurements arrive together, in the wrong order.
    SwapPairs,
    /// A measurement that is so many cycles old comes before the new one, once in a period.
    OldFrame {
        /// Its age in cycles.
        age: usize,
        /// The period in cycles.
        every: u64,
    },
    /// Bits of one of every so many measurements are flipped.
    FlipBits {
        /// How many.
        bits: u32,
        /// Of so many measurements, one.
        every: u64,
    },
    /// All bits of the payload are random in every so many measurements.
    Garbage(u64),
    /// A frame with a random payload comes with every measurement.
    GarbageBeside,
    /// The counter stands still, the data go on.
    StuckCounter,
    /// The force sensor repeats one value (N).
    StuckForce(f64),
    /// The displacement sensor repeats one value (m).
    StuckDisplacement(f64),
    /// Both sensors repeat their values.
    StuckSensors,
    /// The force is not valid.
    InvalidForce,
    /// The displacement is missing.
    InvalidDisplacement,
    /// The force has a factor.
    ScaleForce(f64),
    /// The force has an offset (N).
    OffsetForce(f64),
    /// The force has an offset that grows (N per cycle).
    DriftForce(f64),
    /// The force is this every other cycle (N).
    SpikeForce(f64),
    /// The displacement has a factor.
    ScaleDisplacement(f64),
    /// The displacement has an offset (m).
    OffsetDisplacement(f64),
    /// The displacement has an offset that grows (m per cycle).
    DriftDisplacement(f64),
    /// Somebody else sends measurements with the plain CRC of the DBC.
    PlainSender,
    /// Somebody else knows the session and sends the next measurement too early, with this force
    /// (N).
    SenderAhead(f64),
    /// Another rig sends its measurements under the id of this one.
    OtherRig,
    /// Somebody else commands the rig with the plain CRC of the DBC.
    PlainCommander,
    /// Sixty frames of others in every cycle.
    Flood,
    /// The bus has no room in the first so many cycles of every period.
    NoRoom {
        /// How many.
        full: u64,
        /// Of so many; `u64::MAX`: once.
        of: u64,
    },
    /// The bus goes down.
    Down,
    /// The rig starts anew.
    Reboot,
    /// The rig is gone.
    Gone,
    /// The host misses so many slots, in which the rig goes on.
    SkipSlots(u32),
    /// The rig reports a guard or a limit in its telemetry.
    Trips(Trips),
    /// The rig reports a fault.
    ReportFault,
    /// The rig reports a state in its heartbeat.
    Heartbeat(RunState),
    /// The rig says in a measurement that it is in a state.
    Says(RunState),
    /// The rig reports flags in its measurements.
    Flags(MeasurementFlags),
}

impl Fault {
    /// Whether a command is lost, `since` cycles after the fault began.
    pub(super) fn loses_command(self, since: u64, draw: &mut Draw) -> bool {
        match self {
            Self::LoseCommands { lost, of } => since % of < lost,
            Self::LoseAtRandom { commands, .. } => chance(draw, commands),
            _ => false,
        }
    }

    /// What somebody else sends in a cycle, towards the rig.
    pub(super) fn foreign_command(self, node: Node, since: u64) -> Option<WireFrame> {
        let counter = (since % 15) as u8;
        let command = Command {
            node,
            counter,
            state: RunState::Run,
            mode: Mode::FollowWithVelocity,
            echo: Some(counter),
            displacement_m: Some(3.46e-3),
            velocity_m_per_s: Some(0.0),
            time_us: None,
        };
        let plain = || WireFrame::from(&command.encode(Profile::Classical).0);
        (self == Self::PlainCommander).then(plain)
    }

    /// A frame with which a rig reports trouble.
    pub(super) fn report(self, node: Node) -> Option<Frame> {
        let (counter, state, sender) = (3, RunState::Run, Sender::Rig(node));
        match self {
            Self::Trips(trips) => {
                let (temperature_degc, pressure) = (None, Pressure::Ready);
                let telemetry =
                    Telemetry { node, counter, state, temperature_degc, pressure, trips };
                Some(telemetry.encode().0)
            }
            Self::ReportFault => {
                let code = FaultCode::PressureLost;
                let fault = FaultFrame { sender, counter, state, code, detail: 0 };
                Some(fault.encode().0)
            }
            Self::Heartbeat(state) => Some(Heartbeat::new(sender, counter, state, 0).encode().0),
            _ => None,
        }
    }

    /// Frames of others on the bus in a cycle.
    pub(super) fn flood(self) -> Vec<WireFrame> {
        if self != Self::Flood {
            return Vec::new();
        }
        let ids = [0x001, 0x020, 0x7AA];
        let frames = ids.into_iter().cycle().take(60);
        frames.filter_map(|id| WireFrame::new(id, false, &[0xA5; 8])).collect()
    }
}

/// Whether something of a probability happens.
pub(super) fn chance(draw: &mut Draw, probability: f64) -> bool {
    f64::from(draw.number()) < probability * 2.0_f64.powi(32)
}
