//! Several rigs, rigs that stand for other dampers, and one that drops out, as a person sees them.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::record::Record;
use crate::support::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// The scenario with two rigs and their partners, changed and with more tables, in a folder of its
/// own.
fn scenario(folder: &Path, change: impl Fn(String) -> String) -> PathBuf {
    let scenarios = repository().join("scenarios");
    let text = read(&scenarios.join("ss9-two-rigs-partner.toml"));
    let vehicle = scenarios.join("vehicles/ss9.toml").display().to_string();
    let path = folder.join("several.toml");
    std::fs::write(&path, change(text.replace("vehicles/ss9.toml", &vehicle))).unwrap();
    path
}

fn ran(scenario: &Path, out: &Path, json: bool) -> Output {
    let mut command = yawbench();
    command.arg("run").arg(scenario).args(["--pace", "fast", "--duration", "6", "--out"]);
    command.arg(out).arg("--overwrite").args(json.then_some("--json"));
    output(&mut command)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The front left model has half the damping, and what its rig measures less of it ends the rig.
#[expect(clippy::needless_pass_by_value, reason = "one of the changes that `scenario` takes")]
fn one_is_off(text: String) -> String {
    let (first, rest) = text.split_once("if_rig_drops_out = \"model\"\n").unwrap();
    format!(
        "{first}if_rig_drops_out = \"model\"\nmodel = {{ ce_n_s_per_m = 0.2e6 }}\n{rest}\n\
         [plausibility]\nresidual = {{ limit_n = 1500.0, action = \"stop\" }}\n"
    )
}

#[test]
fn a_run_that_went_on_without_a_rig_is_not_held_and_says_from_when() {
    let folder = folder("dropped-out");
    let scenario = scenario(&folder, one_is_off);
    let out = folder.join("run");
    let result = ran(&scenario, &out, true);
    assert_eq!(result.status.code(), Some(1), "{}", text(&result.stderr));
    let summary: Value = serde_json::from_slice(&result.stdout).unwrap();
    let known: Value =
        serde_json::from_str(&read(&repository().join("docs/schema/summary.schema.json"))).unwrap();
    assert_eq!(schema::misfits(&known, &summary), Vec::<String>::new());
    assert_eq!((&summary["state"], &summary["cause"]), (&"completed".into(), &Value::Null));
    let lost = &summary["drop_outs"];
    assert_eq!(lost.as_array().map(Vec::len), Some(1), "{lost}");
    assert_eq!((&lost[0]["place"], &lost[0]["signal"]), (&"front left".into(), &"residual".into()));
    let said = lost[0]["message"].as_str().unwrap();
    assert!(
        said.starts_with("from ") && said.contains(" s front left ran on its model: rig node 1: ")
    );
    assert_eq!(summary["not_held"][0], said);
    let from_s = summary["damper"][0]["model_from_s"].as_f64().unwrap();
    // The row of the cycle that acts on it.
    assert!((from_s - lost[0]["time_s"].as_f64().unwrap() - 1e-3).abs() < 1e-9, "{said}");
    assert_eq!(summary["damper"][1]["model_from_s"], from_s);
    assert_eq!(summary["damper"][2]["model_from_s"], Value::Null);
    // What came behind it is no loss of the bus.
    assert_eq!(summary["frames"]["lost"], 0);
    let record = Record::read(&out.join("record.npy"));
    let last = record.rows() - 1;
    let sources = [0, 1, 2, 3].map(|slot| record.integer(last, "force_source", slot));
    assert_eq!(sources, [4, 4, 2, 3]);
    let events = read(&out.join("events.jsonl"));
    let event = events.lines().find(|line| line.contains("dropped out")).unwrap();
    assert!(event.contains("\"slot\":1") && event.contains("\"node\":1"), "{event}");
    let report = read(&out.join("report.html"));
    assert!(report.contains("Completed, not held: from ") && report.contains("ran on its model"));
    // The same again from its files, and the report without its program.
    let replay = output(yawbench().arg("replay").arg(&out));
    assert!(replay.status.success(), "{}{}", text(&replay.stdout), text(&replay.stderr));
    std::fs::remove_file(out.join("summary.json")).unwrap();
    let report = output(yawbench().arg("report").arg(&out));
    assert!(report.status.success(), "{}", text(&report.stderr));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_rig_says_for_which_dampers_it_stood_and_how_exactly() {
    let folder = folder("stood-for");
    let partners = scenario(&folder, |text| text);
    let out = folder.join("run");
    let result = ran(&partners, &out, false);
    assert_eq!(result.status.code(), Some(0), "{}", text(&result.stderr));
    let said = text(&result.stdout);
    assert!(
        said.contains("front right: the force of the rig of front left, its sign reversed"),
        "{said}"
    );
    // Each once, with its number in one precision.
    assert_eq!(said.matches("% rms away").count(), 2, "{said}");
    let warned = "warning: rear right: the force of the rig of rear left, its sign reversed";
    assert!(said.contains(warned) && said.contains("it did not feel the force of a rig of"));
    assert!(said.ends_with("no faults counted\n"), "{said}");
    // One rig for all four.
    let one = scenario(&folder, |text| {
        let (before, _) = text.split_once("[[slot]]\nplace = \"rear left\"").unwrap();
        let slot = |place: &str| {
            format!("[[slot]]\nplace = \"{place}\"\non = \"other_bogie\"\nof = \"front left\"\n")
        };
        format!("{before}{}{}", slot("rear left"), slot("rear right"))
    });
    let result = ran(&one, &out, false);
    let said = text(&result.stdout);
    assert_eq!(result.status.code(), Some(0), "{said}");
    let last = said.trim_end().lines().last().unwrap();
    assert!(last.contains("| one measured force used four times: that of front left |"), "{last}");
    let summary: Value = serde_json::from_str(&read(&out.join("summary.json"))).unwrap();
    assert_eq!(summary["labels"].as_array().map(Vec::len), Some(1), "{}", summary["labels"]);
    assert!(read(&out.join("report.html")).contains("one measured force used four times"));
    for study in [&["critical-speed"][..], &["ride"], &["rig-delay"]] {
        let studied = folder.join("study");
        let mut command = yawbench();
        let refused = output(command.args(study).arg(&one).arg("--out").arg(&studied));
        let said = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{study:?}: {said}");
        assert!(said.contains("slot \"rear left\" is on = \"other_bogie\""), "{study:?}: {said}");
        assert!(!studied.exists(), "{study:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
