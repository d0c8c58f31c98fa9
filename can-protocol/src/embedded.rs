//! The bridge to `embedded_can::Frame`, which SocketCAN and bare-metal drivers implement.
//!
//! The trait knows no FD flags: a driver's FD frame type takes our 16 bytes, but the bit-rate
//! switch must be set on the driver's own type after [`to_embedded`] when [`Frame::is_fd`].
use crate::Frame;
use embedded_can::{Id, StandardId};

/// Our frame as a driver's frame; `None` when that type cannot hold the payload (16 bytes in a
/// classical frame).
pub fn to_embedded<F: embedded_can::Frame>(frame: &Frame) -> Option<F> {
    F::new(StandardId::new(frame.id())?, frame.data())
}

/// Id and payload of a driver's frame; `None` for remote frames and extended ids, which this
/// protocol does not use.
pub fn from_embedded<F: embedded_can::Frame>(frame: &F) -> Option<(u16, &[u8])> {
    match frame.id() {
        Id::Standard(id) if frame.is_data_frame() => Some((id.as_raw(), frame.data())),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Heartbeat, RunState, Sender};
    use embedded_can::ExtendedId;
    use heapless::Vec;

    /// A driver's classical frame, as small as the trait allows.
    struct DriverFrame {
        id: Id,
        remote: bool,
        data: Vec<u8, 8>,
    }

    impl embedded_can::Frame for DriverFrame {
        fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
            Some(Self { id: id.into(), remote: false, data: Vec::from_slice(data).ok()? })
        }
        fn new_remote(id: impl Into<Id>, _dlc: usize) -> Option<Self> {
            Some(Self { id: id.into(), remote: true, data: Vec::new() })
        }
        fn is_extended(&self) -> bool {
            matches!(self.id, Id::Extended(_))
        }
        fn is_remote_frame(&self) -> bool {
            self.remote
        }
        fn id(&self) -> Id {
            self.id
        }
        fn dlc(&self) -> usize {
            self.data.len()
        }
        fn data(&self) -> &[u8] {
            &self.data
        }
    }

    #[test]
    fn a_frame_crosses_the_bridge_and_comes_back() {
        let (frame, _) = Heartbeat::new(Sender::Host, 1, RunState::Run, 2).encode();
        let driver: DriverFrame = to_embedded(&frame).unwrap();
        assert_eq!(from_embedded(&driver), Some((0x700, frame.data())));
        assert_eq!(frame.data()[1..], [0x41, 2, 0, 0, 0, 0, 0x02]);
    }

    #[test]
    fn remote_extended_and_oversized_frames_do_not() {
        use embedded_can::Frame as _;
        let id = StandardId::new(0x101).unwrap();
        assert_eq!(from_embedded(&DriverFrame::new_remote(id, 8).unwrap()), None);
        let long = ExtendedId::new(0x101).unwrap();
        assert_eq!(from_embedded(&DriverFrame::new(long, &[0; 8]).unwrap()), None);
        let message = crate::MessageId::Command(crate::Profile::Fd, crate::Node::ALL[0]);
        assert!(to_embedded::<DriverFrame>(&Frame::new(message, [0; 16])).is_none());
    }
}
