//! README.md, ARCHITECTURE.md and all pages name only paths that exist, and ARCHITECTURE.md names
//! every top-level module of every crate: a stale map misleads more than none.

use std::path::Path;

/// Endings of files that are kept in the repository; what a run writes has others or is a
/// placeholder in capitals.
const KEPT: [&str; 7] = [".rs", ".toml", ".md", ".dbc", ".csv", ".py", ".lock"];
/// Folders that are made, not kept.
const MADE: [&str; 2] = ["target", "runs"];
/// Files that a command writes and the documentation names without a folder.
const WRITTEN: [&str; 8] = [
    "calibration.toml",
    "model.toml",
    "model-empirical.toml",
    "scenario.toml",
    "vehicle.toml",
    "service.csv",
    "sine.csv",
    "sine.toml",
];

/// Whether a file is a page for people.
fn is_page(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|ending| ending == "md")
}

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
    let capitals = |part: &str| {
        let stem = part.split('.').next().unwrap_or_default();
        !stem.is_empty() && stem.chars().all(|c| c.is_ascii_uppercase())
    };
    // README.md and the like are pages, everything else in capitals is a placeholder.
    let placeholder = !is_page(name) && path.split('/').any(capitals);
    if path.is_empty() || MADE.contains(&first) || WRITTEN.contains(&path) || placeholder {
        return None;
    }
    let in_a_folder = path.contains('/') && Path::new(first).is_dir();
    let kept = KEPT.iter().any(|ending| name.ends_with(ending));
    (word.ends_with('/') || in_a_folder || kept).then_some(path)
}

fn read(file: &str) -> String {
    std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Folders of the workspace's crates, that of the command line as an empty name.
fn crates() -> Vec<String> {
    let text = read("Cargo.toml");
    let workspace: toml::Table = text.parse().expect("a manifest in TOML");
    let members = workspace["workspace"]["members"].as_array().expect("a list of members");
    let members = members.iter().map(|member| member.as_str().expect("a folder").to_owned());
    members.chain(["firmware".to_owned(), String::new()]).collect()
}

/// Paths of the top-level modules of a crate, without an ending. Modules of tests are left out.
fn top_level_modules(folder: &str) -> Vec<String> {
    let source = Path::new(folder).join("src");
    let entries = std::fs::read_dir(&source).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut modules: Vec<String> = Vec::new();
    for entry in entries {
        let path = entry.expect("an entry").path();
        let is_module = match path.extension() {
            Some(ending) => ending == "rs",
            None => path.join("mod.rs").exists() || path.with_extension("rs").exists(),
        };
        let module = path.with_extension("").to_str().expect("a name in UTF-8").to_owned();
        let name = module.rsplit('/').next().expect("a name");
        let root_or_test = matches!(name, "lib" | "main" | "tests") || name.ends_with("_tests");
        if is_module && !root_or_test {
            modules.push(module);
        }
    }
    modules.sort();
    modules.dedup();
    modules
}

/// Whether a path names a module or something in it.
fn names(path: &str, module: &str) -> bool {
    path.strip_prefix(module)
        .is_some_and(|rest| matches!(rest, "" | ".rs") || rest.starts_with('/'))
}

#[test]
fn the_architecture_names_every_top_level_module() {
    let text = read("ARCHITECTURE.md");
    let paths: Vec<&str> = quoted_words(&text).filter_map(as_path).collect();
    let modules: Vec<String> =
        crates().iter().flat_map(|folder| top_level_modules(folder)).collect();
    assert!(modules.len() > 50, "{} modules: is this test blind?", modules.len());
    let missing: Vec<_> =
        modules.iter().filter(|module| !paths.iter().any(|path| names(path, module))).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md does not name {missing:?}");
}

#[test]
fn a_path_names_its_module_and_no_other() {
    assert!(names("files/src/folder.rs", "files/src/folder"));
    assert!(names("files/src/folder", "files/src/folder"));
    assert!(names("files/src/folder/tests.rs", "files/src/folder"));
    assert!(!names("files/src/folders.rs", "files/src/folder"));
    assert!(!names("files/src", "files/src/folder"));
}

/// The pages for people: those at the root and those in `docs/`.
fn pages() -> Vec<String> {
    let files = ["", "docs/"].into_iter().flat_map(|folder| {
        let entries = std::fs::read_dir(Path::new(".").join(folder)).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        names.map(move |name| format!("{folder}{}", name.to_str().expect("a name in UTF-8")))
    });
    let mut pages: Vec<String> = files.filter(|file| is_page(file)).collect();
    pages.sort();
    pages
}

#[test]
fn every_path_of_every_page_exists() {
    let mut paths = 0;
    for page in pages() {
        let text = read(&page);
        let named: Vec<&str> = quoted_words(&text).filter_map(as_path).collect();
        let gone: Vec<_> = named.iter().filter(|path| !Path::new(path).exists()).collect();
        assert!(gone.is_empty(), "{page} names paths that do not exist: {gone:?}");
        paths += named.len();
    }
    assert!(paths > 100, "{paths} paths: is this test blind?");
}

#[test]
fn every_link_of_every_page_leads_to_a_file() {
    let mut links = 0;
    for page in pages() {
        let text = read(&page);
        let folder = Path::new(&page).parent().expect("a folder");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") {
                continue;
            }
            let file = link.split('#').next().unwrap_or_default();
            assert!(folder.join(file).exists(), "{page} links to {link}, which does not exist");
            links += 1;
        }
    }
    assert!(links > 20, "{links} links: is this test blind?");
}

#[test]
fn pages_wrap_at_100_columns() {
    for page in pages() {
        let text = read(&page);
        let parts = text.split("```").step_by(2);
        let long: Vec<&str> = parts
            .flat_map(str::lines)
            .filter(|line| line.chars().count() > 100 && !line.starts_with('|'))
            .filter(|line| !line.contains("://"))
            .collect();
        assert!(long.is_empty(), "{page} has long lines: {long:?}");
    }
}

#[test]
fn paths_are_distinguished_from_units_programs_and_what_a_run_writes() {
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
