//! What a fault makes of the measurements of a rig.

use super::kind::{Fault, chance};
use crate::bus::WireFrame;
use crate::draw::Draw;
use can_protocol::{Measurement, MeasurementFlags, Node, Profile, Seal};
use std::collections::VecDeque;

/// What a fault remembers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Memory {
    queue: VecDeque<WireFrame>,
    first: Option<(WireFrame, Seal)>,
    pub(super) draw: Draw,
    said: bool,
}

impl Memory {
    pub(super) fn new(draw: Draw) -> Self {
        Self { queue: VecDeque::new(), first: None, draw, said: false }
    }

    /// Forgets the fault before.
    pub(super) fn begin(&mut self) {
        self.queue.clear();
        (self.first, self.said) = (None, false);
    }

    /// Lets frames wait, and gives those that have waited for so many cycles or longer.
    fn wait(&mut self, frame: WireFrame, cycles: usize) -> Vec<WireFrame> {
        self.queue.push_back(frame);
        let due = self.queue.len().saturating_sub(cycles);
        self.queue.drain(..due).collect()
    }
}

impl Fault {
    /// What becomes of a measurement, `since` cycles after the fault began; `seal` is its own.
    pub(super) fn change(
        self,
        since: u64,
        frame: WireFrame,
        seal: Seal,
        node: Node,
        memory: &mut Memory,
    ) -> Vec<WireFrame> {
        if let Some(changed) = self.changed_value(since, &frame, seal) {
            return vec![changed];
        }
        match self {
            Self::LoseMeasurements { lost, of } if since % of < lost => Vec::new(),
            Self::LoseAtRandom { measurements, .. } if chance(&mut memory.draw, measurements) => {
                Vec::new()
            }
            Self::Delay(cycles) => memory.wait(frame, cycles),
            Self::Creep(every) => memory.wait(frame, (since / every) as usize),
            Self::Jitter => {
                let late = usize::from(chance(&mut memory.draw, 0.5));
                memory.wait(frame, late)
            }
            Self::SwapPairs => {
                memory.queue.push_front(frame);
                if memory.queue.len() < 2 { Vec::new() } else { memory.queue.drain(..).collect() }
            }
            Self::Duplicate => vec![frame.clone(), frame],
            Self::OnlyDuplicates => {
                vec![memory.first.get_or_insert((frame, seal)).0.clone()]
            }
            Self::StuckCounter => {
                let (_, first) = *memory.first.get_or_insert((frame.clone(), seal));
                vec![edited(&frame, seal, first, |measured| {
                    measured.counter = first.counter(Profile::Classical);
                })]
            }
            Self::StuckSensors => {
                let (first, its) = memory.first.get_or_insert((frame.clone(), seal));
                let first = Measurement::decode_sealed(first.id(), first.data(), *its);
                vec![edited(&frame, seal, seal, |measured| {
                    if let Ok(first) = first {
                        measured.force_n = first.force_n;
                        measured.displacement_m = first.displacement_m;
                    }
                })]
            }
            Self::OldFrame { age, every } => {
                memory.queue.push_back(frame.clone());
                let old = (memory.queue.len() > age).then(|| memory.queue.pop_front()).flatten();
                let old = old.filter(|_| since % every == every - 1);
                old.into_iter().chain([frame]).collect()
            }
            Self::FlipBits { bits, every } if since.is_multiple_of(every) => {
                vec![flipped(&frame, bits, &mut memory.draw)]
            }
            Self::Garbage(every) if since.is_multiple_of(every) => {
                vec![garbage(&frame, &mut memory.draw)]
            }
            Self::GarbageBeside => {
                let other = garbage(&frame, &mut memory.draw);
                vec![frame, other]
            }
            Self::PlainSender => {
                let own = Measurement::decode_sealed(frame.id(), frame.data(), seal);
                let plain = own.map(|own| WireFrame::from(&own.encode(Profile::Classical).0));
                [frame].into_iter().chain(plain).collect()
            }
            Self::SenderAhead(force_n) => {
                let next = Seal { cycle: seal.cycle + 1, ..seal };
                let other = edited(&frame, seal, next, |measured| {
                    measured.counter = next.counter(Profile::Classical);
                    measured.force_n = Some(force_n);
                });
                vec![frame, other]
            }
            Self::OtherRig => {
                let other = Node::ALL.into_iter().find(|other| *other != node).unwrap_or(node);
                let sound = Measurement::decode_sealed(frame.id(), frame.data(), seal);
                let foreign = sound.ok().and_then(|sound| {
                    let theirs = Measurement { node: other, ..sound };
                    let (theirs, _) = theirs.encode_sealed(Profile::Classical, seal);
                    WireFrame::new(frame.id(), false, WireFrame::from(&theirs).data())
                });
                vec![foreign.unwrap_or(frame)]
            }
            Self::Trips(_) | Self::ReportFault | Self::Heartbeat(_) if !memory.said => {
                memory.said = true;
                let report = self.report(node).map(|report| WireFrame::from(&report));
                [frame].into_iter().chain(report).collect()
            }
            _ => vec![frame],
        }
    }

    /// A measurement with other content, where that is all that the fault does.
    fn changed_value(self, since: u64, frame: &WireFrame, seal: Seal) -> Option<WireFrame> {
        let cycles = since as f64;
        let force = |change: &dyn Fn(f64) -> f64| {
            edited(frame, seal, seal, |measured| measured.force_n = measured.force_n.map(change))
        };
        let displacement = |change: &dyn Fn(f64) -> f64| {
            edited(frame, seal, seal, |measured| {
                measured.displacement_m = measured.displacement_m.map(change);
            })
        };
        Some(match self {
            Self::StuckForce(force_n) => force(&|_| force_n),
            Self::ScaleForce(factor) => force(&|force_n| factor * force_n),
            Self::OffsetForce(by_n) => force(&|force_n| force_n + by_n),
            Self::DriftForce(by_n) => force(&|force_n| force_n + by_n * cycles),
            Self::SpikeForce(force_n) if since.is_multiple_of(2) => force(&|_| force_n),
            Self::StuckDisplacement(at_m) => displacement(&|_| at_m),
            Self::ScaleDisplacement(factor) => displacement(&|at_m| factor * at_m),
            Self::OffsetDisplacement(by_m) => displacement(&|at_m| at_m + by_m),
            Self::DriftDisplacement(by_m) => displacement(&|at_m| at_m + by_m * cycles),
            Self::InvalidForce => edited(frame, seal, seal, |measured| {
                measured.force_n = None;
                measured.flags |= MeasurementFlags::SENSOR_INVALID;
            }),
            Self::InvalidDisplacement => {
                edited(frame, seal, seal, |measured| measured.displacement_m = None)
            }
            Self::Says(state) => edited(frame, seal, seal, |measured| measured.state = state),
            Self::Flags(flags) => edited(frame, seal, seal, |measured| measured.flags |= flags),
            _ => return None,
        })
    }
}

/// A sealed measurement with another content, under the same seal or another.
fn edited(
    frame: &WireFrame,
    seal: Seal,
    other: Seal,
    edit: impl FnOnce(&mut Measurement),
) -> WireFrame {
    let Ok(mut measurement) = Measurement::decode_sealed(frame.id(), frame.data(), seal) else {
        return frame.clone();
    };
    edit(&mut measurement);
    WireFrame::from(&measurement.encode_sealed(Profile::Classical, other).0)
}

/// A frame with a random payload.
fn garbage(frame: &WireFrame, draw: &mut Draw) -> WireFrame {
    with_bytes(frame, |data| {
        for byte in data {
            *byte = draw.number() as u8;
        }
    })
}

/// A frame with so many different bits flipped.
fn flipped(frame: &WireFrame, bits: u32, draw: &mut Draw) -> WireFrame {
    with_bytes(frame, |data| {
        let count = 8 * data.len().max(1);
        let mut places = Vec::new();
        while places.len() < (bits as usize).min(count) {
            let bit = draw.number() as usize % count;
            if !places.contains(&bit) {
                places.push(bit);
                data[bit / 8] ^= 1 << (bit % 8);
            }
        }
    })
}

/// A frame with other bytes.
fn with_bytes(frame: &WireFrame, change: impl FnOnce(&mut [u8])) -> WireFrame {
    let mut data = frame.data().to_vec();
    change(&mut data);
    WireFrame::new(frame.id(), false, &data).unwrap_or_else(|| frame.clone())
}
