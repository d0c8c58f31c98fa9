//! `yawbench identify --on-mass`: the files that it writes, what it refuses, and the public
//! Bouc-Wen benchmark.
//!
//! `YAWBENCH_RECORDS` names the folder that holds `bouc-wen/train-multisine.csv` and the two test
//! files; without it the benchmark says what it skips. The table of `docs/force-in-motion-out.md`
//! comes from
//!
//! ```text
//! YAWBENCH_RECORDS=DIR cargo test --release --test system bouc_wen -- --ignored --nocapture
//! ```

use crate::support::command::{folder, output, repository, yawbench};
use crate::support::schema;
use crate::support::visit::text_of;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;
use std::time::Instant;

/// Samples of a period.
const PERIOD: usize = 128;
const MAPPING: &str = "sample_rate_hz = 200.0\n[on_mass]\nstart = \"periodic\"\n\
    period_samples = 128\n";

/// Three periods of a linear body in steady state, by its frequency response: 2 kg, 5 kN/m,
/// 20 N s/m. The second number is noise that has no pattern over the periods.
fn linear_record(phase: f64) -> String {
    let mut text = "force_n,displacement_m\n".to_owned();
    for n in 0..3 * PERIOD {
        let t = n as f64 / 200.0;
        let (mut force, mut motion) = (0.0, 0.0);
        for line in 3..=24_u32 {
            let omega = TAU * f64::from(line) * 200.0 / PERIOD as f64;
            let (re, im) = (5e3 - 2.0 * omega * omega, 20.0 * omega);
            let turn = omega * t + phase * f64::from(line * line);
            force += 10.0 * libm::cos(turn);
            motion += 10.0 * libm::cos(turn - libm::atan2(im, re)) / libm::hypot(re, im);
        }
        let noise = 1e-6 * libm::sin(0.37 * (n * n) as f64);
        let _ = writeln!(text, "{force},{}", motion + noise);
    }
    text
}

fn identify(place: &Path, args: &[&str]) -> Output {
    output(yawbench().args(["identify", "--on-mass"]).args(args).current_dir(place))
}

#[test]
fn a_linear_body_is_written_with_all_its_files() {
    let place = folder("on-mass");
    std::fs::write(place.join("map.toml"), MAPPING).unwrap();
    std::fs::write(place.join("a.csv"), linear_record(0.7)).unwrap();
    std::fs::write(place.join("b.csv"), linear_record(1.9)).unwrap();
    let args = ["--mapping", "map.toml", "--train", "a.csv", "--holdout", "b.csv", "--out", "out"];
    let found = identify(&place, &args);
    assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stderr));
    let shown = String::from_utf8_lossy(&found.stdout).into_owned();
    assert!(shown.contains("no effect is missing") && shown.contains("noise floor"), "{shown}");
    let result: Value = serde_json::from_str(&text_of(&place.join("out/result.json"))).unwrap();
    let schema = text_of(&repository().join("docs/schema/identify-on-mass.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &result), Vec::<String>::new());
    assert_eq!(result["verdict"], "no_missing_effect");
    let mass = result["body"]["mass_kg"]["value"].as_f64().unwrap();
    assert!((mass / 2.0 - 1.0).abs() < 1e-2, "{mass}");
    for file in ["report.html", "predictions/a.csv", "predictions/b.csv"] {
        assert!(place.join("out").join(file).is_file(), "no {file}");
    }
    let again = identify(&place, &args);
    assert_eq!(again.status.code(), Some(2), "a result is not replaced without --overwrite");
}

#[test]
fn what_cannot_be_a_record_of_a_body_is_refused_in_one_line() {
    let place = folder("on-mass-refused");
    let zero = "force_n,displacement_m\n".to_owned() + &"0,1e-3\n".repeat(80);
    std::fs::write(place.join("zero.csv"), zero).unwrap();
    std::fs::write(place.join("short.csv"), "force_n,displacement_m\n1,2\n").unwrap();
    std::fs::write(place.join("rate.toml"), "sample_rate_hz = 200.0\n").unwrap();
    std::fs::write(place.join("long.toml"), MAPPING.replace("128", "1000")).unwrap();
    std::fs::write(place.join("a.csv"), linear_record(0.7)).unwrap();
    for (args, said) in [
        (&["--mapping", "rate.toml", "--train", "zero.csv"][..], "found a force of zero"),
        (&["--mapping", "rate.toml", "--train", "short.csv"], "found 1 samples, expected 64"),
        (&["--mapping", "long.toml", "--train", "a.csv"], "expected period_samples = 1000"),
        (&["--train", "a.csv"], "time_s"),
        (&["--train", "a.csv", "--thorough"], "--thorough"),
        (
            &["--mapping", "rate.toml", "--train", "a.csv", "--holdout", "a.csv"],
            "both in --train and in --holdout",
        ),
    ] {
        let refused = identify(&place, args);
        let error = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{args:?}: {error}");
        assert!(error.contains(said) && error.lines().count() == 1, "{args:?}: {error}");
    }
    assert!(!place.join("runs").exists(), "a refusal writes nothing");
}

#[test]
#[ignore = "needs the files of the benchmark and some minutes"]
fn bouc_wen_benchmark_is_named() {
    let Some(records) = std::env::var_os("YAWBENCH_RECORDS") else {
        println!("skipped: YAWBENCH_RECORDS does not name a folder with bouc-wen/");
        return;
    };
    let records = Path::new(&records).join("bouc-wen");
    let files = ["train-multisine.csv", "test-multisine.csv", "test-sinesweep.csv"];
    if let Some(missing) = files.iter().find(|name| !records.join(name).is_file()) {
        println!("skipped: no {} in {}", missing, records.display());
        return;
    }
    let [train, multisine, sweep] = files.map(|name| records.join(name).display().to_string());
    let place = folder("on-mass-bouc-wen");
    let mapping = repository().join("scenarios/mappings/bouc-wen.toml").display().to_string();
    let begin = Instant::now();
    let found = identify(
        &place,
        &[
            "--mapping",
            &mapping,
            "--train",
            &train,
            "--holdout",
            &multisine,
            &sweep,
            "--out",
            "out",
        ],
    );
    assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stderr));
    println!("{}", String::from_utf8_lossy(&found.stdout));
    println!("{:.0} s of wall time", begin.elapsed().as_secs_f64());
    let result: Value = serde_json::from_str(&text_of(&place.join("out/result.json"))).unwrap();
    let score = |name: &str| {
        let rows = result["per_record"].as_array().unwrap();
        rows.iter().find(|row| row["name"] == name).unwrap()["kept_rms"].as_f64().unwrap()
    };
    let (multisine, sweep) = (score("test-multisine"), score("test-sinesweep"));
    println!("official score                this program  best published that was found");
    println!("test multisine, rms, m        {multisine:.2e}       7.5e-6");
    println!("test sweep, rms, m            {sweep:.2e}");
    println!(
        "This is no record: the generating law is one of the candidates, and published models may \
         be black boxes. It tests the naming of the law."
    );
    assert_eq!(result["laws"][0]["name"], "bouc_wen");
    assert_eq!(result["laws"].as_array().unwrap().len(), 1);
    assert_eq!(result["verdict"], "effects_found");
    assert!(multisine < 1e-6 && sweep < 5e-6, "{multisine:e} {sweep:e}");
}
