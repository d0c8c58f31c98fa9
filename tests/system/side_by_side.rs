//! `yawbench compare` as a person uses it: repeats and differences of runs, groups by condition and
//! by name, the example of its page, and what it refuses.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A locomotive with one damper on an emulated rig, of this clearance and seed of the noise.
fn scenario(clearance_2a_m: f64, seed: u64) -> String {
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    format!(
        "title = \"seed {seed}\"\nvehicle = '{}'\nspeed_kmh = 160.0\nduration_s = 3.0\n\
         [track.irregularity.aar6]\nseed = 1\nshortest_m = 1.0\nlongest_m = 100.0\n\
         [damper]\nf_relief_n = 11.1e3\nclearance_2a_m = {clearance_2a_m:?}\n\
         [rig]\nseed = {seed}\n[[slot]]\nplace = \"front left\"\non = \"rig\"\nnode = 1\n",
        vehicle.display()
    )
}

/// A folder with runs, made once: an ABA test of a new damper and a worn one, and the first run
/// again with the same seed.
fn runs() -> &'static Path {
    static RUNS: OnceLock<PathBuf> = OnceLock::new();
    RUNS.get_or_init(|| {
        let place = folder("side-by-side");
        let new = 0.2e-3;
        for (name, clearance_2a_m, seed) in [
            ("new-1", new, 1),
            ("worn-1", 4e-3, 1),
            ("worn-2", 4e-3, 2),
            ("new-2", new, 2),
            ("again", new, 1),
        ] {
            let file = place.join(format!("{name}.toml"));
            std::fs::write(&file, scenario(clearance_2a_m, seed)).unwrap();
            let run = ["run", &file.display().to_string(), "--pace", "fast", "--out", name];
            let result = output(yawbench().args(run).current_dir(&place));
            assert!(result.status.success(), "{}", String::from_utf8_lossy(&result.stderr));
        }
        place
    })
}

fn compare(args: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().arg("compare").args(args).current_dir(runs()));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

/// The result as JSON, which fits its schema.
fn compared(args: &[&str]) -> Value {
    let (code, printed, complained) = compare(&[args, &["--json"]].concat());
    assert_eq!(code, Some(0), "{args:?}: {complained}");
    let result: Value = serde_json::from_str(&printed).unwrap();
    let schema = read(&repository().join("docs/schema/compare.schema.json"));
    let found = misfits(&serde_json::from_str(&schema).unwrap(), &result);
    assert!(found.is_empty(), "{found:?}");
    result
}

/// A copy of a run in which one text of one file is another one.
fn edited(copy: &str, of: &str, [file, from, to]: [&str; 3]) -> String {
    let (source, target) = (runs().join(of), folder(copy).join(copy));
    std::fs::create_dir(&target).unwrap();
    for entry in source.read_dir().unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), target.join(entry.file_name())).unwrap();
    }
    let text = read(&target.join(file));
    assert!(text.contains(from), "{file} of {of} holds no {from}");
    std::fs::write(target.join(file), text.replace(from, to)).unwrap();
    target.display().to_string()
}

/// A field of the quantity of this name.
fn of<'a>(rows: &'a Value, quantity: &str) -> &'a Value {
    let mut rows = rows.as_array().unwrap().iter();
    rows.find(|row| row["quantity"] == quantity).unwrap_or_else(|| panic!("no {quantity}"))
}

const CARBODY: &str = "carbody, lateral acceleration rms";

#[test]
fn wear_is_larger_than_the_repeats_of_an_aba_test() {
    let result = compared(&["new-1", "worn-1", "worn-2", "new-2"]);
    let names = |group: usize| -> Vec<&str> {
        let runs = result["groups"][group]["runs"].as_array().unwrap().iter();
        runs.map(|run| run["run"].as_str().unwrap()).collect()
    };
    assert_eq!([names(0), names(1)], [["new-1", "new-2"], ["worn-1", "worn-2"]]);
    // The rig's damper and the slot's model are worn with the scenario's.
    let differing = result["groups"][1]["differing"].as_array().unwrap();
    let is_clearance = |key: &Value| key["key"].as_str().unwrap().ends_with("clearance_2a_m");
    assert!(!differing.is_empty() && differing.iter().all(is_clearance), "{differing:?}");
    let found = &result["comparisons"][0];
    let count = |key: &str| found[key].as_u64().unwrap();
    assert_eq!(count("larger") + count("within") + count("unknown"), 30);
    assert!(found["is_wear"] == true && count("larger") > 0 && count("unknown") == 0, "{found}");

    // The carbody by hand, from the summaries.
    let rms = |run: &str| -> f64 {
        let summary: Value =
            serde_json::from_str(&read(&runs().join(run).join("summary.json"))).unwrap();
        summary["accelerations"]["carbody"]["lateral_rms_m_per_s2"].as_f64().unwrap()
    };
    let [new, worn] = ["new", "worn"].map(|name| [1, 2].map(|n| rms(&format!("{name}-{n}"))));
    let mean = |pair: [f64; 2]| 0.5 * (pair[0] + pair[1]);
    let row = of(&found["quantities"], CARBODY);
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    let near =
        |found: f64, expected: f64| (found - expected).abs() <= 1e-12 + 1e-9 * expected.abs();
    assert!(near(number(&row["difference"]), mean(worn) - mean(new)), "{row}");
    assert!(near(number(&row["drift"]), new[1] - new[0]), "{row}");
    let spread = &of(&result["repeats"], CARBODY)["groups"][0];
    let deviation = (new[1] - new[0]).abs() / 2.0_f64.sqrt();
    assert!(near(number(&spread["standard_deviation"]), deviation), "{spread}");
    assert_eq!((&found["aba"]["first"], &found["aba"]["last"]), (&"new-1".into(), &"new-2".into()));
    let [low, high] = [0, 1].map(|end| number(&row["interval"][end]));
    assert!(low < number(&row["difference"]) && number(&row["difference"]) < high, "{row}");
}

#[test]
fn one_run_or_one_computation_claims_nothing() {
    for args in [&["new-1", "worn-1", "worn-2"][..], &["new-1", "again", "worn-1", "worn-2"][..]] {
        let result = compared(args);
        let found = &result["comparisons"][0];
        assert_eq!((&found["larger"], &found["within"]), (&0.into(), &0.into()), "{args:?}");
        assert_eq!(of(&found["quantities"], CARBODY)["trust"], "unknown");
        assert!(of(&found["quantities"], CARBODY)["difference"].is_f64());
        assert!(result["in_words"][0].as_str().unwrap().contains("unknown in all 30"), "{result}");
    }
    let (_, printed, _) = compare(&["new-1", "again", "worn-1", "worn-2"]);
    assert!(printed.contains("note: again: the same computation as new-1, to the last bit"));
    // Behind the worn ones it would look like an ABA test without any drift.
    assert!(printed.contains("no ABA test"), "{printed}");
}

#[test]
fn one_condition_shows_its_spread_until_groups_are_named() {
    let alike = compared(&["new-1", "new-2"]);
    assert!(alike["comparisons"].as_array().unwrap().is_empty());
    assert_eq!(of(&alike["repeats"], CARBODY)["groups"][0]["count"], 2);
    assert!(alike["in_words"][0].as_str().unwrap().contains("--group"), "{alike}");
    let named =
        compared(&["--group", "left", "new-1", "new-2", "--group", "right", "worn-1", "worn-2"]);
    let found = &named["comparisons"][0];
    assert_eq!((&found["group"], &found["against"]), (&"right".into(), &"left".into()));
    // What a named group mixes is in its spread, and said.
    let (code, printed, _) =
        compare(&["--group", "all", "new-1", "worn-1", "--group", "b", "new-2"]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("the spread of all holds that too"), "{printed}");
}

#[test]
fn a_speed_may_be_what_differs() {
    let text = ["scenario.toml", "speed_kmh = 160.0", "speed_kmh = 159.0"];
    let slower = edited("slower", "new-2", text);
    let result = compared(&["new-1", &slower]);
    let differing = result["groups"][1]["differing"].as_array().unwrap();
    assert_eq!((differing.len(), &differing[0]["key"]), (1, &"speed_kmh".into()));
}

#[test]
fn files_are_written_where_a_folder_is_named_and_nowhere_else() {
    let before = runs().read_dir().unwrap().count();
    let out = folder("side-by-side-out").join("out").display().to_string();
    let (code, printed, _) = compare(&["new-1", "new-2", "worn-1", "worn-2", "--out", &out]);
    assert_eq!((code, runs().read_dir().unwrap().count()), (Some(0), before));
    let last = printed.lines().last().unwrap();
    assert!(last.starts_with("B against A: ") && last.contains("of 30 quantities"), "{printed}");
    let out = Path::new(&out);
    let kept: Value = serde_json::from_str(&read(&out.join("compare.json"))).unwrap();
    assert_eq!(kept["in_words"][0], last);
    let page = read(&out.join("report.html"));
    assert!(page.contains("over the mean of A") && page.contains("larger than repeatability"));
    let (code, _, complained) = compare(&["new-1", "new-2", "--out", "new-1"]);
    assert_eq!(code, Some(2), "{complained}");
}

#[test]
fn what_cannot_stand_side_by_side_is_one_line() {
    let edit = |copy: &str, of: &str, text: [&str; 3]| edited(copy, of, text);
    let speed = ["scenario.toml", "speed_kmh = 160.0", "speed_kmh = 120.0"];
    let track = [
        "scenario.toml",
        "[track.irregularity.aar6]\nseed = 1",
        "[track.irregularity.aar6]\nseed = 7",
    ];
    let killed = edit("killed", "new-2", ["summary.json", "{", "{"]);
    std::fs::remove_file(Path::new(&killed).join("summary.json")).unwrap();
    let partial = edit("partial", "new-2", ["summary.json", "{", "{"]);
    let record = Path::new(&partial).join("record.npy");
    let bytes = std::fs::read(&record).unwrap();
    std::fs::write(&record, &bytes[..bytes.len() / 2]).unwrap();
    let copied = edit("copied", "new-1", ["summary.json", "{", "{"]);
    let stopped = ["summary.json", "\"state\": \"completed\"", "\"state\": \"stopped\""];
    let dropped = ["summary.json", "\"record_dropped\": 0", "\"record_dropped\": 3"];
    let one_force = ["scenario.toml", "on = \"rig\"", "on = \"other_bogie\""];
    let cases: [(&[&str], &str); 14] = [
        (&["new-1", &edit("stopped", "new-2", stopped)], "found a run that ended stopped"),
        (&["new-1", &killed], "no end recorded"),
        (&["new-1", &partial], "cycles that summary.json counts"),
        (&["new-1", &edit("dropped", "new-2", dropped)], "a record without 3 rows"),
        (&["new-1", "new-1"], "found the same run as new-1, expected each run once"),
        (&["new-1", &copied], "found the same run as new-1"),
        (
            &["new-1", &edit("fast-and-worn", "worn-1", speed)],
            "found another speed_kmh 120 (160) and another damper.clearance_2a_m 0.004 (0.0002)",
        ),
        (
            &["new-1", &edit("track-and-worn", "worn-1", track)],
            "track.irregularity.aar6.seed 7 (1)",
        ),
        (
            &[
                "--group",
                "a",
                "new-1",
                &edit("other-speed", "new-2", speed),
                "--group",
                "b",
                "worn-1",
            ],
            "expected that of new-1, which is named as a repeat of it",
        ),
        (
            &["new-1", &edit("one-force", "new-2", one_force)],
            "one measured force on several bogies",
        ),
        (&["new-1", "."], "expected"),
        (&["new-1"], "compare: expected two runs or more"),
        (&["--group", "new-1", "new-2"], "--group new-1: expected a name, and then its runs"),
        (&["--group", "a", "new-1", "--group", "a", "new-2"], "--group a: expected each name once"),
    ];
    for (args, expected) in cases {
        let (code, printed, complained) = compare(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
}

#[test]
fn the_example_of_the_page_gives_what_the_page_says() {
    let page = read(&repository().join("docs/compare.md"));
    let (_, example) = page.split_once("```sh\n").unwrap();
    let (commands, behind) = example.split_once("\n```").unwrap();
    let (_, shown) = behind.split_once("```text\n").unwrap();
    let (shown, _) = shown.split_once("\n```").unwrap();
    let place = folder("side-by-side-page");
    let program = place.join("target/release");
    std::fs::create_dir_all(&program).unwrap();
    symlink(yawbench().get_program(), program.join("yawbench")).unwrap();
    symlink(repository().join("scenarios"), place.join("scenarios")).unwrap();
    let result = output(Command::new("sh").args(["-e", "-c", commands]).current_dir(&place));
    let printed = String::from_utf8_lossy(&result.stdout).into_owned();
    assert!(result.status.success(), "{printed}{}", String::from_utf8_lossy(&result.stderr));
    let shown: Vec<&str> = shown.lines().collect();
    let [first, second, .., last] = shown[..] else { panic!("{shown:?}") };
    assert_eq!(printed.lines().last(), Some(last));
    for group in [first, second] {
        assert!(printed.lines().any(|line| line == group), "{group}\n{printed}");
    }
}
