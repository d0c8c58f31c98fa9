//! A faster loop, as a person asks for it: run, replay and report, and what refuses it by name.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;
use std::path::Path;

fn answer(args: &[&str], out: Option<&Path>) -> (Option<i32>, String, String) {
    let mut command = yawbench();
    command.args(args).current_dir(repository());
    if let Some(out) = out {
        command.arg("--out").arg(out).arg("--overwrite");
    }
    let result = output(&mut command);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

const SCENARIO: &str = "scenarios/ss9-160kmh.toml";

#[test]
fn a_run_at_2_and_4_khz_is_summed_up_reported_and_replayed_bit_for_bit() {
    let out = folder("rates");
    let schema: Value =
        serde_json::from_str(&read(&repository().join("docs/schema/summary.schema.json"))).unwrap();
    let mut rms_n = Vec::new();
    for (rate, cycle) in [("1000", "1"), ("2000", "0.5"), ("4000", "0.25")] {
        let args = ["run", SCENARIO, "--pace", "fast", "--duration", "3", "--profile", "fd"];
        let (code, printed, said) = answer(&[&args[..], &["--rate", rate]].concat(), Some(&out));
        assert_eq!(code, Some(0), "{said}");
        let hz: u64 = rate.parse().unwrap();
        assert!(printed.contains(&format!("{} cycles of {cycle} ms", 3 * hz)), "{printed}");
        let summary: Value = serde_json::from_str(&read(&out.join("summary.json"))).unwrap();
        assert_eq!(misfits(&schema, &summary), Vec::<String>::new());
        assert_eq!((&summary["rate_hz"], &summary["duration_s"]), (&hz.into(), &3.0.into()));
        // Three seconds, and four fades of half a second.
        assert_eq!((&summary["steps"], &summary["cycles"]), (&(3 * hz).into(), &(5 * hz).into()));
        assert_eq!(summary["frames"]["lost"], 0);
        rms_n.push(summary["damper"][0]["force_n"]["rms"].as_f64().unwrap());
        assert!(read(&out.join("scenario.toml")).contains(&format!("rate_hz = {rate}")));

        let (code, replayed, said) = answer(&["replay", out.to_str().unwrap(), "--json"], None);
        assert_eq!(code, Some(0), "{said}");
        let replayed: Value = serde_json::from_str(&replayed).unwrap();
        assert_eq!(replayed["cycles"], summary["cycles"]);

        // The report from the files alone.
        std::fs::remove_file(out.join("report.html")).unwrap();
        let (code, _, said) = answer(&["report", out.to_str().unwrap()], None);
        assert_eq!(code, Some(0), "{said}");
        assert!(read(&out.join("report.html")).contains(&format!("cycles of {cycle} ms")));
    }
    let [usual, double, fourfold] = rms_n[..] else { panic!("{rms_n:?}") };
    assert!((double / usual - 1.0).abs() < 0.02 && (fourfold / usual - 1.0).abs() < 0.02);
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn the_curve_with_its_finer_substeps_and_a_rehearsal_run_at_4_khz() {
    let out = folder("rates-curve");
    let curve = ["run", "scenarios/ss9-curve-400m.toml", "--pace", "fast", "--duration", "1"];
    let (code, _, said) =
        answer(&[&curve[..], &["--profile", "fd", "--rate", "4000"]].concat(), Some(&out));
    assert_eq!(code, Some(0), "{said}");
    // Per millisecond, as in the file: two in each cycle.
    assert!(read(&out.join("scenario.toml")).contains("substeps = 8"));
    std::fs::remove_dir_all(out).unwrap();
    let rehearsal = ["rehearse", SCENARIO, "--duration", "2", "--rate", "4000", "--json"];
    let (code, printed, said) = answer(&rehearsal, None);
    assert_eq!(code, Some(0), "{said}");
    let found: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!((&found["holds"], &found["duration_s"]), (&true.into(), &2.0.into()));
}

#[test]
fn what_a_faster_loop_cannot_do_is_one_line() {
    let out = folder("rates-refused");
    let scenario = out.join("fast.toml");
    let text = read(&repository().join(SCENARIO));
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let text = text.replace("vehicles/ss9.toml", vehicle.to_str().unwrap());
    std::fs::write(&scenario, format!("rate_hz = 2000\n{text}")).unwrap();
    let own = scenario.to_str().unwrap();
    let other = "expected 1000 Hz: no other rate is supported here";
    for (args, expected) in [
        (
            &["run", SCENARIO, "--rate", "2000", "--pace", "fast"][..],
            "--profile: found classical at 2000 Hz, expected fd",
        ),
        (&["run", SCENARIO, "--rate", "3000"], "--rate 3000: expected 1000, 2000 or 4000 Hz"),
        (&["wear-map", own], other),
        (&["wear-map", SCENARIO, "--rate", "4000"], other),
        (&["critical-speed", own], other),
        (&["ride", own], other),
        (&["curve", own], other),
        (&["rig-delay", own], other),
        (&["faults", own], other),
    ] {
        let (code, printed, said) = answer(args, None);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {said}");
        assert!(said.contains(expected), "{args:?}: {said}");
        assert_eq!(said.lines().count(), 1, "{args:?}: {said}");
    }
    std::fs::remove_dir_all(out).unwrap();
}
