//! A bus in memory: the double of CAN drivers.
//!
//! What one end transmits all others receive, in order. A full queue blocks, as the mailboxes of a
//! controller do.

use crate::WireFrame;
use core::array;
use core::cell::RefCell;
use core::convert::Infallible;
use heapless::Deque;

/// Frames on their way to one end: two ticks of the busiest nodes.
const FRAMES: usize = 16;

/// The wire of a bus with `N` ends: a queue towards each of them.
#[derive(Debug)]
pub struct Loopback<const N: usize>([RefCell<Deque<WireFrame, FRAMES>>; N]);

/// One end of it.
#[derive(Debug)]
pub struct End<'a> {
    queues: &'a [RefCell<Deque<WireFrame, FRAMES>>],
    place: usize,
}

impl<const N: usize> Default for Loopback<N> {
    fn default() -> Self {
        Self(array::from_fn(|_| RefCell::default()))
    }
}

impl<const N: usize> Loopback<N> {
    /// All ends.
    pub fn ends(&self) -> [End<'_>; N] {
        array::from_fn(|place| End { queues: &self.0, place })
    }
}

impl embedded_can::nb::Can for End<'_> {
    type Frame = WireFrame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &WireFrame) -> nb::Result<Option<WireFrame>, Infallible> {
        let others = || self.queues.iter().enumerate().filter(|(place, _)| *place != self.place);
        let has_room = |queue: &RefCell<Deque<WireFrame, FRAMES>>| {
            queue.try_borrow().is_ok_and(|queue| !queue.is_full())
        };
        if !others().all(|(_, queue)| has_room(queue)) {
            return Err(nb::Error::WouldBlock);
        }
        for (_, queue) in others() {
            if let Ok(mut queue) = queue.try_borrow_mut() {
                let _full = queue.push_back(frame.clone());
            }
        }
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<WireFrame, Infallible> {
        let queue = self.queues.get(self.place).ok_or(nb::Error::WouldBlock)?;
        let mut queue = queue.try_borrow_mut().map_err(|_| nb::Error::WouldBlock)?;
        queue.pop_front().ok_or(nb::Error::WouldBlock)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_can::nb::Can;

    #[test]
    fn a_frame_reaches_all_others_and_a_full_queue_blocks() {
        let wire = Loopback::<3>::default();
        let [mut one, mut two, mut three] = wire.ends();
        let frame = WireFrame::new(1, false, &[2]).unwrap();
        (0..FRAMES).for_each(|_| assert_eq!(one.transmit(&frame), Ok(None)));
        assert_eq!(one.transmit(&frame), Err(nb::Error::WouldBlock));
        assert_eq!(one.receive(), Err(nb::Error::WouldBlock), "its own frame");
        assert_eq!((two.receive(), three.receive()), (Ok(frame.clone()), Ok(frame.clone())));
        assert_eq!(one.transmit(&frame), Ok(None));
    }
}
