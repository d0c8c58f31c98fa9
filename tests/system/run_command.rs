//! `yawbench run` on the memory bus, as a person runs it, and everything it leaves behind.

use crate::support::command::{folder, output, repository, yawbench};
use crate::support::opened::Opened;
use crate::support::record::Record;
use crate::support::schema;
use can_protocol::{Message, MessageId, Node, Profile, RunState};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// Runs a scenario for some seconds of model time; gives the folder and the summary.
fn run(scenario: &str, seconds: &str) -> (PathBuf, Value) {
    static RUNS: AtomicU32 = AtomicU32::new(0);
    let out = folder(&format!("run-{}", RUNS.fetch_add(1, Ordering::Relaxed)));
    let result = output(
        yawbench()
            .arg("run")
            .arg(repository().join("scenarios").join(scenario))
            .args(["--pace", "fast", "--duration", seconds, "--json", "--out"])
            .arg(&out),
    );
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{errors}");
    let printed: Value = serde_json::from_slice(&result.stdout).unwrap();
    let kept: Value = read_json(&out.join("summary.json"));
    assert_eq!(printed, kept);
    (out, kept)
}

fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_run_leaves_a_summary_that_its_schema_knows() {
    let (out, summary) = run("ss9-160kmh.toml", "4");
    let schema = read_json(&repository().join("docs/schema/summary.schema.json"));
    assert_eq!(schema::misfits(&schema, &summary), Vec::<String>::new());
    assert_eq!(summary["steps"], 4000);
    assert!(summary["notes"].to_string().contains("CALIBRATED"), "{}", summary["notes"]);
    // Four fades of half a second.
    assert_eq!(summary["cycles"], 6000);
    assert_eq!(summary["frames"]["sent"], 6000);
    assert_eq!(summary["frames"]["received"], 6000);
    assert_eq!(summary["frames"]["lost"], 0);
    assert_eq!(summary["damper"][0]["place"], "rig");
    assert_eq!(summary["damper"][0]["name"], "front left");
    assert_eq!(summary["damper"][3]["name"], "rear right");
    let order =
        |body: &str| summary["accelerations"][body]["lateral_rms_m_per_s2"].as_f64().unwrap();
    assert!(order("wheelset_1") > order("bogie_front"));
    assert!(order("bogie_front") > order("carbody"));
    // A schema that nothing can violate protects nothing.
    let mut wrong = summary.clone();
    wrong["steps"] = Value::String("many".to_owned());
    assert_eq!(schema::misfits(&schema, &wrong).len(), 1);
    std::fs::remove_dir_all(out).unwrap();
}

/// Id and payload of every line of a log.
fn frames(log: &str) -> Vec<(u16, Vec<u8>)> {
    let of_line = |line: &str| {
        let (id, data) = line.split(' ').nth(2).unwrap().split_once('#').unwrap();
        let byte = |at: usize| u8::from_str_radix(&data[at..at + 2], 16).unwrap();
        let bytes = (0..data.len()).step_by(2).map(byte).collect();
        (u16::from_str_radix(id, 16).unwrap(), bytes)
    };
    log.lines().map(of_line).collect()
}

#[test]
fn the_record_is_lossless_and_its_frames_are_the_forces() {
    let (out, summary) = run("ss9-160kmh.toml", "2");
    let record = Record::read(&out.join("record.npy"));
    assert_eq!(record.rows(), 4000);
    // The answer in ARMED comes before the first row: the log has it, and what opens the rest.
    let mut opened = Opened::default();
    for (id, data) in frames(&std::fs::read_to_string(out.join("bus.log")).unwrap()) {
        if let Some(Message::Measurement(_)) = opened.hear(id, &data) {
            break;
        }
    }
    for row in 0..record.rows() {
        assert_eq!(record.integer(row, "cycle", 0), row as u64 + 1);
        let bytes: [u8; 16] = std::array::from_fn(|byte| record.integer(row, "frame", byte) as u8);
        let runs = record.integer(row, "state", 0) == u64::from(RunState::Run.code());
        assert_eq!(runs, (1000..3000).contains(&row), "row {row}");
        // Only the first cycle has no answer.
        if row > 0 {
            let id = MessageId::Measurement(Profile::Classical, Node::ALL[0]).raw();
            let Some(Message::Measurement(measurement)) = opened.hear(id, &bytes[..8]) else {
                panic!("row {row}: {bytes:?}");
            };
            if !runs {
                continue;
            }
            // What the vehicle felt is what the frame says, to the last bit.
            assert_eq!(measurement.force_n, Some(record.number(row, "force_n", 0)), "row {row}");
            assert_eq!(record.integer(row, "input", 0), 1);
        }
    }
    let last_hash = record.integer(record.rows() - 1, "hash", 0);
    assert_eq!(format!("{last_hash:016x}"), summary["trajectory_hash"]);
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn the_bus_log_is_candump_and_accounts_for_every_frame() {
    let (out, summary) = run("ss9-160kmh.toml", "2");
    let log = std::fs::read_to_string(out.join("bus.log")).unwrap();
    let (mut commands, mut measurements) = (0, 0);
    // The handshake comes first: the host's announcement, and the rig's heartbeat.
    let first: Vec<&str> = log.lines().take(2).map(|line| &line[20..]).collect();
    assert!(first[0].starts_with("memory 080#") && first[1].starts_with("memory 7"), "{first:?}");
    let mut opened = Opened::default();
    for (line, (id, data)) in log.lines().zip(frames(&log)) {
        let (line, direction) = line.rsplit_once(' ').unwrap();
        match opened.hear(id, &data).unwrap_or_else(|| panic!("{line}")) {
            Message::Command(_) => commands += 1,
            Message::Measurement(_) => measurements += 1,
            _ => {}
        }
        let sent = MessageId::from_raw(id).unwrap().is_of_host();
        assert_eq!(direction, if sent { "T" } else { "R" }, "{line}");
        assert!(line.starts_with('(') && line.contains(") memory "), "{line}");
    }
    // The first command holds the armed ram, the last one ends the run: neither is a cycle, and
    // both are answered.
    assert_eq!(commands, summary["frames"]["sent"].as_u64().unwrap() + 2);
    assert_eq!(measurements, summary["frames"]["received"].as_u64().unwrap() + 2);
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn worn_dampers_show_a_dead_zone_and_do_less_work() {
    let (new_out, new) = run("ss9-160kmh.toml", "12");
    let (worn_out, worn) = run("ss9-worn-2a-4mm.toml", "12");
    for damper in 0..4 {
        let work = |summary: &Value| summary["damper"][damper]["work_per_s_j"].as_f64().unwrap();
        let ratio = work(&worn) / work(&new);
        assert!(ratio > 0.0 && ratio < 0.8, "damper {damper}: work falls to {ratio}");
    }
    // Share of cycles without force, of a modelled damper and of the one on the rig (whose load
    // cell has noise).
    let idle = |out: &Path, slot: usize| {
        let record = Record::read(&out.join("record.npy"));
        let rows = 2000..record.rows();
        let count = rows.len() as f64;
        rows.filter(|row| record.number(*row, "force_n", slot).abs() < 30.0).count() as f64 / count
    };
    for slot in [0, 1] {
        let (new, worn) = (idle(&new_out, slot), idle(&worn_out, slot));
        assert!(new < 0.1 && worn > 0.3, "slot {slot}: without force new {new} worn {worn}");
    }
    std::fs::remove_dir_all(new_out).unwrap();
    std::fs::remove_dir_all(worn_out).unwrap();
}

#[test]
fn wear_in_software_acts_like_wear_on_the_damper() {
    let (out, one) = run("ss9-one-worn-of-four.toml", "12");
    let (new_out, new) = run("ss9-160kmh.toml", "12");
    let work = |summary: &Value, damper: usize| {
        summary["damper"][damper]["work_per_s_j"].as_f64().unwrap()
    };
    assert!(work(&one, 1) > 0.8 * work(&new, 1));
    // The same wear on the rig's damper itself, the other three as new.
    let place = folder("worn-on-the-rig");
    let text = std::fs::read_to_string(repository().join("scenarios/ss9-one-worn-of-four.toml"))
        .unwrap()
        .replace(
            "virtual_wear = { clearance_2a_m = 3.8e-3 }",
            "[rig.damper]\nclearance_2a_m = 4.0e-3",
        )
        .replace(
            "vehicles/ss9.toml",
            repository().join("scenarios/vehicles/ss9.toml").to_str().unwrap(),
        );
    std::fs::write(place.join("physical.toml"), text).unwrap();
    let out_physical = place.join("out");
    let result = output(
        yawbench()
            .arg("run")
            .arg(place.join("physical.toml"))
            .args(["--pace", "fast", "--duration", "12", "--out"])
            .arg(&out_physical),
    );
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    let physical = read_json(&out_physical.join("summary.json"));
    let ratio = work(&one, 0) / work(&physical, 0);
    println!("work, virtual {} physical {}", work(&one, 0), work(&physical, 0));
    assert!((ratio - 1.0).abs() < 0.1, "work in software over on the damper: {ratio}");
    std::fs::remove_dir_all(place).unwrap();
    std::fs::remove_dir_all(out).unwrap();
    std::fs::remove_dir_all(new_out).unwrap();
}

#[test]
fn the_report_opens_in_a_browser_with_all_its_plots() {
    let (out, _) = run("ss9-curve-400m.toml", "6");
    let html = out.join("report.html");
    let text = std::fs::read_to_string(&html).unwrap();
    for part in ["Damper forces", "Loops", "Spectra", "Timing", "CALIBRATED", "no safety function"]
    {
        assert!(text.contains(part), "{part}");
    }
    if let Some(page) = report::browser::open(&html).unwrap_or_else(|error| panic!("{error}")) {
        page.assert_complete();
    }
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_vehicle_without_yaw_dampers_runs_as_well() {
    let place = folder("coach");
    let coach = repository().join("scenarios/vehicles/manchester-coach.toml");
    let scenario = format!(
        "title = \"coach\"\nvehicle = {coach:?}\nspeed_kmh = 160.0\nduration_s = 2.0\n\
         [track.irregularity.aar6]\nseed = 3\nshortest_m = 1.0\nlongest_m = 100.0\n"
    );
    std::fs::write(place.join("coach.toml"), scenario).unwrap();
    let out = place.join("out");
    let result = output(
        yawbench()
            .arg("run")
            .arg(place.join("coach.toml"))
            .args(["--pace", "fast", "--out"])
            .arg(&out),
    );
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    assert_eq!(read_json(&out.join("summary.json"))["damper"], Value::Array(Vec::new()));
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn four_rigs_share_an_fd_bus() {
    let place = folder("four-rigs");
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let mut scenario = format!(
        "title = \"four rigs\"\nvehicle = {vehicle:?}\nspeed_kmh = 160.0\nduration_s = 2.0\n\
         [track.irregularity.aar6]\nseed = 3\nshortest_m = 1.0\nlongest_m = 100.0\n"
    );
    for (node, slot) in ["front left", "front right", "rear left", "rear right"].iter().enumerate()
    {
        let text = format!("[[slot]]\nplace = \"{slot}\"\non = \"rig\"\nnode = {}\n", node + 1);
        scenario.push_str(&text);
    }
    std::fs::write(place.join("four.toml"), scenario).unwrap();
    let out = place.join("out");
    let result = output(
        yawbench()
            .arg("run")
            .arg(place.join("four.toml"))
            .args(["--pace", "fast", "--profile", "fd", "--out"])
            .arg(&out),
    );
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{errors}");
    assert!(errors.contains("warning"), "58 % of the bus is worth a warning: {errors}");
    let summary = read_json(&out.join("summary.json"));
    assert_eq!(summary["frames"]["received"], 4 * summary["cycles"].as_u64().unwrap());
    for damper in summary["damper"].as_array().unwrap() {
        assert_eq!(damper["place"], "rig");
        assert!(damper["force_n"]["rms"].as_f64().unwrap() > 100.0, "{damper}");
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn measured_irregularity_comes_from_a_file() {
    let place = folder("measured-track");
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let mut csv = String::from(
        "# a dip of 4 mm every 25 m on the right rail\ndistance_m,vertical_m,cross_level_m\n",
    );
    for index in 0..2000 {
        let distance = f64::from(index) * 0.25;
        let dip = 2e-3 * (1.0 - libm::cos(core::f64::consts::TAU * distance / 25.0));
        let row = format!("{distance},{},{dip}\n", 0.5 * dip);
        csv.push_str(&row);
    }
    std::fs::write(place.join("track.csv"), &csv).unwrap();
    let scenario = format!(
        "title = \"measured\"\nvehicle = {vehicle:?}\nspeed_kmh = 160.0\nduration_s = 4.0\n\
         [track.irregularity.csv]\npath = \"track.csv\"\n"
    );
    std::fs::write(place.join("measured.toml"), scenario).unwrap();
    let run = |out: &Path| {
        output(
            yawbench()
                .arg("run")
                .arg(place.join("measured.toml"))
                .args(["--pace", "fast", "--out"])
                .arg(out),
        )
    };
    let out = place.join("out");
    let result = run(&out);
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    let summary = read_json(&out.join("summary.json"));
    let vertical =
        summary["accelerations"]["wheelset_1"]["vertical_rms_m_per_s2"].as_f64().unwrap();
    // 1 mm of mean dip at 160 km/h / 25 m = 1.78 Hz: 1e-3 (2 pi 1.78)^2 / sqrt(2) = 0.088 m/s2.
    assert!((vertical - 0.088).abs() < 0.02, "{vertical}");
    // A gap in the distance is named.
    std::fs::write(place.join("track.csv"), csv.replacen("\n10.25,", "\n10.5,", 1)).unwrap();
    let result = run(&place.join("other"));
    let text = String::from_utf8_lossy(&result.stderr).into_owned();
    assert_eq!(result.status.code(), Some(2), "{text}");
    for part in ["track.csv:44", "distance_m", "10.5", "10.25"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn the_scenario_that_a_run_leaves_gives_the_same_run() {
    let (out, first) = run("ss9-one-worn-of-four.toml", "3");
    let again = out.join("again");
    let result = output(
        yawbench()
            .arg("run")
            .arg(out.join("scenario.toml"))
            .args(["--pace", "fast", "--out"])
            .arg(&again),
    );
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    let second = read_json(&again.join("summary.json"));
    assert_eq!(first["trajectory_hash"], second["trajectory_hash"]);
    assert_eq!(first["damper"], second["damper"]);
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_disk_that_takes_no_more_ends_the_run_and_is_not_called_bad_input() {
    let out = folder("full-disk");
    // The limit on the size of a file stands for the disk; its signal is ignored. The kernel's own
    // full device is used by the test of the recording.
    let script = "trap '' XFSZ; ulimit -f 4000; exec \"$@\"";
    let mut limited = Command::new("sh");
    limited.args(["-c", script, "sh"]).arg(yawbench().get_program());
    let scenario = repository().join("scenarios/ss9-160kmh.toml");
    limited.arg("run").arg(scenario).args(["--pace", "fast", "--duration", "600", "--out"]);
    let result = output(limited.arg(&out));
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(1), "{errors}");
    assert!(errors.contains("record.npy: File too large"), "{errors}");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_run_whose_folder_holds_the_scenario_itself_is_refused() {
    let place = folder("own-scenario");
    let scenario = std::fs::read_to_string(repository().join("scenarios/ss9-160kmh.toml")).unwrap();
    let vehicles = repository().join("scenarios/vehicles");
    let scenario = scenario.replace("\"vehicles", &format!("\"{}", vehicles.display()));
    std::fs::write(place.join("scenario.toml"), &scenario).unwrap();
    for more in [&[][..], &["--overwrite"]] {
        let mut run = yawbench();
        run.arg("run").arg(place.join("scenario.toml")).args(["--pace", "fast", "--out"]);
        let result = output(run.arg(&place).args(more));
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{errors}");
        assert!(errors.contains("scenario.toml: is there already"), "{errors}");
        assert_eq!(std::fs::read_to_string(place.join("scenario.toml")).unwrap(), scenario);
        assert_eq!(std::fs::read_dir(&place).unwrap().count(), 1, "something was written");
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_result_is_replaced_only_with_overwrite_and_then_alone() {
    let (out, first) = run("ss9-160kmh.toml", "1");
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    let again = |more: &[&str]| {
        let mut run = yawbench();
        run.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
        run.args(["--pace", "fast", "--duration", "2", "--out"]).arg(&out).args(more);
        output(&mut run)
    };
    let refused = again(&[]);
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("holds a result of `run`") && errors.contains("--overwrite"),
        "{errors}"
    );
    assert_eq!(read_json(&out.join("summary.json")), first);
    let replaced = again(&["--overwrite"]);
    assert_eq!(replaced.status.code(), Some(0), "{}", String::from_utf8_lossy(&replaced.stderr));
    assert_eq!(read_json(&out.join("summary.json"))["steps"], 2000);
    assert_eq!(std::fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn an_interrupted_fast_run_writes_all_its_files_and_is_not_exit_code_0() {
    for (signal, scenario) in [("-INT", "ss9-160kmh.toml"), ("-TERM", "ss9-before-and-after.toml")]
    {
        let out = folder(&format!("interrupted{signal}"));
        let run = yawbench()
            .arg("run")
            .arg(repository().join("scenarios").join(scenario))
            .args(["--pace", "fast", "--duration", "240", "--json", "--out"])
            .arg(&out)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Rows are written once the loop has begun.
        while std::fs::metadata(out.join("record.npy")).map_or(0, |file| file.len()) < 100_000 {
            std::thread::yield_now();
        }
        let sent = Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let result = run.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(130), "{errors}");
        assert!(errors.contains("interrupted"), "{errors}");
        let summary = read_json(&out.join("summary.json"));
        assert_eq!(serde_json::from_slice::<Value>(&result.stdout).unwrap(), summary);
        assert_eq!((&summary["state"], &summary["comparison"]), (&"stopped".into(), &Value::Null));
        let (steps, cycles) = (summary["steps"].as_u64(), summary["cycles"].as_u64().unwrap());
        assert!(steps.unwrap() < 240_000, "{steps:?}");
        assert_eq!(Record::read(&out.join("record.npy")).rows() as u64, cycles);
        for name in ["report.html", "bus.log", "scenario.toml", "vehicle.toml", "manifest.json"] {
            assert!(out.join(name).is_file(), "no {name}");
        }
        std::fs::remove_dir_all(out).unwrap();
    }
}

#[test]
fn the_rate_on_a_bus_is_a_number_for_people() {
    let out = folder("rate");
    let mut run = yawbench();
    run.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
    run.args(["--pace", "fast", "--duration", "0.01", "--slow-down", "3", "--bitrate", "500k"]);
    let result = output(run.arg("--out").arg(&out));
    let text = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{text}");
    assert!(text.contains(" at 333 Hz, classical 500 kbit/s"), "{text}");
    std::fs::remove_dir_all(out).unwrap();
}
