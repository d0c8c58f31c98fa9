//! The faults: what each does to a frame or to the bus.

use crate::bus::WireFrame;
use crate::draw::Draw;
use can_protocol::{
    Command, Fault as FaultFrame, FaultCode, Frame, Measurement, MeasurementFlags, Mode, Node,
    Pressure, Profile, RunState, Seal, Sender, Telemetry, Trips,
};
use std::collections::VecDeque;

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
    /// Measurements arrive so many cycles late.
    Delay(usize),
    /// Every measurement comes twice.
    Duplicate,
    /// A measurement of ten cycles ago comes before the new one, every tenth cycle.
    OldFrame,
    /// One bit of every so many measurements is flipped.
    FlipBit(u64),
    /// All bits of the payload are random in every so many measurements.
    Garbage(u64),
    /// The counter stands still, the data go on.
    StuckCounter,
    /// The force sensor repeats one value (N).
    StuckForce(f64),
    /// The displacement sensor repeats one value (m).
    StuckDisplacement(f64),
    /// The force is not valid.
    InvalidForce,
    /// The displacement is missing.
    InvalidDisplacement,
    /// The force has a factor.
    ScaleForce(f64),
    /// The force is this every other cycle (N).
    SpikeForce(f64),
    /// The displacement has an offset (m).
    OffsetDisplacement(f64),
    /// Somebody else sends measurements with the plain CRC of the DBC.
    PlainSender,
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
    /// The rig reports its emergency stop.
    EmergencyStop,
    /// The rig reports a fault.
    ReportFault,
    /// The rig says in a measurement that it is safe.
    SaysSafe,
    /// The rig reports that it has reached a limit, for ever.
    Flags,
}

/// What a fault remembers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Memory {
    queue: VecDeque<WireFrame>,
    draw: Draw,
    said: bool,
}

impl Memory {
    pub(super) fn new(draw: Draw) -> Self {
        Self { queue: VecDeque::new(), draw, said: false }
    }

    /// Forgets the fault before.
    pub(super) fn begin(&mut self) {
        self.queue.clear();
        self.said = false;
    }
}

impl Fault {
    /// Whether a command is lost, `since` cycles after the fault began.
    pub(super) const fn loses_command(self, since: u64) -> bool {
        match self {
            Self::LoseCommands { lost, of } => since % of < lost,
            _ => false,
        }
    }

    /// What becomes of a measurement; `seal` is its own.
    pub(super) fn change(
        self,
        since: u64,
        frame: WireFrame,
        seal: Seal,
        node: Node,
        memory: &mut Memory,
    ) -> Vec<WireFrame> {
        let lies = |change: &dyn Fn(&mut Measurement)| {
            let opened = Measurement::decode_sealed(frame.id(), frame.data(), seal);
            let Ok(mut measurement) = opened else { return vec![frame.clone()] };
            change(&mut measurement);
            vec![WireFrame::from(&measurement.encode_sealed(Profile::Classical, seal).0)]
        };
        match self {
            Self::LoseMeasurements { lost, of } if since % of < lost => Vec::new(),
            Self::Delay(cycles) => {
                memory.queue.push_back(frame);
                let is_due = memory.queue.len() > cycles;
                is_due.then(|| memory.queue.pop_front()).flatten().into_iter().collect()
            }
            Self::Duplicate => vec![frame.clone(), frame],
            Self::OldFrame => {
                memory.queue.push_back(frame.clone());
                let old = (memory.queue.len() > 10).then(|| memory.queue.pop_front()).flatten();
                let old = old.filter(|_| since.is_multiple_of(10));
                old.into_iter().chain([frame]).collect()
            }
            Self::FlipBit(every) if since.is_multiple_of(every) => {
                let bit = memory.draw.number() as usize % (8 * frame.data().len().max(1));
                vec![changed(&frame, |data| data[bit / 8] ^= 1 << (bit % 8))]
            }
            Self::Garbage(every) if since.is_multiple_of(every) => {
                let draw = &mut memory.draw;
                vec![changed(&frame, |data| {
                    for byte in data.iter_mut() {
                        *byte = draw.number() as u8;
                    }
                })]
            }
            Self::StuckCounter => {
                let first = memory.queue.front().cloned().unwrap_or_else(|| frame.clone());
                memory.queue.push_back(first.clone());
                vec![first]
            }
            Self::StuckForce(force_n) => lies(&|measured| measured.force_n = Some(force_n)),
            Self::StuckDisplacement(at_m) => lies(&|measured| measured.displacement_m = Some(at_m)),
            Self::InvalidForce => lies(&|measured| {
                measured.force_n = None;
                measured.flags |= MeasurementFlags::SENSOR_INVALID;
            }),
            Self::InvalidDisplacement => lies(&|measured| measured.displacement_m = None),
            Self::ScaleForce(factor) => lies(&|measured| {
                measured.force_n = measured.force_n.map(|force_n| factor * force_n);
            }),
            Self::SpikeForce(force_n) if since.is_multiple_of(2) => {
                lies(&|measured| measured.force_n = Some(force_n))
            }
            Self::OffsetDisplacement(by_m) => lies(&|measured| {
                measured.displacement_m = measured.displacement_m.map(|at_m| at_m + by_m);
            }),
            Self::SaysSafe => lies(&|measured| measured.state = RunState::Safe),
            Self::Flags => lies(&|measured| measured.flags |= MeasurementFlags::LIMIT_REACHED),
            Self::PlainSender => {
                let opened = Measurement::decode_sealed(frame.id(), frame.data(), seal);
                let plain = opened.map(|own| own.encode(Profile::Classical).0);
                let other = plain.ok().map(|plain| WireFrame::from(&plain));
                [frame].into_iter().chain(other).collect()
            }
            Self::EmergencyStop | Self::ReportFault if !memory.said => {
                memory.said = true;
                vec![frame, WireFrame::from(&self.report(node))]
            }
            _ => vec![frame],
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
    fn report(self, node: Node) -> Frame {
        if self == Self::EmergencyStop {
            let telemetry = Telemetry {
                node,
                counter: 3,
                state: RunState::Run,
                temperature_degc: None,
                pressure: Pressure::Ready,
                trips: Trips::EMERGENCY_STOP,
            };
            return telemetry.encode().0;
        }
        let fault = FaultFrame {
            sender: Sender::Rig(node),
            counter: 0,
            state: RunState::Run,
            code: FaultCode::PressureLost,
            detail: 0,
        };
        fault.encode().0
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

/// A frame with other bytes.
fn changed(frame: &WireFrame, change: impl FnOnce(&mut [u8])) -> WireFrame {
    let mut data = frame.data().to_vec();
    change(&mut data);
    WireFrame::new(frame.id(), false, &data).unwrap_or_else(|| frame.clone())
}
