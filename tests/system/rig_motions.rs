//! A rig in open loop without a list of tests: playback, jog, warm-up.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

fn characterise(out: &Path, options: &[&str]) -> Output {
    let mut command = yawbench();
    command.args(["characterise", "--bus", "memory", "--out"]).arg(out);
    output(command.args(options))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A record without a force, at 200 Hz, in millimetres.
fn record(path: &Path, x_mm: impl Fn(f64) -> f64) -> String {
    let mut text = "time_s,Weg in mm\n".to_owned();
    for n in 0..800 {
        let time_s = 5e-3 * f64::from(n);
        writeln!(text, "{time_s:.3},{:.6}", x_mm(time_s)).unwrap();
    }
    std::fs::write(path, text).unwrap();
    path.display().to_string()
}

/// 3 mm at 3 Hz about 12 mm, which rises in a second.
fn service_mm(time_s: f64) -> f64 {
    let risen = time_s.min(1.0);
    12.0 + risen * risen * (3.0 - 2.0 * risen) * 3.0 * libm::sin(TAU * 3.0 * time_s)
}

#[test]
fn a_record_is_followed_and_leaves_a_record_that_can_be_followed_again() {
    let out = folder("play");
    let file = record(&out.join("service.csv"), service_mm);
    let found = characterise(&out.join("first"), &["--play", &file]);
    assert!(found.status.success(), "{}", said(&found));
    let csv = read(&out.join("first/played-service.csv"));
    for row in csv.lines().skip(1).step_by(10) {
        let mut cells = row.split(',').map(|cell| cell.parse::<f64>().unwrap());
        let (time_s, x_m) = (cells.next().unwrap(), cells.next().unwrap());
        // The laboratory rig is half a millisecond late.
        let expected_m = 1e-3 * service_mm(time_s - 0.5e-3);
        assert!((x_m - expected_m).abs() < 20e-6, "{time_s} s: {x_m} m, {expected_m} m");
    }
    let tracking: Value = serde_json::from_str(&read(&out.join("first/tracking.json"))).unwrap();
    let file = repository().join("docs/schema/tracking.schema.json");
    let schema: Value = serde_json::from_str(&read(&file)).unwrap();
    assert_eq!(schema::misfits(&schema, &tracking), Vec::<String>::new());
    let delay_s = tracking["delay_s"].as_f64().unwrap();
    let error_s = tracking["delay_standard_error_s"].as_f64().unwrap();
    assert!((delay_s - 0.5e-3).abs() < 5e-6 && (0.0..5e-6).contains(&error_s), "{tracking:#}");

    let again = out.join("first/played-service.csv").display().to_string();
    let found = characterise(&out.join("second"), &["--play", &again]);
    assert!(found.status.success(), "{}", said(&found));
    assert!(out.join("second/played-played-service.csv").is_file());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_record_that_the_ram_cannot_follow_is_refused_with_time_and_value() {
    let out = folder("play-refused");
    let begun = record(&out.join("begun.csv"), |t| 3.0 * libm::sin(TAU * 3.0 * t));
    let far = record(&out.join("far.csv"), |t| 120.0 + service_mm(t));
    let step = |t| service_mm(t) + if t < 2.0 { 0.0 } else { 5.0 };
    let step = record(&out.join("step.csv"), step);
    let good = record(&out.join("good.csv"), service_mm);
    let mapping = "no-mapping.toml";
    for (options, parts) in [
        (&["--play", &begun][..], &["begun.csv", "at 0.000 s", "56.6 mm/s", "at rest"][..]),
        (&["--play", &far], &["far.csv", "132.0 mm", "100.0 mm"]),
        (&["--play", &step], &["step.csv", "at 1.98", "m/s2", "--play-"]),
        (&["--play", &good, "--play-speed", "0.05"], &["good.csv", "0.05", "--play-speed"]),
        (&["--play", &good, "--play-acceleration", "1"], &["good.csv", "--play-acceleration"]),
        (&["--play", &good, "--play-speed", "3"], &["up to 2 m/s"]),
        (&["--play", &good, "--mapping", mapping], &[mapping]),
        (&["--play", "nowhere.csv"], &["nowhere.csv"]),
        (&["--play", &good, "--tests", "short"], &["--tests"]),
        (&["--mapping", mapping], &["--mapping", "--play"]),
        (&["--jog", "200"], &["-100 to 100 mm"]),
        (&["--warm-up", "200"], &["-40 to 120"]),
        (&["--jog", "1", "--warm-up", "20"], &["--warm-up"]),
    ] {
        let found = characterise(&out.join("refused"), options);
        let message = said(&found);
        assert_eq!(found.status.code(), Some(2), "{options:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{options:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{options:?}: {message}");
        assert!(!out.join("refused").exists(), "{options:?}");
    }
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_jog_rests_where_it_leads_unless_that_is_beyond_the_stroke() {
    let out = folder("jog");
    let found = characterise(&out.join("there"), &["--jog", "-12.5"]);
    let text = String::from_utf8_lossy(&found.stdout).into_owned();
    assert!(found.status.success(), "{}", said(&found));
    assert!(text.contains("rests at -12.50 mm"), "{text}");
    // Exactly the stroke is too far for a ram whose sensor has noise; 90 mm is not.
    let short = out.join("short.toml");
    std::fs::write(&short, "stroke_m = 0.1\n").unwrap();
    let rig = short.display().to_string();
    assert!(characterise(&out.join("far"), &["--jog", "90", "--rig", &rig]).status.success());
    // A bar leaves no room for a jog: the rig agrees to a tenth of a millimetre.
    std::fs::write(&short, "mounted = \"bar\"\n").unwrap();
    let found = characterise(&out.join("held"), &["--jog", "1", "--rig", &rig]);
    assert_eq!(found.status.code(), Some(3), "{}", said(&found));
    assert!(!out.join("held").exists());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn warm_oil_is_all_that_a_warm_up_leaves() {
    let out = folder("warm-up");
    let rig = repository().join("scenarios/rigs/servo-hydraulic-rig.toml").display().to_string();
    let found = characterise(&out.join("warm"), &["--warm-up", "20.4", "--rig", &rig]);
    let text = String::from_utf8_lossy(&found.stdout).into_owned();
    assert!(found.status.success(), "{}", said(&found));
    assert!(text.contains("the oil is at 20.4") || text.contains("the oil is at 20.5"), "{text}");
    // The laboratory rig has no thermometer.
    let found = characterise(&out.join("blind"), &["--warm-up", "21"]);
    assert_eq!(found.status.code(), Some(1), "{}", said(&found));
    assert!(said(&found).contains("no temperature"), "{}", said(&found));
    std::fs::remove_dir_all(out).unwrap();
}
