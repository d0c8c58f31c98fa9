//! Answers are never stale: a study whose scenario, vehicle or profile was edited is computed anew,
//! and results of different identities are never put together.

use crate::support::command::{folder, output, read, repository, yawbench};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A folder with a scenario of the SS9 whose wheel profile is a file of points.
fn locomotive(name: &str) -> PathBuf {
    let place = folder(name);
    let scenarios = repository().join("scenarios");
    let vehicle = read(&scenarios.join("vehicles/ss9.toml"));
    assert!(vehicle.contains("wheel = \"jm3_like\""));
    let vehicle = vehicle.replace("wheel = \"jm3_like\"", "wheel = \"wheel.csv\"");
    // The calibrated shape belongs to the other wheel.
    let (head, shape) = vehicle.split_once("[wheel_rail.surface.profiles.jm3_like]").unwrap();
    let (_, tail) = shape.split_once("\n[").unwrap();
    std::fs::write(place.join("vehicle.toml"), format!("{head}[{tail}")).unwrap();
    let scenario = "title = \"locomotive\"\nvehicle = \"vehicle.toml\"\nspeed_kmh = 100.0\n\
        duration_s = 1.0\n";
    std::fs::write(place.join("locomotive.toml"), scenario).unwrap();
    cone(&place, 20);
    place
}

/// Writes a conical wheel of 1 in so many, with a flange of 60 degrees.
fn cone(place: &Path, one_in: u32) {
    let mut text = "y_mm,z_mm\n".to_owned();
    for y in -480..=600 {
        let y = 0.1 * f64::from(y);
        let flange = 1.73 * (-34.0 - y).max(0.0);
        writeln!(text, "{y},{}", flange - y / f64::from(one_in)).unwrap();
    }
    std::fs::write(place.join("wheel.csv"), text).unwrap();
}

/// A folder with a scenario of Cooperrider's bogie, which is quick to compute.
fn bogie(name: &str) -> PathBuf {
    let place = folder(name);
    let vehicle = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    std::fs::copy(vehicle, place.join("vehicle.toml")).unwrap();
    let scenario = "title = \"bogie\"\nvehicle = \"vehicle.toml\"\nspeed_kmh = 100.0\n\
        duration_s = 1.0\n";
    std::fs::write(place.join("locomotive.toml"), scenario).unwrap();
    place
}

const ASKED: [&str; 7] = [
    "critical-speed",
    "locomotive.toml",
    "--method=linear",
    "--stroke-mm=1",
    "--from-kmh=310",
    "--to-kmh=370",
    "--json",
];

/// Runs the command; what it prints on standard output and on standard error.
fn asked(place: &Path, more: &[&str]) -> (Value, String) {
    let result = output(yawbench().args(ASKED).args(more).current_dir(place));
    let errors = String::from_utf8(result.stderr).unwrap();
    assert_eq!(result.status.code(), Some(0), "{more:?}: {errors}");
    (serde_json::from_slice(&result.stdout).unwrap(), errors)
}

fn refused(place: &Path, more: &[&str]) -> String {
    let result = output(yawbench().args(ASKED).args(more).current_dir(place));
    let errors = String::from_utf8(result.stderr).unwrap();
    assert_eq!(result.status.code(), Some(2), "{more:?}: {errors}");
    assert_eq!(errors.lines().count(), 1, "{more:?}: {errors}");
    errors
}

fn linear_kmh(found: &Value) -> f64 {
    found["points"][0]["linear"][0]["critical"]["kmh"].as_f64().unwrap()
}

/// A profile that went from 1:20 to 1:10 gave the old 314.7 km/h out of the same folder, where a
/// fresh one gave 271.2.
#[test]
fn conicity_1_20_to_1_10_in_the_profile_is_computed_anew() {
    let place = locomotive("stale-profile");
    let (first, said) = asked(&place, &[]);
    assert_eq!(said, "");
    // The same question again is answered from the folder.
    assert_eq!(asked(&place, &[]), (first.clone(), String::new()));
    let points = "runs/locomotive-critical-speed/points-1-of-1.jsonl";
    assert_eq!(read(&place.join(points)).lines().count(), 1);

    cone(&place, 10);
    let (second, said) = asked(&place, &[]);
    assert!(said.contains("the content of the wheel profile"), "{said}");
    assert!(said.contains("runs/locomotive-critical-speed-2"), "{said}");
    println!("{} and {} km/h", linear_kmh(&first), linear_kmh(&second));
    assert!(linear_kmh(&second) < linear_kmh(&first) - 10.0);
    assert_eq!(asked(&place, &["--out=fresh"]).0, second);

    // A folder that is named keeps its result, and its points are refused.
    let before = read(&place.join("runs/locomotive-critical-speed/critical-speed.json"));
    let said = refused(&place, &["--out=runs/locomotive-critical-speed"]);
    assert!(said.contains("the content of the wheel profile"), "{said}");
    let said = refused(&place, &["--merge", points, "--out=merged"]);
    assert!(said.contains("with another content of the wheel profile"), "{said}");
    assert!(said.contains("run the shards again"), "{said}");
    assert!(!place.join("merged").exists());
    assert_eq!(read(&place.join("runs/locomotive-critical-speed/critical-speed.json")), before);

    // With the old profile back, the old folder answers.
    cone(&place, 20);
    assert_eq!(asked(&place, &["--out=runs/locomotive-critical-speed"]).0, first);
}

#[test]
fn an_edited_vehicle_or_question_is_another_study_and_a_moved_one_is_not() {
    let place = bogie("stale-vehicle");
    let (first, _) = asked(&place, &["--out=found"]);
    let text = read(&place.join("vehicle.toml"));
    std::fs::write(place.join("vehicle.toml"), format!("{text}\n# edited\n")).unwrap();
    let said = refused(&place, &["--out=found"]);
    assert!(said.contains("the content of the vehicle"), "{said}");
    std::fs::write(place.join("vehicle.toml"), &text).unwrap();
    let said = refused(&place, &["--out=found", "--seeds=2"]);
    assert!(said.contains("seeds"), "{said}");

    let moved = folder("stale-vehicle-moved");
    for name in ["locomotive.toml", "vehicle.toml"] {
        std::fs::copy(place.join(name), moved.join(name)).unwrap();
    }
    let found = place.join("found");
    assert_eq!(asked(&moved, &["--out", found.to_str().unwrap()]).0, first);
}

#[test]
fn shards_of_another_version_of_the_program_are_refused() {
    let place = bogie("stale-program");
    asked(&place, &["--out=found"]);
    let points = place.join("found/points-1-of-1.jsonl");
    let text = read(&points);
    let at = text.find("\"program\":\"").unwrap() + "\"program\":\"".len();
    std::fs::write(&points, format!("{}0123456789abcdef{}", &text[..at], &text[at + 16..]))
        .unwrap();
    for more in [&["--merge", "found/points-1-of-1.jsonl", "--out=merged"][..], &["--out=found"]] {
        let said = refused(&place, more);
        assert!(said.contains("by another version of the program"), "{said}");
        assert!(said.contains("run the shards again"), "{said}");
    }
}
