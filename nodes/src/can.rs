//! Between a node and a CAN driver that has the traits of `embedded_can`.
//!
//! A driver of a microcontroller implements [`embedded_can::nb::Can`]; neither [`receive`] nor
//! [`transmit`] waits. The traits know no bit-rate switch: a driver of CAN FD sets it for frames of
//! more than 8 bytes.

use crate::WireFrame;
use can_protocol::{Frame, from_embedded, to_embedded};
use embedded_can::Id;
use embedded_can::nb::Can;

/// The oldest frame that has arrived; what this protocol has no use for is passed over.
pub fn receive<C: Can>(driver: &mut C) -> Option<WireFrame> {
    loop {
        // An error of the controller is no frame; it is for its driver to count.
        let frame = driver.receive().ok()?;
        if let Some((id, data)) = from_embedded(&frame)
            && let Some(frame) = WireFrame::new(id, data.len() > 8, data)
        {
            return Some(frame);
        }
    }
}

/// Hands a frame to the driver at once; false where there was no room, or where it took the place
/// of another one.
pub fn transmit<C: Can>(driver: &mut C, frame: &Frame) -> bool {
    to_embedded::<C::Frame>(frame).is_some_and(|frame| matches!(driver.transmit(&frame), Ok(None)))
}

impl embedded_can::Frame for WireFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        match id.into() {
            Id::Standard(id) => Self::new(id.as_raw(), data.len() > 8, data),
            Id::Extended(_) => None,
        }
    }

    /// There are none in this protocol.
    fn new_remote(_id: impl Into<Id>, _dlc: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        false
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        // Made from 11 bits.
        embedded_can::StandardId::new(self.id()).unwrap_or(embedded_can::StandardId::ZERO).into()
    }

    fn dlc(&self) -> usize {
        self.data().len()
    }

    fn data(&self) -> &[u8] {
        self.data()
    }
}
