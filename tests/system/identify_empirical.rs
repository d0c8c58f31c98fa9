//! `yawbench identify --empirical`: the map that it leaves beside the physics, its files and columns, and
//! that it leaves nothing where there is nothing to map.

use crate::support::command::repository;
use crate::support::schema;
use crate::support::visit::{Sine, said, text_of, visit};
use serde_json::Value;
use std::path::Path;

const DAMPER: &str = "[damper]\nclearance_2a_m = 1e-3\nf_relief_n = 15e3\nc2_n_s_per_m = 60e3\n";
/// A force in the middle of the stroke that no effect of the catalogue makes.
const MAP: &str = "[damper.empirical]\ncoordinate = \"displacement\"\n\
    at = [-3e-3, -2e-3, -1e-3, 0.0, 1e-3, 2e-3, 3e-3]\n\
    upper_n = [0.0, 400.0, 0.0, -600.0, 0.0, 400.0, 0.0]\n\
    lower_n = [0.0, 0.0, 500.0, 0.0, -500.0, 0.0, 0.0]\nreversal_m_per_s = 1e-3\n";
/// Sines: millimetres, hertz, seconds.
const SINES: [Sine; 5] = [
    ("work", 3.46, 3.5, 2.5),
    ("large", 5.0, 4.0, 2.5),
    ("small", 3.0, 4.0, 2.5),
    ("slow", 5.0, 2.0, 3.5),
    ("fast", 3.5, 5.0, 2.0),
];

/// What `identify --empirical` prints and its result, held against the schema.
fn identified(place: &Path) -> (String, Value) {
    let mut args = vec!["identify", "--empirical", "--out", "found", "--holdout", "bench/fast.csv"];
    args.extend(["--train", "bench/work.csv", "bench/large.csv", "bench/small.csv"]);
    args.push("bench/slow.csv");
    let text = said(place, &args);
    let result = serde_json::from_str(&text_of(&place.join("found/result.json"))).unwrap();
    let schema = text_of(&repository().join("docs/schema/identify.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &result), Vec::<String>::new());
    (text, result)
}

/// The cells of a CSV below the name of a column.
fn column(path: &Path, name: &str) -> Option<Vec<String>> {
    let text = text_of(path);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let index = lines.next().unwrap().split(',').position(|known| known == name)?;
    Some(lines.map(|line| line.split(',').nth(index).unwrap().to_owned()).collect())
}

fn numbers(path: &Path, name: &str) -> Vec<f64> {
    let cells = column(path, name).unwrap_or_else(|| panic!("{}: no {name}", path.display()));
    cells.iter().map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn a_kept_map_stands_beside_the_physics_in_files_of_its_own() {
    let place = visit("identify-empirical", &format!("{DAMPER}{MAP}"), &SINES, "");
    let (text, result) = identified(&place);
    let map = &result["empirical"];
    assert_eq!((&map["kept"], &map["coordinate"]), (&true.into(), &"displacement".into()), "{map}");
    assert_eq!(map["unit"], "m");
    assert!(result["verdict"].as_str().unwrap().ends_with("unexplained"), "{}", result["verdict"]);
    let held = |errors: &Value| errors["holdout_rmse_n"].as_f64().unwrap();
    let (before, after) = (held(&result["errors"]["with_effects"]), held(&map["errors"]));
    assert!(after < 0.6 * before, "{before} {after}");
    assert!(text.contains("\nempirical map "), "no row of its errors: {text}");
    assert!(text.contains("empirical map over displacement: takes away"), "{text}");
    assert!(text.contains("it is no physics (model-empirical.toml)"), "{text}");

    let physics = text_of(&place.join("found/model.toml"));
    let mapped = text_of(&place.join("found/model-empirical.toml"));
    assert!(!physics.contains("mpirical"), "{physics}");
    assert!(mapped.starts_with("# Identified from") && mapped.contains("# Empirical, no physics:"));
    assert!(mapped.contains("valid only inside the range of the records"), "{mapped}");
    let value =
        |model: &str| model.lines().find(|l| l.starts_with("ke_n_per_m")).map(str::to_owned);
    assert_eq!(value(&physics), value(&mapped));

    for name in ["fast", "work"] {
        let record = format!("bench/{name}.csv");
        let predicted = place.join(format!("found/predictions/{name}.csv"));
        let header = text_of(&predicted).lines().nth(1).unwrap().to_owned();
        assert!(header.ends_with("with_effects_n,with_empirical_n"), "{header}");
        said(&place, &["simulate", "found/model-empirical.toml", &record, "--out", "m.csv"]);
        said(&place, &["simulate", "found/model.toml", &record, "--out", "p.csv"]);
        for (again, names) in
            [("m.csv", &["with_effects_n", "with_empirical_n"][..]), ("p.csv", &["with_effects_n"])]
        {
            for column in names {
                let (a, b) = (numbers(&place.join(again), column), numbers(&predicted, column));
                assert_eq!(a.len(), b.len());
                for (a, b) in a.iter().zip(&b) {
                    assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{name} {column}: {a} {b}");
                }
            }
        }
        assert_eq!(column(&place.join("p.csv"), "with_empirical_n"), None);
    }
    // The stated error is that of the column.
    let path = place.join("found/predictions/fast.csv");
    let (measured, mapped) = (numbers(&path, "force_n"), numbers(&path, "with_empirical_n"));
    let tests = result["per_test"].as_array().unwrap();
    let fast = tests.iter().find(|test| test["file"] == "fast").unwrap();
    let run_in = fast["run_in_samples"].as_u64().unwrap() as usize;
    let pairs = measured[run_in..].iter().zip(&mapped[run_in..]);
    let squares: f64 = pairs.map(|(y, f)| (y - f) * (y - f)).sum();
    let rmse_n = (squares / (measured.len() - run_in) as f64).sqrt();
    assert!((rmse_n / after - 1.0).abs() < 1e-9, "{rmse_n} {after}");
    it_runs_in_a_vehicle(&place.join("found"));
}

fn it_runs_in_a_vehicle(found: &Path) {
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let scenario = format!(
        "title = \"mapped\"\nvehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 1.0\n\
         [damper]\nfile = \"model-empirical.toml\"\n",
        vehicle.display()
    );
    std::fs::write(found.join("scenario.toml"), scenario).unwrap();
    said(found, &["run", "scenario.toml", "--pace", "fast", "--out", "run"]);
    let kept = text_of(&found.join("run/scenario.toml"));
    assert!(kept.contains("[damper.empirical]"), "the run did not have the map: {kept}");
}

#[test]
fn where_nothing_is_left_there_is_no_map_and_no_file_of_an_earlier_one() {
    let place = visit("identify-no-map", DAMPER, &SINES, "");
    std::fs::create_dir_all(place.join("found")).unwrap();
    std::fs::write(place.join("found/model-empirical.toml"), "of an earlier one").unwrap();
    let (text, result) = identified(&place);
    assert_eq!(result["verdict"], "no_missing_effect");
    assert_eq!(result["empirical"]["kept"], false, "{}", result["empirical"]);
    let why = result["empirical"]["why"].as_str().unwrap();
    let line = text.lines().find(|line| line.starts_with("no empirical map")).unwrap();
    assert!(line.ends_with(why) && !text.contains("\nempirical map"), "{text}");
    assert!(!place.join("found/model-empirical.toml").exists());
    assert_eq!(column(&place.join("found/predictions/fast.csv"), "with_empirical_n"), None);
}
