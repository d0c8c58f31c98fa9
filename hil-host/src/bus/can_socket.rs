//! A raw `SocketCAN` socket on a CAN interface of Linux, real or virtual.
//!
//! - Kernel filters let through exactly the ids that are wanted, data frames only.
//! - Nothing but [`CanSocket::wait`] blocks, and the send buffer holds a few frames: the kernel's
//!   queues would otherwise deliver commands that are milliseconds old. What does not fit is
//!   dropped, counted and not retried.
//! - To wait is to read: the frame that ends a wait is kept for [`CanSocket::receive`], so that a
//!   round trip in lock-step is two system calls on either side, as in any echo pair.
//! - The kernel counts what it had to drop on the way in (`SO_RXQ_OVFL`) and delivers the number
//!   with the next frame.
//! - Error frames of the controller are counted. A virtual interface has none; it has no bit rate,
//!   no arbitration and no bus load either.
//!
//! FD frames go out with bit-rate switch. On an interface that is not set up for FD the kernel
//! refuses them, which [`CanSocket::open`] reports in advance.

use super::error::BusError;
use super::raw_frame::RawFrame;
use super::{BusCounters, Sent};
use dbc::CanId;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, send};
use nodes::MAX_BYTES;
use socketcan::{CanFdSocket, CanFilter, Socket, SocketOptions};
use std::io::{self, IoSliceMut};
use std::os::fd::{AsFd, AsRawFd};
use std::time::{Duration, Instant};

/// Bytes asked for the send buffer. The kernel doubles the number and charges somewhat under 1 kB
/// per frame: room for about ten frames, what a rig sends in two cycles.
const SEND_BUFFER_BYTES: i32 = 4096;

/// Bytes of a frame as the kernel hands it over, classical and FD.
const CLASSICAL_BYTES: usize = 16;
const FD_BYTES: usize = 72;

/// Room for one 32-bit control message: 16 bytes of header and the number, aligned.
const CONTROL_BYTES: usize = 64;

/// A socket on a CAN interface.
#[derive(Debug)]
pub(crate) struct CanSocket {
    socket: CanFdSocket,
    counters: BusCounters,
    /// The kernel's drop counter as last delivered, modulo 2^32.
    overflow: u32,
    opened: Instant,
    /// What ended a wait and was not received yet.
    arrived: Option<Arrived>,
    /// The longest read that the kernel was told.
    read_limit: Duration,
}

impl CanSocket {
    /// Opens an interface for the frames that are to be received.
    ///
    /// # Errors
    /// The kernel has no CAN, or the interface does not exist, is down, or takes no FD frames that
    /// it is to take.
    pub(crate) fn open(
        interface: &str,
        accept: impl IntoIterator<Item = CanId>,
        takes_fd: bool,
    ) -> Result<Self, BusError> {
        let refused = |error| BusError::Refused { interface: interface.to_owned(), error };
        let socket = CanFdSocket::open(interface).map_err(|error| explain(interface, error))?;
        check_interface(interface, takes_fd)?;
        set_up(&socket, accept).map_err(refused)?;
        Ok(Self {
            socket,
            counters: BusCounters::default(),
            overflow: 0,
            opened: Instant::now(),
            arrived: None,
            read_limit: Duration::ZERO,
        })
    }

    /// Reads one frame of any kind.
    fn read(&mut self, flags: MsgFlags) -> Result<Arrived, Errno> {
        let mut buffer = [0_u8; FD_BYTES];
        let mut control = [0_u8; CONTROL_BYTES];
        let mut parts = [IoSliceMut::new(&mut buffer)];
        let message =
            recvmsg::<()>(self.socket.as_raw_fd(), &mut parts, Some(&mut control), flags)?;
        let bytes = message.bytes;
        for part in message.cmsgs().into_iter().flatten() {
            if let ControlMessageOwned::RxqOvfl(total) = part {
                self.counters.receive_dropped += u64::from(total.wrapping_sub(self.overflow));
                self.overflow = total;
            }
        }
        Ok(Arrived::parse(&buffer, bytes))
    }
}

impl CanSocket {
    /// Hands a frame to the kernel at once, or drops it.
    pub(crate) fn send(&mut self, frame: &RawFrame) -> Sent {
        let (buffer, bytes) = kernel_frame(frame);
        let bytes = buffer.get(..bytes).unwrap_or(&buffer);
        match send(self.socket.as_raw_fd(), bytes, MsgFlags::MSG_DONTWAIT) {
            Ok(_) => {
                self.counters.sent += 1;
                Sent::Away
            }
            Err(error) => {
                self.counters.send_dropped += 1;
                match error {
                    Errno::ENETDOWN | Errno::ENODEV | Errno::ENXIO => Sent::Down,
                    _ => Sent::Dropped,
                }
            }
        }
    }

    /// The oldest frame not yet taken. Never waits.
    pub(crate) fn receive(&mut self) -> Option<RawFrame> {
        // Bounded: as many foreign frames as there may be, the caller gets back to its cycle.
        for _ in 0..MOST_SKIPPED {
            let arrived = match self.arrived.take() {
                Some(arrived) => arrived,
                None => self.read(MsgFlags::MSG_DONTWAIT).ok()?,
            };
            match arrived {
                Arrived::Frame(frame) => {
                    self.counters.received += 1;
                    return Some(frame);
                }
                Arrived::Error => self.counters.error_frames += 1,
                Arrived::Foreign => {}
            }
        }
        None
    }

    /// Waits until a frame may be there; false when the time has passed.
    pub(crate) fn wait(&mut self, timeout: Duration) -> bool {
        if self.arrived.is_some() {
            return true;
        }
        let mut flags = MsgFlags::MSG_DONTWAIT;
        if timeout >= LONG && self.limits_read(timeout) {
            flags = MsgFlags::empty();
        } else if !timeout.is_zero() {
            let timeout = PollTimeout::try_from(timeout).unwrap_or(PollTimeout::MAX);
            let mut sockets = [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)];
            if !matches!(poll(&mut sockets, timeout), Ok(1..)) {
                return false;
            }
        }
        match self.read(flags) {
            Ok(arrived) => self.arrived = Some(arrived),
            Err(Errno::EAGAIN | Errno::EINTR) => return false,
            // An interface that went down, for one: whoever sends is told of it.
            Err(_) => {}
        }
        true
    }

    /// Tells the kernel how long a read may take at most, where that has changed; false where it
    /// takes no such limit.
    fn limits_read(&mut self, limit: Duration) -> bool {
        if self.read_limit != limit {
            if self.socket.set_read_timeout(limit).is_err() {
                return false;
            }
            self.read_limit = limit;
        }
        true
    }

    /// Time since it was opened.
    pub(crate) fn time(&self) -> Duration {
        self.opened.elapsed()
    }

    /// What went over it so far.
    pub(crate) const fn counters(&self) -> BusCounters {
        self.counters
    }
}

/// A frame as the kernel takes it, `struct can_frame` or `canfd_frame`, and how many bytes that is.
fn kernel_frame(frame: &RawFrame) -> ([u8; FD_BYTES], usize) {
    let mut buffer = [0; FD_BYTES];
    let id = match frame.id() {
        CanId::Standard(id) => u32::from(id),
        CanId::Extended(id) => id | libc::CAN_EFF_FLAG,
    };
    let data = frame.data();
    let [a, b, c, d, len, flags, _, _, payload @ ..] = &mut buffer;
    for (to, from) in [a, b, c, d].into_iter().zip(id.to_ne_bytes()) {
        *to = from;
    }
    *len = data.len() as u8;
    payload.iter_mut().zip(data).for_each(|(to, from)| *to = *from);
    if frame.is_fd() {
        *flags = libc::CANFD_BRS as u8;
        return (buffer, FD_BYTES);
    }
    (buffer, CLASSICAL_BYTES)
}

/// Error frames that one call of `receive` passes over.
const MOST_SKIPPED: u32 = 64;

/// Waits from here on are limited reads, whose limit the kernel rounds up to its ticks of some
/// milliseconds. For a shorter one it is asked first.
const LONG: Duration = Duration::from_millis(40);

/// What the kernel handed over.
#[derive(Debug, PartialEq, Eq)]
enum Arrived {
    Frame(RawFrame),
    Error,
    /// A remote request or a length that is none: the filters let none through.
    Foreign,
}

impl Arrived {
    /// `struct can_frame` or `canfd_frame`: id with flags, length, flags, two spare, payload.
    fn parse(buffer: &[u8; FD_BYTES], bytes: usize) -> Self {
        let [a, b, c, d, len, _flags, _, _, payload @ ..] = buffer;
        let id = u32::from_ne_bytes([*a, *b, *c, *d]);
        if id & libc::CAN_ERR_FLAG != 0 {
            return Self::Error;
        }
        let fd = bytes == FD_BYTES;
        let data = payload.get(..usize::from(*len).min(MAX_BYTES));
        let is_remote = id & libc::CAN_RTR_FLAG != 0;
        let id = if id & libc::CAN_EFF_FLAG == 0 {
            CanId::Standard((id & libc::CAN_SFF_MASK) as u16)
        } else {
            CanId::Extended(id & libc::CAN_EFF_MASK)
        };
        match data.and_then(|data| RawFrame::new(id, fd, data)) {
            Some(frame) if !is_remote && (fd || bytes == CLASSICAL_BYTES) => Self::Frame(frame),
            _ => Self::Foreign,
        }
    }
}

fn set_up(socket: &CanFdSocket, accept: impl IntoIterator<Item = CanId>) -> io::Result<()> {
    // Without the two flags in the mask, other kinds of frames would pass as well.
    let flags = libc::CAN_EFF_FLAG | libc::CAN_RTR_FLAG;
    let filters: Vec<CanFilter> = accept
        .into_iter()
        .map(|id| match id {
            CanId::Standard(id) => CanFilter::new(u32::from(id), libc::CAN_SFF_MASK | flags),
            CanId::Extended(id) => {
                CanFilter::new(id | libc::CAN_EFF_FLAG, libc::CAN_EFF_MASK | flags)
            }
        })
        .collect();
    socket.set_filters(&filters)?;
    socket.set_error_filter_accept_all()?;
    socket.set_socket_option_int(libc::SOL_SOCKET, libc::SO_SNDBUF, SEND_BUFFER_BYTES)?;
    socket.set_socket_option_int(libc::SOL_SOCKET, libc::SO_RXQ_OVFL, 1)
}

/// Whether the interface is up and its frames are long enough, as `/sys` shows it; an interface
/// that is not to be seen there is taken as it is.
fn check_interface(interface: &str, takes_fd: bool) -> Result<(), BusError> {
    let read = |name: &str| std::fs::read_to_string(format!("/sys/class/net/{interface}/{name}"));
    let flags = read("flags")
        .ok()
        .and_then(|text| u32::from_str_radix(text.trim().trim_start_matches("0x"), 16).ok());
    if flags.is_some_and(|flags| flags & libc::IFF_UP as u32 == 0) {
        return Err(BusError::Down { interface: interface.to_owned() });
    }
    let mtu = read("mtu").ok().and_then(|text| text.trim().parse::<usize>().ok());
    if takes_fd && mtu.is_some_and(|mtu| mtu < FD_BYTES) {
        return Err(BusError::NotFd { interface: interface.to_owned() });
    }
    Ok(())
}

fn explain(interface: &str, error: io::Error) -> BusError {
    let interface = interface.to_owned();
    match error.raw_os_error().map(Errno::from_raw) {
        Some(Errno::EAFNOSUPPORT | Errno::EPROTONOSUPPORT) => BusError::NoCan,
        Some(Errno::ENODEV | Errno::ENXIO) => {
            // Names are looked up before the socket is made: a kernel without CAN ends here too.
            if has_can() { BusError::NoInterface { interface } } else { BusError::NoCan }
        }
        _ => BusError::Refused { interface, error },
    }
}

/// Whether this kernel makes CAN sockets.
fn has_can() -> bool {
    // Any interface number does: only the address family is asked about.
    match CanFdSocket::open_iface(0) {
        Ok(_) => true,
        Err(error) => error.raw_os_error() != Some(libc::EAFNOSUPPORT),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(id: u32, len: u8, payload: &[u8]) -> [u8; FD_BYTES] {
        let mut buffer = [0; FD_BYTES];
        buffer[..4].copy_from_slice(&id.to_ne_bytes());
        buffer[4] = len;
        buffer[8..8 + payload.len()].copy_from_slice(payload);
        buffer
    }

    #[test]
    fn frames_are_written_as_they_are_read() {
        for (id, fd, data) in [
            (CanId::Standard(0x101), false, &[1, 2, 3][..]),
            (CanId::Standard(0x7FF), false, &[]),
            (CanId::Standard(0x211), true, &[7; 64]),
            (CanId::Extended(0x18FF_0301), false, &[9; 8]),
        ] {
            let frame = RawFrame::new(id, fd, data).unwrap();
            let (buffer, bytes) = kernel_frame(&frame);
            assert_eq!(Arrived::parse(&buffer, bytes), Arrived::Frame(frame));
            assert_eq!(buffer[5], u8::from(fd), "the bit-rate switch");
        }
    }

    #[test]
    fn frames_are_read_by_kind_and_everything_else_is_told_apart() {
        let standard = |id, fd, data: &[u8]| {
            Arrived::Frame(RawFrame::new(CanId::Standard(id), fd, data).unwrap())
        };
        let classical = Arrived::parse(&raw(0x101, 3, &[1, 2, 3]), CLASSICAL_BYTES);
        assert_eq!(classical, standard(0x101, false, &[1, 2, 3]));
        let fd = Arrived::parse(&raw(0x211, 16, &[7; 16]), FD_BYTES);
        assert_eq!(fd, standard(0x211, true, &[7; 16]));
        let long = Arrived::parse(&raw(0x211, 64, &[7; 64]), FD_BYTES);
        assert_eq!(long, standard(0x211, true, &[7; 64]));
        let extended = Arrived::parse(&raw(libc::CAN_EFF_FLAG | 0x101, 0, &[]), CLASSICAL_BYTES);
        let wanted = RawFrame::new(CanId::Extended(0x101), false, &[]).unwrap();
        assert_eq!(extended, Arrived::Frame(wanted));
        let bus_off = raw(libc::CAN_ERR_FLAG | 0x40, 8, &[]);
        assert_eq!(Arrived::parse(&bus_off, CLASSICAL_BYTES), Arrived::Error);
        let remote = raw(libc::CAN_RTR_FLAG | 0x101, 0, &[]);
        assert_eq!(Arrived::parse(&remote, CLASSICAL_BYTES), Arrived::Foreign);
        for length in [0, 8, 15, 17] {
            assert_eq!(Arrived::parse(&raw(0x101, 8, &[]), length), Arrived::Foreign);
        }
    }

    #[test]
    fn an_interface_that_is_not_there_is_one_clear_line() {
        let error = CanSocket::open("no-such-can", [], false).unwrap_err();
        assert!(matches!(error, BusError::NoCan | BusError::NoInterface { .. }), "{error:?}");
        let text = error.to_string();
        assert!(text.contains("modprobe vcan") && !text.contains('\n'), "{text}");
    }
}
