//! A serial line as a bus: frames of [`nodes::serial_line`] over a Unix socket, as an emulated
//! board has on its UART.

use super::error::BusError;
use super::{Bus, BusCounters, Sent};
use can_protocol::Frame;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nodes::WireFrame;
use nodes::serial_line::{Reader, write};
use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// Bytes that are read at once.
const CHUNK: usize = 512;

/// A line to one other end.
#[derive(Debug)]
pub(crate) struct SerialLineBus {
    socket: UnixStream,
    reader: Reader,
    /// Bytes that have been read and not looked at.
    bytes: [u8; CHUNK],
    unread: std::ops::Range<usize>,
    is_closed: bool,
    counters: BusCounters,
}

impl SerialLineBus {
    /// Connects to the socket of a line.
    ///
    /// # Errors
    /// Nobody listens there.
    pub(crate) fn connect(path: &Path) -> Result<Self, BusError> {
        let refused = |error| BusError::NoLine { line: path.to_owned(), error };
        let socket = UnixStream::connect(path).map_err(refused)?;
        socket.set_nonblocking(true).map_err(refused)?;
        Ok(Self {
            socket,
            reader: Reader::default(),
            bytes: [0; CHUNK],
            unread: 0..0,
            is_closed: false,
            counters: BusCounters::default(),
        })
    }

    /// Whether the other end is gone.
    pub(crate) fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Reads what has arrived; false where there is nothing.
    fn refill(&mut self) -> bool {
        match self.socket.read(&mut self.bytes) {
            Ok(0) => self.is_closed = true,
            Ok(read) => self.unread = 0..read,
            Err(why) => {
                let comes_later =
                    matches!(why.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted);
                self.is_closed |= !comes_later;
            }
        }
        !self.unread.is_empty()
    }

    fn dropped(&mut self, sent: Sent) -> Sent {
        self.counters.send_dropped += 1;
        sent
    }
}

impl Bus for SerialLineBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        let mut bytes = heapless::Vec::<u8, 256>::new();
        write(&WireFrame::from(frame), |byte| {
            // The longest frame, all of it escaped, has fewer.
            let _full = bytes.push(byte);
        });
        match self.socket.write(&bytes) {
            Ok(written) if written == bytes.len() => {
                self.counters.sent += 1;
                Sent::Away
            }
            // Half a frame is none for its receiver.
            Ok(_) => self.dropped(Sent::Dropped),
            Err(why) if why.kind() == ErrorKind::WouldBlock => self.dropped(Sent::Dropped),
            Err(_) => {
                self.is_closed = true;
                self.dropped(Sent::Down)
            }
        }
    }

    fn receive(&mut self) -> Option<WireFrame> {
        loop {
            if self.unread.is_empty() && !self.refill() {
                return None;
            }
            while let Some(place) = self.unread.next() {
                let frame = self.bytes.get(place).and_then(|byte| self.reader.take(*byte));
                if frame.is_some() {
                    self.counters.received += 1;
                    return frame;
                }
            }
        }
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        if !self.unread.is_empty() {
            return true;
        }
        if self.is_closed {
            return false;
        }
        let timeout = PollTimeout::try_from(timeout).unwrap_or(PollTimeout::MAX);
        let mut sockets = [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)];
        matches!(poll(&mut sockets, timeout), Ok(1..))
    }

    fn counters(&self) -> BusCounters {
        self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use can_protocol::TrackRequest;
    use std::os::unix::net::UnixListener;

    #[test]
    fn frames_go_both_ways_and_an_end_that_is_gone_is_noticed() {
        let path = std::env::temp_dir().join(format!("serial-line-{}", std::process::id()));
        let listener = UnixListener::bind(&path).unwrap();
        let mut bus = SerialLineBus::connect(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let (mut other, _) = listener.accept().unwrap();
        let frame = TrackRequest { session: 0xC0DB, first: 0xC0, count: 9 }.encode();
        assert_eq!(bus.send(&frame), Sent::Away);
        let mut bytes = [0; 64];
        let read = other.read(&mut bytes).unwrap();
        assert_eq!(bus.receive(), None);
        // Two frames, the second one in two pieces.
        other.write_all(&[&bytes[..read], &bytes[..3]].concat()).unwrap();
        assert!(bus.wait(Duration::from_secs(10)));
        assert_eq!((bus.receive(), bus.receive()), (Some(WireFrame::from(&frame)), None));
        other.write_all(&bytes[3..read]).unwrap();
        assert_eq!((bus.receive(), bus.is_closed()), (Some(WireFrame::from(&frame)), false));
        drop(other);
        assert_eq!((bus.receive(), bus.is_closed()), (None, true));
        assert_eq!(bus.send(&frame), Sent::Down);
    }

    #[test]
    fn a_line_that_nobody_listens_at_is_one_line() {
        let why = SerialLineBus::connect(Path::new("/no/such/line")).unwrap_err().to_string();
        assert!(why.contains("/no/such/line") && why.lines().count() == 1, "{why}");
    }
}
