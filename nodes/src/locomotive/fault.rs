//! The fault code of the protocol for what stopped a run.

use can_protocol::FaultCode;
use firmware_core::supervision::{Cause, Signal};

/// The code of a cause and its detail, which saturates.
pub fn fault_of(cause: &Cause) -> (FaultCode, u16) {
    let (code, detail) = code(cause);
    (code, libm::round(detail.abs()).min(f64::from(u16::MAX)) as u16)
}

fn code(cause: &Cause) -> (FaultCode, f64) {
    let Cause { signal, value, limit, .. } = *cause;
    let per_mille = 1000.0 * value / limit;
    match signal {
        Signal::LostMeasurements
        | Signal::LostCommands
        | Signal::OldMeasurements
        | Signal::SilentRig => (FaultCode::PeerSilent, value),
        Signal::InvalidForce | Signal::StuckForce => (FaultCode::Sensor, 1.0),
        Signal::InvalidDisplacement | Signal::StuckDisplacement | Signal::Acceleration => {
            (FaultCode::Sensor, 2.0)
        }
        Signal::Temperature => (FaultCode::TemperatureLimit, per_mille),
        Signal::Force | Signal::ForceRate | Signal::Residual => (FaultCode::ForceLimit, per_mille),
        Signal::Velocity => (FaultCode::VelocityLimit, per_mille),
        Signal::Tracking | Signal::Delay => (FaultCode::Tracking, value * 1e6),
        Signal::Compensation => (FaultCode::Tracking, 0.0),
        Signal::WearLoopGain | Signal::WearForceError => (FaultCode::Internal, per_mille),
        Signal::Work => (FaultCode::Energy, value),
        Signal::RigState => (FaultCode::StateMismatch, value),
        Signal::RigFault => (FaultCode::from_code(value as u16), 0.0),
        Signal::RigTrip => (FaultCode::Actuator, value),
        Signal::BusQueue | Signal::Track => (FaultCode::Overrun, value),
        Signal::BusDown => (FaultCode::BusOff, 0.0),
        Signal::Growth | Signal::Displacement => (FaultCode::StrokeLimit, per_mille),
        Signal::CommandLimit => (FaultCode::StrokeLimit, 1000.0),
        Signal::WrongSeal | Signal::SecondSender => (FaultCode::Protection, value),
        Signal::Vehicle => (FaultCode::Internal, 0.0),
        Signal::Operator => (FaultCode::EmergencyStop, 0.0),
    }
}
