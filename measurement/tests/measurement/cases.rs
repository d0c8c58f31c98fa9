//! The small inputs of other laboratories that are kept next to the repository, where they are.

use measurement::{Measurement, read_tests};
use std::path::{Path, PathBuf};

fn folder(case: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases").join(case);
    if !folder.is_dir() {
        eprintln!("skipped: no folder {case} next to the repository");
        return None;
    }
    Some(folder)
}

fn work_per_cycle_j(test: &Measurement) -> f64 {
    let (first, last) = (test.cycles[0], test.cycles[test.cycles.len() - 1]);
    let part = |n: usize| {
        let next = (n + 1).min(test.len() - 1);
        let way = test.displacement_m[next] - test.displacement_m[n];
        0.5 * (test.force_n[n] + test.force_n[next]) * way
    };
    (first..last).map(part).sum::<f64>() / (test.cycles.len() - 1) as f64
}

#[test]
fn files_of_other_laboratories_give_their_figures() {
    for (case, file, mapping, tests) in [
        ("clock-time-stamps", "iso.csv", Some("iso.toml"), 1),
        ("clock-time-stamps", "hms.csv", None, 1),
        ("decimal-comma-in-quotes-and-thousands", "qcomma.csv", Some("qcomma.toml"), 1),
        ("decimal-comma-in-quotes-and-thousands", "thousand.csv", Some("thousand.toml"), 1),
        ("unit-spellings", "mts_one.dat", Some("mts.toml"), 1),
        ("unit-spellings", "mts_one.dat", None, 1),
        ("repeated-header-blocks", "mts_two.dat", Some("mts.toml"), 2),
        ("raw-counts", "counts.csv", Some("counts.toml"), 1),
        ("slow-channel-with-blanks", "sparse_temp.csv", None, 1),
    ] {
        let Some(folder) = folder(case) else { return };
        let mapping = mapping.map(|name| folder.join(name));
        let found = read_tests(&[folder.join(file)], mapping.as_deref()).unwrap();
        assert_eq!(found.len(), tests, "{file}");
        for test in &found {
            let work_j = work_per_cycle_j(test);
            assert!((work_j / 156.36 - 1.0).abs() < 2e-3, "{file}: {work_j} J per cycle");
            assert!((test.rate_hz() - 1e3).abs() < 1e-6 && test.len() == 6000, "{file}");
        }
    }
}

#[test]
fn short_and_tapered_tests_have_their_cycles() {
    let Some(folder) = folder("sine-with-rest-or-soft-start-has-no-cycles") else { return };
    for (file, cycles, least, work_j) in
        [("rest3.csv", 3, 2, 78.96), ("rest3b.csv", 3, 2, 78.96), ("soft_3.csv", 4, 3, 463.0)]
    {
        let test = read_tests(&[folder.join(file)], None).unwrap().remove(0);
        let found = test.cycles.len() - 1;
        assert!((least..=cycles).contains(&found), "{file}: {found} cycles");
        let work = work_per_cycle_j(&test);
        assert!((work / work_j - 1.0).abs() < 3e-3, "{file}: {work} J per cycle");
    }
}

#[test]
fn stamps_in_significant_digits_are_equal_steps() {
    let Some(folder) = folder("time-in-significant-digits") else { return };
    for file in ["sigdigits.csv", "sigdigits_sci.csv"] {
        let test = read_tests(&[folder.join(file)], None).unwrap().remove(0);
        assert!((test.rate_hz() / 3004.8 - 1.0).abs() < 1e-5, "{file}: {} Hz", test.rate_hz());
    }
}

#[test]
fn rows_of_separators_and_kips_are_read() {
    let Some(excel) = folder("excel-trailing-empty-rows") else { return };
    let test = read_tests(&[excel.join("emptyrows.csv")], None).unwrap().remove(0);
    assert_eq!((test.cycles.len(), test.len()), (7, 3000));
    let Some(units) = folder("unit-spellings") else { return };
    let mapping = units.join("kip.toml");
    let test = read_tests(&[units.join("kip.csv")], Some(&mapping)).unwrap().remove(0);
    assert!((test.force_n[0] - 0.015_216_720_1 * 4_448.221_615_260_5).abs() < 1e-6);
    assert!((test.displacement_m[0] - 0.000_176_846_981 * 0.0254).abs() < 1e-12);
}
