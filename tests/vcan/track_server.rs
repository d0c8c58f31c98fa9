//! `yawbench track-server` on a bus with a locomotive of a board's memory and a rig in a process of
//! its own. The CAN driver of the locomotive is that of the crate `socketcan`.

use crate::interface::{Interface, aloud, yawbench};
use crate::rig::{LOCK_STEP_RIG, Rig, alone};
use can_protocol::arming::Patience;
use can_protocol::{Node, Pace, Profile};
use firmware_core::line::Line;
use firmware_core::supervision::Checks;
use firmware_core::track::{Irregularity, Track};
use hil_host::clock::Pacer;
use hil_host::control::Arming;
use nodes::locomotive::{End, Locomotive, Terms};
use nodes::loopback::Loopback;
use nodes::timed::{TimedLocomotive, TimedRig};
use nodes::track::{self, Reader, as_sent};
use scenario::run::{Overrides, Run};
use serde_json::Value;
use socketcan::{CanSocket, Socket};
use std::io::Read;
use std::num::NonZeroU8;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Cycles of RUN.
const CYCLES: u64 = 1000;

/// Ticks after which a peer is lost, and a bench that has not ended hangs: a minute.
const PATIENCE_TICKS: u32 = 60_000;

fn scenario() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml")
}

/// A track server process that dies with the test.
pub(crate) struct TrackServer(Option<Child>);

impl TrackServer {
    /// Starts it and waits until it listens.
    pub(crate) fn start(interface: &Interface, args: &[&str]) -> Self {
        let mut command = yawbench();
        command.arg("track-server").arg(scenario()).args(["--duration", "5", "--json", "--bus"]);
        command.arg(format!("socketcan:{interface}")).args(args);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = child.expect("the track server");
        let said = child.stderr.as_mut().expect("its messages");
        let (mut line, mut byte) = (Vec::new(), [0]);
        while !line.ends_with(b"waiting for a locomotive\n") {
            said.read_exact(&mut byte).expect("a server that starts");
            line.push(byte[0]);
        }
        Self(Some(child))
    }

    /// Interrupts it; gives its summary.
    pub(crate) fn interrupt(mut self) -> Value {
        let child = self.0.take().expect("a running server");
        let process = rustix::process::Pid::from_child(&child);
        rustix::process::kill_process(process, rustix::process::Signal::INT).expect("its signal");
        let output = child.wait_with_output().expect("its end");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("its summary")
    }
}

impl Drop for TrackServer {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The reader that was written from the DBC alone, by the same server as the test below.
#[test]
fn a_reader_in_another_language_reads_the_track_from_the_bus() {
    let Some((vcan, _turn)) = alone() else { return };
    let server = TrackServer::start(&vcan, &[]);
    let mut python = Command::new("python3");
    python.arg("-B").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vcan/track_reader.py"));
    python.args(["--bus", &vcan, "--session", "258", "--samples", "2000"]);
    let output = match python.output() {
        Ok(output) => output,
        Err(reason) => {
            aloud(&format!("SKIPPED: no reader of a track: python3: {reason}"));
            return;
        }
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let reader: Value = serde_json::from_slice(&output.stdout).expect("its summary");
    let server = server.interrupt();
    assert_eq!((&reader["received"], &reader["refused"]), (&2000.into(), &0.into()));
    assert_eq!(reader["fingerprint"], server["fingerprint"]);
}

fn terms(run: &Run) -> Terms {
    let Arming { number, boot, requirements, .. } = Arming::in_memory().requiring(&run.readiness);
    let profile = Profile::Classical;
    Terms {
        node: Node::ALL[0],
        slot: 0,
        profile,
        pace: Pace::LockStep,
        slow_down: NonZeroU8::MIN,
        number,
        boot,
        requirements,
        checks: Checks::usual(profile.counter_modulus(), run.cycle_s(), 100e3),
        patience: Patience {
            repeat_cycles: 20,
            attempts: 250,
            quiet_cycles: PATIENCE_TICKS as u16,
        },
        silence_ticks: PATIENCE_TICKS,
        cycles: CYCLES,
    }
}

/// The run with everything in this process; end, hash and cycles.
fn in_memory(run: &Run) -> (End, u64, u64) {
    let mut rounded = run.clone();
    for sample in &mut rounded.track.samples.samples {
        *sample = as_sent(sample).expect("a track that travels");
    }
    let track = rounded.track.view();
    let line = hil_host::run::line(&rounded, &track);
    let mut state = line.start(run.start.state.clone());
    let wire = Loopback::default();
    let [mut at_locomotive, mut at_rig] = wire.ends();
    let locomotive = Locomotive::new(&line, &mut state, terms(run)).expect("a slot with a rig");
    let mut locomotive = TimedLocomotive::new(locomotive);
    let rig = hil_host::rig::RigNode::new(&run.rig, Node::ALL[0], Profile::Classical);
    let mut rig = TimedRig::new(rig, PATIENCE_TICKS);
    for _ in 0..PATIENCE_TICKS {
        locomotive.tick(&mut at_locomotive, 0);
        rig.tick(&mut at_rig);
        if let Some(end) = locomotive.locomotive().end() {
            let node = locomotive.locomotive();
            return (end, node.hash(), node.state().cycle);
        }
    }
    panic!("no end in memory");
}

#[test]
fn a_locomotive_with_25_m_of_track_in_memory_has_the_hash_of_one_with_all_of_it() {
    let Some((vcan, _turn)) = alone() else { return };
    let overrides = Overrides { duration_s: Some(5.0), ..Overrides::default() };
    let run = Run::load(&scenario(), overrides).expect("the scenario");
    let expected = in_memory(&run);
    assert_eq!(expected.0, End::Completed);

    let rig = Rig::start(&vcan, LOCK_STEP_RIG);
    let server = TrackServer::start(&vcan, &[]);
    let irregularity = Irregularity { samples: &[], ..run.track.view().irregularity };
    let track = Track { irregularity, ..run.track.view() };
    let line: Line<'_> = hil_host::run::line(&run, &track);
    let mut state = line.start(run.start.state.clone());
    let locomotive = Locomotive::new(&line, &mut state, terms(&run)).expect("a slot with a rig");
    let mut locomotive = TimedLocomotive::new(locomotive);
    let mut reader = Reader::<256>::NEW;
    let (reach_m, ahead_m) = (run.vehicle.reach_m(), run.speed_m_per_s * run.cycle_s());
    reader.begin(track::Terms { session: 0x5EED, expected: None, reach_m, ahead_m });
    let mut can = CanSocket::open(&vcan).expect("a CAN socket");
    can.set_nonblocking(true).expect("a socket that does not wait");
    let mut pacer = Pacer::new(1_000_000, 1);
    let ended = (0..PATIENCE_TICKS).find_map(|_| {
        pacer.wait();
        locomotive.tick_reading(&mut can, &mut reader, 0);
        locomotive.locomotive().end()
    });
    let node = locomotive.locomotive();
    let found = (ended.expect("an end within a minute"), node.hash(), node.state().cycle);
    assert_eq!(found, expected, "{:?}, {:?}", reader.fault(), node.stop());

    let summary = server.interrupt();
    assert!(summary["offers"].as_u64().is_some_and(|offers| offers >= 1), "{summary}");
    let new = summary["samples"].as_u64().zip(summary["repeated"].as_u64());
    let new = new.map_or(0, |(samples, again)| samples - again);
    // 133 m at 160 km/h, and the window at both ends.
    assert!((1550..1650).contains(&new), "{summary}");
    assert_eq!(rig.end().0, Some(0));
}
