//! What is wrong is one line, names the place, and cannot act on a terminal.

use crate::support::{Folder, shipped};
use scenario::damper::DamperFile;
use scenario::datasheet::Datasheet;
use scenario::rig::RigFile;
use scenario::run::{Overrides, Rate, Run};
use scenario::{Kind, ScenarioError};

const GOOD: &str = "title = \"a case\"\nspeed_kmh = 160.0\nduration_s = 1.0\n";

fn load(path: &std::path::Path) -> Result<Run, ScenarioError> {
    Run::load(path, Overrides::default())
}

/// The scenario with a vehicle and something more.
fn scenario(folder: &Folder, more: &str) -> Result<Run, ScenarioError> {
    let vehicle = shipped().join("vehicles/ss9.toml");
    load(&folder.write("run.toml", &format!("vehicle = \"{}\"\n{GOOD}{more}", vehicle.display())))
}

#[test]
fn a_file_of_another_kind_is_named_as_such() {
    let shipped = shipped();
    let kinds = |error: ScenarioError| match error {
        ScenarioError::Kind { found, expected, .. } => (found, expected),
        other => panic!("{other}"),
    };
    let rig = shipped.join("rigs/laboratory-rig.toml");
    let run = shipped.join("ss9-160kmh.toml");
    let vehicle = shipped.join("vehicles/ss9.toml");
    let hydraulic = shipped.join("dampers/hydraulic-yaw-damper.toml");
    let mapping = shipped.join("mappings/labcontrol.toml");
    let folder = Folder::new("kinds");
    let model = folder.write("model.toml", "[damper]\nke_n_per_m = 9e6\n");
    let sheet = folder.write("sheet.toml", "[damper]\nv_relief_m_per_s = 0.1\nf_relief_n = 1e4\n");
    for (path, found) in [
        (&rig, Kind::Rig),
        (&vehicle, Kind::Vehicle),
        (&hydraulic, Kind::HydraulicDamper),
        (&mapping, Kind::Mapping),
        (&model, Kind::DamperModel),
        (&sheet, Kind::Datasheet),
    ] {
        assert_eq!(kinds(load(path).unwrap_err()), (found, Kind::Scenario), "{path:?}");
    }
    assert_eq!(kinds(RigFile::load(&run).unwrap_err()), (Kind::Scenario, Kind::Rig));
    assert_eq!(kinds(RigFile::load(&vehicle).unwrap_err()), (Kind::Vehicle, Kind::Rig));
    let model_error = |path| DamperFile::load_model(path).unwrap_err();
    assert_eq!(kinds(model_error(&rig)), (Kind::Rig, Kind::DamperModel));
    assert_eq!(kinds(model_error(&sheet)), (Kind::Datasheet, Kind::DamperModel));
    assert_eq!(kinds(Datasheet::load(&run).unwrap_err()), (Kind::Scenario, Kind::Datasheet));
    let vehicle_error =
        load(&folder.write("run.toml", &format!("vehicle = \"{}\"\n{GOOD}", run.display())));
    assert_eq!(kinds(vehicle_error.unwrap_err()), (Kind::Scenario, Kind::Vehicle));
    let said = load(&rig).unwrap_err().to_string();
    let end =
        "laboratory-rig.toml:13: found a rig, expected a scenario (unknown field `delay_cycles`, ";
    assert!(said.contains(end) && !said.contains('\n'), "{said}");
    // A misspelt key in a file of the right kind is only that.
    let error = scenario(&folder, "sped_kmh = 1\n").unwrap_err();
    assert!(matches!(error, ScenarioError::Syntax { .. }), "{error}");
    assert!(error.is_bad_input());
}

#[test]
fn an_option_out_of_range_is_named_without_a_line_of_the_scenario() {
    let path = shipped().join("ss9-160kmh.toml");
    let said = |overrides| Run::load(&path, overrides).unwrap_err().to_string();
    let duration = |duration_s| Overrides { duration_s: Some(duration_s), ..Overrides::default() };
    let speed = |speed_kmh| Overrides { speed_kmh: Some(speed_kmh), ..Overrides::default() };
    assert_eq!(said(duration(-1.0)), "--duration -1: expected 0.001 to 86400 s");
    assert_eq!(said(duration(f64::NAN)), "--duration NaN: expected 0.001 to 86400 s");
    assert_eq!(said(speed(700.0)), "--speed-kmh 700: expected more than 0 and at most 600 km/h");
    let slow = said(speed(20.0));
    assert!(slow.starts_with("--speed-kmh 20: expected at least "), "{slow}");
    assert!(!slow.contains("toml"), "{slow}");
}

#[test]
fn a_rate_is_one_of_three_and_divides_the_substeps() {
    let folder = Folder::new("rates");
    let run = scenario(&folder, "rate_hz = 4000\n").unwrap();
    // Four substeps per millisecond: one in each cycle.
    assert_eq!((run.rate, run.substeps, run.cycles()), (Rate::Fourfold, 1, 4000));
    assert_eq!((run.motion.ramp_cycles, run.plausibility.lost_rows), (2000, Some(4000)));
    assert_eq!(run.plausibility.checks(255, 40e3).acceleration.limit, 2400.0);
    let usual = scenario(&folder, "").unwrap();
    assert_eq!((usual.rate, usual.substeps, usual.cycles()), (Rate::Usual, 4, 1000));
    // The same track from end to end, and the same start.
    assert_eq!((&run.track, &run.start), (&usual.track, &usual.start));
    let said = |more: &str| scenario(&folder, more).unwrap_err().to_string();
    for (more, expected) in [
        ("rate_hz = 3000\n", "rate_hz = 3000, expected 1000, 2000 or 4000 Hz"),
        ("rate_hz = 4000\nsubsteps = 6\n", "substeps = 6, expected a multiple of 4 at 4 kHz"),
        ("rate_hz = 2000\nsubsteps = 5\n", "substeps = 5, expected a multiple of 2 at 2 kHz"),
    ] {
        let said = said(more);
        assert!(said.ends_with(expected) && said.contains("run.toml"), "{said}");
    }
    // 20 ms are 80 cycles at 4 kHz, and the motion is computed by at most 63 ahead.
    let worn = "\n[[slot]]\nplace = \"front left\"\non = \"rig\"\n\
                virtual_wear = { clearance_2a_m = 1e-3 }\n\
                compensation = { kind = \"polynomial\", delay_s = 20e-3 }\n";
    assert!(
        scenario(&folder, worn).is_ok()
            && scenario(&folder, &format!("rate_hz = 2000{worn}")).is_ok()
    );
    let said = said(&format!("rate_hz = 4000{worn}"));
    assert!(said.contains("virtual_wear at 4 kHz") && !said.contains('\n'), "{said}");
}

#[test]
fn text_of_a_file_is_escaped_and_cut_in_messages() {
    let folder = Folder::new("quoted");
    let shown = |more: &str| {
        let said = scenario(&folder, more).unwrap_err().to_string();
        assert!(!said.contains(['\u{1b}', '\n']), "{said:?}");
        assert!(said.len() < 3000, "{} characters", said.len());
        said
    };
    let megabyte = "x".repeat(1_000_000);
    assert!(shown(&format!("{megabyte} = 1\n")).contains("… (1000000 characters)"));
    let red = "\\u001b[31mred";
    let escaped = "\\u{1b}[31mred";
    for more in [
        format!("\"{red}\" = 1\n"),
        format!("[[slot]]\nplace = \"{red}\"\non = \"rig\"\n"),
        format!("[[damper.effect]]\nname = \"{red}\"\n"),
        format!("[[damper.effect]]\nname = \"play\"\n\"{red}\" = 1\n"),
        format!("[damper]\nfile = \"{red}\"\n"),
        format!("[track.irregularity.csv]\npath = \"{red}\"\n"),
    ] {
        let said = shown(&more);
        assert!(said.contains(escaped) || more.contains("play"), "{said}");
    }
    let track = folder.write("track.csv", "distance_m,\u{1b}[31mred\n0,0\n");
    let said = shown(&format!("[track.irregularity.csv]\npath = \"{}\"\n", track.display()));
    assert!(said.contains("unknown column `\\u{1b}[31mred`"), "{said}");
    // Names that are shown and not refused are quoted too.
    let vehicle = shipped().join("vehicles/ss9.toml");
    let text = format!("vehicle = \"{}\"\n{}", vehicle.display(), GOOD.replace("a case", red));
    let run = load(&folder.write("red.toml", &text)).unwrap();
    assert_eq!(run.title, escaped);
    assert!(run.effective.scenario.contains("\\u001B[31mred"), "{}", run.effective.scenario);
}

#[test]
fn a_file_that_is_not_regular_is_not_read() {
    let folder = Folder::new("devices");
    for more in [
        "[damper]\nfile = \"/dev/zero\"\n",
        "[track.irregularity.csv]\npath = \"/dev/zero\"\n",
        "[compare.damper]\nfile = \"/dev/zero\"\n",
    ] {
        let said = scenario(&folder, more).unwrap_err().to_string();
        assert!(said.contains("/dev/zero: found a device, expected a file"), "{said}");
    }
    let said = load(std::path::Path::new("/dev/zero")).unwrap_err().to_string();
    assert_eq!(said, "/dev/zero: found a device, expected a file");
}
