//! `yawbench rths-benchmark --yaw-damper` as a person uses it.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;
use std::path::Path;

fn problem(args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = yawbench();
    command.args(["rths-benchmark", "--yaw-damper"]).args(args).current_dir(repository());
    let result = output(&mut command);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

fn in_folder(place: &Path, name: &str) -> String {
    place.join(name).to_str().unwrap().to_owned()
}

#[test]
fn others_score_a_filter_and_a_command_with_the_files_of_the_problem() {
    let place = folder("yaw-damper-problem");
    let files = in_folder(&place, "problem");
    let (code, printed, complained) = problem(&["--problem", "--out", &files]);
    assert_eq!((code, complained.as_str()), (Some(0), ""), "{printed}");
    for name in [
        "rig-new.csv",
        "load-worn.csv",
        "perturbed-rigs.csv",
        "scoring.csv",
        "wanted-worn-hunting.csv",
    ] {
        assert!(printed.contains(name) && place.join("problem").join(name).is_file(), "{printed}");
    }
    let wanted = read(&place.join("problem/wanted-new-track.csv"));
    assert!(wanted.starts_with("time_s,displacement_m,velocity_m_per_s\n0,"), "{wanted:.100}");
    assert_eq!(wanted.lines().count(), 16_001);
    // pandas and NumPy take line 1 for the names of the columns, in every table.
    for entry in std::fs::read_dir(place.join("problem")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let text = read(&path);
            let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
            let is_name =
                |name: &&str| name.bytes().all(|byte| byte == b'_' || byte.is_ascii_alphanumeric());
            assert!(names.len() > 1 && names.iter().all(is_name), "{}: {names:?}", path.display());
        }
    }
    let read_me = read(&place.join("problem/README.txt"));
    assert!(read_me.contains("delay_s + dead time - 0.0005 s") && read_me.contains("seed 1"));
    let rigs = read(&place.join("problem/perturbed-rigs.csv"));
    assert_eq!(rigs.lines().count(), 22, "{rigs}");

    let command = in_folder(&place, "problem/example-command-new-track-5ms.csv");
    let open = ["--motion", "new-track", "--dead-time-ms", "5", "--command"];
    let (_, printed, complained) = problem(&[&open[..], &[&command]].concat());
    assert_eq!(complained, "");
    assert!(printed.contains("emulated rig, open loop: new-track, dead time 5 ms"), "{printed}");
    // Nothing compensates the wanted motion itself.
    let wanted = in_folder(&place, "problem/wanted-new-track.csv");
    let (code, printed, _) = problem(&[&open[..], &[&wanted, "--json"]].concat());
    assert_eq!(code, Some(1), "{printed}");
    let found: Value = serde_json::from_str(&printed).unwrap();
    assert!(found["errors"]["phase_deg"].as_f64().unwrap() < -8.0, "{found}");
    assert_eq!(found["result_of"], "emulated rig");

    let filter = in_folder(&place, "problem/example-filter-5ms.csv");
    let out = in_folder(&place, "filter");
    let closed = ["--quick", "--dead-time-ms", "5", "--filter", &filter, "--out", &out];
    let (code, printed, complained) = problem(&closed);
    assert_eq!(complained, "");
    assert!(matches!(code, Some(0 | 1)), "{printed}");
    assert_eq!(code == Some(1), printed.contains("MISSED"), "{printed}");
    assert!(printed.contains("filter") && printed.contains("emulated rig"), "{printed}");
    assert!(printed.contains("report.html, scores.json, README.txt, perturbed-rigs.csv"));
    let scores: Value = serde_json::from_str(&read(&place.join("filter/scores.json"))).unwrap();
    let schema = read(&repository().join("docs/schema/yaw-damper-problem.schema.json"));
    let misfits = misfits(&serde_json::from_str(&schema).unwrap(), &scores);
    assert!(misfits.is_empty(), "{misfits:?}");
    assert_eq!(scores["scores"].as_array().map(Vec::len), Some(2));
    assert!(read(&place.join("filter/report.html")).contains("Reference problem"));
    let _ = std::fs::remove_dir_all(&place);
}

#[test]
fn what_is_no_command_or_filter_is_one_line() {
    let place = folder("yaw-damper-bad");
    let open = ["--motion", "worn-hunting", "--dead-time-ms", "2", "--command"];
    let closed = ["--quick", "--dead-time-ms", "2", "--filter"];
    let head = "time_s,displacement_m\n";
    for (name, text, option, expected) in [
        ("time.csv", "time_s\n0\n", &open[..], "time.csv:1: found no column displacement_m"),
        (
            "nan.csv",
            &format!("{head}0,0\n0.001,NaN\n"),
            &open,
            "nan.csv:3: found \"NaN\" in column displacement_m, expected a finite number",
        ),
        (
            "step.csv",
            &format!("{head}0,0\n0.01,0\n"),
            &open,
            "step.csv:3: found time 0.01 s, expected 0.001 s, steps of 1 ms from 0 s",
        ),
        ("short.csv", &format!("{head}0,0\n"), &open, "short.csv: found 1 rows, expected 25000"),
        ("no.csv", "b,a\n1,0\n", &closed, "no.csv: found 1 coefficients b and 1 a, expected"),
        ("grows.csv", "b,a\n1,1\n,-1.1\n", &closed, "grows.csv: found 1 coefficients b and 2 a"),
        ("b.csv", "b\n1\n", &closed, "b.csv:1: found no column a, expected b,a"),
    ] {
        std::fs::write(place.join(name), text).unwrap();
        let file = in_folder(&place, name);
        let (code, printed, complained) = problem(&[option, &[&file]].concat());
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{name}: {complained}");
        assert!(complained.contains(expected), "{name}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{name}: {complained}");
    }
    for (args, expected) in [
        (&["--dead-time-ms", "3"][..], "--dead-time-ms 3: expected 1, 2, 5, 10 or 15"),
        (&["--dead-time-ms", "5"], "--dead-time-ms: expected --command or --filter with it"),
        (&["--scenario", "none.toml", "--quick"], "none.toml"),
        (&["--scenario", "scenarios/vehicles/ss9.toml", "--quick"], "expected a scenario"),
        (&["--motion", "new-track"], "--command"),
    ] {
        let (code, printed, complained) = problem(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
    let mut alone = yawbench();
    let alone = output(alone.args(["rths-benchmark", "--quick"]));
    assert_eq!(alone.status.code(), Some(2));
    let _ = std::fs::remove_dir_all(&place);
}
