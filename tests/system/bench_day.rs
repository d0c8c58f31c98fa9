//! A laboratory's day: every command of the table in docs/real-bench.md runs on an emulated rig, in
//! the order of the page. What is another there than on the page: the bus is memory, lengths are
//! short, and folders are those of the test.

use crate::support::command::{folder, output, read, repository, yawbench};
use std::path::{Path, PathBuf};

const SCENARIO: &str = "ss9-160kmh.toml";

/// The commands of the page, in words, without `yawbench`.
fn commands_of_the_page() -> Vec<Vec<String>> {
    let page = read(&repository().join("docs/real-bench.md"));
    let (_, day) = page.split_once("## A day in order").expect("the day");
    let rows = day.lines().skip_while(|line| !line.starts_with("| ---")).skip(1);
    let rows = rows.take_while(|line| line.starts_with('|'));
    let spans = rows.map(|row| row.split('`').skip(1).step_by(2).map(str::to_owned).collect());
    let of_row = |spans: Vec<String>| spans.into_iter().find(|span| span.starts_with("yawbench "));
    let commands = spans.filter_map(of_row);
    commands.map(|span| span.split_whitespace().skip(1).map(str::to_owned).collect()).collect()
}

/// The words of the page as this machine can run them.
fn here(words: &[String], place: &Path, number: usize) -> Vec<String> {
    let (visit, run) = (place.join("visit"), place.join("run"));
    let shown = |path: &Path| path.display().to_string();
    let scenario = shown(&repository().join("scenarios").join(SCENARIO));
    let mut adapted = Vec::new();
    for word in words {
        match word.as_str() {
            "--bus" | "socketcan:can0" => {}
            "SCENARIO" | "scenarios/ss9-160kmh.toml" => adapted.push(scenario.clone()),
            "runs/SCENARIO-1" => adapted.push(shown(&run)),
            "runs/rig-1" => adapted.push(shown(&visit)),
            "runs/rig-1/*.csv" => adapted.extend(records(&visit).iter().map(|file| shown(file))),
            other => adapted.push(other.to_owned()),
        }
    }
    let is_visit = words.iter().any(|word| word == "--tests");
    let out = if is_visit { shown(&visit) } else { shown(&place.join(number.to_string())) };
    // It reports a temperature and has a fixture; the default rig has neither.
    let servo = shown(&repository().join("scenarios/rigs/servo-hydraulic-rig.toml"));
    let takes_servo = words.iter().any(|word| word == "--warm-up" || word == "--calibrate");
    let more: Vec<&str> = match words[0].as_str() {
        "rtcheck" => vec!["--seconds", "1"],
        "characterise" if takes_servo => vec!["--bus", "memory", "--rig", &servo, "--out", &out],
        "characterise" => vec!["--bus", "memory", "--out", &out],
        "identify" => vec!["--out", &out],
        "rehearse" => vec!["--duration", "4"],
        "run" => vec!["--pace", "fast", "--duration", "4", "--out", run.to_str().expect("a path")],
        "report" => vec![run.to_str().expect("a path")],
        _ => Vec::new(),
    };
    adapted.extend(more.into_iter().map(str::to_owned));
    adapted
}

fn records(visit: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(visit).expect("the visit").flatten().map(|entry| entry.path());
    let mut records: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|ending| ending == "csv")).collect();
    records.sort();
    records
}

#[test]
fn every_command_of_the_day_runs_in_the_order_of_the_page() {
    let place = folder("day");
    let commands = commands_of_the_page();
    let mut order: Vec<&str> = commands.iter().map(|words| words[0].as_str()).collect();
    order.dedup();
    let expected =
        ["doctor", "rtcheck", "characterise", "identify", "rehearse", "run", "report", "replay"];
    assert_eq!(order, expected);
    for (number, words) in commands.iter().enumerate() {
        let words = here(words, &place, number);
        let found = output(yawbench().args(&words).current_dir(&place));
        let code = found.status.code();
        // Whether a machine is ready is not for this test to say.
        let is_answer = matches!(words[0].as_str(), "doctor" | "rtcheck") && code == Some(1);
        let complained = String::from_utf8_lossy(&found.stderr);
        assert!(code == Some(0) || is_answer, "{words:?}: {code:?}: {complained}");
        assert!(!found.stdout.is_empty(), "{words:?} prints nothing");
    }
    std::fs::remove_dir_all(place).expect("the folder");
}
