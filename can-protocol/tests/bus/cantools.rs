//! The DBC contract once more with Python's cantools, both directions.
//!
//! Needs a python3 with cantools; `PYTHON` names another interpreter. Without it the test says
//! that it was skipped, and fails instead when `REQUIRE_CANTOOLS=1`.
use crate::support::samples::{self, Value};
use can_protocol::{Message, MessageId, Profile};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use serde_json::json;
use std::collections::BTreeMap;
use std::env;
use std::io::Write;
use std::process::{Command, Stdio};

/// Frames sent to cantools, and frames per message that it sends back.
const SENT: u32 = 6000;
const MADE: usize = 300;
const SEED: u32 = 20_480;

fn python() -> String {
    env::var("PYTHON").unwrap_or_else(|_| "python3".into())
}

fn cantools_is_there() -> bool {
    let import = Command::new(python()).args(["-c", "import cantools"]).output();
    import.is_ok_and(|output| output.status.success())
}

/// A frame as a line for the script.
fn line(message: &Message, profile: Profile) -> String {
    let (frame, _) = message.encode(profile);
    let decoded = Message::decode(frame.id(), frame.data()).expect("our own frame");
    let signals: BTreeMap<String, serde_json::Value> = samples::dbc_values(&decoded, profile)
        .into_iter()
        .map(|(name, value)| match value {
            Value::Number(number) => (name, json!(number)),
            Value::Name(text) => (name, json!(text)),
        })
        .collect();
    // As cansend takes it: the payload follows # or, with the FD flags, ##1.
    let text = frame.to_string();
    let (_, data) = text.split_once(if frame.is_fd() { "##1" } else { "#" }).expect("a payload");
    let (id, fd) = (frame.id(), frame.is_fd());
    json!({"id": id, "fd": fd, "brs": fd, "data": data, "signals": signals}).to_string()
}

/// Panics unless the codec reads a frame of cantools as cantools meant it.
fn check(line: &str) {
    let made: serde_json::Value = serde_json::from_str(line).expect("a JSON line");
    let id = made["id"].as_u64().expect("id") as u16;
    let hex = made["data"].as_str().expect("data");
    let data: Vec<u8> = (0..hex.len() / 2)
        .map(|at| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).expect("hex"))
        .collect();
    let profile = MessageId::from_raw(id).expect("our id").profile();
    assert_eq!(made["brs"], json!(profile == Profile::Fd), "{line}");
    let message = Message::decode(id, &data).unwrap_or_else(|error| panic!("{error}: {line}"));
    let values = samples::dbc_values(&message, profile);
    let sent = made["signals"].as_object().expect("signals");
    assert_eq!(sent.len(), values.len(), "{line}");
    for (name, value) in values {
        match value {
            Value::Name(text) => assert_eq!(sent[&name], json!(text), "{name} of {line}"),
            Value::Number(number) => {
                let meant = sent[&name].as_f64().unwrap_or(f64::NAN);
                // Both sides hold whole multiples of at least 1e-5.
                let close = (meant - number).abs() <= 1e-8 + 1e-12 * number.abs();
                assert!(close, "{name} is {number}, meant {meant}: {line}");
            }
        }
    }
    // The codec makes the very same frame of it.
    assert_eq!(message.encode(profile).0.data(), data, "{line}");
}

#[test]
fn cantools_and_the_codec_read_each_other() {
    if !cantools_is_there() {
        let required = env::var("REQUIRE_CANTOOLS").is_ok_and(|value| value == "1");
        assert!(!required, "REQUIRE_CANTOOLS=1, but {} has no cantools", python());
        // Bypasses the test harness, which captures the output of a passing test.
        let _ = writeln!(std::io::stderr(), "SKIPPED: cantools test: no cantools in {}", python());
        return;
    }
    let mut runner = TestRunner::new(samples::config(SENT));
    let strategy = samples::message();
    let lines: Vec<String> = (0..SENT)
        .map(|_| {
            let (message, profile) = strategy.new_tree(&mut runner).expect("a sample").current();
            line(&message, profile)
        })
        .collect();
    let folder = env!("CARGO_MANIFEST_DIR");
    let mut script = Command::new(python())
        .arg(format!("{folder}/tests/bus/dbc_check.py"))
        .args([format!("{folder}/yawbench.dbc"), MADE.to_string(), SEED.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python");
    // The script reads everything before it writes; if it ends early, its message says why.
    let mut input = script.stdin.take().expect("stdin");
    let _ = input.write_all((lines.join("\n") + "\n").as_bytes());
    drop(input);
    let output = script.wait_with_output().expect("output");
    let report = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cantools disagrees (seed {SEED}): {report}");
    let made = String::from_utf8(output.stdout).expect("utf-8");
    assert_eq!(made.lines().count(), MADE * MessageId::all().count());
    made.lines().for_each(check);
    eprintln!("{} {} frames read back", report.trim(), made.lines().count());
}
