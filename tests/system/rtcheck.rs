//! `yawbench rtcheck` as a person uses it. Counts are judged; times are this machine's own.

use crate::support::command::{output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;

fn rtcheck(args: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().arg("rtcheck").args(args).current_dir(repository()));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

/// The result of a measurement, which fits its schema and its exit code.
fn measured(args: &[&str]) -> Value {
    let (code, printed, complained) = rtcheck(&[args, &["--json"]].concat());
    let result: Value = serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{complained}"));
    let schema = read(&repository().join("docs/schema/rtcheck.schema.json"));
    let found = misfits(&serde_json::from_str(&schema).unwrap(), &result);
    assert!(found.is_empty(), "{found:?}");
    let is_held = result["outcome"] == "held";
    assert_eq!(code, Some(i32::from(!is_held)), "{printed}");
    result
}

#[test]
fn every_tick_of_a_second_is_met_or_skipped() {
    let result = measured(&["scenarios/ss9-160kmh.toml", "--seconds", "1"]);
    let count = |key: &str| result[key].as_u64().unwrap();
    assert_eq!(count("expected_ticks"), 1000);
    assert_eq!(count("met_ticks") + count("skipped_ticks"), 1000);
    let bins = result["lateness_histogram"].as_array().unwrap();
    let in_bins: u64 = bins.iter().map(|bin| bin["count"].as_u64().unwrap()).sum();
    assert_eq!(in_bins, count("met_ticks"));
    assert_eq!(result["interrupted"], false);
    assert!(result["vehicle"].is_string() && result["step_us"]["p50"].as_f64().unwrap() > 0.0);
    assert_eq!(result["answers"], Value::Null);
}

#[test]
fn without_a_scenario_the_clock_alone_is_measured() {
    let result = measured(&["--seconds", "0.2", "--fifo-priority", "0", "--budget-us", "1000"]);
    assert_eq!(result["expected_ticks"], 200);
    assert_eq!((&result["vehicle"], &result["step_us"]), (&Value::Null, &Value::Null));
    let step = result["checks"].as_array().unwrap();
    let step = step.iter().find(|check| check["what"] == "vehicle step, worst").unwrap();
    assert_eq!(step["verdict"], "unknown");
    let (_, printed, _) = rtcheck(&["--seconds", "0.1"]);
    for part in ["100 ticks of 1000 us: ", "Lateness (a bar is the logarithm", "Limits", "eld"] {
        assert!(printed.contains(part), "no \"{part}\" in {printed}");
    }
}

#[test]
fn what_cannot_be_measured_is_one_line() {
    for (args, expected) in [
        (&["none.toml"][..], "none.toml"),
        (&["--seconds", "0"][..], "--seconds 0: expected a duration from 0.1 to 86400 s"),
        (&["--budget-us", "0"][..], "--budget-us 0: expected a time from 1 to 1000 us"),
        (&["--bus", "can0"][..], "expected memory or socketcan:INTERFACE"),
        (&["--bus", "socketcan:no-such-can"][..], "modprobe vcan"),
    ] {
        let (code, printed, complained) = rtcheck(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
}
