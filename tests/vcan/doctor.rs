//! `yawbench doctor` and `yawbench rtcheck` on a virtual interface: nothing of it is called CAN.

use crate::interface;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

fn json(args: &[&str]) -> Value {
    let output = interface::yawbench().args(args).output().expect("the command");
    let printed = String::from_utf8_lossy(&output.stdout);
    let complained = String::from_utf8_lossy(&output.stderr);
    serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{args:?}: {complained}"))
}

#[test]
fn doctor_judges_no_timing_of_a_virtual_bus() {
    let Some(interface) = interface::interface() else { return };
    let bus = format!("socketcan:{}", &*interface);
    let answer = json(&["doctor", "--bus", &bus, "--data-bitrate", "5M", "--json"]);
    let checks = answer["bus"]["checks"].as_array().expect("a list of checks");
    let row = |what: &str| {
        let found = checks.iter().find(|check| check["what"] == what);
        let check = found.unwrap_or_else(|| panic!("no {what}: {answer}"));
        (check["found"].as_str().expect("text"), check["verdict"].as_str().expect("text"))
    };
    assert_eq!(row("interface"), (&*format!("{} is up", &*interface), "good"));
    assert_eq!(row("kind"), ("virtual (no bus, no timing)", "unknown"));
    assert_eq!(row("CAN FD"), ("on", "good"));
    for what in ["bit rate", "sample point", "controller state", "transmit queue"] {
        assert_eq!(row(what), ("does not apply to a virtual bus", "unknown"));
    }
}

#[test]
fn rtcheck_says_that_a_second_socket_answered() {
    let Some(interface) = interface::interface() else { return };
    let bus = format!("socketcan:{}", &*interface);
    let result = json(&["rtcheck", "--seconds", "2", "--bus", &bus, "--json"]);
    let answers = &result["answers"];
    assert_eq!(answers["answered_by"], "loopback");
    assert_eq!(answers["is_can"], false);
    assert_eq!(answers["bus"], format!("{bus}, vcan (no CAN timing)"));
    let count = |key: &str| answers[key].as_u64().expect("a count");
    assert!(count("sent") > 0 && count("lost") <= count("sent"), "{answers}");
}

#[test]
fn rtcheck_times_the_heartbeats_of_a_rig_and_leaves_it_unarmed() {
    let Some(interface) = interface::interface() else { return };
    let bus = format!("socketcan:{}", &*interface);
    let mut rig = interface::yawbench();
    rig.args(["rig", "--bus", &bus, "--node", "2", "--fifo-priority", "0"]);
    let mut rig = rig.stderr(Stdio::piped()).spawn().expect("a rig");
    let mut lines = BufReader::new(rig.stderr.take().expect("a pipe")).lines();
    let said = lines.next().expect("a line").expect("text");
    assert!(said.contains("waiting for a host"), "{said}");
    let result = json(&["rtcheck", "--seconds", "3", "--bus", &bus, "--json"]);
    rig.kill().expect("a rig that runs");
    rig.wait().expect("its end");
    let answers = &result["answers"];
    assert_eq!(answers["answered_by"], "rig 2");
    let count = |key: &str| answers[key].as_u64().expect("a count");
    assert!(count("sent") > count("lost"), "{answers}");
    // What a rig says of a session or of motion, it says on standard error.
    let said: Vec<String> = lines.map_while(Result::ok).collect();
    assert!(!said.iter().any(|line| line.contains("ARMED")), "{said:?}");
}
