//! What a rig says of itself: its state, its guards and limits, its faults.
//!
//! A frame that fails its check says nothing. What a rig has said counts from the cycle in which it
//! was heard.

use crate::WireFrame;
use can_protocol::{
    Fault, FaultCode, Heartbeat, MessageId, Node, RunState, Sender, Telemetry, Trips,
};
use firmware_core::supervision::{Cause, Signal};

/// Guards and limits of the rig that end a run. The others, such as a stroke limit that was
/// reached, are the flags of measurements, which are counted.
const ENDS: Trips = Trips::EMERGENCY_STOP
    .union(Trips::GUARD_OPEN)
    .union(Trips::FORCE_LIMIT)
    .union(Trips::TEMPERATURE_LIMIT);

/// The cause in a frame of a rig, if it has one: a guard or limit in its telemetry, a fault, or a
/// heartbeat in SAFE, FAULT or INIT.
pub fn cause(node: Node, frame: &WireFrame) -> Option<Cause> {
    let (id, data) = (frame.id(), frame.data());
    match MessageId::from_raw(id)? {
        MessageId::Telemetry(sender) if sender == node => {
            let trips = Telemetry::decode(id, data).ok()?.trips & ENDS;
            (!trips.is_empty()).then(|| Cause::fact(Signal::RigTrip, f64::from(trips.bits())))
        }
        MessageId::Fault(Sender::Rig(sender)) if sender == node => {
            let code = Fault::decode(id, data).ok()?.code;
            (code != FaultCode::Cleared)
                .then(|| Cause::fact(Signal::RigFault, f64::from(code.code())))
        }
        MessageId::Heartbeat(Sender::Rig(sender)) if sender == node => {
            let state = Heartbeat::decode(id, data).ok()?.state;
            // A rig that has started again is in INIT, and armed no more.
            of_state(state).or_else(|| (state == RunState::Init).then(|| of_code(state)))
        }
        _ => None,
    }
}

/// The telemetry in a frame of a rig.
pub fn telemetry(node: Node, frame: &WireFrame) -> Option<Telemetry> {
    let telemetry = Telemetry::decode(frame.id(), frame.data()).ok();
    telemetry.filter(|telemetry| telemetry.node == node)
}

/// The cause in the state of a rig, if it is one in which it has stopped by itself.
pub fn of_state(state: RunState) -> Option<Cause> {
    let has_stopped = matches!(state, RunState::Safe | RunState::Fault);
    has_stopped.then(|| of_code(state))
}

fn of_code(state: RunState) -> Cause {
    Cause::fact(Signal::RigState, f64::from(state.code()))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use can_protocol::Pressure;

    const NODE: Node = Node::ALL[0];

    fn telemetry(node: Node, trips: Trips) -> WireFrame {
        let telemetry = Telemetry {
            node,
            counter: 0,
            state: RunState::Run,
            temperature_degc: None,
            pressure: Pressure::Ready,
            trips,
        };
        WireFrame::from(&telemetry.encode().0)
    }

    #[test]
    fn an_emergency_stop_in_telemetry_was_never_read() {
        let heard = cause(NODE, &telemetry(NODE, Trips::EMERGENCY_STOP | Trips::STROKE_LIMIT));
        assert_eq!(heard, Some(Cause::fact(Signal::RigTrip, 128.0)));
        assert_eq!(cause(NODE, &telemetry(NODE, Trips::STROKE_LIMIT)), None);
        assert_eq!(cause(NODE, &telemetry(Node::ALL[1], Trips::EMERGENCY_STOP)), None);
    }

    #[test]
    fn a_fault_frame_and_a_heartbeat_in_fault_were_never_read() {
        let sender = Sender::Rig(NODE);
        let fault = |code| {
            let fault = Fault { sender, counter: 0, state: RunState::Run, code, detail: 0 };
            WireFrame::from(&fault.encode().0)
        };
        assert_eq!(
            cause(NODE, &fault(FaultCode::GuardOpen)),
            Some(Cause::fact(Signal::RigFault, 35.0))
        );
        assert_eq!(cause(NODE, &fault(FaultCode::Cleared)), None);
        let heartbeat = |state| WireFrame::from(&Heartbeat::new(sender, 0, state, 0).encode().0);
        assert_eq!(
            cause(NODE, &heartbeat(RunState::Fault)),
            Some(Cause::fact(Signal::RigState, 7.0))
        );
        assert_eq!(cause(NODE, &heartbeat(RunState::Run)), None);
    }

    #[test]
    fn a_damaged_frame_says_nothing() {
        let whole = telemetry(NODE, Trips::EMERGENCY_STOP);
        let mut data = whole.data().to_vec();
        data[2] ^= 1;
        assert_eq!(cause(NODE, &WireFrame::new(whole.id(), false, &data).unwrap()), None);
    }
}
