//! Every input of the corpora: what fuzzing found worth keeping, and what once broke a target.

use fuzz::TARGETS;
use std::path::{Path, PathBuf};

fn inputs(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|why| panic!("{target}: {why}"));
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort();
    files
}

#[test]
fn every_input_of_the_corpora_is_survived() {
    for target in &TARGETS {
        let files = inputs(target.name);
        assert!(files.len() >= 10, "{}: a corpus of {} inputs", target.name, files.len());
        for file in files {
            let bytes =
                std::fs::read(&file).unwrap_or_else(|why| panic!("{}: {why}", file.display()));
            let survived = std::panic::catch_unwind(|| (target.run)(&bytes));
            assert!(survived.is_ok(), "{} breaks on {}", target.name, file.display());
        }
    }
}
