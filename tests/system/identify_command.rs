//! `yawbench identify` and `yawbench simulate`: from records and a datasheet to the named effect,
//! the files it leaves and what they are good for, and what is refused.

use crate::support::command::{output, repository, yawbench};
use crate::support::schema;
use crate::support::visit::{Sine, text_of, visit};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

/// One clear effect: 5 % more damping and relief in extension, as much less in compression.
const DAMPER: &str = "[damper]\nclearance_2a_m = 1e-3\nf_relief_n = 15e3\nc2_n_s_per_m = 60e3\n\
    [[damper.effect]]\nname = \"asymmetric_damping\"\ndamping_asymmetry = 0.05\n\
    relief_asymmetry = 0.05\n";
/// A tenth off, without clearance and without slope beyond relief.
const SHEET: &str = "[damper]\nce_n_s_per_m = 1.1e6\nke_n_per_m = 11e6\nf_relief_n = 16e3\n";
/// Sines: millimetres, hertz, seconds. Short, but with some forty whole cycles for chance to fail
/// in.
const SINES: [Sine; 5] = [
    ("work", 3.46, 3.5, 2.5),
    ("large", 5.0, 4.0, 2.5),
    ("small", 2.2, 4.0, 2.5),
    ("slow", 5.0, 2.0, 3.5),
    ("fast", 1.5, 8.0, 2.0),
];
const MODELS: [&str; 3] = ["datasheet", "refitted", "with_effects"];

/// The records of one virtual visit, `bench/*.csv`, and `sheet.toml`.
static VISIT: LazyLock<PathBuf> = LazyLock::new(|| {
    let service = "[[test]]\nname = \"service\"\nduration_s = 3.0\ntest_only = true\n\
         service = { rms_m = 2e-3, lowest_hz = 0.5, highest_hz = 12.0, tones = 24, seed = 2014 }\n";
    let place = visit("identify-visit", DAMPER, &SINES, service);
    std::fs::write(place.join("sheet.toml"), SHEET).unwrap();
    place
});

fn identify(args: &[&str]) -> Output {
    output(yawbench().arg("identify").args(args).current_dir(&*VISIT))
}

/// Identifies into a folder and gives `result.json`, held against its schema, and the folder.
fn identified(out: &str, args: &[&str]) -> (Value, PathBuf) {
    let found = identify(&[args, &["--out", out]].concat());
    assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stderr));
    let place = VISIT.join(out);
    let result: Value = serde_json::from_str(&text_of(&place.join("result.json"))).unwrap();
    let schema = text_of(&repository().join("docs/schema/identify.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &result), Vec::<String>::new());
    for effect in result["effects"].as_array().unwrap() {
        for value in effect["parameters"].as_object().unwrap().values() {
            let misfits = schema::misfits(&schema["$defs"]["parameter_value"], value);
            assert_eq!(misfits, Vec::<String>::new(), "{effect}");
        }
    }
    (result, place)
}

fn notes(result: &Value) -> String {
    let notes = result["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap());
    notes.collect::<Vec<_>>().join("\n")
}

/// The cells below the names of a CSV.
fn rows(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = text_of(path);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().to_owned();
    (names, lines.map(|line| line.split(',').map(str::to_owned).collect()).collect())
}

const COLUMNS: &str = "time_s,displacement_m,force_n,datasheet_n,refitted_n,with_effects_n";

#[test]
fn a_missing_effect_is_named_and_the_damper_with_it_runs_in_a_vehicle() {
    let train = ["bench/work.csv", "bench/large.csv", "bench/small.csv", "bench/slow.csv"];
    let rest = ["bench/fast.csv", "--holdout", "bench/service.csv", "--datasheet", "sheet.toml"];
    let (result, place) = identified("full", &[&["--train"], &train[..], &rest].concat());

    assert_eq!(result["verdict"], "effects_found");
    assert_eq!(result["effects"].as_array().unwrap().len(), 1, "{}", result["effects"]);
    let effect = &result["effects"][0];
    assert_eq!(effect["name"], "asymmetric_damping");
    assert_eq!(effect["direction"], "positive is extension, as declared");
    for name in ["damping_asymmetry", "relief_asymmetry"] {
        let value = effect["parameters"][name]["value"].as_f64().unwrap();
        assert!((value - 0.05).abs() < 2e-3, "{name} = {value}");
    }
    let gain = effect["evidence"]["holdout_gain"].as_f64().unwrap();
    assert!((0.5..1.0).contains(&gain), "{gain}");
    let ce = &result["nominal"]["ce_n_s_per_m"];
    assert_eq!((&ce["datasheet"], &ce["unit"]), (&Value::from(1.1e6), &Value::from("N s/m")));
    assert!((ce["value"].as_f64().unwrap() / 1e6 - 1.0).abs() < 0.01, "{ce}");

    // Held out: the datasheet is worse than the refit, and that worse than the model with the
    // effect, which is at the floor. The noise of the bench is 0.1 % of 50 kN.
    for role in ["train", "holdout"] {
        let rmse = MODELS.map(|model| result["errors"][model][format!("{role}_rmse_n")].as_f64());
        let [sheet, refitted, after] = rmse.map(Option::unwrap);
        assert!(sheet > 1.5 * refitted && refitted > 4.0 * after, "{role}: {rmse:?}");
        assert!((45.0..60.0).contains(&after), "{role}: {after}");
        for model in MODELS {
            let share = result["errors"][model][format!("{role}_nrmse")].as_f64().unwrap();
            assert!(share > 1e-3 && share < 0.5, "{model} {role}: {share}");
        }
    }
    let floor = result["noise_floor_n"].as_f64().unwrap();
    assert!((45.0..60.0).contains(&floor), "{floor}");
    let lines = notes(&result);
    assert!(lines.contains("datasheet: C2 = 0.06 Ce"), "{lines}");
    assert!(lines.contains("lose 3 dB at") && !lines.contains("hold-out"), "{lines}");
    assert!(text_of(&place.join("report.html")).contains("asymmetric damping"), "no such report");
    assert_eq!(result["empirical"], Value::Null, "no map was asked for");
    assert!(!place.join("model-empirical.toml").exists());

    predictions_fit_the_result(&result, &place);
    simulate_repeats_the_predictions(&place);
    the_damper_runs_in_a_vehicle(&place);
}

/// Columns, samples, and the errors that the result states, worked out again from the files.
fn predictions_fit_the_result(result: &Value, place: &Path) {
    let tests = result["per_test"].as_array().unwrap();
    assert_eq!(tests.len(), SINES.len() + 1);
    for test in tests {
        let name = test["file"].as_str().unwrap();
        assert_eq!(test["role"], if name == "service" { "holdout" } else { "train" });
        let (names, cells) = rows(&place.join(format!("predictions/{name}.csv")));
        assert_eq!(names, COLUMNS);
        let (_, measured) = rows(&VISIT.join(format!("bench/{name}.csv")));
        assert_eq!(cells.len(), measured.len(), "{name}");
        let run_in = test["run_in_samples"].as_u64().unwrap() as usize;
        let counted = test["samples"].as_u64().unwrap() as usize;
        assert_eq!(run_in + counted, cells.len(), "{name}");
        let number = |row: &[String], column: usize| row[column].parse::<f64>().unwrap();
        for (model, column) in MODELS.iter().zip(3..) {
            let squares = cells[run_in..].iter().map(|row| {
                let error = number(row, 2) - number(row, column);
                error * error
            });
            let rmse = (squares.sum::<f64>() / counted as f64).sqrt();
            let stated = test["rmse_n"][*model].as_f64().unwrap();
            assert!((rmse / stated - 1.0).abs() < 1e-9, "{name} {model}: {rmse} {stated}");
        }
    }
}

fn simulate_repeats_the_predictions(place: &Path) {
    for name in ["service", "work"] {
        let args = [
            "simulate",
            "full/model.toml",
            &format!("bench/{name}.csv"),
            "--out",
            "s.csv",
            "--overwrite",
        ];
        let done = output(yawbench().args(args).current_dir(&*VISIT));
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        let (names, again) = rows(&VISIT.join("s.csv"));
        let (_, first) = rows(&place.join(format!("predictions/{name}.csv")));
        assert_eq!((names.as_str(), again.len()), (COLUMNS, first.len()));
        for (a, b) in again.iter().zip(&first) {
            let (a, b) = (a[5].parse::<f64>().unwrap(), b[5].parse::<f64>().unwrap());
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{name}: {a} {b}");
        }
    }
    // Without a force there is nothing to find the start of the dashpot in.
    let (_, measured) = rows(&VISIT.join("bench/service.csv"));
    let mut motion = "time_s,displacement_m\n".to_owned();
    for row in &measured {
        writeln!(motion, "{},{}", row[0], row[1]).unwrap();
    }
    std::fs::write(VISIT.join("motion.csv"), motion).unwrap();
    let args = ["simulate", "full/model.toml", "motion.csv", "--out", "m.csv"];
    let done = output(yawbench().args(args).current_dir(&*VISIT));
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{said}");
    assert!(said.contains("no column force_n, started at rest in the middle"), "{said}");
    let (_, moved) = rows(&VISIT.join("m.csv"));
    let (_, first) = rows(&place.join("predictions/service.csv"));
    let last = |rows: &[Vec<String>]| rows[rows.len() - 1][5].parse::<f64>().unwrap();
    assert!(moved[0][2].is_empty(), "{:?}", moved[0]);
    assert!((last(&moved) - last(&first)).abs() < 1.0, "the start is not forgotten in 3 s");
}

fn the_damper_runs_in_a_vehicle(place: &Path) {
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let scenario = format!(
        "title = \"identified\"\nvehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 9.0\n\
         [damper]\nfile = \"model.toml\"\n",
        vehicle.display()
    );
    std::fs::write(place.join("scenario.toml"), scenario).unwrap();
    let args = ["run", "scenario.toml", "--pace", "fast", "--duration", "1", "--out", "run"];
    let run = output(yawbench().args(args).current_dir(place));
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let kept = text_of(&place.join("run/scenario.toml"));
    assert!(kept.contains("damping_asymmetry"), "the run did not have the effect: {kept}");
}

/// Foreign columns in millimetres and kilonewtons that do not say which side is extension.
#[test]
fn without_a_declared_direction_a_side_is_a_letter() {
    let map = "[time]\ncolumn = \"t\"\n[displacement]\ncolumn = \"way\"\nunit = \"mm\"\n\
               [force]\ncolumn = \"load\"\nunit = \"kN\"\n";
    std::fs::write(VISIT.join("map.toml"), map).unwrap();
    std::fs::create_dir_all(VISIT.join("foreign")).unwrap();
    let mut args: Vec<String> = ["--mapping", "map.toml", "--train"].map(str::to_owned).to_vec();
    for (name, ..) in SINES {
        let mut text = "t,load,way\n".to_owned();
        for row in rows(&VISIT.join(format!("bench/{name}.csv"))).1 {
            let number = |column: usize| row[column].parse::<f64>().unwrap();
            writeln!(text, "{},{},{}", row[0], number(2) * 1e-3, number(1) * 1e3).unwrap();
        }
        let file = format!("foreign/{name}.csv");
        std::fs::write(VISIT.join(&file), text).unwrap();
        if name == "small" {
            args.push("--holdout".to_owned());
        }
        args.push(file);
        if name == "small" {
            args.push("--train".to_owned());
        }
    }
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let (result, place) = identified("letters", &args);
    let effect = &result["effects"][0];
    assert_eq!(effect["name"], "asymmetric_damping", "{}", result["rejected"]);
    assert_eq!(effect["direction"], "not declared: positive is side A, negative side B");
    assert_eq!(result["errors"]["datasheet"], Value::Null);
    let mapping = text_of(&place.join("predictions/small.toml"));
    assert!(mapping.ends_with("\nextension = \"unknown\"\n"), "{mapping}");
}

#[test]
fn few_tests_are_cut_into_cycles_and_the_number_of_cores_changes_no_byte() {
    let args = ["--train", "bench/work.csv", "bench/large.csv", "bench/slow.csv"];
    let mut files = Vec::new();
    for threads in ["1", "2"] {
        let out = format!("threads-{threads}");
        let mut command = yawbench();
        command.env("RAYON_NUM_THREADS", threads).arg("identify").args(args);
        let found = output(command.args(["--out", &out, "--json"]).current_dir(&*VISIT));
        assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stderr));
        let place = VISIT.join(&out);
        assert_eq!(String::from_utf8(found.stdout).unwrap(), text_of(&place.join("result.json")));
        let read = |name: &str| text_of(&place.join(name));
        files.push([read("result.json"), read("model.toml"), read("predictions/slow.csv")]);
    }
    assert!(files[0] == files[1], "another result with another number of threads");
    let result: Value = serde_json::from_str(&files[0][0]).unwrap();
    let lines = notes(&result);
    assert!(lines.contains("no hold-out was given: 1 of 3 whole tests is held out"), "{lines}");
    assert!(lines.contains("training tests: 2, fewer than four"), "{lines}");
    assert!(
        lines.contains("folds leave out 6 runs of whole cycles") && lines.contains("guard gap"),
        "{lines}"
    );
}

#[test]
fn one_test_gives_its_last_two_fifths() {
    let (result, place) = identified("one", &["--train", "bench/work.csv"]);
    assert_eq!(result["errors"]["datasheet"], Value::Null);
    assert_eq!(result["nominal"]["ce_n_s_per_m"]["datasheet"], Value::Null);
    let lines = notes(&result);
    assert!(lines.contains("one test was given: its last part, from 1."), "{lines}");
    assert!(lines.contains("training tests: 1, fewer than four"), "{lines}");
    let (_, first) = rows(&place.join("predictions/work-first-part.csv"));
    let (_, last) = rows(&place.join("predictions/work-last-part.csv"));
    let share = last.len() as f64 / (first.len() + last.len()) as f64;
    // Cut between cycles, so within half of one of nine.
    assert!((share - 0.4).abs() < 0.07, "{share}");
    assert!(first[0][3].is_empty() && !first[0][4].is_empty(), "{:?}", first[0]);
    let role = |index: usize| result["per_test"][index]["role"].clone();
    assert_eq!((role(0), role(1)), (Value::from("train"), Value::from("holdout")));
}

#[test]
fn identify_deleted_csv_files_of_the_user_in_predictions() {
    let place = VISIT.join("kept");
    std::fs::create_dir_all(place.join("predictions")).unwrap();
    let own = place.join("predictions/mine.csv");
    std::fs::write(&own, "of the user").unwrap();
    identified("kept", &["--train", "bench/work.csv"]);
    assert_eq!(text_of(&own), "of the user");

    // The folder holds a result now: it is replaced on request only, and nothing else is.
    let args = ["--train", "bench/small.csv", "--out", "kept"];
    let refused = identify(&args);
    said_in_one_line(&refused, &args, &["--out kept", "holds a result", "--overwrite"]);
    assert!(place.join("predictions/work-first-part.csv").exists());
    identified("kept", &["--train", "bench/small.csv", "--overwrite"]);
    assert_eq!(text_of(&own), "of the user");
    assert!(!place.join("predictions/work-first-part.csv").exists());
    assert!(!place.join("predictions/work-first-part.toml").exists());
    assert!(place.join("predictions/small-first-part.csv").exists());
}

#[test]
fn identify_replaced_files_that_it_had_not_written() {
    let place = VISIT.join("foreign-files");
    std::fs::create_dir_all(place.join("predictions")).unwrap();
    for name in ["result.json", "predictions/work-last-part.csv"] {
        let own = place.join(name);
        std::fs::write(&own, "of the user").unwrap();
        let args = ["--train", "bench/work.csv", "--out", "foreign-files", "--overwrite"];
        said_in_one_line(&identify(&args), &args, &[name, "was not written by this program"]);
        assert_eq!(text_of(&own), "of the user");
        std::fs::remove_file(own).unwrap();
    }
}

/// The signal is sent once the command catches it, long before the first fit ends. What is written
/// after a later signal is tested in the crate.
#[test]
fn ctrl_c_killed_identify() {
    let mut command = yawbench();
    command.args(["identify", "--train", "bench/work.csv", "bench/large.csv", "bench/slow.csv"]);
    command.args(["--out", "stopped"]).current_dir(&*VISIT);
    let running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let status = PathBuf::from(format!("/proc/{}/status", running.id()));
    let catches = || {
        let status = text_of(&status);
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        u64::from_str_radix(caught.trim(), 16).unwrap() & 0b10 != 0
    };
    while !catches() {
        std::thread::yield_now();
    }
    let sent = Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let ended = running.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).trim().to_owned();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    // During set-up, or during the first fit.
    let interrupted = said.trim_start_matches("error: ").starts_with("interrupted before");
    assert!(interrupted && said.lines().count() == 1, "{said}");
    assert!(ended.stdout.is_empty() && !VISIT.join("stopped").exists());
}

#[test]
fn simulate_replaced_existing_files() {
    let simulate = |out: &str, more: &[&str]| {
        let args = ["simulate", "damper.toml", "bench/work.csv", "--out", out];
        output(yawbench().args(args).args(more).current_dir(&*VISIT))
    };
    for (existing, out) in [("old.csv", "old.csv"), ("other.toml", "other.csv")] {
        std::fs::write(VISIT.join(existing), "of the user").unwrap();
        let parts = [out, existing, "exists", "--overwrite"];
        said_in_one_line(&simulate(out, &[]), &[out], &parts);
        assert_eq!(text_of(&VISIT.join(existing)), "of the user");
        let done = simulate(out, &["--overwrite"]);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        assert_ne!(text_of(&VISIT.join(existing)), "of the user");
    }
    // The mapping of this CSV would replace the model itself.
    let damper = text_of(&VISIT.join("damper.toml"));
    let refused = simulate("damper.csv", &["--overwrite"]);
    said_in_one_line(&refused, &[], &["damper.csv", "damper.toml, which is an input"]);
    assert_eq!(text_of(&VISIT.join("damper.toml")), damper);
    said_in_one_line(&simulate("x.toml", &[]), &[], &["x.toml", "such as .csv"]);
}

/// Other programs read the CSV with their defaults, and its mapping states the direction.
#[test]
fn predictions_have_their_names_in_line_1_and_a_mapping() {
    let args = ["simulate", "damper.toml", "bench/slow.csv", "--out", "plain.csv"];
    let done = output(yawbench().args(args).current_dir(&*VISIT));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let text = text_of(&VISIT.join("plain.csv"));
    assert_eq!(text.lines().next(), Some(COLUMNS));
    let columns = COLUMNS.split(',').count();
    assert!(text.lines().all(|line| line.split(',').count() == columns));
    // The mapping fits the file that it belongs to.
    let args = ["simulate", "damper.toml", "plain.csv", "--mapping", "plain.toml"];
    let again = output(yawbench().args(args).args(["--out", "again.csv"]).current_dir(&*VISIT));
    assert_eq!(again.status.code(), Some(0), "{}", String::from_utf8_lossy(&again.stderr));
    let extension = |name: &str| text_of(&VISIT.join(name)).lines().last().map(str::to_owned);
    assert_eq!(extension("again.toml").as_deref(), Some("extension = \"positive\""));
    assert_eq!(extension("plain.toml"), extension("again.toml"));
}

#[test]
fn bad_input_gets_one_line_and_nothing_is_written() {
    let good = text_of(&VISIT.join("bench/work.csv"));
    let lines: Vec<&str> = good.lines().collect();
    let begin = lines.iter().position(|line| line.starts_with("time_s")).unwrap();
    let write = |name: &str, text: String| std::fs::write(VISIT.join(name), text).unwrap();
    let with = |row: usize, cells: &str| {
        let mut lines = lines.clone();
        lines[begin + row] = cells;
        lines.join("\n")
    };
    write("nan.csv", with(100, "0.099,nan,1.0,20.0"));
    write("text.csv", with(100, "0.099,one,1.0,20.0"));
    write("hot.csv", with(100, "0.099,0.0,1.0,nan"));
    write("short.csv", lines[..begin + 30].join("\n"));
    write("part.csv", lines[..begin + 120].join("\n"));
    write("backwards.csv", with(100, lines[begin + 50]));
    let mut names: Vec<&str> = lines[begin].split(',').collect();
    names.swap(1, 2);
    assert_eq!(names[1..3], ["force_n", "displacement_m"]);
    write("swapped.csv", with(0, &names.join(",")));
    write("copy.csv", lines.join("\n"));
    write("renamed.csv", with(0, &lines[begin].replace("force_n", "channel_3")));
    write("unknown.toml", format!("{SHEET}stiffness = 1.0\n"));
    write("negative.toml", SHEET.replace("11e6", "-11e6"));
    write("empty.toml", "[damper]\nke_n_per_m = 11e6\n".to_owned());
    write("oil.toml", "[temperature]\ncolumn = \"oil\"\n".to_owned());
    write("wrong.toml", "[force]\nunit = \"furlong\"\n".to_owned());
    let work = "bench/work.csv";
    let cases: [(&[&str], &[&str]); 18] = [
        (
            &["--train", "none.csv", "--next-test", "--stroke-mm", "1e300"],
            &["--stroke-mm 1e300: expected 0.1 to 1000"],
        ),
        (&["--train", "none.csv"], &["none.csv", "cannot be read"]),
        (&["--train", work, "--holdout", "none.csv"], &["none.csv", "cannot be read"]),
        (&["--train", "nan.csv"], &["nan.csv", "displacement_m", "nan"]),
        (&["--train", "text.csv"], &["text.csv", "displacement_m", "one"]),
        (&["--train", "hot.csv"], &["hot.csv", "temperature_degc", "nan"]),
        (&["--train", "swapped.csv"], &["swapped.csv", "swapped?"]),
        (&["--train", "renamed.csv"], &["renamed.csv", "force_n", "channel_3"]),
        (&["--train", "short.csv"], &["short.csv", "29 samples", "at least 50"]),
        (&["--train", work, "part.csv"], &["part.csv", "a whole cycle at least"]),
        (&["--train", "backwards.csv"], &["backwards.csv", "time_s"]),
        (&["--train", work, "--mapping", "oil.toml"], &["work.csv", "oil"]),
        (&["--train", work, "--mapping", "wrong.toml"], &["wrong.toml:2", "furlong", "kN"]),
        (&["--train", work, "--datasheet", "unknown.toml"], &["unknown.toml:5", "stiffness"]),
        (&["--train", work, "--datasheet", "negative.toml"], &["negative.toml:3", "-11000000"]),
        (&["--train", work, "--datasheet", "empty.toml"], &["empty.toml", "ce_n_s_per_m"]),
        (&["--train", work, "--holdout", work], &["work.csv", "both in --train and in --holdout"]),
        // Under another name it would be as dishonest.
        (&["--train", work, "--holdout", "copy.csv"], &["copy.csv", "same numbers", "work.csv"]),
    ];
    for (args, parts) in cases {
        let refused = identify(&[args, &["--out", "refused"]].concat());
        said_in_one_line(&refused, args, parts);
        assert!(!VISIT.join("refused").exists(), "{args:?} wrote something");
    }
    // What the reader of arguments refuses has a hint below.
    for args in [&["--train"][..], &[], &["--train", work, "--train-on", "b"]] {
        let refused = identify(&[args, &["--out", "refused"]].concat());
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.starts_with("error: ") && said.contains("--train"), "{args:?}: {said}");
        assert!(refused.stdout.is_empty() && !VISIT.join("refused").exists(), "{args:?}");
    }
    let cases: [(&[&str], &[&str]); 4] = [
        (&["none.toml", work], &["none.toml", "cannot be read"]),
        (&["damper.toml", "none.csv"], &["none.csv", "cannot be read"]),
        (&["damper.toml", "nan.csv"], &["nan.csv", "displacement_m", "nan"]),
        (&["sheet.toml", "short.csv"], &["short.csv", "at least 50"]),
    ];
    for (args, parts) in cases {
        let args = [&["simulate"], args, &["--out", "refused.csv"]].concat();
        let refused = output(yawbench().args(&args).current_dir(&*VISIT));
        said_in_one_line(&refused, &args, parts);
        assert!(!VISIT.join("refused.csv").exists(), "{args:?} wrote something");
    }
    let before = std::fs::read(VISIT.join(work)).unwrap();
    for (out, part) in
        [(work, "the record itself"), ("no/where.csv", "no place"), ("bench", "no place")]
    {
        let args = ["simulate", "damper.toml", work, "--out", out];
        let refused = output(yawbench().args(args).current_dir(&*VISIT));
        said_in_one_line(&refused, &args, &[out, part]);
    }
    assert_eq!(std::fs::read(VISIT.join(work)).unwrap(), before);
}

fn said_in_one_line(refused: &Output, args: &[&str], parts: &[&str]) {
    let said = String::from_utf8_lossy(&refused.stderr).trim().to_owned();
    assert_eq!(refused.status.code(), Some(2), "{args:?}: {said}");
    assert_eq!(said.lines().count(), 1, "{args:?}: {said}");
    for part in parts {
        assert!(said.contains(part), "{args:?}: no {part} in {said}");
    }
    assert!(refused.stdout.is_empty(), "{args:?}");
}
