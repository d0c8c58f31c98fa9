//! Tests on a rig in open loop: their records are those of a laboratory, and `identify` reads them.

use crate::support::command::{folder, output, read, repository, yawbench};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn visit(out: &Path, options: &[&str]) -> Output {
    let mut command = yawbench();
    command.args(["characterise", "--bus", "memory", "--tests", "short", "--overwrite", "--out"]);
    output(command.arg(out).args(options))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_visit_on_a_rig_measures_its_damper_and_its_delay() {
    let out = folder("open-loop");
    let rig = repository().join("scenarios/rigs/laboratory-rig.toml").display().to_string();
    let found = visit(&out, &["--rig", &rig, "--specimen", "seven", "--orientation", "upright"]);
    assert!(found.status.success(), "{}", said(&found));
    // The heat of every test is printed before anything moves.
    assert!(said(&found).contains("expected heat"), "{}", said(&found));
    let text = String::from_utf8_lossy(&found.stdout).into_owned();
    let tracking: Vec<&str> =
        text.lines().skip_while(|line| !line.starts_with("Tracking")).skip(2).take(10).collect();
    for line in tracking {
        // The lag of the ram in the rig's file: half a millisecond.
        assert_eq!(line.split_whitespace().nth(1), Some("0.50"), "{line}");
    }
    let csv = read(&out.join("sine-1hz-1.5mm.csv"));
    // The columns are named in line 1, as in every CSV file of the program.
    assert!(csv.starts_with("time_s,displacement_m,force_n"), "{csv:.80}");
    assert_eq!(csv.lines().count(), 1 + 7501);
    let mapping = read(&out.join("sine-1hz-1.5mm.toml"));
    assert!(mapping.contains("specimen = \"seven\""), "{mapping}");
    assert!(mapping.contains("\"orientation: upright\""), "{mapping}");
    // Record, log and events are there too, and the rig was never coupled.
    for file in [
        "record.npy",
        "bus.log",
        "events.jsonl",
        "laboratory.json",
        "tracking.json",
        "manifest.json",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let events = read(&out.join("events.jsonl"));
    assert!(events.contains("OPEN_LOOP") && !events.contains("RAMP_IN"), "{events}");

    let train = ["sine-3.5hz-3.46mm", "triangle-20mm-s", "sine-3.5hz-8mm", "sine-1hz-1.5mm"];
    let train: Vec<PathBuf> = train.iter().map(|name| out.join(format!("{name}.csv"))).collect();
    let mut identify = yawbench();
    identify.args(["identify", "--json", "--out"]).arg(out.join("identified")).arg("--train");
    let identified = output(identify.args(train));
    assert!(identified.status.success(), "{}", said(&identified));
    let result: Value = serde_json::from_slice(&identified.stdout).unwrap();
    assert!(result["accepted"].as_array().is_none_or(Vec::is_empty), "{result:#}");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_rig_that_cannot_make_a_test_is_not_moved() {
    let out = folder("open-loop-refused");
    let rig = out.join("slow.toml");
    std::fs::write(&rig, "rate_m_per_s = 0.1\n").unwrap();
    let found = visit(&out.join("visit"), &["--rig", &rig.display().to_string()]);
    let message = said(&found);
    assert_eq!(found.status.code(), Some(3), "{message}");
    let last = message.lines().last().unwrap();
    assert!(last.contains("VELOCITY_UM_PER_S") && last.contains("100000"), "{message}");
    for (options, expected) in
        [(["--oil-degc", "20"], "FROM:TO"), (["--believed-kn", "1000"], "1 to 100 kN")]
    {
        let found = visit(&out.join("refused"), &options);
        let message = said(&found);
        assert_eq!(found.status.code(), Some(2), "{message}");
        assert!(message.lines().last().unwrap().contains(expected), "{message}");
        assert!(!out.join("refused").exists());
    }
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_test_too_short_for_a_record_was_refused_when_the_ram_had_moved() {
    let out = folder("open-loop-short");
    let list = out.join("short.toml");
    let tests = "[[test]]\nname = \"tiny\"\nduration_s = 0.01\n\
                 sine = { amplitude_m = 1e-3, frequency_hz = 2.0 }\n";
    std::fs::write(&list, tests).unwrap();
    let visit = out.join("visit");
    let mut command = yawbench();
    command.args(["characterise", "--bus", "memory", "--tests"]).arg(&list);
    let refused = output(command.arg("--out").arg(&visit));
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    assert!(said(&refused).contains("test tiny of 11 samples"), "{}", said(&refused));
    assert!(!visit.exists());
    std::fs::remove_dir_all(out).unwrap();
}
