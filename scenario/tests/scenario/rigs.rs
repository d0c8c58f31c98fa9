//! Kinds of rigs: what each takes and refuses, and a scenario that names the file of its rig.

use crate::support::{Folder, shipped};
use scenario::ScenarioError;
use scenario::rig::{Drive, RigFile, RigSetup, ServoSetup};
use scenario::run::{Overrides, Run};

/// A rig file with this text.
fn rig(folder: &Folder, text: &str) -> Result<RigSetup, ScenarioError> {
    RigFile::load(&folder.write("rig.toml", text))
}

#[test]
fn a_rig_without_a_kind_is_ideal_and_the_shipped_ones_are_what_they_say() {
    let shipped = |name: &str| RigFile::load(&shipped().join("rigs").join(name)).unwrap();
    assert_eq!(shipped("laboratory-rig.toml").drive, Drive::Ideal);
    assert_eq!(shipped("slow-rig.toml").drive, Drive::Ideal);
    assert_eq!(shipped("rths-benchmark-rig.toml").drive, Drive::RthsBenchmark);
    let written = shipped("servo-hydraulic-rig.toml");
    let usual = rig(&Folder::new("servo"), "kind = \"servo\"").unwrap();
    let (Drive::Servo(written_out), Drive::Servo(by_default)) = (written.drive, usual.drive) else {
        panic!("two servo rigs")
    };
    let oil_volume_m3 = by_default.oil_volume_m3;
    assert!((written_out.oil_volume_m3 / oil_volume_m3 - 1.0).abs() < 1e-12);
    let written_out = ServoSetup { oil_volume_m3, ..written_out };
    assert_eq!(written_out, by_default, "the file writes out the defaults");
    assert_eq!(written.fixture_m_per_n, usual.fixture_m_per_n);
    assert!((usual.rate_m_per_s - 0.6).abs() < 1e-12, "{} m/s", usual.rate_m_per_s);
}

#[test]
fn what_means_nothing_to_a_kind_is_refused() {
    let folder = Folder::new("foreign-keys");
    for (text, parts) in [
        ("kind = \"servo\"\nlag_s = 1e-3\n", ["rig.toml:2", "lag_s", "\"servo\""]),
        ("kind = \"servo\"\nrate_m_per_s = 1.0\n", ["rig.toml:2", "rate_m_per_s", "\"servo\""]),
        (
            "kind = \"rths-benchmark\"\nfixture_n_per_m = 1e8\n",
            ["rig.toml:2", "fixture_n_per_m", "\"rths-benchmark\""],
        ),
        ("stroke_m = 0.1\n[servo]\narea_m2 = 1e-3\n", ["rig.toml", "[servo]", "\"ideal\""]),
        ("kind = \"hydraulic\"\nstroke_m = 0.1\n", ["rig.toml:1", "hydraulic", "servo"]),
    ] {
        let error = rig(&folder, text).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn hydraulics_that_cannot_be_are_refused() {
    let folder = Folder::new("hydraulics");
    for (text, parts) in [
        ("feed_forward = 1.5", ["rig.toml:3", "feed_forward", "0 to 1"]),
        ("oil_volume_m3 = 5e-4", ["rig.toml:3", "oil_volume_m3", "6.000e-4"]),
        ("bulk_modulus_pa = 3e9\nram_mass_kg = 1.0", ["the ram", "2516 Hz", "2500 Hz"]),
        ("area_mm2 = 3000.0", ["rig.toml:3", "area_mm2", "area_m2"]),
    ] {
        let text = format!("kind = \"servo\"\n[servo]\n{text}\n");
        let error = rig(&folder, &text).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
    // What the ram sweeps is enough.
    assert!(rig(&folder, "kind = \"servo\"\n[servo]\noil_volume_m3 = 6e-4\n").is_ok());
}

#[test]
fn a_scenario_names_the_file_of_its_rig_and_writes_out_what_that_says() {
    let folder = Folder::new("rig-file");
    folder.write("rig.toml", "kind = \"servo\"\nseed = 9\n[damper]\nf_relief_n = 15e3\n");
    let run = |text: &str| {
        let vehicle = shipped().join("vehicles/ss9.toml");
        let head = format!("vehicle = \"{}\"\nspeed_kmh = 160.0\n", vehicle.display());
        let path = folder.write("run.toml", &format!("{head}duration_s = 1.0\n{text}"));
        Run::load(&path, Overrides::default())
    };
    let named = run("[damper]\nf_relief_n = 12e3\nke_n_per_m = 9e6\n[rig]\nfile = \"rig.toml\"\n");
    let named = named.unwrap();
    assert_eq!(named.rig.seed, 9);
    // The rig's file rules over the scenario's damper, which fills in what the file leaves open.
    assert_eq!(named.rig.damper.nominal().f_relief_n, 15e3);
    assert_eq!(named.rig.damper.nominal().ke_n_per_m, 9e6);
    assert!(named.inputs.keys().any(|role| role == "rig"), "{:?}", named.inputs);
    // The effective scenario is the same rig, without the file.
    std::fs::remove_file(folder.write("rig.toml", "")).unwrap();
    folder.write("vehicle.toml", &named.effective.vehicle);
    let again = folder.write("effective.toml", &named.effective.scenario);
    let again = Run::load(&again, Overrides::default()).unwrap();
    assert_eq!(again.rig, named.rig);
    for key in ["kind = \"servo\"", "valve_hz = 80", "heat_capacity_j_per_k = 21000"] {
        assert!(named.effective.scenario.contains(key), "no {key}: {}", named.effective.scenario);
    }

    folder.write("rig.toml", "kind = \"servo\"\nstroke_m = -1.0\n");
    let error = run("[rig]\nfile = \"rig.toml\"\n").unwrap_err().to_string();
    assert!(error.contains("rig.toml:2") && error.contains("stroke_m"), "{error}");
    let error = run("[rig]\nfile = \"rig.toml\"\nseed = 2\n").unwrap_err().to_string();
    assert!(error.contains("run.toml") && error.contains("[rig.damper]"), "{error}");
}
