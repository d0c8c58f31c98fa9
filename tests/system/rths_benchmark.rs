//! `yawbench rths-benchmark` as a person uses it.

use crate::support::command::{folder, output, yawbench};
use std::path::Path;

/// The command on a record.
fn on(record: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().args(["rths-benchmark", "--record"]).arg(record).args(more));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

/// Two seconds of a sine.
fn short_record() -> String {
    let line = |k: u32| {
        let time_s = f64::from(k) * 0.02;
        format!("{time_s},{}\n", 2.0 * libm::sin(12.0 * time_s))
    };
    let lines: String = (0..=100).map(line).collect();
    format!("time_s,ground_acceleration_m_per_s2\n{lines}")
}

#[test]
fn tables_are_printed_without_a_comparison_for_another_record() {
    let place = folder("rths-benchmark");
    let record = place.join("sine.csv");
    std::fs::write(&record, short_record()).unwrap();
    let (code, printed, complained) = on(&record, &["--seed", "3"]);
    assert_eq!((code, complained.as_str()), (Some(0), ""), "{printed}");
    for expected in [
        "sine.csv, 2 s, peak ",
        "Seed 3.",
        "PI + lead, mean over 64 realisations of the noise",
        "The published table is of El Centro, 1940 (41.18 s, peak 3.135 m/s2): no comparison.",
        "Compensators, nominal plant",
        "polynomial 2, 18 ms",
        "adaptive, force delay",
        "20 perturbed plants, case 1",
        "Unknown delay in addition, case 1",
        "J4 of the worst case: ",
    ] {
        assert!(printed.contains(expected), "no \"{expected}\" in: {printed}");
    }
    assert!(!printed.contains("published   ") && !printed.contains("NaN"), "{printed}");
    let (code, printed, _) = on(&record, &["--json"]);
    assert_eq!(code, Some(0));
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(json["seed"], 1);
    assert_eq!(json["outside"], serde_json::Value::Null);
    assert_eq!(json["nominal"].as_array().map(Vec::len), Some(28));
    assert_eq!(json["nominal"][0]["criteria"].as_array().map(Vec::len), Some(9));
    let _ = std::fs::remove_dir_all(&place);
}

#[test]
fn a_record_that_is_none_is_refused_in_one_line() {
    let place = folder("rths-benchmark-bad");
    for (name, text, expected) in [
        ("one.csv", "time_s\n0\n1\n", "one.csv:1: found one column, expected time_s,"),
        ("nan.csv", "t,a\n0,0\n1,NaN\n", "nan.csv:3: found \"NaN\", expected a finite number"),
        ("huge.csv", "t,a\n0,0\n1,1e300\n", "huge.csv:3: found 1e300 m/s2, expected at most"),
        ("back.csv", "t,a\n0,0\n2,1\n1,0\n", "back.csv:4: found time 1 s, expected more than 2 s"),
        ("rest.csv", "t,a\n0,0\n2,0\n", "rest.csv: found a peak of 0 m/s2, expected at least"),
        ("empty.csv", "", "empty.csv: found 0 s, expected at least 1 s"),
    ] {
        let record = place.join(name);
        std::fs::write(&record, text).unwrap();
        let (code, printed, complained) = on(&record, &[]);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{name}: {complained}");
        assert!(complained.contains(expected), "{name}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{name}: {complained}");
    }
    let (code, _, complained) = on(&place.join("none.csv"), &[]);
    assert_eq!((code, complained.lines().count()), (Some(2), 1), "{complained}");
    assert!(complained.contains("none.csv: cannot be read"), "{complained}");
    let _ = std::fs::remove_dir_all(&place);
}
