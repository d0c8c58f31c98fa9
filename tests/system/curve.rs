//! `yawbench curve`: its schema, what it reports about a curve, the same bytes in shards and on
//! one core, and what it refuses.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A folder with a scenario of the SS9 in a short curve.
fn curve(name: &str) -> PathBuf {
    let place = folder(name);
    let vehicle = repository().join("scenarios/vehicles/ss9.toml");
    let head = format!("title = \"curve\"\nvehicle = '{}'\n", vehicle.display());
    let text = "speed_kmh = 70.0\nduration_s = 1.0\nsubsteps = 8\n\
        [track.curve]\nradius_m = 450.0\ndirection = \"left\"\ncant_m = 0.08\nlead_in_m = 80.0\n\
        transition_m = 60.0\nlength_m = 120.0\n\
        [track.irregularity.aar6]\nseed = 1\nshortest_m = 1.0\nlongest_m = 100.0\n";
    std::fs::write(place.join("curve.toml"), format!("{head}{text}")).unwrap();
    let straight = "speed_kmh = 70.0\nduration_s = 1.0\nsubsteps = 8\n";
    std::fs::write(place.join("straight.toml"), format!("{head}{straight}")).unwrap();
    place
}

const VARIED: [&str; 3] = ["--vary=speed_kmh=60:80:3", "--seeds=2", "curve.toml"];

fn run(place: &Path, args: &[&str]) -> String {
    let result = output(yawbench().arg("curve").args(args).current_dir(place));
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{args:?}: {errors}");
    String::from_utf8(result.stdout).unwrap()
}

#[test]
fn a_curve_is_reported_by_section_and_is_the_same_in_shards_and_on_one_core() {
    let place = curve("curve-reported");
    let varied = |more: &[&str]| run(&place, &[&VARIED[..], more].concat());
    let text = varied(&["--out=whole"]);
    for message in [
        "left curve of 450 m, cant 0.080 m",
        "80 m of run-in, entry 80 to 140 m, curve 140 to 260 m, exit 260 to 320 m",
        "class-6 track, wavelengths 1 to 100 m, seeds 1 to 2",
        "limits at 206.0 kN an axle: sum of Y 78.7 kN",
        "simulated",
    ] {
        assert!(text.contains(message), "{message}: {text}");
    }
    let json = read(&place.join("whole/curve.json"));
    let found: Value = serde_json::from_str(&json).unwrap();
    let schema = read(&repository().join("docs/schema/curve.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &found), Vec::<String>::new());
    for point in found["points"].as_array().unwrap() {
        let curve = &point["curve"];
        let full = &curve["sections"][1];
        let number = |value: &Value| value["mean"].as_f64().unwrap();
        let axles = full["wheelsets"].as_array().unwrap();
        // 0.3 m/s2 and less is half of what irregularity does: the mean is met to some kN.
        let carried_n: f64 = axles.iter().map(|axle| number(&axle["sum_quasi_static_n"])).sum();
        let expected_n = 126.0e3 * curve["unbalanced_m_per_s2"].as_f64().unwrap();
        assert!((carried_n - expected_n).abs() < 15.0e3, "{carried_n} {expected_n}");
        assert!(number(&axles[0]["outer"]["y_over_q"]) > number(&axles[1]["outer"]["y_over_q"]));
        assert!(axles.iter().all(|axle| !axle["stability_rms_n"].is_null()));
        assert!(curve["sections"][0]["wheelsets"][0]["stability_rms_n"].is_null());
    }
    let report = read(&place.join("whole/report.html"));
    for drawn in ["Prud&#39;homme", "Y/Q, worst wheel", "Spectrum of the lateral axle force"] {
        let plain = drawn.replace("&#39;", "'");
        assert!(report.contains(drawn) || report.contains(&plain), "{drawn}");
    }

    varied(&["--out=parts", "--shard=2/2"]);
    varied(&["--out=parts", "--shard=1/2"]);
    let files = ["--merge", "parts/points-2-of-2.jsonl", "parts/points-1-of-2.jsonl"];
    varied(&[&["--out=merged"], &files[..]].concat());
    assert_eq!(read(&place.join("merged/curve.json")), json);
    assert_eq!(read(&place.join("merged/report.html")), report);

    let args = [&VARIED[..], &["--out=one"]].concat();
    let one = yawbench()
        .arg("curve")
        .args(args)
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(&place)
        .output();
    assert!(one.unwrap().status.success());
    assert_eq!(read(&place.join("one/curve.json")), json);
}

#[test]
fn impossible_requests_get_one_line_and_nothing_is_written() {
    let place = curve("curve-refused");
    for (scenario, args, message) in [
        ("straight.toml", &[][..], "straight.toml: the track has no curve"),
        ("curve.toml", &["--vary=track.curve.radius_m=50,400"], "radius_m = 50"),
        ("curve.toml", &["--vary=track.curve.raduis_m=400,500"], "unknown field `raduis_m`"),
        ("curve.toml", &["--k1=0"], "--k1 0: expected more than 0"),
        ("curve.toml", &["--seeds=1001"], "--seeds 1001"),
        ("curve.toml", &["--merge", "none.jsonl"], "none.jsonl"),
    ] {
        let result = output(
            yawbench().args(["curve", scenario, "--out=out"]).args(args).current_dir(&place),
        );
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(message), "{args:?}: {errors}");
        assert!(!place.join("out").exists(), "{args:?}");
    }
}
