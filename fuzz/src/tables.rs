//! Tables of other laboratories: a mapping, a line of its own with `---`, and the table; without
//! that line the table alone.
//!
//! A proposed mapping is TOML that the reader of mappings takes or refuses in one line. Every test
//! that is read has as many forces as displacements, all finite, and a clock that runs forward.

use crate::temporary::Temporary;
use crate::toml_files::check;
use measurement::body_record::read_body_records;
use measurement::{propose_mapping, read_motions, read_tests};

/// Between mapping and table.
const MARK: &[u8] = b"\n---\n";

pub(crate) fn tables(bytes: &[u8]) {
    let split = bytes.windows(MARK.len()).position(|window| window == MARK);
    let (mapping, table) = match split {
        Some(at) => (Some(&bytes[..at]), &bytes[at + MARK.len()..]),
        None => (None, bytes),
    };
    let Some(table) = Temporary::new("table.csv", table) else { return };
    let mapping = mapping.and_then(|text| Temporary::new("mapping.toml", text));
    let mapping = mapping.as_ref().map(Temporary::path);
    let paths = [table.path().to_owned()];
    check(read_tests(&paths, mapping).inspect(|tests| {
        for test in tests {
            assert!(test.step_s > 0.0 && test.step_s.is_finite(), "a step of {} s", test.step_s);
            assert_eq!(test.displacement_m.len(), test.force_n.len(), "{}", test.name);
            let is_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
            assert!(is_finite(&test.displacement_m) && is_finite(&test.force_n), "{}", test.name);
        }
    }));
    check(read_motions(table.path(), mapping));
    check(read_body_records(&paths, mapping));
    if let Ok(proposed) = propose_mapping(table.path())
        && let Some(proposed) = Temporary::new("proposed.toml", proposed.as_bytes())
    {
        check(read_tests(&paths, Some(proposed.path())));
    }
}
