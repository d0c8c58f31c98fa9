//! `yawbench rig-delay`: the table of two delays, what it refuses, and its file.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema::misfits;
use serde_json::Value;

fn rig_delay(args: &[&str]) -> (Option<i32>, String, String) {
    let result = output(yawbench().arg("rig-delay").args(args).current_dir(repository()));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (result.status.code(), text(&result.stdout), text(&result.stderr))
}

const SCENARIO: &str = "scenarios/ss9-160kmh.toml";

#[test]
fn the_file_has_every_delay_with_what_it_costs_and_how_far_the_speed_is_off() {
    let out = folder("rig-delay").join("out");
    let out = out.to_str().unwrap();
    let quick = ["--from-kmh=225", "--to-kmh=260", "--delay-ms=3,0", "--out", out, SCENARIO];
    let (code, printed, complained) = rig_delay(&quick);
    assert_eq!(code, Some(0), "{complained}");
    assert!(printed.contains("emulated rig") && printed.contains("1 rig km/h"), "{printed}");
    let text = read(&std::path::Path::new(out).join("rig-delay.json"));
    let found: Value = serde_json::from_str(&text).unwrap();
    let schema = read(&repository().join("docs/schema/rig-delay.schema.json"));
    let misfits = misfits(&serde_json::from_str(&schema).unwrap(), &found);
    assert!(misfits.is_empty(), "{misfits:?}");
    let [late, ideal] = found["points"].as_array().unwrap().as_slice() else { panic!("{text}") };
    assert_eq!(late["at"][0]["key"], "rig_delay_ms");
    let of = |point: &Value, case: &str, key: &str| point[case][key].as_f64().unwrap();
    for case in ["as_in_scenario", "all_on_rigs"] {
        // 3 ms at 3.3 Hz and w lambda = 1.67 cost about a tenth of the damping.
        let lost = of(late, case, "damping_lost_percent");
        assert!((8.0..15.0).contains(&lost), "{case}: {lost}");
        assert!((of(late, case, "measured_delay_s") - 3e-3).abs() < 0.05e-3, "{case}");
        assert!(of(ideal, case, "measured_delay_s").abs() < 0.05e-3, "{case}");
        let fold = |point: &Value| point[case]["speeds"]["fold"]["kmh"].as_f64();
        let modelled = ideal["modelled"]["fold"]["kmh"].as_f64().unwrap();
        assert!((fold(ideal).unwrap() - modelled).abs() <= 1.0, "{case}: {ideal}");
    }
    assert_eq!(
        (&late["as_in_scenario"]["rigs"], &late["all_on_rigs"]["rigs"]),
        (&1.into(), &4.into())
    );
    // The same question is answered from the points that are kept.
    let (code, again, _) = rig_delay(&quick);
    assert_eq!((code, again), (Some(0), printed));
    let report = read(&std::path::Path::new(out).join("report.html"));
    assert!(report.contains("Error of the critical speed that is measured with rigs"));
}

#[test]
fn what_cannot_be_asked_is_one_line() {
    let bogie = folder("rig-delay-bogie").join("bogie.toml");
    let vehicle = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    let text = format!("vehicle = '{}'\nspeed_kmh = 200.0\nduration_s = 1.0\n", vehicle.display());
    std::fs::write(&bogie, text).unwrap();
    for (args, expected) in [
        (&["none.toml"][..], "none.toml"),
        (&[SCENARIO, "--delay-ms=99"][..], "--delay-ms 99: expected delays from -20 to 60 ms"),
        (&[SCENARIO, "--delay-ms=1,1"][..], "expected each once"),
        (&[SCENARIO, "--from-kmh=300", "--to-kmh=200"][..], "expected 0 < from < to <= 600"),
        (&[SCENARIO, "--vary=speed_kmh=100,200"][..], "--vary speed_kmh"),
        (&[bogie.to_str().unwrap()][..], "found no damper slot"),
    ] {
        let (code, printed, complained) = rig_delay(args);
        assert_eq!((code, printed.as_str()), (Some(2), ""), "{args:?}: {complained}");
        assert!(complained.contains(expected), "{args:?}: {complained}");
        assert_eq!(complained.lines().count(), 1, "{args:?}: {complained}");
    }
}
