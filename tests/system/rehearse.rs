//! `yawbench rehearse` as a person uses it: a scenario whose limits hold, one whose limit is
//! passed, and what it refuses.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;
use std::path::Path;

fn rehearse(args: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().arg("rehearse").args(args).current_dir(repository()));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

/// The result of a rehearsal, which fits its schema and its exit code.
fn rehearsed(args: &[&str]) -> Value {
    let (code, printed, complained) = rehearse(&[args, &["--json"]].concat());
    let result: Value = serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{complained}"));
    let schema = read(&repository().join("docs/schema/rehearsal.schema.json"));
    let found = misfits(&serde_json::from_str(&schema).unwrap(), &result);
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(code, Some(i32::from(result["holds"] == false)), "{printed}");
    result
}

/// The check of a key.
fn check<'a>(result: &'a Value, key: &str) -> &'a Value {
    let checks = result["checks"].as_array().unwrap();
    checks.iter().find(|check| check["check"] == key).unwrap_or_else(|| panic!("no {key}"))
}

fn reached(result: &Value, key: &str) -> f64 {
    check(result, key)["reached"].as_f64().unwrap_or_else(|| panic!("nothing reached by {key}"))
}

/// A scenario of a locomotive with one damper on a rig, and more lines.
fn scenario(place: &Path, more: &str) -> String {
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let text = format!(
        "vehicle = '{}'\nspeed_kmh = 160.0\nduration_s = 6.0\n{more}\n\
         [track.irregularity.aar6]\nseed = 1\nshortest_m = 1.0\nlongest_m = 100.0\n\
         [[slot]]\nplace = \"front left\"\non = \"rig\"\nnode = 1\n",
        vehicle.display()
    );
    let file = place.join("scenario.toml");
    std::fs::write(&file, text).unwrap();
    file.display().to_string()
}

#[test]
fn every_limit_of_a_sound_scenario_holds_and_nothing_is_written() {
    let place = folder("rehearse-holds");
    let file = scenario(&place, "");
    let result = rehearsed(&[&file]);
    assert_eq!((&result["holds"], &result["state"]), (&true.into(), &"completed".into()));
    assert_eq!(result["duration_s"], 6.0);
    // The motion of the ram is that of the command: one check says of both nearly the same.
    let (command, measured) = (reached(&result, "stroke_m"), reached(&result, "displacement"));
    assert!(measured > 1e-3 && (command - measured).abs() < 0.1 * measured, "{command} {measured}");
    // Nothing is lost in memory, and a damper takes work in every cycle of the motion.
    for key in ["lost_in_a_row", "lost_of_50", "lost_of_250", "work"] {
        assert_eq!(reached(&result, key), 0.0, "{key}");
    }
    assert_eq!(check(&result, "temperature")["verdict"], "not_measured");
    assert_eq!(std::fs::read_dir(&place).unwrap().count(), 1);
}

#[test]
fn a_later_ram_costs_the_damping_of_the_formula_and_ends_at_the_gate() {
    let place = folder("rehearse-late");
    let file = scenario(&place, "");
    let costs = ["0.5", "1.5", "5"].map(|ms| {
        let result = rehearsed(&[&file, "--delay-ms", ms]);
        (reached(&result, "damping_lost"), result)
    });
    let [(none, _), (some, _), (much, refused)] = &costs;
    // A lag of 0.5 ms is no delay of the force; a millisecond costs about 4 % of the damping.
    assert!(*none < 0.005 && (0.03..0.05).contains(some) && *much > 0.1, "{none} {some} {much}");
    assert_eq!(refused["cause"]["signal"], "delay");
    assert_eq!((&refused["state"], &refused["duration_s"]), (&"ramped_out".into(), &0.0.into()));
}

#[test]
fn a_lower_limit_is_passed_and_named() {
    let place = folder("rehearse-beyond");
    let file = scenario(&place, "[plausibility]\nvelocity = { limit_m_per_s = 5e-3 }");
    let out = place.join("out").display().to_string();
    let (code, printed, _) = rehearse(&[&file, "--out", &out]);
    assert_eq!(code, Some(1), "{printed}");
    assert!(printed.contains("beyond: front left velocity"), "{printed}");
    let kept: Value = serde_json::from_str(&read(&place.join("out/rehearsal.json"))).unwrap();
    let velocity = check(&kept, "velocity");
    assert_eq!((&velocity["verdict"], &velocity["limit"]), (&"beyond".into(), &5e-3.into()));
    assert!(velocity["margin_percent"].as_f64().unwrap() < 0.0, "{velocity}");
    assert_eq!(kept["cause"]["signal"], "velocity");
}

#[test]
fn the_delay_that_an_open_loop_and_a_run_have_measured_is_rehearsed() {
    let place = folder("rehearse-measured");
    let file = scenario(&place, "");
    let command = |args: &[&str]| {
        let result = output(yawbench().args(args).current_dir(&place));
        assert!(result.status.success(), "{}", String::from_utf8_lossy(&result.stderr));
    };
    command(&["characterise", "--bus", "memory", "--tests", "short", "--out", "rig"]);
    command(&["run", &file, "--pace", "fast", "--out", "run"]);
    for measured in ["rig", "run"] {
        let measured = place.join(measured).display().to_string();
        let result = rehearsed(&[&file, "--measured", &measured]);
        // The lag of the laboratory rig.
        let delay_s = result["ram"]["delay_s"].as_f64().unwrap();
        assert!((delay_s - 0.5e-3).abs() < 0.02e-3, "{measured}: {delay_s}");
    }
    let tracking: Value = serde_json::from_str(&read(&place.join("rig/tracking.json"))).unwrap();
    let schema = read(&repository().join("docs/schema/tracking.schema.json"));
    let found = misfits(&serde_json::from_str(&schema).unwrap(), &tracking);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn what_cannot_be_rehearsed_is_one_line() {
    let place = folder("rehearse-refused");
    let file = scenario(&place, "");
    let empty = place.display().to_string();
    for (args, expected) in [
        (&["none.toml"][..], "none.toml"),
        (&[&file, "--delay-ms", "-1"][..], "--delay-ms -1: expected a delay from 0 to 64 ms"),
        (&[&file, "--measured", &empty][..], "expected the folder of an open loop or of a run"),
        (&[&file, "--overwrite"][..], "--out"),
    ] {
        let (code, printed, complained) = rehearse(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
}
