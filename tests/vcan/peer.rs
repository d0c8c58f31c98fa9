//! A rig that shares no code with us: `peer.py`, written from `yawbench.dbc` and from
//! `docs/write-your-own-rig.md` alone.
//!
//! An honest one shows that the two documents are enough to write a rig. One that lies shows that
//! the host finds it out.

use crate::interface::{Interface, aloud, yawbench};
use crate::rig::{MEASUREMENT, alone, hear, host, listener, out};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};

/// A rig process that dies with the test.
struct Peer(Child);

impl Peer {
    /// Starts it; none, and it says so, where there is no Python.
    fn start(interface: &Interface, lie: &[&str]) -> Option<Self> {
        let mut python = Command::new("python3");
        // No compiled copies beside the sources.
        python.arg("-B").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vcan/peer.py"));
        python.args(["--node", "1", "--exit-after-run", "--bus", interface]).args(lie);
        match python.stdout(Stdio::null()).spawn() {
            Ok(child) => Some(Self(child)),
            Err(reason) => {
                aloud(&format!("SKIPPED: no peer of our rigs: python3: {reason}"));
                None
            }
        }
    }

    /// Waits for its end by itself.
    fn end(&mut self) -> ExitStatus {
        let begin = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().expect("the peer's status") {
                return status;
            }
            assert!(begin.elapsed() < Duration::from_secs(20), "the peer does not end");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Two seconds in lock-step; gives the host's output and its `summary.json`, null where it wrote
/// none.
fn run(interface: &Interface) -> (Output, Value) {
    let folder = out(interface, "peer");
    let bus = format!("socketcan:{interface}");
    let output = host(&bus, "2", &folder, &["--pace", "lockstep"]).output().expect("the host");
    let text = std::fs::read_to_string(folder.join("summary.json")).unwrap_or("null".into());
    let summary = serde_json::from_str(&text).expect("JSON");
    let _ = std::fs::remove_dir_all(folder);
    (output, summary)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_peer_written_from_the_documents_alone_is_armed_and_runs_to_the_end() {
    let Some((vcan, _turn)) = alone() else { return };
    let Some(mut peer) = Peer::start(&vcan, &[]) else { return };
    let (output, summary) = run(&vcan);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(summary["state"], "completed");
    assert_eq!(summary["steps"], 2000);
    assert_eq!(summary["frames"]["received"], summary["cycles"]);
    for count in ["lost", "crc_errors", "repeated", "wrong_sequence"] {
        assert_eq!(summary["frames"][count], 0, "{count}");
    }
    let damper = &summary["damper"][0];
    assert_eq!((&damper["place"], &damper["flagged_measurements"]), (&"rig".into(), &0.into()));
    let work = damper["work_per_s_j"].as_f64().expect("its work");
    assert!(work > 10.0, "{work} J/s");
    // The host's STANDBY ends its session, and it with it.
    assert!(peer.end().success());
}

#[test]
fn a_peer_that_is_not_ready_is_refused_by_the_name_of_the_item() {
    let Some((vcan, _turn)) = alone() else { return };
    for (lie, item) in [("no-zero", "ZERO_AGE_S"), ("wrong-hash", "CONFIGURATION_HASH")] {
        let Some(_peer) = Peer::start(&vcan, &["--lie", lie]) else { return };
        let (output, summary) = run(&vcan);
        assert_eq!(output.status.code(), Some(3), "{lie}: {}", said(&output));
        assert!(said(&output).contains(&format!("not armed: {item} is")), "{}", said(&output));
        assert_eq!(summary, Value::Null, "{lie}");
    }
}

#[test]
fn a_peer_that_lies_in_motion_is_found_out_by_name() {
    let Some((vcan, _turn)) = alone() else { return };
    let lies = [
        ("constant-force", "stuck_force", "ramped_out"),
        ("frozen-force", "stuck_force", "ramped_out"),
        ("reversed-force", "work", "ramped_out"),
        ("displacement-off", "velocity", "safe"),
        ("wrong-seal", "wrong_seal", "safe"),
    ];
    for (lie, signal, state) in lies {
        // It begins half a second into RUN.
        let Some(mut peer) = Peer::start(&vcan, &["--lie", lie, "--after", "1500"]) else { return };
        let (output, summary) = run(&vcan);
        assert_eq!(output.status.code(), Some(3), "{lie}: {}", said(&output));
        let cause = &summary["cause"];
        assert_eq!((&cause["signal"], &summary["state"]), (&signal.into(), &state.into()), "{lie}");
        assert_eq!(cause["node"], 1);
        let cycle = cause["cycle"].as_u64().expect("a cycle");
        assert!((1500..2500).contains(&cycle), "{lie}: {cause}");
        if state == "ramped_out" {
            assert!(peer.end().success(), "{lie}");
        }
    }
}

#[test]
fn a_peer_whose_host_is_killed_is_latched_until_it_is_reset() {
    let Some((vcan, _turn)) = alone() else { return };
    let Some(mut peer) = Peer::start(&vcan, &[]) else { return };
    let (folder, bus) = (out(&vcan, "peer-killed"), format!("socketcan:{vcan}"));
    let socket = listener(&vcan);
    let mut killed = host(&bus, "60", &folder, &["--pace", "lockstep"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the host");
    assert_eq!(hear(&socket, MEASUREMENT, 1500).len(), 1500, "the run did not start");
    killed.kill().expect("kill");
    killed.wait().expect("the host's end");
    let _ = std::fs::remove_dir_all(folder);
    // Without a clock, one second of silence is a lost host.
    std::thread::sleep(Duration::from_millis(1500));
    let (output, _) = run(&vcan);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("is latched in SAFE"), "{}", said(&output));
    let reset = yawbench().args(["rig-reset", "--node", "1", "--bus", &bus]).output();
    let reset = reset.expect("the reset");
    assert_eq!(reset.status.code(), Some(0), "{}", said(&reset));
    let (output, summary) = run(&vcan);
    assert_eq!((output.status.code(), &summary["state"]), (Some(0), &"completed".into()));
    assert!(peer.end().success());
}
