//! Who else is on the bus: a second host, a second rig, a rig that starts anew, an old log. Each is
//! a process of its own on a real SocketCAN interface; `hil-host/tests/bench/second_sender.rs` has
//! the same in virtual time, with exact cycles.

use crate::interface::{Candump, Interface};
use crate::opened::Opened;
use crate::rig::{
    COMMAND, LOCK_STEP_RIG, MEASUREMENT, Rig, alone, hear, host, listener, out, parts, resume,
    summary, suspend,
};
use can_protocol::{Message, MessageId, Node, RunState, Sender};
use serde_json::Value;
use socketcan::{CanAnyFrame, CanFdSocket, Socket};
use std::path::Path;
use std::process::{Child, Output, Stdio};

/// A rig that stays when its host has gone.
const PATIENT_RIG: &[&str] = &["--fifo-priority", "0"];

/// What a rig sends every 20 cycles.
const HEARTBEAT: MessageId = MessageId::Heartbeat(Sender::Rig(Node::ALL[0]));

/// What a rig sends when it goes safe by itself.
const FAULT: MessageId = MessageId::Fault(Sender::Rig(Node::ALL[0]));

/// Largest step of a command at the default limit of 0.5 m/s, with the last digit of a frame, m.
const STEP_M: f64 = 0.5e-3 + 0.1e-3;

fn start(interface: &Interface, seconds: &str, folder: &Path) -> Child {
    let bus = format!("socketcan:{interface}");
    host(&bus, seconds, folder, &["--pace", "lockstep", "--overwrite"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the host")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The summary of a host, which has to end in the safe state.
fn ended_safe(host: Child) -> Value {
    let host = host.wait_with_output().expect("the host");
    let end = summary(&host);
    assert_eq!((host.status.code(), &end["state"]), (Some(3), &"safe".into()), "{end}");
    end
}

/// Displacements in the measurements of the first session in a log, m.
fn displacements_m(frames: &[CanAnyFrame]) -> Vec<f64> {
    let mut opened = Opened::default();
    let messages = frames.iter().filter_map(parts);
    let messages = messages.filter_map(|(id, data)| opened.hear(id, &data));
    let measured = messages.filter_map(|message| match message {
        Message::Measurement(measured) => measured.displacement_m,
        _ => None,
    });
    measured.collect()
}

/// The ram never moved further in a cycle than a command may.
fn assert_no_jump(frames: &[CanAnyFrame]) {
    let displacements_m = displacements_m(frames);
    assert!(displacements_m.len() > 500, "{} measurements", displacements_m.len());
    for pair in displacements_m.windows(2) {
        let step_m = (pair[1] - pair[0]).abs();
        assert!(step_m <= STEP_M, "the ram jumped by {step_m} m");
    }
}

#[test]
fn a_second_host_commands_nothing_and_says_why() {
    let Some((vcan, _turn)) = alone() else { return };
    let _rig = Rig::start(&vcan, PATIENT_RIG);
    let candump = Candump::start(&vcan);
    let socket = listener(&vcan);
    let folders = ["first-host", "second-host"].map(|name| out(&vcan, name));
    let first = start(&vcan, "60", &folders[0]);
    assert_eq!(hear(&socket, MEASUREMENT, 500).len(), 500, "the run did not start");
    let second = start(&vcan, "2", &folders[1]).wait_with_output().expect("the second host");
    let text = said(&second);
    assert_eq!(second.status.code(), Some(3), "{text}");
    // Its SYNC is that of another host: the rig is safe at once, and is not armed by the second,
    // which may hear of it from the rig's heartbeat or from its answer.
    let is_latched = ["latched in SAFE", "the rig refused: STATE"].map(|why| text.contains(why));
    assert!(is_latched.contains(&true), "{text}");
    let first = first.wait_with_output().expect("the first host");
    let first = summary(&first);
    assert_eq!(first["state"], "safe", "{first}");
    println!("the first host: {}", first["cause"]["message"]);
    assert_no_jump(&candump.stop());
    for folder in folders {
        let _ = std::fs::remove_dir_all(folder);
    }
}

#[test]
fn two_rigs_under_one_number_are_not_armed() {
    let Some((vcan, _turn)) = alone() else { return };
    let _rigs = [Rig::start(&vcan, PATIENT_RIG), Rig::start(&vcan, PATIENT_RIG)];
    let candump = Candump::start(&vcan);
    let folder = out(&vcan, "two-rigs");
    let refused = start(&vcan, "2", &folder).wait_with_output().expect("the host");
    let text = said(&refused);
    assert_eq!(refused.status.code(), Some(3), "{text}");
    println!("two rigs: {text}");
    let frames = candump.stop();
    let commands = frames.iter().filter_map(parts).filter(|(id, _)| *id == COMMAND.raw());
    assert_eq!(commands.count(), 0, "rigs were commanded");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_rig_that_starts_anew_in_mid_run_is_not_moved_again() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, PATIENT_RIG);
    let socket = listener(&vcan);
    let folder = out(&vcan, "new-rig");
    let host = start(&vcan, "60", &folder);
    assert_eq!(hear(&socket, MEASUREMENT, 500).len(), 500, "the run did not start");
    drop(rig);
    let candump = Candump::start(&vcan);
    let _new = Rig::start(&vcan, PATIENT_RIG);
    let end = ended_safe(host);
    println!("a new rig: {}", end["cause"]["message"]);
    // The new rig has answered no command of the old session.
    let frames = candump.stop();
    let mut states =
        frames.iter().filter_map(parts).filter_map(|(id, data)| match Message::decode(id, &data) {
            Ok(Message::Heartbeat(rig)) if id == HEARTBEAT.raw() => Some(rig.state),
            _ => None,
        });
    assert!(states.all(|state| matches!(state, RunState::Init | RunState::Standby)));
    let measured = frames.iter().filter_map(parts).filter(|(id, _)| *id == MEASUREMENT.raw());
    assert_eq!(measured.count(), 0, "the new rig measured in a session that it does not know");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_rig_that_stands_still_and_goes_on_is_not_moved_again() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, PATIENT_RIG);
    let (candump, socket) = (Candump::start(&vcan), listener(&vcan));
    let folder = out(&vcan, "stopped-rig");
    let host = start(&vcan, "60", &folder);
    assert_eq!(hear(&socket, MEASUREMENT, 500).len(), 500, "the run did not start");
    suspend(rig.id());
    let end = ended_safe(host);
    println!("a rig that stands still: {}", end["cause"]["message"]);
    // Awake again, it takes what the host has sent last, or finds no host.
    resume(rig.id());
    let mut states = std::iter::repeat_with(|| hear(&socket, HEARTBEAT, 1)).take(200);
    let stopped = states.find_map(|data| {
        let Message::Heartbeat(rig) = Message::decode(HEARTBEAT.raw(), data.first()?).ok()? else {
            return None;
        };
        (!matches!(rig.state, RunState::RampIn | RunState::Run)).then_some(rig.state)
    });
    assert_eq!(stopped, Some(RunState::Safe));
    assert_no_jump(&candump.stop());
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_host_that_stands_still_finds_its_rig_safe_and_ends() {
    let Some((vcan, _turn)) = alone() else { return };
    let _rig = Rig::start(&vcan, PATIENT_RIG);
    let (candump, socket) = (Candump::start(&vcan), listener(&vcan));
    let folder = out(&vcan, "stopped-host");
    let host = start(&vcan, "60", &folder);
    assert_eq!(hear(&socket, MEASUREMENT, 500).len(), 500, "the run did not start");
    suspend(host.id());
    assert_eq!(hear(&socket, FAULT, 1).len(), 1, "the rig did not go safe");
    resume(host.id());
    let end = ended_safe(host);
    println!("a host that stood still: {}", end["cause"]["message"]);
    assert_no_jump(&candump.stop());
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_log_that_is_played_again_moves_no_ram() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let candump = Candump::start(&vcan);
    let folder = out(&vcan, "replayed");
    let sound = start(&vcan, "1", &folder).wait_with_output().expect("the host");
    assert_eq!(sound.status.code(), Some(0), "{}", said(&sound));
    rig.end();
    let log = candump.stop();
    // The same rig, started again, and whatever the host had sent to it.
    let _rig = Rig::start(&vcan, PATIENT_RIG);
    let socket = listener(&vcan);
    let after = Candump::start(&vcan);
    let player = CanFdSocket::open(&vcan).expect("a CAN socket");
    let from_host = |frame: &&CanAnyFrame| {
        let id = parts(frame).map(|(id, _)| id);
        id.is_some_and(|id| matches!(id, 0x080 | 0x101 | 0x601 | 0x700))
    };
    let mut count = 0;
    for frame in log.iter().filter(from_host) {
        let CanAnyFrame::Normal(frame) = frame else { continue };
        player.write_frame(frame).expect("room on the bus");
        count += 1;
    }
    assert!(count > 3000, "{count} frames played");
    assert_eq!(hear(&socket, HEARTBEAT, 3).len(), 3, "the rig is silent");
    for (id, data) in after.stop().iter().filter_map(parts) {
        assert_ne!(id, MEASUREMENT.raw(), "the rig answered an old command");
        if let Ok(Message::Heartbeat(rig)) = Message::decode(id, &data)
            && id == HEARTBEAT.raw()
        {
            let is_idle = matches!(rig.state, RunState::Init | RunState::Standby);
            assert!(is_idle, "an old log brought the rig to {}", rig.state.name());
        }
    }
    let _ = std::fs::remove_dir_all(folder);
}
