//! A rig that is lost while the vehicle goes on with the model of its slot.
//!
//! ```text
//! cause of one rig -> the slot may drop out? -> SAFE to this rig, urgent fade to the model, RUN
//!                  -> no, or no rig is left  -> the run ends as the cause asks for, or ramps out
//! ```
//! A slot drops out in RUN and in `RAMP_OUT`, where the scenario says so, and for a cause that is
//! this rig's own. In `RAMP_IN` nothing has been measured yet: that ends the run. A second sender
//! is somebody on the bus and no lost rig; it ends the run too.
//!
//! The rig that has dropped out is sent SAFE and HOLD until the session ends, so that one that was
//! only away is at rest as soon as it hears again. What it sends is recorded and not used, and it
//! does not come back.

use super::buses::Buses;
use super::port::{Port, PortState};
use super::session::{Session, SessionState};
use super::stop::PressureRequest;
use crate::bus::Bus;
use crate::silence::SILENCE;
use can_protocol::RunState;
use firmware_core::supervision::{Action, Cause, Signal, State};
use std::time::Duration;

impl Session<'_> {
    /// Acts on a cause of the rig behind a port: its slot drops out, or the run ends.
    pub(super) fn on_cause_of_rig(
        &self,
        state: &mut SessionState,
        number: usize,
        cause: Cause,
        action: Action,
    ) {
        let (Some(port), Some(memory)) = (self.ports.get(number), state.ports.get(number)) else {
            return;
        };
        if memory.has_dropped_out() {
            return;
        }
        let node = Some(port.node.number());
        let may_go_on = port.may_drop_out
            && matches!(state.line.state, State::Run | State::RampOut)
            && state.stop.is_none()
            && cause.signal != Signal::SecondSender;
        if !may_go_on {
            self.stop(state, node, cause, action);
            return;
        }
        let why = self.found(state, node, cause);
        state.line.drop_out(port.slot);
        if let Some(memory) = state.ports.get_mut(number) {
            port.finish(memory);
            memory.dropped_out = Some(why);
            memory.pressure_off = (action == Action::PowerOff).then(|| PressureRequest::new(why));
        }
        if state.ports.iter().all(PortState::has_dropped_out) {
            // Nothing real is left to be tested.
            self.stop(state, node, cause, Action::RampOut);
        }
    }

    /// How long a rig may be silent in lock-step. Where the run goes on without it, it goes on
    /// before the other rigs have lost their host, which is silent to them meanwhile.
    pub(super) fn patience(&self, state: &SessionState) -> Duration {
        let live = || {
            let ports = self.ports.iter().zip(&state.ports);
            ports.filter(|(_, memory)| !memory.has_dropped_out())
        };
        let may_go_on = live().count() > 1 && live().any(|(port, _)| port.may_drop_out);
        if may_go_on { SILENCE / 2 } else { SILENCE }
    }

    /// Asks rigs that have dropped out to drop their pressure, where their displacement is not
    /// believed.
    pub(super) fn announce_pressure_off<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
    ) {
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let request = memory.pressure_off.as_mut();
            if let Some(request) = request.and_then(|request| request.next(RunState::Safe)) {
                buses.send(port.bus, &request);
            }
        }
    }
}

impl Port {
    /// Whether the rig has not answered the last command, and was to.
    pub(super) fn owes_an_answer(&self, state: &PortState) -> bool {
        !state.has_dropped_out() && !self.has_echo(state)
    }
}

impl PortState {
    /// The state that the rig is sent while the host is in this one.
    pub(super) fn told(&self, run: RunState) -> RunState {
        if self.has_dropped_out() { RunState::Safe } else { run }
    }
}
