//! The mapping next to a file.

use crate::support::{Folder, NAMES, record};
use measurement::mapping::{Companion, Extension};
use measurement::{Measurement, read_tests};
use std::path::Path;

fn read(path: &Path) -> Measurement {
    let mut tests = read_tests(&[path.to_owned()], None).unwrap();
    assert_eq!(tests.len(), 1);
    tests.remove(0)
}

const TURNED: Companion = Companion {
    specimen: None,
    notes: Vec::new(),
    extension: Extension::Negative,
    temperature: true,
};

#[test]
fn what_a_file_cannot_say_comes_from_the_mapping_next_to_it() {
    let folder = Folder::new("companion");
    let path = folder.write("sine.csv", record(NAMES));
    let alone = read(&path);
    assert!(alone.direction_declared && alone.specimen.is_none());
    let companion = Companion { specimen: Some("damper 7".to_owned()), ..TURNED };
    folder.write("sine.toml", companion.to_toml("sine.csv"));
    let test = read(&path);
    assert_eq!(test.specimen.as_deref(), Some("damper 7"));
    assert_eq!(test.displacement_m[30], -alone.displacement_m[30]);
    assert_eq!(test.force_n[30], -alone.force_n[30]);
    assert_eq!(test.temperature_degc, alone.temperature_degc);
    assert_eq!(test.repairs, alone.repairs);
    // A mapping that is named takes its place.
    let named = folder.write("m.toml", "extension = \"unknown\"\n");
    let test = read_tests(&[path], Some(&named)).unwrap().remove(0);
    assert!(!test.direction_declared && test.specimen.is_none());
    assert_eq!(test.displacement_m, alone.displacement_m);
}

#[test]
fn another_toml_file_of_the_same_stem_is_no_mapping() {
    let folder = Folder::new("unrelated");
    let path = folder.write("sine.csv", record(NAMES));
    let alone = read(&path);
    folder.write("other.csv", record(NAMES));
    let texts: [&[u8]; 5] = [
        b"title = \"sine\"\n[damper]\nf_relief_n = 15e3\n",
        b"extension = \"negative\"\n",
        b"this is = = no TOML",
        b"\xff\xfe\x00binary",
        b"mapping_for = \"other.csv\"\nextension = \"negative\"\n",
    ];
    for text in texts {
        folder.write("sine.toml", text);
        assert_eq!(read(&path), alone, "{}", String::from_utf8_lossy(text));
    }
    std::fs::remove_file(folder.join("sine.toml")).unwrap();
    let pipe = folder.join("sine.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert_eq!(read(&path), alone);
}

#[test]
fn a_mapping_that_does_not_fit_its_file_is_refused() {
    let folder = Folder::new("misfit");
    let path = folder.write("renamed.csv", record(NAMES));
    folder.write("renamed.toml", TURNED.to_toml("sine.csv"));
    let refused = || read_tests(std::slice::from_ref(&path), None).unwrap_err().to_string();
    let message = refused();
    let expected = "renamed.toml: found mapping_for = \"sine.csv\", expected \"renamed.csv\"";
    assert!(message.contains(expected), "{message}");
    folder.write("renamed.toml", "mapping_for = \"renamed.csv\"\nextension = \"up\"\n");
    let message = refused();
    assert!(message.contains("renamed.toml:2: unknown variant `up`"), "{message}");
    let without = record("time_s,displacement_m,force_n,oil");
    let cold = folder.write("cold.csv", without);
    folder.write("cold.toml", TURNED.to_toml("cold.csv"));
    let message = read_tests(&[cold], None).unwrap_err().to_string();
    assert!(message.contains("expected one called temperature_degc"), "{message}");
}

#[test]
fn files_with_and_without_a_mapping_decide_about_their_signs_together() {
    let folder = Folder::new("together");
    let paths = ["a.csv", "b.csv"].map(|name| folder.write(name, record(NAMES)));
    folder.write("a.toml", Companion { extension: Extension::Positive, ..TURNED }.to_toml("a.csv"));
    // So late that it says nothing about its own sign.
    let late = |n: u32| {
        let angle = std::f64::consts::TAU * 2.0 * f64::from(n) * 2e-3;
        let (x, f) = (5e-3 * libm::sin(angle), -1e3 * libm::sin(angle - 0.1));
        format!("{:.3},{x:.7},{f:.3},20.0\n", f64::from(n) * 2e-3)
    };
    std::fs::write(&paths[1], format!("{NAMES}\n{}", (0..1000).map(late).collect::<String>()))
        .unwrap();
    let together = read_tests(&paths, None).unwrap();
    std::fs::remove_file(folder.join("a.toml")).unwrap();
    let plain = read_tests(&paths, None).unwrap();
    assert_eq!(together, plain);
}
