//! Every file that a run reads is one of its inputs, by what it is for.

use crate::support::{Folder, shipped};
use files::identity::content_hash;
use scenario::profile::{cn60, lma};
use scenario::run::{Overrides, Run};
use std::fmt::Write as _;
use std::fs;

const SCENARIO: &str = "title = \"all files\"\nvehicle = \"vehicle.toml\"\nspeed_kmh = 160.0\n\
    duration_s = 1.0\ndamper = { file = \"damper.toml\" }\n\
    [track.irregularity.csv]\npath = \"track.csv\"\n\
    [rig]\ndamper = { file = \"mounted.toml\" }\n\
    [compare]\ndamper = { file = \"other.toml\" }\n\
    [[slot]]\nplace = \"front left\"\non = \"rig\"\nwatch = { damper = { file = \"model.toml\" } }\n\
    [[slot]]\nplace = \"front right\"\non = \"modelled\"\ndamper = { file = \"own.toml\" }\n";

#[test]
fn every_file_that_a_run_reads_is_an_input_with_the_hash_of_its_bytes() {
    let folder = Folder::new("inputs");
    let vehicle = fs::read_to_string(shipped().join("vehicles/ss9.toml")).unwrap();
    let named = [
        ("wheel = \"jm3_like\"", "wheel = \"wheel.csv\""),
        ("\"cn60\"", "\"rail.csv\""),
        // The upright sides of a rail from points are cut off.
        ("gauge_depth_m = { value = 0.016", "gauge_depth_m = { value = 0.012"),
    ];
    let vehicle = named.iter().fold(vehicle, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let points = |profile: scenario::profile::Profile| {
        let mut text = "y_mm,z_mm\n".to_owned();
        let (first, last) = (profile.first_m() * 1e3, profile.last_m() * 1e3);
        for step in 0..=((last - first) * 10.0) as u32 {
            let y = first + 0.1 * f64::from(step);
            writeln!(text, "{y},{}", profile.at(y * 1e-3).down_m * 1e3).unwrap();
        }
        text
    };
    let mut track = "distance_m,gauge_m\n".to_owned();
    for step in 0..500 {
        writeln!(track, "{step},0").unwrap();
    }
    let damper = |ke: u32| format!("[damper]\nke_n_per_m = {ke}e6\n");
    let files = [
        ("scenario", "run.toml", SCENARIO.to_owned()),
        ("vehicle", "vehicle.toml", vehicle),
        ("wheel profile", "wheel.csv", points(lma())),
        ("rail profile", "rail.csv", points(cn60())),
        // With a byte-order mark, which belongs to the bytes.
        ("measured track", "track.csv", format!("\u{feff}{track}")),
        ("damper", "damper.toml", damper(9)),
        ("rig damper", "mounted.toml", damper(10)),
        ("compared damper", "other.toml", damper(11)),
        ("watched model front left", "model.toml", damper(12)),
        ("damper front right", "own.toml", damper(13)),
    ];
    for (_, name, text) in &files {
        folder.write(name, text);
    }
    let path = folder.write("run.toml", SCENARIO);
    let run = Run::load(&path, Overrides::default()).unwrap();
    let expected = files.iter().map(|(role, _, text)| {
        let hash = content_hash(text.as_bytes());
        ((*role).to_owned(), hash)
    });
    assert_eq!(run.inputs, expected.collect());
    // Settings change the question, not the file.
    let setting = scenario::setting::Setting::to("speed_kmh", 150.0);
    let other = Run::load_with(&path, Overrides::default(), &[setting]).unwrap();
    assert_eq!(other.inputs, run.inputs);
    assert_ne!(other.speed_m_per_s, run.speed_m_per_s);
}

#[test]
fn a_run_without_other_files_has_two_inputs() {
    let run = Run::load(&shipped().join("ss9-160kmh.toml"), Overrides::default()).unwrap();
    assert_eq!(run.inputs.keys().collect::<Vec<_>>(), ["scenario", "vehicle"]);
}
