// Shared by the build scripts of the crates that compute answers: a hash over the sources of those
// crates. It is part of the identity of an answer, so that an answer of another program is never
// mistaken for one of this program.

use std::path::{Path, PathBuf};

#[expect(unreachable_pub, reason = "public where it is a module of a library")]
#[path = "../../firmware-core/src/fnv.rs"]
mod fnv;

/// Sets `variable` for the crate that is built to the hash over every file below the given folders,
/// which are relative to the crate's own. Files count in the order of their paths relative to
/// their folder, each with its path and its content.
fn export_hash(variable: &str, folders: &[&str]) {
    let mut hash = fnv::START;
    for folder in folders {
        println!("cargo:rerun-if-changed={folder}");
        let mut files = Vec::new();
        collect(Path::new(folder), &mut files);
        files.sort_unstable();
        assert!(!files.is_empty(), "{folder}: found no file, expected the sources of a crate");
        for file in files {
            let content =
                std::fs::read(&file).unwrap_or_else(|why| panic!("{}: {why}", file.display()));
            let name = file.to_string_lossy();
            for part in [name.as_bytes(), &content] {
                hash = fnv::add(hash, part.len() as u64);
                hash = part.iter().fold(hash, |hash, byte| fnv::add(hash, u64::from(*byte)));
            }
        }
    }
    println!("cargo:rustc-env={variable}={hash:016x}");
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries =
        std::fs::read_dir(folder).unwrap_or_else(|why| panic!("{}: {why}", folder.display()));
    for entry in entries {
        let entry = entry.unwrap_or_else(|why| panic!("{}: {why}", folder.display()));
        if entry.path().is_dir() {
            collect(&entry.path(), files);
        } else {
            files.push(entry.path());
        }
    }
}
