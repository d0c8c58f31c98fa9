//! What a visit writes reads back as what it recorded.

use crate::support::Folder;
use measurement::mapping::Companion;
use measurement::{Measurement, read_tests};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use virtual_bench::bench_visit::RawRecord;
use virtual_bench::characterisation::Outcome;

/// Writes a record as `characterise` does.
fn write(folder: &Folder, record: &RawRecord, specimen: &str) -> PathBuf {
    let name = record.csv_name();
    let mut text = Vec::new();
    record.write_csv(&mut text).unwrap();
    folder.write(&Companion::name_for(&name), &record.companion(specimen).to_toml(&name));
    folder.write(&name, &String::from_utf8(text).unwrap())
}

fn visited(folder: &Folder) -> (Outcome, Vec<Measurement>) {
    let outcome = folder.visit().run(&[], &AtomicBool::new(false), &mut |_| {}).unwrap();
    let records = outcome.records.iter();
    let paths: Vec<PathBuf> = records.map(|one| write(folder, one, &outcome.specimen)).collect();
    let tests = read_tests(&paths, None).unwrap();
    (outcome, tests)
}

#[test]
fn a_visit_reads_back_with_its_numbers_direction_temperature_and_specimen() {
    let folder = Folder::new("round-trip");
    let (outcome, tests) = visited(&folder);
    assert_eq!((outcome.records.len(), tests.len()), (3, 3));
    for (record, test) in outcome.records.iter().zip(&tests) {
        assert_eq!(test.name, record.name);
        assert_eq!(test.specimen.as_deref(), Some("damper 7"));
        assert!(test.direction_declared && !test.force_turned);
        assert_eq!(test.repairs, [""; 0]);
        assert_eq!(test.rate_hz(), record.rate_hz);
        // As they are in the file: a nanometre, a millinewton, a hundredth of a kelvin.
        let rounded = |values: &[f64], decimals: usize| -> Vec<f64> {
            values.iter().map(|value| format!("{value:.decimals$}").parse().unwrap()).collect()
        };
        assert!(test.displacement_m == rounded(&record.displacement_m, 9), "{}", test.name);
        assert!(test.force_n == rounded(&record.force_n, 3), "{}", test.name);
        let degc = record.temperature_degc.as_ref().map(|degc| rounded(degc, 2));
        assert!(degc.is_some() && test.temperature_degc == degc, "{}", test.name);
    }
}

#[test]
fn other_programs_met_a_comment_in_line_1() {
    let folder = Folder::new("line-1");
    let (outcome, _) = visited(&folder);
    for record in &outcome.records {
        let text = std::fs::read_to_string(folder.join(record.csv_name())).unwrap();
        assert!(!text.contains(['#', '"', ' ', '\r']), "{}", record.name);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("time_s,displacement_m,force_n,temperature_degc"));
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), 4, "{line}");
            assert!(cells.iter().all(|cell| cell.parse::<f64>().is_ok()), "{line}");
        }
    }
}

#[test]
fn an_own_file_with_its_direction_in_a_comment_is_still_read() {
    let folder = Folder::new("comment");
    let (outcome, tests) = visited(&folder);
    let record = &outcome.records[0];
    std::fs::remove_file(folder.join("sine.toml")).unwrap();
    let path = folder.join("sine.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("# extension: negative\n{text}")).unwrap();
    let turned = read_tests(&[path], None).unwrap().remove(0);
    assert_eq!(turned.len(), record.force_n.len());
    assert!(turned.force_n.iter().zip(&tests[0].force_n).all(|(a, b)| *a == -b));
}
