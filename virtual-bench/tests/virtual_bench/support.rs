//! A folder for a test, and a damper with a short list of tests.

use std::ops::Deref;
use std::path::{Path, PathBuf};
use virtual_bench::bench_visit::test_list::TestList;
use virtual_bench::characterisation::Visit;

const MODEL: &str = "[damper]\nclearance_2a_m = 1e-3\nf_relief_n = 15e3\nc2_n_s_per_m = 60e3\n";

const LIST: &str = "[[test]]\nname = \"sine\"\nduration_s = 2.0\n\
    sine = { amplitude_m = 3e-3, frequency_hz = 3.0 }\n\
    [[test]]\nname = \"triangle\"\n\
    triangle = { stroke_m = 5e-3, speed_m_per_s = 0.02, cycles = 2 }\n\
    [[test]]\nname = \"last\"\nduration_s = 2.0\n\
    sine = { amplitude_m = 1e-3, frequency_hz = 5.0 }\n";

/// A folder that goes when the test ends.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let name = format!("yawbench-virtual-bench-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// A visit of three tests with a thermometer.
    pub(crate) fn visit(&self) -> Visit {
        let list = TestList::load(&self.write("list.toml", LIST)).unwrap();
        Visit::of_model(&self.write("damper 7.toml", MODEL), list, 1).unwrap()
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
