//! The layout of the workspace: a crate uses only crates of lower layers, and no files of a crate
//! use each other in a circle.
//!
//! An edge from file to file is a `use` or an inline path, resolved through re-exports to the file
//! that defines the item. Edges between a module and the modules below it do not count, and neither
//! does test code. [`modules`] reads the sources, [`edges`] resolves the paths, [`circles`] finds
//! the circles.

mod circles;
mod edges;
mod examples;
mod modules;

use modules::{Crate, Tree};
use std::path::Path;

/// The layers, lowest first; the crates of one group do not know each other.
const LAYERS: [&[&str]; 10] = [
    &["can-protocol", "firmware-core"],
    &["nodes"],
    &["files"],
    &["dbc", "report", "signal"],
    &["scenario"],
    &["measurement", "rig-emulator"],
    &["virtual-bench", "identification", "vehicle-studies", "rths", "hil-host"],
    &["evidence"],
    &["yawbench"],
    &["firmware", "fuzz", "xtask"],
];

/// What test code uses of its own layer: crate, what it uses, why.
const TESTS_MAY_USE: [(&str, &str, &str); 1] =
    [("identification", "virtual-bench", "records for the tests of the identification")];

/// Circles that may stay: their files and the reason. Never more than two.
const BENIGN: &[(&[&str], &str)] = &[(
    &["report/src/document.rs", "report/src/page.rs"],
    "a document renders itself, and a page is made of its blocks",
)];

/// The position of a crate in the layers.
fn layer(name: &str) -> Option<usize> {
    LAYERS.iter().position(|group| group.contains(&name))
}

/// True where a crate may use another one.
fn may_use(user: &str, used: &str) -> bool {
    match (layer(user), layer(used)) {
        (Some(above), Some(below)) => above > below,
        _ => false,
    }
}

/// Dependencies that run up, or between crates of one group.
fn wrong_dependencies(tree: &Tree) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, about) in &tree.crates {
        if layer(name).is_none() {
            wrong.push(format!("{name}: is in no layer"));
        }
        let ours = |used: &&String| tree.crates.contains_key(*used) && *used != name;
        for used in about.dependencies.iter().filter(ours) {
            if !may_use(name, used) {
                wrong.push(format!("{}: {name} depends on {used}", about.manifest));
            }
        }
        for used in about.dev_dependencies.iter().filter(ours) {
            let listed = TESTS_MAY_USE.iter().any(|may| (may.0, may.1) == (name, used));
            if !may_use(name, used) && !listed {
                wrong.push(format!("{}: tests of {name} depend on {used}", about.manifest));
            }
        }
    }
    wrong
}

/// Everything that is wrong with a tree, one line each.
fn violations(tree: &Tree, benign: &[(&[&str], &str)]) -> Vec<String> {
    let mut wrong = wrong_dependencies(tree);
    let edges = edges::edges(tree);
    for edge in &edges.between_crates {
        if !may_use(&edge.from, &edge.to) {
            wrong.push(format!("{}: {} uses {} ({})", edge.place, edge.from, edge.to, edge.path));
        }
    }
    wrong.extend(edges.unresolved.iter().cloned());
    wrong.extend(circles::circles(&edges.between_files, benign));
    wrong
}

#[test]
fn no_arrow_runs_up_and_no_files_use_each_other_in_a_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tree = Tree::read(root);
    assert!(tree.crates.len() >= 15, "found only {:?}: is this test blind?", tree.crates.keys());
    assert!(BENIGN.len() <= 2, "more than two circles are listed as benign");
    let wrong = violations(&tree, BENIGN);
    assert!(wrong.is_empty(), "{} faults of the layout:\n{}", wrong.len(), wrong.join("\n"));
}

/// A crate for an example.
fn example_crate(name: &str, dependencies: &[&str]) -> (String, Crate) {
    let dependencies = dependencies.iter().map(|used| (*used).to_owned()).collect();
    let manifest = format!("{name}/Cargo.toml");
    (name.to_owned(), Crate { manifest, dependencies, dev_dependencies: Vec::new() })
}
