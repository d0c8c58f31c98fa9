//! `[compare]`: a run compared with the same run with another damper.

use crate::support::command::{folder, output, repository, yawbench};
use crate::support::record::Record;
use crate::support::schema;
use can_protocol::RunState;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A watched rig, and a slot that says nothing of its own.
const SLOTS: &str = "
[[slot]]
place = \"front left\"
on = \"rig\"
watch = {}
[[slot]]
place = \"rear right\"
on = \"modelled\"
";

const AIR: &str = "{ ke_n_per_m = 11e6, effect = [
    { name = \"entrained_air\", toe_m = 1e-3, air_force_n = 1e3 },
    { name = \"moving_mass\", mass_kg = 20.0 } ] }";

/// The head of a scenario with a track, before its dampers.
fn head(scale: f64) -> String {
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    format!(
        "title = \"two dampers\"\nvehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 5.0\n\
         [track.irregularity.aar6]\nseed = 4\nshortest_m = 1.0\nlongest_m = 100.0\n\
         scale = {scale:?}\n",
        vehicle.display()
    )
}

/// Runs a scenario text in a folder of its own; gives the folder, the summary and the exit code.
fn run(name: &str, scenario: &str, args: &[&str]) -> (PathBuf, Value, Option<i32>) {
    let place = folder(name);
    std::fs::write(place.join("case.toml"), scenario).unwrap();
    run_file(&place.join("case.toml"), &place.join("out"), args)
}

fn run_file(scenario: &Path, out: &Path, args: &[&str]) -> (PathBuf, Value, Option<i32>) {
    let result =
        output(yawbench().arg("run").arg(scenario).args(["--json", "--out"]).arg(out).args(args));
    let errors = String::from_utf8_lossy(&result.stderr);
    let printed: Value =
        serde_json::from_slice(&result.stdout).unwrap_or_else(|error| panic!("{error}: {errors}"));
    assert_eq!(printed, read_json(&out.join("summary.json")));
    (out.to_owned(), printed, result.status.code())
}

fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn quantities(summary: &Value) -> &[Value] {
    summary["comparison"]["quantities"].as_array().unwrap()
}

/// The row of a quantity.
fn row<'a>(summary: &'a Value, name: &str) -> &'a Value {
    let found = quantities(summary).iter().find(|quantity| quantity["quantity"] == name);
    found.unwrap_or_else(|| panic!("no {name}"))
}

fn change(summary: &Value, name: &str) -> f64 {
    row(summary, name)["change_percent"].as_f64().unwrap()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_damper_compared_with_itself_changes_no_quantity() {
    let damper = one_line(AIR);
    let scenario = format!("damper = {damper}\n{}{SLOTS}[compare]\ndamper = {damper}\n", head(1.0));
    // On the clock and without one: the pace changes no bit on the memory bus.
    for (name, args) in [("self-fast", ["--pace", "fast"]), ("self-paced", ["--pace", "realtime"])]
    {
        let (out, summary, code) = run(name, &scenario, &args);
        assert_eq!(code, Some(0), "{}", summary["cause"]);
        assert_eq!(quantities(&summary).len(), 30);
        for quantity in quantities(&summary) {
            assert_eq!(quantity["before"], quantity["after"], "{quantity}");
            assert_eq!(quantity["change_percent"], 0.0, "{quantity}");
            assert!(quantity["after"].as_f64().unwrap().abs() > 0.0, "{quantity}");
        }
        let comparison = &summary["comparison"];
        assert_eq!(comparison["trajectory_hash"], summary["trajectory_hash"]);
        assert_eq!(comparison["modelled_instead"], Value::Array(Vec::new()));
        std::fs::remove_dir_all(out.parent().unwrap()).unwrap();
    }
}

#[test]
fn before_is_a_plain_run_with_that_damper() {
    // The scenario's own dampers are all different; none of them remains in the comparison run.
    let own = "[damper]\nclearance_2a_m = 4e-3\n[[slot]]\nplace = \"front left\"\non = \"rig\"\n\
               watch = {}\nvirtual_wear = { clearance_2a_m = 1e-3 }\n[[slot]]\n\
               place = \"rear right\"\non = \"modelled\"\ndamper = { ke_n_per_m = 5e6 }\n";
    let both = format!("{}{own}[compare]\ndamper = {}\n", head(1.0), one_line(AIR));
    let plain = format!("damper = {}\n{}{SLOTS}", one_line(AIR), head(1.0));
    let args = ["--pace", "fast"];
    let (both_out, both, _) = run("before-both", &both, &args);
    let (plain_out, plain, _) = run("before-plain", &plain, &args);
    assert_eq!(both["comparison"]["trajectory_hash"], plain["trajectory_hash"]);
    assert_ne!(both["trajectory_hash"], plain["trajectory_hash"]);
    assert_eq!(plain["comparison"], Value::Null);
    let before = |name: &str| row(&both, name)["before"].clone();
    let accelerations = &plain["accelerations"];
    for (name, body) in
        [("wheelset 1", "wheelset_1"), ("bogie front", "bogie_front"), ("carbody", "carbody")]
    {
        let lateral = &accelerations[body]["lateral_rms_m_per_s2"];
        assert_eq!(&before(&format!("{name}, lateral acceleration rms")), lateral);
    }
    let vertical = &accelerations["carbody"]["vertical_rms_m_per_s2"];
    assert_eq!(&before("carbody, vertical acceleration rms"), vertical);
    for damper in plain["damper"].as_array().unwrap() {
        let name = damper["name"].as_str().unwrap();
        for (what, value) in [
            ("force rms", &damper["force_n"]["rms"]),
            ("force min", &damper["force_n"]["min"]),
            ("force max", &damper["force_n"]["max"]),
            ("stroke rms", &damper["stroke_m"]["rms"]),
            ("stroke max", &damper["stroke_m"]["max"]),
            ("work", &damper["work_per_s_j"]),
        ] {
            assert_eq!(&before(&format!("damper {name}, {what}")), value);
        }
    }
    // The record is that of the plain run, row by row, and the wheelset's figures are in it.
    let compared = Record::read(&both_out.join("record-compared.npy"));
    let record = Record::read(&plain_out.join("record.npy"));
    // Four fades of half a second.
    assert_eq!((compared.rows(), record.rows()), (7000, 7000));
    let (mut square, mut most, mut count) = (0.0, 0.0f64, 0);
    for row in 0..record.rows() {
        assert_eq!(compared.integer(row, "hash", 0), record.integer(row, "hash", 0));
        assert_eq!(compared.number(row, "force_n", 0), record.number(row, "force_n", 0));
        let runs = record.integer(row, "state", 0) == u64::from(RunState::Run.code());
        if runs && record.number(row, "time_s", 0) >= 2.0 {
            let shift = record.number(row, "wheelset_lateral_m", 0);
            (square, most, count) = (square + shift * shift, most.max(shift.abs()), count + 1);
        }
    }
    let rms = before("wheelset 1, lateral displacement rms").as_f64().unwrap();
    assert!((rms / (square / f64::from(count)).sqrt() - 1.0).abs() < 1e-12, "{rms}");
    assert_eq!(before("wheelset 1, lateral displacement max"), most);
    for quantity in quantities(&both) {
        let of = |key: &str| quantity[key].as_f64().unwrap();
        let expected = 100.0 * (of("after") / of("before") - 1.0);
        assert!((of("change_percent") - expected).abs() < 1e-9, "{quantity}");
    }
    std::fs::remove_dir_all(both_out.parent().unwrap()).unwrap();
    std::fs::remove_dir_all(plain_out.parent().unwrap()).unwrap();
}

#[test]
fn the_example_shows_the_effect_of_air_in_the_oil_and_its_files_repeat_it() {
    let place = folder("example");
    let args = ["--pace", "fast", "--duration", "12"];
    let example = repository().join("scenarios/ss9-before-and-after.toml");
    let (out, summary, code) = run_file(&example, &place.join("out"), &args);
    assert_eq!(code, Some(0));
    let schema = read_json(&repository().join("docs/schema/summary.schema.json"));
    assert_eq!(schema::misfits(&schema, &summary), Vec::<String>::new());
    let mut wrong = summary.clone();
    wrong["comparison"]["quantities"][0]["before"] = Value::String("little".to_owned());
    wrong["comparison"]["more"] = Value::Null;
    assert_eq!(schema::misfits(&schema, &wrong).len(), 2);

    let comparison = &summary["comparison"];
    assert_eq!(comparison["name"], "datasheet");
    assert_eq!(comparison["damper"]["f_relief_n"], 11.1e3);
    assert_eq!(comparison["damper"]["effects"], Value::Array(Vec::new()));
    assert!(change(&summary, "carbody, lateral acceleration rms") > 15.0);
    assert!(change(&summary, "damper front left, work") < -40.0);
    assert!(change(&summary, "damper front left, force max") > -5.0);

    let (_, again, _) =
        run_file(&out.join("scenario.toml"), &place.join("again"), &["--pace", "fast"]);
    assert_eq!(again["trajectory_hash"], summary["trajectory_hash"]);
    assert_eq!(again["comparison"], summary["comparison"]);

    let html = out.join("report.html");
    let page = std::fs::read_to_string(&html).unwrap();
    let main = page.split_once("<main>").unwrap().1;
    for part in [
        "Before and after</h2>",
        "Before: the same run with “datasheet” in every slot",
        "<caption>Before (datasheet) and after</caption>",
        "<td>damper rear right, work</td><td>J/s</td>",
        "Lateral acceleration of front bogie and carbody, before and after",
        "Force over displacement before and after, rear right",
        "Lateral acceleration of the carbody, before and after",
        "[compare]",
    ] {
        assert!(main.contains(part), "no \"{part}\"");
    }
    if let Some(page) = report::browser::open(&html).unwrap() {
        page.assert_complete();
    }
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn people_see_a_second_table_and_a_run_without_comparison_has_none() {
    let place = folder("print");
    let printed = |scenario: &str| {
        let result = output(
            yawbench()
                .arg("run")
                .arg(repository().join("scenarios").join(scenario))
                .args(["--pace", "fast", "--duration", "3", "--out"])
                .arg(place.join(scenario)),
        );
        String::from_utf8(result.stdout).unwrap()
    };
    let text = printed("ss9-160kmh.toml");
    assert!(!text.contains("before") && !text.contains("record-compared.npy"), "{text}");
    let text = printed("ss9-before-and-after.toml");
    let table =
        text.split_once("what the difference does to the vehicle: datasheet before").unwrap();
    let rows: Vec<&str> = table.1.lines().filter(|line| line.contains(", ")).collect();
    assert!(rows.iter().any(|row| row.starts_with("damper rear left, stroke rms  ")), "{text}");
    let files = text.lines().find(|line| line.starts_with("files in ")).unwrap();
    assert!(files.ends_with("record-compared.npy"), "{text}");
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn an_identified_model_can_be_on_either_side() {
    let place = folder("models");
    std::fs::write(place.join("sheet.toml"), "damper = { ke_n_per_m = 11e6 }\n").unwrap();
    std::fs::create_dir(place.join("found")).unwrap();
    let found = "[damper]\nke_n_per_m = { value = 1.2e7, provenance = \"identified\" }\n\
                 [[damper.effect]]\nname = \"asymmetric_damping\"\ndamping_asymmetry = 0.3\n\
                 relief_asymmetry = 0.3\n";
    std::fs::write(place.join("found/model.toml"), found).unwrap();
    let scenario = format!(
        "{}[damper]\nfile = \"found/model.toml\"\n[compare]\ndamper = {{ file = \"sheet.toml\" }}\n",
        head(1.0)
    );
    std::fs::write(place.join("case.toml"), scenario).unwrap();
    let args = ["--pace", "fast"];
    let (_, summary, code) = run_file(&place.join("case.toml"), &place.join("out"), &args);
    assert_eq!(code, Some(0));
    assert_eq!(summary["comparison"]["name"], "sheet");
    assert_eq!(summary["comparison"]["damper"]["ke_n_per_m"], 11e6);
    // Pulls harder and pushes less than the datasheet says.
    assert!(change(&summary, "damper front left, force max") > 15.0);
    assert!(change(&summary, "damper front left, force min") < -15.0);
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_vehicle_that_leaves_its_track_is_reported_and_has_no_figures() {
    let scenario =
        format!("{}[compare]\nname = \"sheet\"\ndamper = {}\n", head(10.0), one_line(AIR));
    let (out, summary, code) = run("derailed", &scenario, &["--pace", "fast"]);
    assert_eq!(code, Some(3));
    let schema = read_json(&repository().join("docs/schema/summary.schema.json"));
    let comparison = &schema["properties"]["comparison"];
    assert_eq!(schema::misfits(comparison, &summary["comparison"]), Vec::<String>::new());
    assert_eq!(summary["comparison"]["state"], "safe");
    assert!(summary["comparison"]["duration_s"].as_f64().unwrap() < 2.0);
    for quantity in quantities(&summary) {
        assert_eq!(
            (&quantity["before"], &quantity["change_percent"]),
            (&Value::Null, &Value::Null)
        );
    }
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("with sheet the model left its track after "), "no warning");
    assert!(page.contains("the run ended in the safe state: after covers"), "no warning");
    std::fs::remove_dir_all(out.parent().unwrap()).unwrap();
}
