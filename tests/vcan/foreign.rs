//! A rig that knows its own DBC alone (`foreign_rig.py`), behind the gateway of `yawbench run`.
//!
//! Both ends read the same two files, `scenarios/rigs/own-messages/`: the rig with cantools, the
//! host with its own codec.

use crate::interface::{Interface, aloud, yawbench};
use crate::rig::{alone, host, out};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// Every loss of the plain messages.
const PLAIN_LOSSES: &str = "no-session,no-crc,no-readiness,no-pressure-off,no-echo,\
                            no-command-counter,no-velocity,no-state,no-validity,no-stop,\
                            no-limits,no-timeout";

/// Every loss of the servo's.
const SERVO_LOSSES: &str = "no-session,no-crc,no-readiness,no-pressure-off";

/// The servo's time-out: a machine that stands still for less is no reason to stop.
const TIME_OUT_S: &str = "1.0";

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/rigs/own-messages").join(name)
}

/// A rig process that dies with the test.
struct ForeignRig(Child);

impl ForeignRig {
    /// Starts it; none, and it says so, where there is no Python with cantools.
    fn start(interface: &Interface, messages: &str, more: &[&str]) -> Option<Self> {
        let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
        let has_cantools = Command::new(&python).args(["-c", "import can, cantools"]).output();
        if !has_cantools.is_ok_and(|output| output.status.success()) {
            let is_required = std::env::var("REQUIRE_CANTOOLS").is_ok_and(|value| value == "1");
            assert!(!is_required, "REQUIRE_CANTOOLS=1, but {python} has no cantools");
            aloud("SKIPPED: no rig with its own messages: no Python with cantools");
            return None;
        }
        let mut rig = Command::new(python);
        rig.arg("-B").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vcan/foreign_rig.py"));
        rig.args(["--bus", interface, "--messages", messages, "--own-clock-after-s", "0.5"]);
        Some(Self(rig.args(more).stdout(Stdio::null()).spawn().expect("the rig")))
    }
}

impl Drop for ForeignRig {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A copy of a map with a part of it replaced.
fn map(interface: &Interface, name: &str, from: &str, to: &str) -> PathBuf {
    let text = std::fs::read_to_string(example(&format!("{name}-map.toml"))).expect("the map");
    assert!(text.contains(from), "{from}");
    let path = out(interface, &format!("{name}-map.toml"));
    std::fs::write(&path, text.replace(from, to)).expect("a map");
    path
}

/// A run in lock-step; the host's output and its `summary.json`, null where it wrote none.
fn run(
    interface: &Interface,
    (messages, map): (&str, &Path),
    seconds: &str,
    accept: &str,
) -> (Output, Value) {
    let folder = out(interface, "foreign");
    let bus = format!("socketcan:{interface}");
    let mut host = host(&bus, seconds, &folder, &["--pace", "lockstep"]);
    host.arg("--dbc").arg(example(&format!("{messages}.dbc"))).arg("--dbc-map").arg(map);
    host.args(["--accept", accept]);
    let output = host.output().expect("the host");
    let text = std::fs::read_to_string(folder.join("summary.json")).unwrap_or("null".into());
    let _ = std::fs::remove_dir_all(folder);
    (output, serde_json::from_str(&text).expect("JSON"))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The run was completed and no frame was lost.
fn assert_whole(output: &Output, summary: &Value, cycles: u64) {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    assert_eq!((&summary["state"], &summary["steps"]), (&"completed".into(), &cycles.into()));
    for count in ["lost", "crc_errors", "repeated", "wrong_sequence"] {
        assert_eq!(summary["frames"][count], 0, "{count}: {}", summary["frames"]);
    }
    let work = summary["damper"][0]["work_per_s_j"].as_f64().expect("its work");
    assert!(work > 10.0, "{work} J/s");
}

#[test]
fn a_rig_that_knows_its_own_dbc_alone_runs_to_the_end() {
    let Some((vcan, _turn)) = alone() else { return };
    let Some(_rig) = ForeignRig::start(&vcan, "servo", &["--time-out-s", TIME_OUT_S]) else {
        return;
    };
    let map = map(&vcan, "servo", "timeout_s = 0.1", &format!("timeout_s = {TIME_OUT_S}"));
    let (output, summary) = run(&vcan, ("servo", &map), "20", SERVO_LOSSES);
    assert_whole(&output, &summary, 20_000);
    // What it does without is said before anything moves.
    assert!(said(&output).contains("no-session"), "{}", said(&output));
    println!("the servo: {}", summary["frames"]);
}

#[test]
fn a_rig_with_big_endian_multiplexed_and_float_signals_runs_to_the_end() {
    let Some((vcan, _turn)) = alone() else { return };
    let Some(_rig) = ForeignRig::start(&vcan, "plain", &[]) else { return };
    let (output, summary) = run(&vcan, ("plain", &example("plain-map.toml")), "2", PLAIN_LOSSES);
    assert_whole(&output, &summary, 2000);
}

#[test]
fn losses_that_nobody_has_accepted_and_a_rig_without_a_counter_are_refused() {
    let Some((vcan, _turn)) = alone() else { return };
    let (output, summary) = run(&vcan, ("plain", &example("plain-map.toml")), "2", "no-echo");
    assert_eq!((output.status.code(), &summary), (Some(2), &Value::Null), "{}", said(&output));
    let line = said(&output);
    assert!(line.trim_end().ends_with(&format!("expected --accept {PLAIN_LOSSES}")), "{line}");
    let map = map(&vcan, "plain", "counter = \"Life\"\n", "");
    let all = format!("{PLAIN_LOSSES},no-counter");
    let (output, summary) = run(&vcan, ("plain", &map), "2", &all);
    assert_eq!((output.status.code(), &summary), (Some(2), &Value::Null), "{}", said(&output));
    assert!(said(&output).contains("OPEN_LOOP"), "{}", said(&output));
}

#[test]
fn a_rig_that_does_not_stop_after_its_declared_time_out_is_not_armed() {
    let Some((vcan, _turn)) = alone() else { return };
    let Some(_rig) = ForeignRig::start(&vcan, "servo", &[]) else { return };
    let map = map(&vcan, "servo", "timeout_s = 0.1", &format!("timeout_s = {TIME_OUT_S}"));
    let (output, summary) = run(&vcan, ("servo", &map), "2", SERVO_LOSSES);
    assert_eq!((output.status.code(), &summary), (Some(3), &Value::Null), "{}", said(&output));
    assert!(said(&output).contains("moving on by"), "{}", said(&output));
}

#[test]
fn options_of_own_messages_belong_together() {
    let dbc = example("servo.dbc");
    let output =
        yawbench().args(["run", "none.toml", "--dbc"]).arg(dbc).output().expect("the host");
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("--dbc-map"), "{}", said(&output));
}
