//! A bus of two ends in memory: the double of a CAN driver.
//!
//! What one end transmits the other one receives, in order. A full queue blocks, as the mailboxes
//! of a controller do.

use crate::WireFrame;
use core::cell::RefCell;
use core::convert::Infallible;
use heapless::Deque;

/// Frames on their way to one end: two ticks of the busier node.
const FRAMES: usize = 16;

/// The wire: a queue towards either end.
#[derive(Debug, Default)]
pub struct Loopback([RefCell<Deque<WireFrame, FRAMES>>; 2]);

/// One end of it.
#[derive(Debug)]
pub struct End<'a> {
    out: &'a RefCell<Deque<WireFrame, FRAMES>>,
    into: &'a RefCell<Deque<WireFrame, FRAMES>>,
}

impl Loopback {
    /// Both ends.
    pub fn ends(&self) -> (End<'_>, End<'_>) {
        let [one, other] = &self.0;
        (End { out: one, into: other }, End { out: other, into: one })
    }
}

impl embedded_can::nb::Can for End<'_> {
    type Frame = WireFrame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &WireFrame) -> nb::Result<Option<WireFrame>, Infallible> {
        let mut queue = self.out.try_borrow_mut().map_err(|_| nb::Error::WouldBlock)?;
        queue.push_back(frame.clone()).map_err(|_| nb::Error::WouldBlock)?;
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<WireFrame, Infallible> {
        let mut queue = self.into.try_borrow_mut().map_err(|_| nb::Error::WouldBlock)?;
        queue.pop_front().ok_or(nb::Error::WouldBlock)
    }
}
