//! Every path that ARCHITECTURE.md and README.md name is there: a map that has gone stale
//! misleads more than none.

use std::path::Path;

/// Endings of files that are kept in the repository; what a run writes has others or is a
/// placeholder in capitals.
const KEPT: [&str; 7] = [".rs", ".toml", ".md", ".dbc", ".csv", ".py", ".lock"];
/// Folders that are made, not kept.
const MADE: [&str; 2] = ["target", "runs"];

/// The words of a text that are set in back quotes or stand in a fenced block.
fn quoted_words(text: &str) -> impl Iterator<Item = &str> {
    let parts = text.split("```").enumerate().flat_map(|(at, part)| {
        let fenced = at % 2 == 1;
        let spans = part.split('`').enumerate();
        spans.filter(move |(at, _)| fenced || at % 2 == 1).map(|(_, span)| span)
    });
    parts.flat_map(str::split_whitespace)
}

/// A word that can only mean a file or folder of this repository, without its last slash.
fn as_path(word: &str) -> Option<&str> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    if word.starts_with(['/', '-']) || !word.chars().all(plain) {
        return None;
    }
    let path = word.trim_start_matches("./").trim_end_matches('/');
    let first = path.split('/').next()?;
    let name = path.rsplit('/').next()?;
    let placeholder = name.strip_suffix(".toml").or(name.strip_suffix(".csv"));
    let placeholder = placeholder.is_some_and(|stem| stem == stem.to_uppercase());
    if path.is_empty() || MADE.contains(&first) || placeholder {
        return None;
    }
    let in_a_folder = path.contains('/') && Path::new(first).is_dir();
    let kept = KEPT.iter().any(|ending| name.ends_with(ending));
    (word.ends_with('/') || in_a_folder || kept).then_some(path)
}

fn assert_every_path_exists(file: &str) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let paths: Vec<&str> = quoted_words(&text).filter_map(as_path).collect();
    assert!(!paths.is_empty(), "{file} names no path: is this test blind?");
    let gone: Vec<_> = paths.iter().filter(|path| !Path::new(path).exists()).collect();
    assert!(gone.is_empty(), "{file} names what is not there: {gone:?}");
}

#[test]
fn every_path_of_the_architecture_exists() {
    assert_every_path_exists("ARCHITECTURE.md");
}

#[test]
fn every_path_of_the_readme_exists() {
    assert_every_path_exists("README.md");
}

#[test]
fn paths_are_told_from_units_programs_and_what_a_run_writes() {
    let text =
        "Folder `firmware-core/src/`, not firmware-core/none, `Y/Q` in `N/m`, `./Cargo.toml`.
        ```sh
        cargo run --release -- run scenarios/none.toml --out runs/a target/x `y.md`
        ```
        `rig RIG.toml`, `summary.json`, `/dev/null`, `can_dbc::Dbc`, `no-such-folder/`";
    let paths: Vec<_> = quoted_words(text).filter_map(as_path).collect();
    let expected =
        ["firmware-core/src", "Cargo.toml", "scenarios/none.toml", "y.md", "no-such-folder"];
    assert_eq!(paths, expected);
}
