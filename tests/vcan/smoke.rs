//! What every test over SocketCAN rests on: a virtual interface carries classical and FD frames
//! between sockets, in order and unchanged, and can-utils sees the same.

use std::fmt::Write as _;
use std::time::Duration;

use crate::interface::{self, Candump, Interface};
use socketcan::id::FdFlags;
use socketcan::{
    CanAnyFrame, CanDataFrame, CanFdFrame, CanFdSocket, EmbeddedFrame, Frame, Socket,
    SocketOptions, StandardId,
};

fn open(interface: &Interface) -> CanFdSocket {
    let socket = CanFdSocket::open(interface).expect("a CAN socket");
    socket.set_read_timeout(Duration::from_secs(10)).expect("a read limit");
    socket
}

fn classical(id: u16, data: &[u8]) -> CanDataFrame {
    let id = StandardId::new(id).expect("11 bits");
    CanDataFrame::new(id, data).expect("8 bytes at most")
}

fn fd(id: u16, data: &[u8]) -> CanFdFrame {
    let id = StandardId::new(id).expect("11 bits");
    CanFdFrame::with_flags(id, data, FdFlags::BRS).expect("a length that FD knows")
}

/// As `cansend` spells it: identifier, `#`, data; `##` and 1 for bit-rate switch in FD.
///
/// Without FDF: newer kernels set that flag in every FD frame that they hand out, older ones do
/// not.
fn spelled(frame: &CanAnyFrame) -> String {
    let CanAnyFrame::Fd(frame) = frame else { return format!("{frame:X}") };
    let flags = (frame.flags() - FdFlags::FDF).bits();
    let mut text = format!("{:03X}##{flags:X}", frame.raw_id());
    for byte in frame.data() {
        write!(text, "{byte:02X}").expect("a string takes it");
    }
    text
}

#[test]
fn a_classical_frame_arrives_at_the_other_socket_and_not_at_its_own() {
    let Some(interface) = interface::interface() else { return };
    let (sender, receiver) = (open(&interface), open(&interface));
    sender.set_recv_own_msgs(false).unwrap();
    sender.write_frame(&classical(0x123, &[1, 2, 3, 4, 5, 6, 7, 8])).unwrap();
    assert_eq!(spelled(&receiver.read_frame().unwrap()), "123#0102030405060708");
    sender.set_nonblocking(true).unwrap();
    assert_eq!(sender.read_frame().unwrap_err().kind(), std::io::ErrorKind::WouldBlock);
}

#[test]
fn an_fd_frame_keeps_its_sixteen_bytes_and_its_bit_rate_switch() {
    let Some(interface) = interface::interface() else { return };
    let (sender, receiver) = (open(&interface), open(&interface));
    let data: Vec<u8> = (0xf0..=0xff).collect();
    sender.write_frame(&fd(0x7ff, &data)).unwrap();
    let CanAnyFrame::Fd(frame) = receiver.read_frame().unwrap() else { panic!("not FD") };
    assert!(frame.is_brs() && !frame.is_esi());
    assert_eq!(frame.data(), data);
}

#[test]
fn a_thousand_frames_arrive_in_the_order_they_were_sent() {
    let Some(interface) = interface::interface() else { return };
    let (sender, receiver) = (open(&interface), open(&interface));
    // A receive queue takes a hundred frames or more: ten at a time lose none.
    for burst in 0..100_u16 {
        let counts = || burst * 10..burst * 10 + 10;
        for count in counts() {
            sender.write_frame(&classical(0x100, &count.to_be_bytes())).unwrap();
        }
        for count in counts() {
            assert_eq!(spelled(&receiver.read_frame().unwrap()), format!("100#{count:04X}"));
        }
    }
}

#[test]
fn candump_records_both_kinds_and_its_log_reads_back() {
    let Some(interface) = interface::interface() else { return };
    let candump = Candump::start(&interface);
    let sender = open(&interface);
    sender.write_frame(&classical(0x0a1, &[0xde, 0xad])).unwrap();
    sender.write_frame(&fd(0x0a2, &[0x5a; 16])).unwrap();
    let log = candump.stop();
    let frames: Vec<_> = log.iter().map(spelled).collect();
    assert_eq!(frames, ["0A1#DEAD".to_owned(), format!("0A2##1{}", "5A".repeat(16))]);
}

#[test]
fn what_cansend_sends_is_what_we_receive() {
    let Some(interface) = interface::interface() else { return };
    let receiver = open(&interface);
    interface::cansend(&interface, "2B0#C0FFEE");
    interface::cansend(&interface, "2B1##100112233");
    assert_eq!(spelled(&receiver.read_frame().unwrap()), "2B0#C0FFEE");
    assert_eq!(spelled(&receiver.read_frame().unwrap()), "2B1##100112233");
}

#[test]
fn the_command_starts_in_this_machine() {
    let Some(_interface) = interface::interface() else { return };
    let output = interface::yawbench().arg("--help").output().unwrap();
    assert!(output.status.success(), "{output:?}");
}
