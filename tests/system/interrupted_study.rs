//! Ctrl-C ends a study with the points that it has, and the same command continues.

use crate::support::command::{folder, output, read, repository, yawbench};
use std::process::{Command, Stdio};

#[test]
fn an_interrupted_study_keeps_its_points_says_how_to_go_on_and_ends_with_130() {
    let place = folder("interrupted-study");
    let vehicle = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    let vehicle = vehicle.display();
    let text =
        format!("title = \"bogie\"\nvehicle = '{vehicle}'\nspeed_kmh = 200.0\nduration_s = 1.0\n");
    std::fs::write(place.join("bogie.toml"), text).unwrap();
    let asked = [
        "critical-speed",
        "bogie.toml",
        "--method=linear",
        "--from-kmh=240",
        "--to-kmh=260",
        "--vary=vehicle.wheel_rail.surface.conical.conicity=0.045:0.055:400",
        "--out=found",
    ];
    let mut study = yawbench();
    study.args(asked).current_dir(&place).env("RAYON_NUM_THREADS", "1").stderr(Stdio::piped());
    let running = study.stdout(Stdio::piped()).spawn().unwrap();
    let points = place.join("found/points-1-of-1.jsonl");
    // The first point shows that the study has begun and hears signals.
    while std::fs::metadata(&points).map_or(0, |about| about.len()) == 0 {
        std::thread::yield_now();
    }
    let signalled = Command::new("kill").args(["-INT", &running.id().to_string()]).status();
    assert!(signalled.unwrap().success());
    let ended = running.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(130), "{errors}");
    let kept = read(&points).lines().count();
    let said = format!("found/points-1-of-1.jsonl holds {kept} of 400 points; the same command");
    assert!((1..400).contains(&kept) && errors.contains(&said), "{errors}");

    let whole = output(yawbench().args(asked).current_dir(&place));
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));
    assert_eq!(read(&points).lines().count(), 400);
}
