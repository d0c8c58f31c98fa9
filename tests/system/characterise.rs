//! `yawbench characterise`: virtual visits, figures of measured records, and what it refuses.

use crate::support::command::{folder, output, repository, yawbench};
use crate::support::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

const MODEL: &str = "[damper]\nclearance_2a_m = 1e-3\nf_relief_n = 15e3\nc2_n_s_per_m = 60e3\n";

const ONE_TEST: &str = "[[test]]\nname = \"one\"\nduration_s = 2.0\n\
    sine = { amplitude_m = 3e-3, frequency_hz = 3.0 }\n";

/// A folder with the model in it.
fn place(name: &str) -> PathBuf {
    let place = folder(name);
    std::fs::write(place.join("model.toml"), MODEL).unwrap();
    place
}

fn characterise(place: &Path, args: &[&str]) -> Output {
    output(yawbench().arg("characterise").args(args).current_dir(place))
}

fn figures(place: &Path, args: &[&str]) -> Value {
    let result = characterise(place, args);
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{errors}");
    serde_json::from_slice(&result.stdout).unwrap()
}

#[test]
fn a_visit_leaves_records_that_give_the_same_figures_when_they_are_read_again() {
    let place = place("visit");
    let visit = figures(&place, &["model.toml", "--tests", "short", "--out", "a", "--json"]);
    let schema = std::fs::read_to_string(repository().join("docs/schema/laboratory.schema.json"));
    let schema: Value = serde_json::from_str(&schema.unwrap()).unwrap();
    assert_eq!(schema::misfits(&schema, &visit), Vec::<String>::new());
    let kept: Value =
        serde_json::from_str(&std::fs::read_to_string(place.join("a/laboratory.json")).unwrap())
            .unwrap();
    assert_eq!(visit, kept);
    // The working sine, worked out for this project by another program: 140.4 J, 4.03 MN/m.
    let sine = &visit["tests"][0];
    assert!((sine["work_per_cycle_j"].as_f64().unwrap() / 140.4 - 1.0).abs() < 5e-3, "{sine}");
    let stiffness = sine["dynamic"]["stiffness_real_n_per_m"].as_f64().unwrap();
    assert!((stiffness / 4.03e6 - 1.0).abs() < 5e-3, "{stiffness}");

    let names: Vec<String> = visit["tests"]
        .as_array()
        .unwrap()
        .iter()
        .map(|test| format!("a/{}.csv", test["name"].as_str().unwrap()))
        .collect();
    let mut args = vec!["--json", "--out", "b", "--from"];
    args.extend(names.iter().map(String::as_str));
    let again = figures(&place, &args);
    assert_eq!(schema::misfits(&schema, &again), Vec::<String>::new());
    assert_eq!(again["source"], "measured");
    for (first, second) in
        visit["tests"].as_array().unwrap().iter().zip(again["tests"].as_array().unwrap())
    {
        // A file has a thousandth of a newton and a nanometre.
        for key in ["force_max_n", "force_mean_n", "amplitude_m", "duration_s"] {
            let (a, b) = (first[key].as_f64().unwrap(), second[key].as_f64().unwrap());
            assert!((a - b).abs() < 2e-3, "{key}: {a} {b}");
        }
        assert_eq!(first["cycles_used"], second["cycles_used"]);
        if let Some(work) = first["work_per_cycle_j"].as_f64() {
            let read = second["work_per_cycle_j"].as_f64().unwrap();
            assert!((work / read - 1.0).abs() < 1e-4, "{}: {work} {read}", first["name"]);
        }
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_result_was_overwritten_without_a_warning() {
    let place = place("again");
    std::fs::write(place.join("list.toml"), ONE_TEST).unwrap();
    let visit = ["model.toml", "--tests", "list.toml", "--out", "a"];
    assert_eq!(characterise(&place, &visit).status.code(), Some(0));
    let first = std::fs::read(place.join("a/one.csv")).unwrap();
    std::fs::write(place.join("a/notes.txt"), "mine").unwrap();
    let other = [visit.as_slice(), &["--seed", "2"]].concat();
    let refused = characterise(&place, &other);
    let text = String::from_utf8_lossy(&refused.stderr).trim().to_owned();
    assert_eq!((refused.status.code(), text.lines().count()), (Some(2), 1), "{text}");
    assert!(text.contains("--out a: holds a result of `characterise`"), "{text}");
    assert!(std::fs::read(place.join("a/one.csv")).unwrap() == first);
    let replaced = characterise(&place, &[other.as_slice(), &["--overwrite"]].concat());
    assert_eq!(replaced.status.code(), Some(0));
    assert!(std::fs::read(place.join("a/one.csv")).unwrap() != first);
    assert_eq!(std::fs::read_to_string(place.join("a/notes.txt")).unwrap(), "mine");
    // The user's own file is in the way of a new result.
    std::fs::create_dir(place.join("b")).unwrap();
    std::fs::write(place.join("b/one.toml"), MODEL).unwrap();
    let taken = ["model.toml", "--tests", "list.toml", "--out", "b", "--overwrite"];
    let text = characterise(&place, &taken);
    assert_eq!(text.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&text.stderr).contains("b/one.toml"));
    assert_eq!(std::fs::read_to_string(place.join("b/one.toml")).unwrap(), MODEL);
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_record_has_its_names_in_line_1_and_its_direction_in_a_mapping() {
    let place = place("mapping");
    std::fs::write(place.join("list.toml"), ONE_TEST).unwrap();
    figures(&place, &["model.toml", "--tests", "list.toml", "--out", "a", "--json"]);
    let text = std::fs::read_to_string(place.join("a/one.csv")).unwrap();
    assert!(text.starts_with("time_s,displacement_m,force_n,temperature_degc\n0,"), "{text:.99}");
    let mapping = std::fs::read_to_string(place.join("a/one.toml")).unwrap();
    for line in ["mapping_for = \"one.csv\"", "specimen = \"model\"", "extension = \"positive\""] {
        assert!(mapping.lines().any(|other| other == line), "no {line} in {mapping}");
    }
    let alone = ["--from", "a/one.csv", "--out", "b", "--json"];
    let explicit = ["--from", "a/one.csv", "--mapping", "a/one.toml", "--out", "c", "--json"];
    assert_eq!(figures(&place, &alone), figures(&place, &explicit));
    let turned = mapping.replace("\"positive\"", "\"unknown\"");
    std::fs::write(place.join("a/one.toml"), turned).unwrap();
    let unknown = figures(&place, &["--from", "a/one.csv", "--out", "d", "--json"]);
    assert_eq!(unknown["direction_declared"], false);
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn ctrl_c_ended_a_visit_without_a_message() {
    let place = place("stop");
    let list = ONE_TEST.replace("2.0", "3600.0");
    std::fs::write(place.join("list.toml"), list).unwrap();
    let mut command = yawbench();
    command.args(["characterise", "model.toml", "--tests", "list.toml", "--out", "a"]);
    command.current_dir(&place).stderr(std::process::Stdio::piped());
    let child = command.spawn().unwrap();
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    // Until the program has a handler for SIGINT, bit 1 of the mask.
    let handled = |text: String| {
        let mask = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 2 != 0)
    };
    while !std::fs::read_to_string(&status).is_ok_and(handled) {
        std::thread::yield_now();
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let result = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&result.stderr).trim().to_owned();
    assert_eq!(result.status.code(), Some(130), "{text}");
    // While the files are still read it is the first result that is missing, then the first test.
    let ended = [
        "interrupted before the first test was recorded: nothing is written",
        "interrupted before the first result: no result is written",
    ];
    assert!(ended.iter().any(|ended| text.ends_with(ended)), "{text}");
    assert!(!place.join("a").exists());
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn the_seed_decides_the_noise_to_the_last_byte() {
    let place = place("seed");
    std::fs::write(place.join("list.toml"), ONE_TEST).unwrap();
    for (out, seed) in [("a", "7"), ("b", "7"), ("c", "8")] {
        figures(
            &place,
            &["model.toml", "--tests", "list.toml", "--seed", seed, "--out", out, "--json"],
        );
    }
    let csv = |out: &str| std::fs::read(place.join(out).join("one.csv")).unwrap();
    assert!(csv("a") == csv("b"), "the same seed");
    assert!(csv("a") != csv("c"), "another seed");
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_hydraulic_damper_is_held_against_its_datasheet() {
    let place = place("physical");
    let list = "[[test]]\nname = \"slow\"\n\
                triangle = { stroke_m = 15e-3, speed_m_per_s = 0.03, cycles = 2 }\n";
    std::fs::write(place.join("list.toml"), list).unwrap();
    let row = |force: f64| {
        format!(
            "[[force]]\nvelocity_m_per_s = 0.03\nextension_n = {force}\ncompression_n = {force}\n"
        )
    };
    let damper = repository().join("scenarios/dampers/hydraulic-yaw-damper.toml");
    for (force, verdict) in [(16.5e3, true), (12.0e3, false)] {
        std::fs::write(place.join("sheet.toml"), row(force)).unwrap();
        let args = ["--physical", damper.to_str().unwrap(), "--tests", "list.toml"];
        let more = ["--datasheet", "sheet.toml", "--out", "o", "--overwrite", "--json"];
        let visit = figures(&place, &[args.as_slice(), &more].concat());
        assert_eq!(visit["source"], "physical");
        assert_eq!(
            visit["force_velocity"][0]["within_limit"], verdict,
            "{}",
            visit["force_velocity"]
        );
    }
    let args = ["--physical", damper.to_str().unwrap(), "--tests", "list.toml", "--out", "p"];
    let result = characterise(&place, &args);
    let text = String::from_utf8_lossy(&result.stdout);
    for part in
        ["Force over velocity", "extension kN", "slow", "virtual visit, seed 1", "files in p"]
    {
        assert!(text.contains(part), "no {part} in {text}");
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn bad_input_gets_one_line_and_nothing_is_written() {
    let place = place("refused");
    std::fs::write(place.join("far.toml"), "[[test]]\nname = \"far\"\nmean_m = 0.2\nduration_s = 2.0\nsine = { amplitude_m = 1e-3, frequency_hz = 3.0 }\n").unwrap();
    std::fs::write(place.join("bad.toml"), "[[test]]\nname = \"bad\"\n").unwrap();
    std::fs::write(place.join("soft.toml"), "[damper]\nke_n_per_m = -1.0\n").unwrap();
    std::fs::write(place.join("short.csv"), "time_s,displacement_m,force_n\n0.0,0.0,0.0\n")
        .unwrap();
    let damper = repository().join("scenarios/dampers/hydraulic-yaw-damper.toml");
    let damper = damper.to_str().unwrap();
    let cases: [(&[&str], &[&str]); 7] = [
        (&["nothing.toml"], &["nothing.toml", "cannot be read"]),
        (&["soft.toml"], &["soft.toml:2", "ke_n_per_m = -1"]),
        (&["model.toml", "--tests", "medium"], &["medium", "cannot be read"]),
        (&["model.toml", "--tests", "bad.toml"], &["bad.toml", "\"bad\" has 0 motions"]),
        (&["model.toml", "--datasheet", "model.tom"], &["model.tom", "cannot be read"]),
        (&["--physical", damper, "--tests", "far.toml"], &["\"far\"", "half_stroke_m = 0.11"]),
        (&["--from", "short.csv"], &["short.csv"]),
    ];
    for (args, parts) in cases {
        let result = characterise(&place, &[args, &["--out", "out"]].concat());
        let text = String::from_utf8_lossy(&result.stderr).trim().to_owned();
        assert_eq!(result.status.code(), Some(2), "{args:?}: {text}");
        assert_eq!(text.lines().count(), 1, "{args:?}: {text}");
        for part in parts {
            assert!(text.contains(part), "{args:?}: no {part} in {text}");
        }
        assert!(result.stdout.is_empty() && !place.join("out").exists(), "{args:?}");
    }
    // A record in the place of the damper was read as TOML: "key with no value, expected `=`".
    let refused = characterise(&place, &["short.csv", "--out", "out"]);
    let text = String::from_utf8_lossy(&refused.stderr).trim().to_owned();
    assert_eq!((refused.status.code(), text.lines().count()), (Some(2), 1), "{text}");
    assert!(text.contains("short.csv: found a CSV file, expected the TOML file"), "{text}");
    assert!(text.contains("--from short.csv"), "{text}");
    // No damper at all, or two.
    for args in [&[][..], &["model.toml", "--physical", damper], &["model.toml", "--from", "a.csv"]]
    {
        assert_eq!(characterise(&place, args).status.code(), Some(2), "{args:?}");
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_mapping_is_proposed_and_never_replaces_a_file_unasked() {
    let place = place("propose");
    let row = |n: u32| {
        let angle = 0.0125 * f64::from(n);
        let (x, force) = (512.0 + 400.0 * libm::sin(angle), 512.0 + 420.0 * libm::cos(angle));
        format!("{n};{x:.0};{force:.0}\n")
    };
    let table = format!("time_ms;Weg_raw;Kraft_raw\n{}", (0..3000).map(row).collect::<String>());
    std::fs::write(place.join("raw.csv"), &table).unwrap();
    let printed = characterise(&place, &["--propose-mapping", "raw.csv"]);
    assert_eq!(printed.status.code(), Some(0));
    let text = String::from_utf8_lossy(&printed.stdout).into_owned();
    for part in ["separator = \"semicolon\"", "unit = \"ms\"", "QUESTION: which unit?"] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    let write = ["--propose-mapping", "raw.csv", "--out", "map.toml"];
    assert_eq!(characterise(&place, &write).status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(place.join("map.toml")).unwrap(), text);
    let refused = characterise(&place, &write);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("--out map.toml: found a file that exists"), "{said}");
    let own = ["--propose-mapping", "raw.csv", "--out", "raw.csv", "--overwrite"];
    assert_eq!(characterise(&place, &own).status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(place.join("raw.csv")).unwrap(), table);
    let answered =
        text.replace("# scale = 1.0", "scale = 10.0").replace("# offset = 0.0", "offset = 512");
    let answered = answered.replacen("scale = 10.0", "scale = 2.5e-5", 1);
    std::fs::write(place.join("map.toml"), answered).unwrap();
    let read = ["--from", "raw.csv", "--mapping", "map.toml", "--out", "o", "--json"];
    let figures = figures(&place, &read);
    let amplitude_m = figures["tests"][0]["amplitude_m"].as_f64().unwrap();
    assert!((amplitude_m / 10e-3 - 1.0).abs() < 0.01, "{figures}");
    std::fs::remove_dir_all(place).unwrap();
}
