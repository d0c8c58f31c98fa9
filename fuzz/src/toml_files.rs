//! Files in TOML: the first byte chooses the kind, the rest is the text.

use crate::temporary::Temporary;
use scenario::damper::DamperFile;
use scenario::datasheet::Datasheet;
use scenario::rig::RigFile;
use scenario::run::{Overrides, Run};
use scenario::source::Source;
use std::fmt::Display;
use std::path::Path;
use virtual_bench::bench_visit::test_list::TestList;
use virtual_bench::hydraulic::HydraulicDamper;

pub(crate) fn toml_files(bytes: &[u8]) {
    let Some((kind, text)) = bytes.split_first() else { return };
    let Some(file) = Temporary::new("file.toml", text) else { return };
    let path = file.path();
    match kind % 7 {
        0 => scenario(text),
        1 => check(RigFile::load(path)),
        2 => check(DamperFile::load_model(path)),
        3 => check(Datasheet::load(path)),
        4 => check(TestList::load(path)),
        5 => check(HydraulicDamper::load(path)),
        _ => {
            let named =
                format!("vehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 1.0\n", path.display());
            scenario(named.as_bytes());
        }
    }
}

/// A scenario next to those of the repository, whose files it can name. A second of it is enough:
/// a longer track only takes longer.
fn scenario(text: &[u8]) {
    let Ok(text) = std::str::from_utf8(text) else { return };
    let next_to_them = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/fuzzed.toml");
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    check(Run::from_source(&Source::from_text(&next_to_them, text), overrides));
}

/// An error has one line.
pub(crate) fn check<T, E: Display>(read: Result<T, E>) {
    if let Err(error) = read {
        let text = error.to_string();
        assert!(!text.is_empty() && !text.contains('\n'), "not one line: {text:?}");
        assert!(text.len() < 4000, "an error of {} bytes: {text}", text.len());
    }
}
