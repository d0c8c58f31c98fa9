//! Any frame of the protocol: for logs, monitors and tests.
use crate::{
    ArmMessage, Command, Error, Fault, Frame, Heartbeat, Measurement, MessageId, PressureOff,
    Residual, Saturated, Sync, Telemetry, TrackOffer, TrackRequest, TrackSample,
};
use core::fmt;

/// One decoded frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// The host asks to drop the pressure.
    PressureOff(PressureOff),
    /// Period, pace and time.
    Sync(Sync),
    /// Host to rig.
    Command(Command),
    /// Rig to host.
    Measurement(Measurement),
    /// What went wrong.
    Fault(Fault),
    /// A rig's slow values.
    Telemetry(Telemetry),
    /// How far a rig's damper is from its model.
    Residual(Residual),
    /// A locomotive asks for its track.
    TrackRequest(TrackRequest),
    /// Which track there is.
    TrackOffer(TrackOffer),
    /// Half a sample of it.
    TrackSample(TrackSample),
    /// One step of the arming exchange.
    Arm(ArmMessage),
    /// Alive.
    Heartbeat(Heartbeat),
}

impl Message {
    /// The message in a plain frame, whichever it is. A sealed command, measurement or
    /// sample of the track needs its seal: [`Command::decode_sealed`],
    /// [`Measurement::decode_sealed`], [`TrackSample::decode_sealed`].
    ///
    /// # Errors
    /// An id that is not of this protocol, or whatever that message's own `decode` finds.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        match MessageId::from_raw(id).ok_or(Error::UnknownId { id })? {
            MessageId::PressureOff(_) => PressureOff::decode(id, data).map(Self::PressureOff),
            MessageId::Sync => Sync::decode(id, data).map(Self::Sync),
            MessageId::Command(..) => Command::decode(id, data).map(Self::Command),
            MessageId::Measurement(..) => Measurement::decode(id, data).map(Self::Measurement),
            MessageId::Fault(_) => Fault::decode(id, data).map(Self::Fault),
            MessageId::Telemetry(_) => Telemetry::decode(id, data).map(Self::Telemetry),
            MessageId::Residual(_) => Residual::decode(id, data).map(Self::Residual),
            MessageId::TrackRequest => TrackRequest::decode(id, data).map(Self::TrackRequest),
            MessageId::TrackOffer => TrackOffer::decode(id, data).map(Self::TrackOffer),
            MessageId::TrackSample(_) => TrackSample::decode(id, data).map(Self::TrackSample),
            MessageId::ArmRequest(_) | MessageId::ArmAnswer(_) => {
                ArmMessage::decode(id, data).map(Self::Arm)
            }
            MessageId::Heartbeat(_) => Heartbeat::decode(id, data).map(Self::Heartbeat),
        }
    }

    /// The frame, and what had to be saturated to fit it. The profile matters to commands and
    /// measurements only.
    pub fn encode(&self, profile: crate::Profile) -> (Frame, Saturated) {
        match self {
            Self::PressureOff(request) => request.encode(),
            Self::Sync(sync) => (sync.encode(), Saturated::empty()),
            Self::Command(command) => command.encode(profile),
            Self::Measurement(measurement) => measurement.encode(profile),
            Self::Fault(fault) => fault.encode(),
            Self::Telemetry(telemetry) => telemetry.encode(),
            Self::Residual(residual) => residual.encode(),
            Self::TrackRequest(request) => (request.encode(), Saturated::empty()),
            Self::TrackOffer(offer) => (offer.encode(), Saturated::empty()),
            Self::TrackSample(sample) => sample.encode(),
            Self::Arm(message) => message.encode(),
            Self::Heartbeat(heartbeat) => heartbeat.encode(),
        }
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PressureOff(request) => request.fmt(f),
            Self::Sync(sync) => sync.fmt(f),
            Self::Command(command) => command.fmt(f),
            Self::Measurement(measurement) => measurement.fmt(f),
            Self::Fault(fault) => fault.fmt(f),
            Self::Telemetry(telemetry) => telemetry.fmt(f),
            Self::Residual(residual) => residual.fmt(f),
            Self::TrackRequest(request) => request.fmt(f),
            Self::TrackOffer(offer) => offer.fmt(f),
            Self::TrackSample(sample) => sample.fmt(f),
            Self::Arm(message) => message.fmt(f),
            Self::Heartbeat(heartbeat) => heartbeat.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_log_line_says_it_all() {
        for (id, bytes, line) in [
            (
                0x080,
                &[0xD5, 0x11, 0xF4, 0x01, 0x01, 0x40, 0x42, 0x0F][..],
                "sync v1 Fd CLOCK period 500 us x1 time 1000000 us",
            ),
            (
                0x101,
                &[0x18, 0x43, 0x28, 0x87, 0x00, 0x50, 0xE2, 0x22],
                "command 1 #3 RUN FOLLOW_WITH_VELOCITY displacement +3.4600 mm \
                 velocity -76.00 mm/s echo 2",
            ),
            (
                0x201,
                &[0x03, 0x42, 0x71, 0xA0, 0xBE, 0x38, 0x04, 0xA3],
                "measurement 1 #2 RUN force -17999.8 N displacement +3.4582 mm echo 3 \
                 LIMIT_REACHED ACTUATOR_LAGGING",
            ),
            (0x302, &[0x7B, 0x65, 0x01, 0x00, 0x05, 0x00], "fault 2 #5 SAFE PEER_SILENT (1) 5"),
            (
                0x403,
                &[0x5C, 0x4E, 0x1D, 0x10, 0x03, 0x22],
                "telemetry 3 #14 RUN temperature +41.25 degC pressure READY STROKE_LIMIT WATCHDOG",
            ),
            (
                0x703,
                &[0x58, 0x67, 0xEF, 0xBE, 0xAD, 0xDE, 0x01, 0x32],
                "heartbeat 3 #7 SAFE v2 boot deadbeef ENABLED",
            ),
            (
                0x602,
                &[0x15, 0x14, 0x01, 0x05, 0xEF, 0xBE, 0xAD, 0xDE],
                "arming request 2 #4 STANDBY ARM 0xdeadbeef",
            ),
            (0x042, &[0x83, 0x63, 0x20, 0x00, 0x02, 0x00], "pressure off 2 #3 SAFE SENSOR (32) 2"),
        ] {
            assert_eq!(Message::decode(id, bytes).unwrap().to_string(), line);
        }
    }

    #[test]
    fn errors_name_what_they_found() {
        let crc = Message::decode(0x302, &[0x7C, 0x65, 0x01, 0x00, 0x05, 0x00]).unwrap_err();
        assert_eq!(crc.to_string(), "frame 0x302 has crc 0x7c, its content gives 0x7b");
        let length = Message::decode(0x302, &[0; 8]).unwrap_err();
        assert_eq!(length.to_string(), "frame 0x302 has 8 bytes, must have 6");
        let id = Message::decode(0x105, &[0; 8]).unwrap_err();
        assert_eq!(id.to_string(), "frame id 0x105 is not expected here");
    }
}
