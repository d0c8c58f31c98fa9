//! Before a run: which rig is on which bus, and whether the buses can carry it.

use crate::BenchError;
use crate::bus::BusChoice;
use crate::gateway::{self, GatewayError};
use crate::options::{PaceChoice, RunOptions};
use can_protocol::{BusPlan, Node, Profile, Verdict};
use scenario::run::{Rate, Run, SlotForce};

/// Where the rig of a slot is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigPlace {
    pub(crate) slot: usize,
    pub(crate) node: Node,
    /// Number of its bus in the list of choices.
    pub(crate) bus: usize,
}

/// The buses of a run and its rigs on them.
#[derive(Debug)]
pub(crate) struct Plan {
    /// All buses that the scenario names.
    pub(crate) buses: Vec<BusChoice>,
    /// The rigs, in slot order.
    pub(crate) rigs: Vec<RigPlace>,
}

/// The load of the buses.
#[derive(Debug)]
pub(crate) struct BusLoad {
    /// One line for each bus.
    pub(crate) lines: Vec<String>,
    /// The greatest worst-case share of a bus.
    pub(crate) most: f64,
}

/// Whether a rig of a scenario is on a real bus; `default` is the bus of slots that name none.
pub fn is_on_a_bus(run: &Run, default: &BusChoice) -> bool {
    // A bus that cannot be one is refused later, by name.
    Plan::new(run, default).map_or(true, |plan| plan.real_bus().is_some())
}

/// The frames of a loop on emulated rigs: classical ones at the usual rate, CAN FD above.
pub(crate) fn profile_of(rate: Rate) -> Profile {
    if rate > Rate::Usual { Profile::Fd } else { Profile::Classical }
}

impl Plan {
    /// The plan of a scenario; `default` is the bus of slots that name none.
    pub(crate) fn new(run: &Run, default: &BusChoice) -> Result<Self, BenchError> {
        let mut plan = Self { buses: Vec::new(), rigs: Vec::new() };
        for (slot, place) in run.slots.iter().enumerate() {
            let SlotForce::Rig { node, bus, .. } = &place.force else { continue };
            let choice = match bus {
                Some(text) => text
                    .parse()
                    .map_err(|why| BenchError::SlotBus { place: place.place.clone(), why })?,
                None => default.clone(),
            };
            let known = plan.buses.iter().position(|known| *known == choice);
            let bus = known.unwrap_or(plan.buses.len());
            if known.is_none() {
                plan.buses.push(choice);
            }
            plan.rigs.push(RigPlace { slot, node: Node::new(*node)?, bus });
        }
        Ok(plan)
    }

    /// Whether the slot is on a rig that is emulated in this process.
    pub(crate) fn is_emulated(&self, slot: usize) -> bool {
        let rig = self.rigs.iter().find(|rig| rig.slot == slot);
        rig.is_some_and(|rig| self.buses.get(rig.bus) == Some(&BusChoice::Memory))
    }

    /// The first bus that is not in memory.
    pub(crate) fn real_bus(&self) -> Option<&BusChoice> {
        self.buses.iter().find(|bus| **bus != BusChoice::Memory)
    }

    /// Refuses a rate that the frames, or the messages of a rig's own, are not made for.
    pub(crate) fn check_rate(&self, rate: Rate, options: &RunOptions) -> Result<(), BenchError> {
        if rate > Rate::Usual && !self.rigs.is_empty() {
            if options.gateway.is_some() {
                return Err(GatewayError::Rate { found_hz: rate.hz() }.into());
            }
            if options.profile == Profile::Classical {
                return Err(BenchError::ClassicalRate { found_hz: rate.hz() });
            }
        }
        Ok(())
    }

    /// Refuses a pace that a bus cannot keep.
    pub(crate) fn check_pace(&self, pace: PaceChoice) -> Result<(), BenchError> {
        match self.real_bus() {
            Some(bus) if pace == PaceChoice::Fast => {
                Err(BenchError::FastOnBus { bus: bus.to_string() })
            }
            _ => Ok(()),
        }
    }

    /// Refuses what a rig's own messages cannot do: a bus that is not one interface with one rig,
    /// or a slow-down.
    pub(crate) fn check_gateway(&self, options: &RunOptions) -> Result<(), BenchError> {
        if options.gateway.is_none() {
            return Ok(());
        }
        let number = self.buses.iter().position(|bus| *bus == options.bus);
        let rigs = self.rigs.iter().filter(|rig| Some(rig.bus) == number).count();
        let is_one = rigs == 1 && options.bus != BusChoice::Memory;
        let why = match options.slow_down.get() {
            1 if is_one => return Ok(()),
            1 => GatewayError::Bus { found: format!("{rigs} rig(s) on --bus {}", options.bus) },
            found => GatewayError::SlowDown { found },
        };
        Err(why.into())
    }

    /// The load of every bus; too much is refused.
    pub(crate) fn load(&self, rate: Rate, options: &RunOptions) -> Result<BusLoad, BenchError> {
        let mut found = BusLoad { lines: Vec::new(), most: 0.0 };
        for (number, bus) in self.buses.iter().enumerate() {
            let plan = BusPlan {
                profile: options.profile,
                rigs: self.rigs.iter().filter(|rig| rig.bus == number).count() as u8,
                rate_hz: 1.0 / (rate.cycle_s() * f64::from(options.slow_down.get())),
                nominal_bits_per_s: options.bit_rates.0,
                data_bits_per_s: options.bit_rates.1,
            };
            let own = options.gateway.as_ref().filter(|_| *bus == options.bus);
            let load = match own {
                Some(own) => gateway::load(own, plan.rate_hz, options.bit_rates),
                None => plan.cyclic_load(),
            };
            let warning = match Verdict::of(load) {
                Verdict::Accept => "",
                Verdict::Warn => " - warning: above 50 %, a retransmission may delay a cycle",
                Verdict::Refuse => {
                    return Err(BenchError::BusLoad { bus: bus.to_string(), load });
                }
            };
            found.lines.push(match own {
                Some(_) => format!(
                    "bus {bus}: bus load {:.1} % worst case: 1 rig at {:.0} Hz by its own \
                     messages, {} kbit/s{warning}",
                    100.0 * load,
                    plan.rate_hz,
                    plan.nominal_bits_per_s / 1e3
                ),
                None => format!("bus {bus}: {plan}{warning}"),
            });
            found.most = found.most.max(load);
        }
        Ok(found)
    }
}
