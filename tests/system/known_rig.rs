//! What is known of a rig before a run: its measured delay and its calibration.

use crate::support::command::{folder, output, read, repository, yawbench};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

const SERVO: &str = "scenarios/ss9-160kmh-servo-rig.toml";

fn run(scenario: &str, out: &Path, options: &[&str]) -> Output {
    let mut command = yawbench();
    command.arg("run").arg(repository().join(scenario));
    command.args(["--pace", "fast", "--duration", "1", "--out"]).arg(out).args(options);
    output(&mut command)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The folder of an open loop on a rig whose ram was late by so much in a sine, and later in a slow
/// triangle.
fn measured(place: &Path, node: u8, delay_s: f64) -> String {
    let folder = place.join(format!("late-{node}-{delay_s}"));
    std::fs::create_dir(&folder).unwrap();
    let text = format!(
        "{{ \"format\": 1, \"node\": {node}, \"tests\": [\
         {{ \"name\": \"sine\", \"frequency_hz\": 3.5, \"delay_s\": {delay_s} }}, \
         {{ \"name\": \"triangle\", \"frequency_hz\": 0.4, \"delay_s\": 13.4e-3 }}] }}\n"
    );
    std::fs::write(folder.join("tracking.json"), text).unwrap();
    folder.display().to_string()
}

#[test]
fn a_measured_delay_that_is_not_compensated_is_refused_before_anything_is_written() {
    let place = folder("measured-delay");
    let (right, wrong) = (measured(&place, 1, 5.4e-3), measured(&place, 1, 9e-3));
    let out = place.join("out");
    let refused = run(SERVO, &out, &["--measured", &wrong]);
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    for part in ["front left", "tracking.json", "9.000 ms late", "3.600 ms are left", "delay_s"] {
        assert!(said(&refused).contains(part), "{part}: {}", said(&refused));
    }
    assert!(!out.exists());
    let passed = run(SERVO, &out, &["--measured", &right]);
    assert!(said(&passed).contains("0.000 ms are left"), "{}", said(&passed));
    let about: Value = serde_json::from_str(&read(&out.join("run.json"))).unwrap();
    assert_eq!(
        (&about["rams"][0]["delay_s"], &about["rams"][0]["place"]),
        (&5.4e-3.into(), &"front left".into())
    );
    // That of a rig which the scenario does not have, and one that no rig has.
    let other = place.join("other");
    for (node, delay_s, found) in [(3, 5.4e-3, "node 3 at 3.5 Hz"), (1, 0.2975, "297.500 ms late")]
    {
        let folder = measured(&place, node, delay_s);
        let refused = run(SERVO, &other, &["--measured", &folder]);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains(found), "{}", said(&refused));
    }
    let modelled = place.join("modelled.toml");
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let text =
        format!("vehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 1.0\n", vehicle.display());
    std::fs::write(&modelled, text).unwrap();
    let no_rig = run(&modelled.display().to_string(), &other, &["--measured", &right]);
    assert_eq!(no_rig.status.code(), Some(2), "{}", said(&no_rig));
    assert!(said(&no_rig).contains("no damper is on a rig"), "{}", said(&no_rig));
    assert!(!other.exists());
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn the_calibration_of_a_rig_stands_in_the_record_of_its_run() {
    let place = folder("calibrated-run");
    let file = place.join("calibration.toml");
    std::fs::write(
        &file,
        "format = 1\nnode = 1\n[end_mass]\ndate = \"2026-11-29\"\ncertificate = \"K-7\"\n\
         mass_kg = 9.79\nmass_error_kg = 0.01\nresidual = 0.01\n",
    )
    .unwrap();
    let (out, path) = (place.join("out"), file.display().to_string());
    let found = run("scenarios/ss9-160kmh.toml", &out, &["--calibration", &path]);
    let line = "node 1: end mass of 2026-11-29, certificate K-7: 9.790 +- 0.010 kg";
    for file in ["run.json", "summary.json"] {
        let value: Value = serde_json::from_str(&read(&out.join(file))).unwrap();
        assert_eq!(value["calibrations"][0], line, "{file}: {}", said(&found));
    }
    assert!(read(&out.join("report.html")).contains("certificate K-7"));
    // That of a rig which the scenario does not have.
    let text = read(&file).replace("node = 1", "node = 3");
    std::fs::write(&file, text).unwrap();
    let other = run("scenarios/ss9-160kmh.toml", &place.join("other"), &["--calibration", &path]);
    assert_eq!(other.status.code(), Some(2), "{}", said(&other));
    assert!(said(&other).contains("found the calibration of node 3, expected node 1"));
    assert!(!place.join("other").exists());
    std::fs::remove_dir_all(place).unwrap();
}
