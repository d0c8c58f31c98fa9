//! `yawbench campaign`: the same seed gives the same table, whole, in shards, or stopped
//! and continued; and what it refuses.

use crate::support::command::{folder, output, read, yawbench};
use std::path::Path;

/// Two cases that take seconds; those of another seed may take minutes.
fn campaign(place: &Path, more: &[&str]) -> String {
    let args = ["campaign", "--cases", "2", "--seed", "6", "--brief"];
    let result = output(yawbench().args(args).args(more).current_dir(place));
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    String::from_utf8(result.stdout).unwrap()
}

#[test]
fn a_seed_gives_the_same_table_whole_in_shards_and_after_a_stop() {
    let place = folder("campaign");
    let whole = campaign(&place, &["--out", "whole"]);
    let table = read(&place.join("whole/table.json"));
    assert!(whole.starts_with("2 brief cases of seed 6"), "{whole}");
    assert_eq!(whole, read(&place.join("whole/table.txt")));

    campaign(&place, &["--out", "parts", "--shard", "2/2"]);
    campaign(&place, &["--out", "parts", "--shard", "1/2"]);
    let files = ["parts/cases-2-of-2.jsonl", "parts/cases-1-of-2.jsonl"];
    let merge = ["campaign", "--out", "merged", "--merge", files[0], files[1]];
    let merged = output(yawbench().args(merge).current_dir(&place));
    assert_eq!(String::from_utf8_lossy(&merged.stdout), whole);
    assert_eq!(read(&place.join("merged/table.json")), table);

    // Stopped within a line: that case runs again and no other.
    let file = place.join("whole/cases-1-of-1.jsonl");
    let lines = read(&file);
    let first = lines.find('\n').unwrap() + 1;
    std::fs::write(&file, &lines[..first + 100]).unwrap();
    assert_eq!(campaign(&place, &["--out", "whole"]), whole);
    assert_eq!(read(&place.join("whole/table.json")), table);
    let again = read(&file);
    assert!(again.starts_with(&lines[..first]) && again.lines().count() == 2, "{again}");
}

/// Damping that depends on the position and an asymmetry: alone each of them improves some tests
/// and worsens others. (Case 582 of the former design had this pair.)
#[test]
#[ignore = "a minute and a half; `cargo xtask ci --full` runs it"]
fn case_582_was_left_unexplained_as_neither_of_its_two_effects_helps_alone() {
    let place = folder("campaign-pair");
    let args = ["campaign", "--cases", "1254", "--seed", "4", "--shard", "1034/1254"];
    let result = output(yawbench().args(args).args(["--out", "pair"]).current_dir(&place));
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    let case: serde_json::Value =
        serde_json::from_str(read(&place.join("pair/cases-1034-of-1254.jsonl")).trim()).unwrap();
    let names = case["named"].as_array().unwrap().iter().map(|named| named["name"].as_str());
    let mut names: Vec<&str> = names.map(Option::unwrap).collect();
    names.sort_unstable();
    assert_eq!(names, ["asymmetric_damping", "position_dependent_damping"], "{case}");
    assert_eq!(case["verdict"], "effects_found");
}

#[test]
fn contradictory_options_are_refused() {
    let place = folder("campaign-refused");
    for (args, said) in [
        (&["--cases", "3"][..], "--seed <S> is missing"),
        (&["--cases", "3", "--seed", "1", "--train", "a.csv"], "--train: unknown option"),
        (&["--cases", "3", "--seed", "1", "--shard", "3/2"], "expected part/parts"),
        (&["--cases", "3", "--merge", "a.jsonl"], "cannot be used with"),
        (&["--merge", "none.jsonl"], "none.jsonl"),
        (&[], "--cases <N>, --seed <S>"),
    ] {
        let result = output(yawbench().arg("campaign").args(args).current_dir(&place));
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(said), "{args:?}: {errors}");
    }
    std::fs::write(place.join("bad.jsonl"), "{\"index\": 0}\n").unwrap();
    let result = output(yawbench().args(["campaign", "--merge", "bad.jsonl"]).current_dir(&place));
    assert!(String::from_utf8_lossy(&result.stderr).contains("bad.jsonl:1:"));
}

#[test]
fn the_former_options_of_identify_name_the_new_command() {
    for (args, said) in [
        (["identify", "--campaign", "3", "--seed", "1"], "`yawbench campaign --cases N --seed S`"),
        (["identify", "--out", "x", "--merge", "a.jsonl"], "`yawbench campaign --merge JSONL...`"),
    ] {
        let result = output(yawbench().args(args));
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(said) && errors.lines().count() == 1, "{args:?}: {errors}");
    }
}
