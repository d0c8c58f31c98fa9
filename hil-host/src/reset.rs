//! `yawbench rig-reset`: a latched rig is released over the bus.
//!
//! It is the short exchange of [`can_protocol::arming`]: numbers, then RESET with the rig's own.
//! The rig decides whether it may: only in SAFE or FAULT, and only with its ram at rest. It leads
//! to INIT, never to motion.

use crate::BenchError;
use crate::bus::{Bus, BusChoice, SocketCanBus};
use crate::clock::Pacer;
use crate::draw::Draw;
use can_protocol::arming::{
    Configuration, HostArming, HostOutcome, HostPlan, Limits, Listener, Patience, Quiet, Refusal,
    Requirements,
};
use can_protocol::{ArmItem, ArmMessage, MessageId, Node, Pace, Profile};
use std::num::{NonZeroU8, NonZeroU16};
use std::time::Duration;

/// Real time of a cycle of the exchange.
const CYCLE: Duration = Duration::from_millis(1);

/// Questions are repeated slowly: a rig that is slowed down has cycles of a quarter of a second.
const PATIENCE: Patience = Patience { repeat_cycles: 200, attempts: 10, quiet_cycles: 0 };

/// Resets a latched rig on a CAN interface.
///
/// # Errors
/// The interface cannot be used; the rig does not answer or refuses.
pub fn reset_rig(interface: &str, node: Node) -> Result<(), BenchError> {
    let draw = Draw::system().map_err(|why| BenchError::NoRandom { why })?;
    let mut bus = SocketCanBus::open(interface, &[MessageId::ArmAnswer(node)], Profile::Classical)?;
    reset_over(&mut bus, node, draw, CYCLE).map_err(|refusal| BenchError::UnresetRig {
        node: node.number(),
        bus: BusChoice::SocketCan(interface.to_owned()).to_string(),
        refusal,
    })
}

/// Resets a latched rig over a bus; `cycle` is the real time of a cycle, zero in memory.
///
/// # Errors
/// The rig does not answer or refuses.
pub fn reset_over<B: Bus>(
    bus: &mut B,
    node: Node,
    mut draw: Draw,
    cycle: Duration,
) -> Result<(), Refusal> {
    let mut exchange = HostArming::reset(plan(node, draw.number()));
    let quiet = Quiet::new(Listener::Host);
    let mut pacer = Pacer::every(cycle);
    loop {
        while let Some(frame) = bus.receive() {
            if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data()) {
                exchange.receive(&answer);
            }
        }
        match exchange.outcome() {
            HostOutcome::Reset => return Ok(()),
            HostOutcome::Refused(refusal) => return Err(refusal),
            // A reset arms nothing.
            HostOutcome::Armed(_) => return Err(Refusal::ByRig(ArmItem::Reset)),
            HostOutcome::Pending(_) => {}
        }
        if let Some(question) = exchange.cycle(&quiet) {
            bus.send(&question.encode().0);
        }
        pacer.wait();
        bus.wait(Duration::ZERO);
    }
}

/// The plan of a reset: node, number and patience; the rest is for arming.
fn plan(node: Node, number: u32) -> HostPlan {
    let limits =
        Limits { stroke_um: 0, velocity_um_per_s: 0, acceleration_mm_per_s2: 0, force_n: 0 };
    HostPlan {
        node,
        number,
        asked: limits,
        needed: limits,
        requirements: Requirements {
            enabled: false,
            zero_age_s: 0,
            shunt_passed: false,
            force_at_rest_n: 0,
            stroke_um: 0,
        },
        configuration: Configuration {
            profile: Profile::Classical,
            pace: Pace::Clock,
            period_us: NonZeroU16::MIN,
            slow_down: NonZeroU8::MIN,
            watchdog_cycles: 0,
            limits,
        },
        patience: PATIENCE,
    }
}
