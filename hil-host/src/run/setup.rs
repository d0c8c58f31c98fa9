//! From a scenario to a session that can cycle: the line, the ports, the buses.

use super::model_peak::believed_forces_n;
use super::plan::{Plan, RigPlace};
use crate::BenchError;
use crate::bus::{AnyBus, BusChoice, CanSocket, MemoryBus, SocketCanBus};
use crate::clock::Pacer;
use crate::control::{Arming, DelayGate, MOST_FORCE_N, Pace, Port, Session, Watch};
use crate::draw::Draw;
use crate::gateway::{Gateway, GatewayPlan};
use crate::options::{PaceChoice, RunOptions};
use crate::rig::RigNode;
use can_protocol::{MessageId, Node, Pace as WirePace, Profile, Sender};
use firmware_core::line::{Fade, Line, RigSlot, Slot, StandIn};
use firmware_core::supervision::CommandLimits;
use firmware_core::track::Track;
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::{IfRigDropsOut, MEASURING_S, Rate, Run, SlotForce};
use std::num::NonZeroU8;
use std::time::Duration;

/// What the rigs are given in the handshake, and whether the user sees what goes on before it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms {
    pub(crate) profile: Profile,
    pub(crate) pace: WirePace,
    pub(crate) slow_down: NonZeroU8,
    pub(crate) arming: Arming,
    /// Frequency of hunting at which the delay is judged before RUN (Hz); none where it is not.
    pub(crate) gate_hz: Option<f64>,
    /// Whether set-up that takes long shows its progress.
    pub(crate) shows_progress: bool,
}

impl Terms {
    /// Those of rigs on the memory bus without a clock.
    pub(crate) fn in_memory(profile: Profile) -> Self {
        let arming = Arming::in_memory();
        let (pace, slow_down) = (WirePace::LockStep, NonZeroU8::MIN);
        Self { profile, pace, slow_down, arming, gate_hz: None, shows_progress: false }
    }
}

/// The control session of a scenario with its rigs.
pub(crate) fn session<'a>(
    run: &'a Run,
    track: &'a Track<'a>,
    rigs: &[RigPlace],
    terms: Terms,
) -> Result<Session<'a>, can_protocol::Error> {
    let Terms { profile, pace, slow_down, arming, gate_hz, shows_progress } = terms;
    let gate = gate_hz.filter(|_| !rigs.is_empty());
    // A second of work, which a run without rigs does not need.
    let forces_n = if rigs.is_empty() {
        [f64::INFINITY; DAMPER_SLOTS]
    } else {
        believed_forces_n(run, line(run, track), shows_progress)
    };
    let port = |rig: &RigPlace| {
        let force_n = forces_n[rig.slot].min(MOST_FORCE_N);
        let checks = run.plausibility.checks(profile.counter_modulus(), force_n);
        let port = Port::new(rig.node, rig.bus, rig.slot, profile)?
            .checked(checks, run.motion.beyond_limits);
        let port = match watch_of(run, rig.slot) {
            Some(watch) => port.watched(watch),
            None => port,
        };
        Ok(if goes_on_without(run, rig.slot) { port.dropping_out() } else { port })
    };
    let body = |name: &str| run.body_names.iter().position(|body| body == name);
    let mut line = line(run, track);
    if gate.is_some() {
        line.fade.measuring_cycles = run.rate.cycles(MEASURING_S) as u32;
    }
    Ok(Session {
        line,
        ports: rigs.iter().map(port).collect::<Result<_, can_protocol::Error>>()?,
        profile,
        pace,
        slow_down,
        arming: arming.requiring(&run.readiness),
        delay_gate: gate.map(|hunting_hz| DelayGate { hunting_hz, accepted: accepted(run) }),
        watched: [body("carbody"), body("bogie_front"), body("wheelset_1")],
        rear_bogie: body("bogie_rear"),
    })
}

/// The line of a scenario: the vehicle on its track with its damper slots.
#[expect(clippy::large_stack_arrays, reason = "made once, before the loop")]
pub fn line<'a>(run: &'a Run, track: &'a Track<'a>) -> Line<'a> {
    debug_assert!(run.slots.len() <= DAMPER_SLOTS, "a vehicle with {} slots", run.slots.len());
    let cycle_s = run.cycle_s();
    let substep_s = cycle_s / f64::from(run.substeps);
    let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
    for (slot, place) in slots.iter_mut().zip(&run.slots) {
        *slot = match &place.force {
            SlotForce::Modelled(damper) => Slot::Modelled(damper.clone().prepared(substep_s)),
            SlotForce::Rig {
                virtual_clearance_2a_m,
                virtual_compliance_m_per_n,
                specimen,
                model,
                compensator,
                ..
            } => {
                let model = (**model).clone().prepared(substep_s);
                let rig = RigSlot::new(model, *compensator, limits(run), cycle_s);
                let (clearance, compliance) =
                    (*virtual_clearance_2a_m, *virtual_compliance_m_per_n);
                Slot::Rig(if clearance == 0.0 && compliance == 0.0 {
                    rig
                } else {
                    rig.behind_wear(clearance, compliance, specimen, cycle_s)
                })
            }
            SlotForce::StandIn { of, is_reversed, model, .. } => Slot::StandIn(StandIn {
                model: (**model).clone().prepared(substep_s),
                of: *of,
                is_reversed: *is_reversed,
            }),
        };
    }
    Line {
        vehicle: &run.vehicle,
        track,
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        speed_m_per_s: run.speed_m_per_s,
        cycle_s,
        substeps: run.substeps,
        slots,
        fade: Fade {
            motion_cycles: run.motion.ramp_cycles,
            measuring_cycles: 0,
            coupling_cycles: run.motion.ramp_cycles,
        },
    }
}

/// Slots that accept the cost of their delay.
fn accepted(run: &Run) -> [bool; DAMPER_SLOTS] {
    let mut accepted = [false; DAMPER_SLOTS];
    for (accepted, slot) in accepted.iter_mut().zip(&run.slots) {
        *accepted = matches!(slot.force, SlotForce::Rig { accept_delay_error: true, .. });
    }
    accepted
}

/// Whether the vehicle goes on with the model of a slot whose rig is lost.
fn goes_on_without(run: &Run, slot: usize) -> bool {
    let force = run.slots.get(slot).map(|slot| &slot.force);
    matches!(force, Some(SlotForce::Rig { if_drops_out: IfRigDropsOut::Model, .. }))
}

/// The limits of the commands to a rig.
pub(crate) fn limits(run: &Run) -> CommandLimits {
    CommandLimits {
        stroke_m: run.motion.stroke_m,
        velocity_m_per_s: run.motion.velocity_m_per_s,
        acceleration_m_per_s2: run.motion.acceleration_m_per_s2,
    }
}

/// The watch over the rig of a slot.
pub fn watch_of(run: &Run, slot: usize) -> Option<Watch> {
    match run.slots.get(slot).map(|slot| &slot.force) {
        Some(SlotForce::Rig { watch: Some(watch), .. }) => Some(Watch::new(watch, run.cycle_s())),
        _ => None,
    }
}

/// What the host brings into the arming exchange.
pub(super) fn arming(
    buses: &[BusChoice],
    rate: Rate,
    options: &RunOptions,
) -> Result<Arming, BenchError> {
    if buses.iter().all(|bus| *bus == BusChoice::Memory) {
        return Ok(Arming::in_memory());
    }
    let draw = Draw::system().map_err(|why| BenchError::NoRandom { why })?;
    let cycle = Duration::from_nanos(rate.cycle_ns()) * u32::from(options.slow_down.get());
    Ok(Arming::on_a_bus(draw, cycle))
}

/// The pace of the loop.
pub(super) fn pace(rate: Rate, options: &RunOptions) -> Pace {
    match options.pace {
        PaceChoice::Realtime => {
            let slow_down = u32::from(options.slow_down.get());
            Pace::Realtime(Pacer::new(rate.cycle_ns(), slow_down))
        }
        PaceChoice::Lockstep => Pace::LockStep,
        PaceChoice::Fast => Pace::Fast,
    }
}

/// Opens every bus; on the memory bus the rigs are emulated.
pub(super) fn open_buses(
    run: &Run,
    options: &RunOptions,
    plan: &Plan,
) -> Result<Vec<AnyBus>, BenchError> {
    let open = |(number, choice): (usize, &BusChoice)| {
        let rigs = plan.rigs.iter().filter(|rig| rig.bus == number);
        let nodes = rigs.map(|rig| rig.node);
        Ok(match choice {
            BusChoice::Memory => AnyBus::Memory(MemoryBus::new(
                nodes.map(|node| RigNode::new(&run.rig, node, options.profile)),
            )),
            BusChoice::SocketCan(name) => {
                let own = options.gateway.as_ref().filter(|_| *choice == options.bus);
                if let (Some(own), Some(node)) = (own, nodes.clone().next()) {
                    return Ok(AnyBus::Gateway(gateway(own, name, node, options.profile)?));
                }
                let of_rigs = nodes.flat_map(|node| sent_by(node, options.profile));
                let of_hosts = MessageId::all().filter(|message| message.is_of_host());
                let accept: Vec<_> = of_rigs.chain(of_hosts).collect();
                AnyBus::SocketCan(SocketCanBus::open(name, &accept, options.profile)?)
            }
        })
    };
    plan.buses.iter().enumerate().map(open).collect()
}

/// Opens the interface of a rig that speaks its own messages.
fn gateway(
    own: &GatewayPlan,
    interface: &str,
    node: Node,
    profile: Profile,
) -> Result<Gateway<CanSocket>, BenchError> {
    let socket = CanSocket::open(interface, own.received(), own.needs_fd())?;
    let draw = Draw::system().map_err(|why| BenchError::NoRandom { why })?;
    Ok(Gateway::new(own.clone(), socket, node, profile, draw))
}

/// What a host receives of a rig.
pub(super) fn sent_by(node: Node, profile: Profile) -> [MessageId; 5] {
    [
        MessageId::Measurement(profile, node),
        MessageId::Fault(Sender::Rig(node)),
        MessageId::Telemetry(node),
        MessageId::ArmAnswer(node),
        MessageId::Heartbeat(Sender::Rig(node)),
    ]
}
