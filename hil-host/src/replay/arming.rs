//! The arming of a recorded session, from its frames.
//!
//! How long a host waited for rigs and operators is not repeated: what counts is what the exchange
//! agreed on, the commands that held the armed rigs, and what they measured until then.

use super::script::{Entry, Script};
use crate::bus::WireFrame;
use crate::control::{Port, PortState, Session, SessionState};
use crate::record::{Direction, FrameBytes, Row};
use can_protocol::arming::Limits;
use can_protocol::{ArmItem, ArmMessage, Heartbeat, MessageId, Node, Profile, RunState, Sender};
use firmware_core::command::Command;
use firmware_core::supervision::Event;
use firmware_core::vehicle::DAMPER_SLOTS;

/// Why a session cannot be armed as it was.
#[derive(Debug)]
pub(super) enum NotArmed {
    /// The log ends before all rigs are armed.
    NoExchange,
    /// It shows no displacement from which the rigs could be coupled, or one too far away.
    NoStart,
}

impl NotArmed {
    /// What the log shows.
    pub(super) const fn found(&self) -> &'static str {
        match self {
            Self::NoExchange => "no exchange that arms all rigs of the run",
            Self::NoStart => "no place from which the rigs can be coupled",
        }
    }
}

/// What the exchange with one rig has shown.
#[derive(Debug, Clone, Copy)]
struct Heard {
    rig_number: Option<u32>,
    limits: Limits,
}

/// Arms and couples the rigs as the log shows it. `first` is the first row of the record.
pub(super) fn arm(
    session: &Session<'_>,
    state: &mut SessionState,
    script: &mut Script,
    first: &Row,
) -> Result<(), NotArmed> {
    state.line.on(Event::Agreed);
    if session.ports.is_empty() {
        return session.couple(state, [0.0; DAMPER_SLOTS]).map_err(|_| NotArmed::NoStart);
    }
    let most = u32::MAX;
    let limits = Limits {
        stroke_um: most,
        velocity_um_per_s: most,
        acceleration_mm_per_s2: most,
        force_n: most,
    };
    let mut heard = vec![Heard { rig_number: None, limits }; session.ports.len()];
    // Rigs that are armed, and frames that came, since the host sent last.
    let (mut armed, mut came): (Vec<usize>, Vec<Entry>) = (Vec::new(), Vec::new());
    loop {
        let entry = script.take().ok_or(NotArmed::NoExchange)?;
        if entry.direction == Direction::Received {
            armed.extend(hear(session, &mut heard, &entry));
            came.push(entry);
            continue;
        }
        if is_of_the_run(session, state, &came, &entry) {
            script.put_back(vec![entry]);
            break;
        }
        deliver(session, state, &came);
        came.clear();
        for number in armed.drain(..) {
            let Heard { rig_number, limits } = heard[number];
            let rig_number = rig_number.ok_or(NotArmed::NoExchange)?;
            session.begin_sealed(state, number, rig_number, limits);
        }
        hold(session, state, &entry);
        if let Ok(said) = Heartbeat::decode(entry.frame.id(), entry.frame.data())
            && entry.frame.id() == MessageId::Heartbeat(Sender::Host).raw()
        {
            state.go_on_with_heartbeat(Profile::Classical.next_counter(said.counter));
        }
    }
    // What came last was found before arming was done, or by the first cycle: its row shows it.
    let of_cycle = came.iter().position(|entry| is_in(first, entry)).unwrap_or(came.len());
    let of_first_cycle = came.split_off(of_cycle);
    deliver(session, state, &came);
    script.put_back(of_first_cycle);
    let coupled = session.rams_m(state).and_then(|rams_m| session.couple(state, rams_m));
    coupled.map_err(|_| NotArmed::NoStart)
}

/// Takes notice of the answer of a rig; the number of its port where it says that it is armed.
fn hear(session: &Session<'_>, heard: &mut [Heard], entry: &Entry) -> Option<usize> {
    let answer = ArmMessage::decode(entry.frame.id(), entry.frame.data()).ok()?;
    let is_its = |port: &Port| port.node == answer.node && port.bus == entry.bus;
    let number = session.ports.iter().position(is_its)?;
    let heard = heard.get_mut(number)?;
    match answer.item {
        ArmItem::RigNumber => heard.rig_number = Some(answer.value),
        ArmItem::Stroke => heard.limits.stroke_um = answer.value,
        ArmItem::Velocity => heard.limits.velocity_um_per_s = answer.value,
        ArmItem::Acceleration => heard.limits.acceleration_mm_per_s2 = answer.value,
        ArmItem::Force => heard.limits.force_n = answer.value,
        ArmItem::Armed => return Some(number),
        _ => {}
    }
    None
}

/// Hands frames to the armed rigs' ports.
fn deliver(session: &Session<'_>, state: &mut SessionState, came: &[Entry]) {
    for Entry { bus, frame, .. } in came {
        let ports = session.ports.iter().zip(&mut state.ports);
        for (port, memory) in ports.filter(|(port, _)| port.bus == *bus) {
            if memory.is_armed() {
                port.take_frame(memory, frame);
            }
        }
    }
}

/// Repeats a command that holds an armed rig.
fn hold(session: &Session<'_>, state: &mut SessionState, entry: &Entry) {
    let ports = session.ports.iter().zip(&mut state.ports);
    for (port, memory) in ports.filter(|(port, _)| port.bus == entry.bus) {
        if memory.is_armed() && is_command(session, port.node, entry) {
            port.command(memory, &Command::default(), RunState::Armed, 0);
        }
    }
}

/// Whether an entry is the first command of the run itself: every rig is armed, and it is not the
/// one that would hold its rig after what `came`.
fn is_of_the_run(
    session: &Session<'_>,
    state: &SessionState,
    came: &[Entry],
    entry: &Entry,
) -> bool {
    if !state.ports.iter().all(PortState::is_armed) {
        return false;
    }
    let mut ports = session.ports.iter().zip(state.ports.clone());
    ports.any(|(port, mut memory)| {
        let is_its = port.bus == entry.bus && is_command(session, port.node, entry);
        is_its && {
            for Entry { frame, .. } in came.iter().filter(|came| came.bus == port.bus) {
                port.take_frame(&mut memory, frame);
            }
            let held = port.command(&mut memory, &Command::default(), RunState::Armed, 0);
            WireFrame::from(&held) != entry.frame
        }
    })
}

fn is_command(session: &Session<'_>, node: Node, entry: &Entry) -> bool {
    entry.frame.id() == MessageId::Command(session.profile, node).raw()
}

/// Whether a row was made with this frame.
fn is_in(row: &Row, entry: &Entry) -> bool {
    let mut bytes = FrameBytes::default();
    for (to, from) in bytes.iter_mut().zip(entry.frame.data()) {
        *to = *from;
    }
    bytes != FrameBytes::default() && row.frame.contains(&bytes)
}
