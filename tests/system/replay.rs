//! A recorded run is computed again from its files, bit for bit; a record that was changed is not.

use crate::support::command::{folder, output, read, repository, yawbench};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn run(scenario: &str, out: &Path, options: &[&str]) {
    let scenario = repository().join("scenarios").join(scenario);
    let mut command = yawbench();
    command.arg("run").arg(scenario).args(["--pace", "fast", "--overwrite", "--out"]);
    let run = output(command.arg(out).args(options));
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

fn replay(run: &Path) -> (Option<i32>, Value) {
    let Output { status, stdout, stderr } = output(yawbench().arg("replay").arg(run).arg("--json"));
    let said = String::from_utf8_lossy(&stderr).into_owned();
    (status.code(), serde_json::from_slice(&stdout).unwrap_or(Value::String(said)))
}

#[test]
fn a_run_is_replayed_bit_for_bit_from_its_files() {
    let out = folder("replay");
    for (scenario, options) in [
        ("ss9-160kmh.toml", &["--duration", "2"][..]),
        // With a watch, a second run and FD frames; and in a curve.
        ("ss9-before-and-after.toml", &["--duration", "1", "--profile", "fd"]),
        ("ss9-curve-400m.toml", &["--duration", "1"]),
    ] {
        run(scenario, &out, options);
        let (code, found) = replay(&out);
        assert_eq!(code, Some(0), "{found}");
        let summary: Value = serde_json::from_str(&read(&out.join("summary.json"))).unwrap();
        assert_eq!(found["cycles"], summary["cycles"], "{found}");
        let hash = summary["trajectory_hash"].as_str().unwrap();
        assert!(hash.ends_with(found["trajectory_hash"].as_str().unwrap()), "{hash} {found}");
    }
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn one_changed_bit_of_a_measurement_is_found_in_its_cycle() {
    let out = folder("replay-changed");
    run("ss9-160kmh.toml", &out, &["--duration", "1"]);
    let log = read(&out.join("bus.log"));
    let mut measured = 0;
    let changed: Vec<String> = log
        .lines()
        .map(|line| {
            measured += usize::from(line.contains(" 201#"));
            let is_it = line.contains(" 201#") && measured == 1500;
            // The last digit before the direction: the CRC no longer fits.
            let digit = if line.ends_with("0 R") { "1 R" } else { "0 R" };
            if is_it { format!("{}{digit}", &line[..line.len() - 3]) } else { line.to_owned() }
        })
        .collect();
    std::fs::write(out.join("bus.log"), changed.join("\n") + "\n").unwrap();
    let (code, found) = replay(&out);
    assert_eq!(code, Some(1), "{found}");
    let cycle = found["difference"]["cycle"].as_u64().unwrap();
    assert!((1490..=1500).contains(&cycle), "{found}");
    assert_eq!(found["cycles"], cycle - 1);

    // A log that ends too early is no difference, and no whole replay.
    let half: Vec<&str> = log.lines().take(2000).collect();
    std::fs::write(out.join("bus.log"), half.join("\n") + "\n").unwrap();
    let (code, found) = replay(&out);
    assert_eq!((code, &found["difference"]), (Some(1), &Value::Null), "{found}");
    let (cycles, missing) = (found["cycles"].as_u64(), found["not_replayed"].as_u64());
    assert_eq!(cycles.zip(missing).map(|(some, rest)| some + rest), Some(3000), "{found}");

    let (code, found) = replay(&repository().join("scenarios"));
    assert_eq!(code, Some(2));
    assert_eq!(found.as_str().map(|line| line.lines().count()), Some(1), "{found}");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_run_is_a_record_for_the_commands_that_read_records() {
    let out = folder("run-as-record");
    run("ss9-before-and-after.toml", &out, &["--duration", "3"]);
    let figures = |arguments: &[&str]| {
        let mut command = yawbench();
        command.args(["characterise", "--json", "--from"]).args(arguments);
        command.arg("--out").arg(out.join("figures")).arg("--overwrite");
        output(&mut command)
    };
    let path = |name: &str| out.join(name).display().to_string();
    let peak = |found: &Output| {
        let said = String::from_utf8_lossy(&found.stderr).into_owned();
        assert!(found.status.success(), "{said}");
        let figures: Value = serde_json::from_slice(&found.stdout).unwrap();
        figures.to_string()
    };
    let log = peak(&figures(&[&path("bus.log")]));
    assert!(log.contains("bus-node1"), "{log}");
    let record = peak(&figures(&[&path("record.npy")]));
    assert!(record.contains("record-slot0"), "{record}");
    let by_place = peak(&figures(&[&path("record.npy"), "--slot", "front right"]));
    assert!(by_place.contains("record-slot1"), "{by_place}");

    // What is meant is asked for, not guessed.
    for (arguments, expected) in [
        (vec![path("record.npy"), "--slot".to_owned(), "bogie".to_owned()], "\"front left\""),
        (vec![path("bus.log"), "--node".to_owned(), "2".to_owned()], "no measurement of node 2"),
    ] {
        let refused = figures(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
    }
    std::fs::remove_file(out.join("run.json")).unwrap();
    let refused = figures(&[&path("record.npy")]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("--slot with one of"), "{said}");
    std::fs::remove_dir_all(out).unwrap();
}
