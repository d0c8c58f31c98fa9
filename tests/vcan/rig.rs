//! Host and rig as two processes on a real SocketCAN interface.

use crate::interface::{Candump, Interface, cansend, interface, slow_down, yawbench};
use crate::opened::Opened;
use crate::record::Record;
use can_protocol::{Fault, Measurement, Message, MessageId, Node, Profile, RunState, Sender};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use socketcan::{CanAnyFrame, CanFdSocket, EmbeddedFrame, Id, Socket, SocketOptions};
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Tests of this file take turns: paced processes must not share a processor with others.
static TURN: Mutex<()> = Mutex::new(());

/// An interface, with exclusive use of the machine.
pub(crate) fn alone() -> Option<(Interface, MutexGuard<'static, ()>)> {
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    interface().map(|interface| (interface, turn))
}

/// Without a clock nothing needs the real-time scheduler, and candump is to keep up.
pub(crate) const LOCK_STEP_RIG: &[&str] = &["--exit-after-run", "--fifo-priority", "0"];

/// A rig process that dies with the test.
pub(crate) struct Rig(Option<Child>);

impl Rig {
    pub(crate) fn start(interface: &Interface, args: &[&str]) -> Self {
        let mut command = yawbench();
        // The rig with the damper of the scenarios, as the README starts it.
        command.arg("rig").arg(scenario("rigs/laboratory-rig.toml"));
        command.args(["--json", "--bus"]).arg(format!("socketcan:{interface}")).args(args);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the rig");
        Self(Some(child))
    }

    pub(crate) fn id(&self) -> u32 {
        self.0.as_ref().expect("a running rig").id()
    }

    /// Waits until it listens to its bus: who does not wait for an answer calls this first.
    pub(crate) fn wait_until_it_listens(&mut self) {
        let said = self.0.as_mut().and_then(|rig| rig.stderr.as_mut()).expect("its messages");
        let (mut line, mut byte) = (Vec::new(), [0]);
        while !line.ends_with(b"waiting for a host\n") {
            said.read_exact(&mut byte).expect("a rig that starts");
            line.push(byte[0]);
        }
    }

    /// Interrupts it; gives its summary.
    pub(crate) fn interrupt(self) -> Value {
        signal(self.id(), Signal::INT);
        self.end().1
    }

    /// Waits for its end; gives exit code and summary.
    pub(crate) fn end(mut self) -> (Option<i32>, Value) {
        let output =
            self.0.take().expect("a running rig").wait_with_output().expect("the rig's end");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let summary =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {text}"));
        (output.status.code(), summary)
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name)
}

pub(crate) fn out(interface: &str, name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("yawbench-{interface}-{name}"))
}

pub(crate) fn host(bus: &str, seconds: &str, out: &Path, args: &[&str]) -> Command {
    host_of("ss9-160kmh.toml", bus, seconds, out, args)
}

/// The same with another scenario.
pub(crate) fn host_of(name: &str, bus: &str, seconds: &str, out: &Path, args: &[&str]) -> Command {
    let mut command = yawbench();
    command.arg("run").arg(scenario(name));
    command.args(["--json", "--duration", seconds, "--bus", bus, "--out"]).arg(out).args(args);
    command.arg("--arm");
    command
}

pub(crate) fn summary(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The run is computed again from its files, bit for bit.
pub(crate) fn assert_replays(folder: &Path) {
    let replay = yawbench().arg("replay").arg(folder).output().expect("replay");
    let said = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(replay.status.success(), "{said}{}", String::from_utf8_lossy(&replay.stderr));
    assert!(said.contains("are the same, bit for bit"), "{said}");
}

/// The hash of the same run with the rig in memory.
fn hash_in_memory(interface: &str, seconds: &str) -> Value {
    let folder = out(interface, "memory");
    let output = host("memory", seconds, &folder, &["--pace", "fast"]).output().expect("the host");
    let summary = summary(&output);
    let _ = std::fs::remove_dir_all(folder);
    summary["trajectory_hash"].clone()
}

/// The frames of every id, in order, as text.
type ById = BTreeMap<u16, Vec<Vec<u8>>>;

fn of_candump(frames: &[CanAnyFrame]) -> ById {
    let mut by_id = ById::new();
    for frame in frames {
        let (id, data) = parts(frame).expect("only our frames are on this bus");
        by_id.entry(id).or_default().push(data);
    }
    by_id
}

/// How many frames of an id there are.
fn of_candump_id(by_id: &ById, id: MessageId) -> u64 {
    by_id.get(&id.raw()).map_or(0, |frames| frames.len() as u64)
}

pub(crate) fn parts(frame: &CanAnyFrame) -> Option<(u16, Vec<u8>)> {
    let (id, data) = match frame {
        CanAnyFrame::Normal(frame) => (frame.id(), frame.data().to_vec()),
        CanAnyFrame::Fd(frame) => (frame.id(), frame.data().to_vec()),
        _ => return None,
    };
    match id {
        Id::Standard(id) => Some((id.as_raw(), data)),
        Id::Extended(_) => None,
    }
}

fn of_bus_log(path: &Path) -> ById {
    let mut by_id = ById::new();
    for line in std::fs::read_to_string(path).expect("bus.log").lines() {
        let frame = line.split(' ').nth(2).expect("a frame");
        let (id, data) = frame.split_once('#').expect("a frame");
        let data = data.strip_prefix('#').map_or(data, |fd| &fd[1..]);
        let byte = |at: usize| u8::from_str_radix(&data[at..at + 2], 16).expect("hex");
        let bytes = (0..data.len()).step_by(2).map(byte).collect();
        by_id.entry(u16::from_str_radix(id, 16).expect("hex")).or_default().push(bytes);
    }
    by_id
}

pub(crate) const COMMAND: MessageId = MessageId::Command(Profile::Classical, Node::ALL[0]);
pub(crate) const MEASUREMENT: MessageId = MessageId::Measurement(Profile::Classical, Node::ALL[0]);

#[test]
fn thirty_thousand_cycles_in_lock_step_lose_nothing_and_match_memory_bit_for_bit() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let candump = Candump::start(&vcan);
    let folder = out(&vcan, "lockstep");
    let bus = format!("socketcan:{vcan}");
    let output = host(&bus, "30", &folder, &["--pace", "lockstep"]).output().expect("the host");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let host = summary(&output);
    let (code, rig) = rig.end();
    let frames = candump.stop();
    let wire = of_candump(&frames);
    assert_eq!(code, Some(0), "{rig}");

    assert_eq!(host["steps"], 30_000);
    // Four fades of half a second.
    let cycles = host["cycles"].as_u64().expect("a count");
    assert_eq!(cycles, 32_000);
    assert_eq!(host["frames"]["sent"], cycles);
    assert_eq!(host["frames"]["received"], cycles);
    assert_eq!(host["frames"]["lost"], 0);
    // The first commands hold the armed ram and the last one ends the run: they are no cycles.
    let commands = of_candump_id(&wire, COMMAND);
    assert_eq!(rig["frames"]["received"], commands, "{rig}");
    assert!(commands >= cycles + 2, "{commands} commands");
    assert_eq!(rig["frames"]["lost"], 0);
    assert_eq!(host["trajectory_hash"], hash_in_memory(&vcan, "30"));

    // What candump saw is what we recorded, frame by frame, and every one of it decodes.
    let own = of_bus_log(&folder.join("bus.log"));
    for id in [COMMAND, MEASUREMENT] {
        let (wire, own) = (&wire[&id.raw()], &own[&id.raw()]);
        assert!(wire.len() >= 30_000, "{id}: {}", wire.len());
        assert_eq!(&wire[..own.len()], &own[..], "{id}");
    }
    let mut opened = Opened::default();
    for (id, data) in frames.iter().filter_map(parts) {
        assert!(opened.hear(id, &data).is_some(), "{id:03X}#{}", hex(&data));
    }
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn thirty_thousand_cycles_on_the_clock_account_for_every_frame() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, &["--exit-after-run"]);
    let folder = out(&vcan, "paced");
    let slow_down = slow_down().to_string();
    let bus = format!("socketcan:{vcan}");
    let output = host(&bus, "30", &folder, &["--pace", "realtime", "--slow-down", &slow_down])
        .output()
        .expect("the host");
    let host = summary(&output);
    let (_, rig) = rig.end();
    let number = |value: &Value| value.as_u64().expect("a count");
    println!(
        "paced, slow-down {slow_down}: cycle {} lateness {} skipped {} frames {} rig {}",
        host["cycle_time_us"], host["lateness_us"], host["overruns"], host["frames"], rig["frames"]
    );
    let sent = number(&host["frames"]["sent"]);
    assert_eq!(sent + number(&host["frames"]["late"]), number(&host["cycles"]));
    // A machine that withholds the processor makes both clocks skip ticks; nothing else may.
    let skipped = number(&host["overruns"]) + number(&rig["skipped"]);
    let dropped = number(&rig["send_dropped"]) + number(&host["bus_counters"]["receive_dropped"]);
    assert!(dropped == 0 || skipped > 0, "{dropped} frames dropped on an idle machine");
    if host["state"] == "completed" {
        assert_eq!(number(&host["steps"]), 30_000);
        // More: those that hold the armed ram, and the one that ends the run.
        assert!(number(&rig["frames"]["received"]) + number(&rig["frames"]["lost"]) >= sent + 2);
        // The rig measures on its own clock; its counters show that none went missing but those
        // that a full queue dropped and counted.
        let lost = number(&host["frames"]["lost"]);
        assert!(lost <= dropped, "{lost} measurements lost, {dropped} dropped");
        assert!(number(&host["frames"]["wrong_sequence"]) <= dropped);
        assert!(number(&host["bus_counters"]["received"]) <= number(&rig["sent"]));
    } else {
        // Five cycles in a row without the other side: four of them were skipped.
        let state = &host["state"];
        assert!(skipped >= 4, "{state} with {skipped} ticks skipped: {host} {rig}");
        println!("{state} after {} cycles with {skipped} ticks skipped", host["steps"]);
    }
    // However it ended: what was skipped, lost and late is in its files.
    assert_replays(&folder);
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_comparison_models_the_slot_of_a_rig_that_cannot_be_run_again() {
    let Some((vcan, _turn)) = alone() else { return };
    let folder = out(&vcan, "compared");
    std::fs::create_dir_all(&folder).expect("a folder");
    let example = std::fs::read_to_string(scenario("ss9-before-and-after.toml")).expect("a file");
    let vehicles = format!("\"{}", scenario("vehicles").display());
    let example = example.replace("\"vehicles", &vehicles);
    // Without ramps, so that both runs begin at the same place on the track.
    let example = example.replace("[[slot]]", "[motion]\nramp_s = 0.0\n[[slot]]");
    let (modelled, _) = example.split_once("[[slot]]").expect("a slot");
    let run = |name: &str, text: &str, args: &[&str]| {
        let file = folder.join(name);
        std::fs::write(&file, text).expect("a scenario");
        let mut command = yawbench();
        command.args(["run", "--json", "--arm", "--duration", "4"]).arg(&file).args(args);
        let out = folder.join(format!("out-{name}"));
        summary(&command.arg("--out").arg(out).output().expect("the host"))
    };
    let alike = run("modelled.toml", modelled, &["--pace", "fast"]);
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let bus = format!("socketcan:{vcan}");
    let host = run("rig.toml", &example, &["--pace", "lockstep", "--bus", &bus]);
    let (code, rig) = rig.end();
    assert_eq!(code, Some(0), "{rig}");
    // The rig carries a new damper, whatever the scenario says of an emulated one.
    assert_ne!(host["trajectory_hash"], alike["trajectory_hash"]);
    assert_eq!(host["comparison"]["modelled_instead"], serde_json::json!(["front left"]));
    assert_eq!(host["comparison"]["state"], "completed");
    assert_eq!(host["comparison"]["trajectory_hash"], alike["comparison"]["trajectory_hash"]);
    let _ = std::fs::remove_dir_all(folder);
}

/// Suspends a process and returns when it stands still.
pub(crate) fn suspend(process: u32) {
    signal(process, Signal::STOP);
    // The state is the field after the name in brackets.
    let is_suspended = || {
        let text = std::fs::read_to_string(format!("/proc/{process}/stat")).expect("its state");
        text.rsplit_once(')').is_some_and(|(_, behind)| behind.trim_start().starts_with('T'))
    };
    while !is_suspended() {
        std::thread::yield_now();
    }
}

/// Lets a suspended process run again.
pub(crate) fn resume(process: u32) {
    signal(process, Signal::CONT);
}

fn signal(process: u32, signal: Signal) {
    let pid = i32::try_from(process).ok().and_then(Pid::from_raw).expect("a process number");
    kill_process(pid, signal).expect("the right to signal it");
}

/// As Linux numbers them.
const SOL_SOCKET: i32 = 1;
const SO_RCVBUFFORCE: i32 = 33;

/// A socket that sees every frame.
pub(crate) fn listener(interface: &Interface) -> CanFdSocket {
    let socket = CanFdSocket::open(interface).expect("a CAN socket");
    socket.set_read_timeout(Duration::from_millis(200)).expect("a time limit");
    // Room for seconds of frames: a test that waits for the processor must not miss the newest.
    // Without the right to it the kernel's own size has to do.
    let _ = socket.set_socket_option_int(SOL_SOCKET, SO_RCVBUFFORCE, 16 << 20);
    socket
}

/// Frames of an id until there are enough. A host may take its time to start.
pub(crate) fn hear(socket: &CanFdSocket, id: MessageId, enough: usize) -> Vec<Vec<u8>> {
    let (begin, mut heard) = (Instant::now(), Vec::new());
    while heard.len() < enough && begin.elapsed() < Duration::from_secs(20) {
        let Ok(frame) = socket.read_frame() else { continue };
        heard.extend(parts(&frame).filter(|(raw, _)| *raw == id.raw()).map(|(_, data)| data));
    }
    heard
}

/// Frames that are on their way: until nothing comes for a while.
fn remaining(socket: &CanFdSocket) -> Vec<(u16, Vec<u8>)> {
    let frames = std::iter::from_fn(|| socket.read_frame().ok());
    frames.filter_map(|frame| parts(&frame)).collect()
}

pub(crate) fn hex(data: &[u8]) -> String {
    data.iter().fold(String::new(), |text, byte| text + &format!("{byte:02X}"))
}

#[test]
fn garbage_wrong_crc_and_old_frames_change_nothing_but_a_counter() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let folder = out(&vcan, "garbage");
    let socket = listener(&vcan);
    let bus = format!("socketcan:{vcan}");
    let host = host(&bus, "10", &folder, &["--pace", "lockstep"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the host");
    let mut history = hear(&socket, MEASUREMENT, 500);
    assert_eq!(history.len(), 500, "the run did not start");
    // Both are suspended: nothing on the bus can be newer than what was heard, and it does not
    // matter how long the rest takes.
    suspend(rig.id());
    suspend(host.id());
    let rest = remaining(&socket);
    let measured = rest.iter().filter(|(id, _)| *id == MEASUREMENT.raw());
    history.extend(measured.map(|(_, data)| data.clone()));
    let cyclic = [COMMAND.raw(), MEASUREMENT.raw()];
    let last_id = rest.iter().rev().map(|(id, _)| *id).find(|id| cyclic.contains(id));
    let [.., old, _, _, last] = history.as_slice() else { panic!("no history") };
    let (measurement, command) = (MEASUREMENT.raw(), COMMAND.raw());
    let mut broken = last.clone();
    broken[3] ^= 0x10;
    cansend(&vcan, &format!("{measurement:03X}#{}", hex(&broken)));
    cansend(&vcan, &format!("{measurement:03X}#{}", hex(old)));
    cansend(&vcan, &format!("{measurement:03X}#{}", hex(last)));
    cansend(&vcan, &format!("{measurement:03X}#0102"));
    cansend(&vcan, &format!("{command:03X}#DEADBEEF"));
    cansend(&vcan, "7AA#0011223344556677");
    let sent = hear(&socket, MEASUREMENT, 4);
    assert_eq!(sent.len(), 4, "the frames from outside");
    // The side that owes the next frame resumes first: the other one has waited for too long by its
    // own clock.
    if last_id == Some(COMMAND.raw()) {
        resume(rig.id());
        assert_eq!(hear(&socket, MEASUREMENT, 1).len(), 1, "the rig's answer");
        resume(host.id());
    } else {
        resume(host.id());
        assert_eq!(hear(&socket, COMMAND, 1).len(), 1, "the host's command");
        resume(rig.id());
    }
    let output = host.wait_with_output().expect("the host");
    let host = summary(&output);
    let (code, rig) = rig.end();
    assert_eq!((output.status.code(), code), (Some(0), Some(0)), "{host} {rig}");
    assert_eq!(host["frames"]["crc_errors"], 2);
    assert_eq!(host["frames"]["repeated"], 1);
    assert_eq!(host["frames"]["wrong_sequence"], 1);
    assert_eq!(host["frames"]["lost"], 0);
    assert_eq!(rig["frames"]["crc_errors"], 1, "{rig}");
    assert_eq!(host["trajectory_hash"], hash_in_memory(&vcan, "10"));
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_rig_whose_host_is_killed_goes_safe_within_five_cycles() {
    let Some((vcan, _turn)) = alone() else { return };
    // A host that met a standstill of the machine tells the rig to be safe before it is killed.
    let was_told = |rig: &Value| rig["safe_events"] == 0 && rig["skipped"].as_u64() > Some(0);
    let mut attempts = (0..5).map(|_| kill_the_host(&vcan));
    let undisturbed = attempts.find(|(_, rig, _)| !was_told(rig));
    let (code, rig, frames) = undisturbed.expect("the machine stood still in every attempt");
    assert_eq!(code, Some(3), "{rig}");
    assert_eq!(rig["safe_events"], 1, "{rig}");
    assert_eq!(cycles_to_safe(&frames), 5, "{rig}");
    let fault = MessageId::Fault(Sender::Rig(Node::ALL[0])).raw();
    let fault = frames
        .iter()
        .filter_map(parts)
        .any(|(id, data)| id == fault && Fault::decode(id, &data).is_ok());
    assert!(fault || rig["state"] == "SAFE", "{rig}");
}

/// A run on the clock whose host is killed: how the rig ends, and all frames.
fn kill_the_host(vcan: &Interface) -> (Option<i32>, Value, Vec<CanAnyFrame>) {
    let rig = Rig::start(vcan, &["--exit-after-run"]);
    let folder = out(vcan, "host-killed");
    let slow_down = slow_down().to_string();
    let bus = format!("socketcan:{vcan}");
    let candump = Candump::start(vcan);
    let socket = listener(vcan);
    let mut host = host(&bus, "60", &folder, &["--pace", "realtime", "--slow-down", &slow_down])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the host");
    assert_eq!(hear(&socket, MEASUREMENT, 100).len(), 100, "the run did not start");
    host.kill().expect("kill");
    host.wait().expect("the host's end");
    let (code, rig) = rig.end();
    println!("rig skipped {} of {} cycles", rig["skipped"], rig["cycles"]);
    let _ = std::fs::remove_dir_all(folder);
    (code, rig, candump.stop())
}

/// Cycles of the rig from the one that took the last command to the one that went safe, by its own
/// counters: how late either of them was on the clock does not matter.
fn cycles_to_safe(frames: &[CanAnyFrame]) -> u8 {
    let mut opened = Opened::default();
    let messages = frames.iter().filter_map(parts).filter_map(|(id, data)| opened.hear(id, &data));
    let measurements: Vec<Measurement> = messages
        .filter_map(|message| match message {
            Message::Measurement(measurement) => Some(measurement),
            _ => None,
        })
        .collect();
    let safe = measurements.iter().position(|m| m.state == RunState::Safe).expect("a safe rig");
    let before = measurements[..safe].iter().rposition(|m| m.echo != measurements[safe].echo);
    let taken = &measurements[before.map_or(0, |before| before + 1)];
    Profile::Classical.counter_steps(taken.counter, measurements[safe].counter)
}

#[test]
fn a_host_whose_rig_is_killed_goes_safe_within_five_cycles() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, &[]);
    let folder = out(&vcan, "rig-killed");
    let slow_down = slow_down().to_string();
    let bus = format!("socketcan:{vcan}");
    let socket = listener(&vcan);
    let host = host(&bus, "60", &folder, &["--pace", "realtime", "--slow-down", &slow_down])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the host");
    assert_eq!(hear(&socket, MEASUREMENT, 100).len(), 100, "the run did not start");
    drop(rig);
    let output = host.wait_with_output().expect("the host");
    let host = summary(&output);
    assert_eq!(output.status.code(), Some(3), "{host}");
    assert_eq!(host["state"], "safe");
    let record = Record::read(&folder.join("record.npy"));
    let fresh =
        (0..record.rows()).rfind(|row| record.integer(*row, "input", 0) == 1).expect("a force");
    let last = record.rows() - 1;
    // Five cycles of patience, the fifth of which trips, then the stop.
    assert_eq!(last - fresh, 5 + 200, "rows after the last force");
    assert_eq!(record.number(last, "command_m_per_s", 0), 0.0);
    let held = record.number(last, "command_m", 0);
    assert_eq!(held, record.number(last - 100, "command_m", 0), "it does not hold its position");
    for row in fresh..last {
        let step = (record.number(row + 1, "command_m_per_s", 0)
            - record.number(row, "command_m_per_s", 0))
        .abs();
        assert!(row < fresh + 5 || step <= 0.01 + 1e-12, "row {row}: a jump of {step} m/s");
    }
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_rig_that_went_safe_was_released_by_the_next_run() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, &["--fifo-priority", "0"]);
    let folder = out(&vcan, "latched");
    let socket = listener(&vcan);
    let bus = format!("socketcan:{vcan}");
    let run = |seconds: &str| {
        host(&bus, seconds, &folder, &["--pace", "lockstep", "--overwrite"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the host")
    };
    let reset = || {
        let mut command = yawbench();
        command.args(["rig-reset", "--node", "1", "--bus", &bus]).output().expect("the command")
    };
    let text = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    let mut killed = run("60");
    assert_eq!(hear(&socket, MEASUREMENT, 100).len(), 100, "the run did not start");
    killed.kill().expect("kill");
    killed.wait().expect("the host's end");
    let fault = MessageId::Fault(Sender::Rig(Node::ALL[0]));
    assert_eq!(hear(&socket, fault, 1).len(), 1, "the rig did not go safe");
    let refused = run("1").wait_with_output().expect("the host");
    assert_eq!(refused.status.code(), Some(3), "{}", text(&refused));
    let line = text(&refused);
    assert!(line.contains("latched in SAFE") && line.contains("yawbench rig-reset"), "{line}");
    let released = reset();
    assert_eq!(released.status.code(), Some(0), "{}", text(&released));
    let again = reset();
    assert_eq!(again.status.code(), Some(3), "{}", text(&again));
    assert!(text(&again).contains("the rig refused: STATE"), "{}", text(&again));
    let done = run("1").wait_with_output().expect("the host");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done));
    drop(rig);
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn the_fd_profile_goes_out_with_bit_rate_switch() {
    let Some((vcan, _turn)) = alone() else { return };
    let rig = Rig::start(&vcan, &["--exit-after-run", "--fifo-priority", "0", "--profile", "fd"]);
    let candump = Candump::start(&vcan);
    let folder = out(&vcan, "fd");
    let bus = format!("socketcan:{vcan}");
    let output = host(&bus, "1", &folder, &["--pace", "lockstep", "--profile", "fd"])
        .output()
        .expect("the host");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let (code, rig) = rig.end();
    let frames = candump.stop();
    assert_eq!(code, Some(0), "{rig}");
    let command = MessageId::Command(Profile::Fd, Node::ALL[0]).raw();
    let measurement = MessageId::Measurement(Profile::Fd, Node::ALL[0]).raw();
    let mut counts = [0, 0];
    for frame in &frames {
        let Some((id, data)) = parts(frame) else { continue };
        for (count, wanted) in counts.iter_mut().zip([command, measurement]) {
            if id == wanted {
                let CanAnyFrame::Fd(frame) = frame else { panic!("{id:03X} is not FD") };
                assert!(frame.is_brs(), "{id:03X} without bit-rate switch");
                assert_eq!(data.len(), 16);
                *count += 1;
            }
        }
    }
    // A second, four fades of half a second, what holds the armed ram, and what ends the run.
    assert_eq!(counts[0], counts[1], "commands and measurements");
    assert!((3002..3100).contains(&counts[0]), "{counts:?}");
    let _ = std::fs::remove_dir_all(folder);
}
