//! `yawbench ride`: its schema, the same bytes whole, in shards, after a stop and on one core, and
//! what it refuses.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A folder with a scenario of the Manchester coach in it, half as rough as class 6.
fn coach(name: &str) -> PathBuf {
    let place = folder(name);
    let vehicle = repository().join("scenarios/vehicles/manchester-coach.toml");
    let text = format!(
        "title = \"coach\"\nvehicle = '{}'\nspeed_kmh = 140.0\nduration_s = 1.0\n\
         [track.irregularity.aar6]\nseed = 1\nshortest_m = 2.0\nlongest_m = 80.0\nscale = 0.5\n",
        vehicle.display()
    );
    std::fs::write(place.join("coach.toml"), text).unwrap();
    place
}

/// Three speeds of one track of 20 s.
const VARIED: [&str; 6] = [
    "--vary=speed_kmh=80:160:3",
    "--seeds=1",
    "--section-s=20",
    "--run-in-s=3",
    "--grades=coach",
    "coach.toml",
];

fn run(place: &Path, args: &[&str]) -> String {
    let result = output(yawbench().arg("ride").args(args).current_dir(place));
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(0), "{args:?}: {errors}");
    String::from_utf8(result.stdout).unwrap()
}

#[test]
fn a_coach_rides_worse_the_faster_it_runs_and_says_on_which_track() {
    let place = coach("ride-coach");
    let text = run(&place, &[&VARIED[..], &["--out=found"]].concat());
    for message in [
        "80 to 160 km/h on straight class-6 track times 0.5, wavelengths 2 to 80 m, seeds 1",
        "20 s of each after 3 s of run-in",
        "simulated",
        "coaches",
    ] {
        assert!(text.contains(message), "{message}: {text}");
    }
    let json = read(&place.join("found/ride.json"));
    let found: Value = serde_json::from_str(&json).unwrap();
    let schema = read(&repository().join("docs/schema/ride.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &found), Vec::<String>::new());
    let indices = |direction: &str| -> Vec<f64> {
        let points = found["points"].as_array().unwrap().iter();
        let index = |point: &Value| {
            let place = &point["ride"]["floor"][0][direction];
            let [old, new] =
                ["sperling_1985", "sperling_2019"].map(|of| place[of]["mean"].as_f64().unwrap());
            // Windows of a quarter of the length: 7 % more for noise, less for tones.
            assert!((1.0..1.12).contains(&(new / old)), "{old} {new}");
            old
        };
        points.map(index).collect()
    };
    for direction in ["lateral", "vertical"] {
        let found = indices(direction);
        assert!(found[0] < found[1] && found[1] < found[2], "{direction}: {found:?}");
        assert!(found.iter().all(|index| (0.5..3.5).contains(index)), "{direction}: {found:?}");
    }
    let report = read(&place.join("found/report.html"));
    for drawn in ["Sperling index, lateral", "qualified", "Mean comfort of EN 12299"] {
        assert!(report.contains(drawn), "{drawn}");
    }
}

#[test]
fn points_are_the_same_whole_in_shards_after_a_stop_and_on_one_core() {
    let place = coach("ride-shards");
    let varied = |more: &[&str]| run(&place, &[&VARIED[..], more].concat());
    varied(&["--out=whole"]);
    let json = read(&place.join("whole/ride.json"));
    let report = read(&place.join("whole/report.html"));
    assert_eq!(varied(&["--out=whole", "--json"]), json);

    varied(&["--out=parts", "--shard=2/2"]);
    varied(&["--out=parts", "--shard=1/2"]);
    let files = ["--merge", "parts/points-2-of-2.jsonl", "parts/points-1-of-2.jsonl"];
    varied(&[&["--out=merged"], &files[..]].concat());
    assert_eq!(read(&place.join("merged/ride.json")), json);
    assert_eq!(read(&place.join("merged/report.html")), report);

    // Stopped within a line: that point is found again and no other.
    let file = place.join("whole/points-1-of-1.jsonl");
    let lines = read(&file);
    std::fs::write(&file, &lines[..lines.find('\n').unwrap() + 30]).unwrap();
    varied(&["--out=whole"]);
    assert_eq!(read(&place.join("whole/ride.json")), json);

    let args = [&VARIED[..], &["--out=one"]].concat();
    let one = yawbench()
        .arg("ride")
        .args(args)
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(&place)
        .output();
    assert!(one.unwrap().status.success());
    assert_eq!(read(&place.join("one/ride.json")), json);
}

#[test]
fn a_vehicle_off_the_track_is_reported_and_the_exit_code_is_1() {
    let place = coach("ride-off-the-track");
    // A carbody of almost no mass: the wheels lose their load.
    let light = ["ride", "--vary=vehicle.body.carbody.mass_kg=1e-3", "--seeds=1", "--out=off"];
    let result = output(yawbench().args(light).arg("coach.toml").current_dir(&place));
    let text = String::from_utf8_lossy(&result.stdout);
    assert_eq!(result.status.code(), Some(1), "{text}");
    assert!(text.contains("point 1: track 1: off the track at"), "{text}");
    let found: Value = serde_json::from_str(&read(&place.join("off/ride.json"))).unwrap();
    assert!(found["points"][0]["failure"].is_string() && found["points"][0]["ride"].is_null());
    assert!(!read(&place.join("off/report.html")).contains("Spectra of acceleration"));
}

#[test]
fn impossible_requests_get_one_line_and_nothing_is_written() {
    let place = coach("ride-refused");
    let bogie = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    let bogie = format!(
        "title = \"b\"\nvehicle = '{}'\nspeed_kmh = 140.0\nduration_s = 1.0\n",
        bogie.display()
    );
    std::fs::write(place.join("bogie.toml"), bogie).unwrap();
    let rough = read(&place.join("coach.toml"));
    let perfect = rough.split("[track").next().unwrap();
    std::fs::write(place.join("perfect.toml"), perfect).unwrap();
    for (scenario, args, message) in [
        ("coach.toml", &["--vary=vehicle.body.frame.mass_kg=1:2:2"][..], "body has no \"frame\""),
        ("coach.toml", &["--vary=speed_kmh=0,100"], "speed_kmh = 0"),
        ("coach.toml", &["--section-s=19"], "--section-s 19: expected 20"),
        ("coach.toml", &["--run-in-s=-1"], "--run-in-s -1"),
        ("coach.toml", &["--floor-m=nan"], "--floor-m NaN"),
        ("coach.toml", &["--seeds=0"], "--seeds 0"),
        ("coach.toml", &["--merge", "none.jsonl"], "none.jsonl"),
        ("bogie.toml", &[], "bogie.toml: no body is named \"carbody\""),
        ("perfect.toml", &[], "perfect.toml: the track has no irregularity"),
        ("coach.toml", &["--no-such"], "error: --no-such: unknown option"),
        ("none.toml", &[], "none.toml"),
    ] {
        let result =
            output(yawbench().args(["ride", scenario, "--out=out"]).args(args).current_dir(&place));
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(message), "{args:?}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{args:?}: {errors}");
        assert!(!place.join("out").exists(), "{args:?}");
    }
}
