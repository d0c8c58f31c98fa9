//! Ctrl-C ends a command with what it has: a study keeps its points, and the same command goes on.

use crate::support::command::{folder, output, read, repository, yawbench};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A folder with the scenario of a bogie.
fn bogie(name: &str) -> std::path::PathBuf {
    let place = folder(name);
    let vehicle = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    let vehicle = vehicle.display();
    let text =
        format!("title = \"bogie\"\nvehicle = '{vehicle}'\nspeed_kmh = 200.0\nduration_s = 1.0\n");
    std::fs::write(place.join("bogie.toml"), text).unwrap();
    place
}

/// The linear critical speed at so many values of a key.
fn asked(points: usize) -> [String; 7] {
    let vary = "--vary=vehicle.wheel_rail.surface.conical.conicity=0.045:0.055:";
    [
        "critical-speed".to_owned(),
        "bogie.toml".to_owned(),
        "--method=linear".to_owned(),
        "--from-kmh=240".to_owned(),
        "--to-kmh=260".to_owned(),
        format!("{vary}{points}"),
        "--out=found".to_owned(),
    ]
}

/// Starts a command on one core.
fn started(place: &Path, arguments: &[String]) -> Child {
    let mut command = yawbench();
    command.args(arguments).current_dir(place).env("RAYON_NUM_THREADS", "1");
    command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
}

fn interrupt(running: &Child) {
    let signalled = Command::new("kill").args(["-INT", &running.id().to_string()]).status();
    assert!(signalled.unwrap().success());
}

/// True once a process handles SIGINT, signal 2: from then on it does not end it unheard.
fn handles_interrupts(running: &Child) -> bool {
    let status = read(Path::new(&format!("/proc/{}/status", running.id())));
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
    u64::from_str_radix(caught.trim(), 16).unwrap() & 0b10 != 0
}

#[test]
fn an_interrupted_study_keeps_its_points_says_how_to_go_on_and_ends_with_130() {
    let place = bogie("interrupted-study");
    let asked = asked(400);
    let running = started(&place, &asked);
    let points = place.join("found/points-1-of-1.jsonl");
    // The first point shows that the study has begun and hears signals.
    while std::fs::metadata(&points).map_or(0, |about| about.len()) == 0 {
        std::thread::yield_now();
    }
    interrupt(&running);
    let ended = running.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(130), "{errors}");
    let kept = read(&points).lines().count();
    let said = format!("found/points-1-of-1.jsonl holds {kept} of 400 points; the same command");
    assert!((1..400).contains(&kept) && errors.contains(&said), "{errors}");

    let whole = output(yawbench().args(&asked).current_dir(&place));
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));
    assert_eq!(read(&points).lines().count(), 400);
}

#[test]
fn a_command_that_is_interrupted_while_it_reads_its_files_says_so_and_ends_with_130() {
    let place = bogie("interrupted-set-up");
    // A million points are read before the first is computed.
    let running = started(&place, &asked(1_000_000));
    while !handles_interrupts(&running) {
        std::thread::yield_now();
    }
    interrupt(&running);
    let ended = running.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(130), "{errors}");
    assert_eq!(errors, "interrupted before the first result: no result is written\n");
    assert!(ended.stdout.is_empty() && !place.join("found").exists());
}

#[test]
fn a_study_that_was_killed_reports_that_its_last_line_is_computed_again() {
    let place = bogie("killed-study");
    let asked = asked(2);
    let run = || output(yawbench().args(&asked).current_dir(&place));
    let whole = run();
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));
    let points = place.join("found/points-1-of-1.jsonl");
    let text = read(&points);
    std::fs::write(&points, &text[..text.len() - 10]).unwrap();
    let again = run();
    let errors = String::from_utf8_lossy(&again.stderr);
    let said = "points-1-of-1.jsonl: the last line was incomplete, its point was computed again\n";
    assert!(again.status.success() && errors.ends_with(said), "{errors}");
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert_eq!(read(&points).lines().count(), 2);
    assert_eq!(run().stderr, b"");
}
