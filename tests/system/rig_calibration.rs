//! Calibration of an emulated rig: what is found is what its file says.

use crate::support::command::{folder, output, read, yawbench};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A servo rig whose fixture, end mass and load cell are known.
const RIG: &str = "kind = \"servo\"\nfixture_n_per_m = 100e6\nforce_noise_n = 10.0\n\
    [sensors]\ndisplacement = \"ram\"\nforce_skew_s = 0.4e-3\nforce_gain = 0.98\n\
    force_offset_n = 40.0\n[servo]\nend_mass_kg = 10.0\n";

fn rig(out: &Path) -> PathBuf {
    let file = out.join("rig.toml");
    std::fs::write(&file, RIG).unwrap();
    file
}

fn characterise(options: &[&str]) -> Output {
    output(yawbench().args(["characterise", "--bus", "memory"]).args(options))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The calibration that these options leave in a folder.
fn calibrated(rig: &Path, out: &Path, options: &[&str]) -> Value {
    let (rig, out) = (rig.display().to_string(), out.display().to_string());
    let found = characterise(&[&["--json", "--rig", &rig, "--out", &out], options].concat());
    assert!(found.status.success(), "{}", said(&found));
    serde_json::from_slice(&found.stdout).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}, expected a number"))
}

#[test]
fn a_bar_shows_the_fixture_in_series_with_it_and_the_skew() {
    let out = folder("bar");
    let found =
        calibrated(&rig(&out), &out.join("bar"), &["--calibrate", "bar", "--cell-kn", "100"]);
    let bar = &found["bar"];
    // 100 MN/m in series with a bar of 1 GN/m, as a load cell shows it whose gain is 0.98.
    let expected = 0.98 / (1.0 / 100e6 + 1.0 / 1e9);
    let stiffness = number(&bar["stiffness_n_per_m"]);
    assert!((stiffness / expected - 1.0).abs() < 0.01, "{found:#}");
    // The damping of the fixture takes 0.01 ms off.
    assert!((number(&bar["skew_s"]) - 0.4e-3).abs() < 0.03e-3, "{found:#}");
    assert!(number(&bar["stiffness_error_n_per_m"]) < 0.005 * stiffness, "{found:#}");
    assert!(number(&bar["residual"]) < 0.01, "{found:#}");
    // Limits of the bar: the ram has not left a tenth of a millimetre.
    let csv = read(&out.join("bar/bar-10hz.csv"));
    let rows = csv.lines().skip_while(|line| !line.starts_with("time_s")).skip(1);
    let far = rows.map(|row| row.split(',').nth(1).unwrap().parse::<f64>().unwrap().abs());
    let farthest_m = far.fold(0.0, f64::max);
    assert!((1e-6..0.1e-3).contains(&farthest_m), "{farthest_m} m");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_force_beyond_a_fifth_of_the_load_cell_ends_the_run() {
    let out = folder("bar-force");
    let (rig, runs) = (rig(&out).display().to_string(), out.join("bar").display().to_string());
    let asked = ["--calibrate", "bar", "--cell-kn", "5", "--bar-um", "60"];
    let found = characterise(&[&["--rig", &rig, "--out", &runs], &asked[..]].concat());
    assert_eq!(found.status.code(), Some(3), "{}", said(&found));
    assert!(!out.join("bar/calibration.toml").exists());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn parts_add_up_to_one_file_and_stand_above_later_records() {
    let out = folder("parts");
    let rig = rig(&out);
    let file = |name: &str| out.join(name).join("calibration.toml").display().to_string();
    let found = calibrated(&rig, &out.join("dry"), &["--calibrate", "dry", "--certificate", "K-7"]);
    let mass = number(&found["end_mass"]["mass_kg"]);
    assert!((mass / (0.98 * 10.0) - 1.0).abs() < 0.01, "{found:#}");
    assert!(number(&found["end_mass"]["mass_error_kg"]) < 0.05, "{found:#}");
    let gain = |name: &str, before: &str, kg: &str| {
        let options = ["--calibrate", "gain", "--dead-weight-kg", kg, "--calibration", before];
        calibrated(&rig, &out.join(name), &options)
    };
    let zero = gain("zero", &file("dry"), "0");
    assert_eq!(zero["load_cell"]["gain"], Value::Null, "{zero:#}");
    let found = gain("loaded", &file("zero"), "500");
    let cell = &found["load_cell"];
    // force = gain (reading - offset), the other way round than in the rig's file.
    let off = (number(&cell["gain"]) - 1.0 / 0.98).abs();
    assert!(off < 4.0 * number(&cell["gain_error"]) && off < 1e-3, "{found:#}");
    let off_n = (number(&cell["offset_n"]) - 40.0).abs();
    assert!(off_n < 4.0 * number(&cell["offset_error_n"]) && off_n < 1.0, "{found:#}");
    assert_eq!(number(&found["end_mass"]["mass_kg"]), mass, "{found:#}");

    let (visit, runs) = (out.join("visit"), file("loaded"));
    let shown = visit.display().to_string();
    let options = ["--jog", "1", "--calibration", &runs, "--out", &shown];
    assert!(characterise(&options).status.success());
    let list = out.join("one.toml");
    let test = "[[test]]\nname = \"sine\"\nduration_s = 3.0\n\
                sine = { amplitude_m = 1e-3, frequency_hz = 2.0 }\n";
    std::fs::write(&list, test).unwrap();
    let list = list.display().to_string();
    let options = ["--tests", &list, "--calibration", &runs, "--out", &shown, "--overwrite"];
    let found = characterise(&options);
    assert!(found.status.success(), "{}", said(&found));
    let mapping = read(&visit.join("sine.toml"));
    assert!(mapping.contains("\"calibration: end mass of "), "{mapping}");
    assert!(mapping.contains("\"calibration: load cell of "), "{mapping}");
    assert!(mapping.contains("K-7"), "{mapping}");
    assert_eq!(read(&visit.join("calibration.toml")), read(Path::new(&runs)));
    // What is old is said, and what belongs to another rig is refused.
    let text = read(Path::new(&runs)).replace("date = \"20", "date = \"19");
    std::fs::write(&runs, text).unwrap();
    let found = characterise(&options);
    assert!(found.status.success() && said(&found).contains("expected at most 365"));
    std::fs::write(&runs, read(Path::new(&runs)).replace("node = 1", "node = 2")).unwrap();
    let found = characterise(&options);
    assert_eq!(found.status.code(), Some(2), "{}", said(&found));
    assert!(said(&found).contains("node 2"), "{}", said(&found));
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn what_a_calibration_cannot_be_is_refused_in_one_line() {
    let out = folder("calibration-refused");
    let runs = out.join("run").display().to_string();
    for (options, expected) in [
        (&["--calibrate", "bar", "--tests", "short"][..], "--tests"),
        (&["--calibrate", "bar", "--jog", "1"], "--jog"),
        (&["--calibrate", "bar"], "--cell-kn"),
        (&["--calibrate", "bar", "--cell-kn", "0.5"], "1 to 500 kN"),
        (&["--calibrate", "bar", "--cell-kn", "50", "--bar-um", "100"], "1 to 90 um"),
        (&["--calibrate", "bar", "--cell-kn", "50", "--at-mm", "600"], "-500 to 500 mm"),
        (&["--calibrate", "gain"], "--dead-weight-kg"),
        (&["--calibrate", "gain", "--dead-weight-kg", "-1"], "0 to 10000 kg"),
        (&["--calibrate", "gain", "--shunt-n", "many"], "-100000 to 100000 N"),
        (&["--calibrate", "gain", "--shunt-n", "1", "--reference-n", "1"], "--reference-n"),
        (&["--calibrate", "dry", "--cell-kn", "50"], "--calibrate bar"),
        (&["--calibrate", "bar", "--shunt-n", "5"], "--calibrate gain"),
        (&["--calibrate", "fixture"], "bar"),
        (&["--certificate", "K-7"], "--calibrate"),
        (&["--calibration", "nowhere.toml"], "nowhere.toml"),
        (&["--calibration-days", "0", "--calibration", "a.toml"], "1 to 3650"),
    ] {
        let found = characterise(&[&["--out", &runs], options].concat());
        let message = said(&found);
        assert_eq!(found.status.code(), Some(2), "{options:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{options:?}: {message}");
        assert!(message.contains(expected), "{options:?}: {message}");
        assert!(!Path::new(&runs).exists(), "{options:?}");
    }
    std::fs::remove_dir_all(out).unwrap();
}
