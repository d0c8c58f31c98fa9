//! Files that use each other, directly or through others.

use std::collections::{BTreeMap, BTreeSet};

/// One line for each circle that is not listed as benign, and for each listed one that is gone.
pub(super) fn circles(
    edges: &BTreeMap<(String, String), String>,
    benign: &[(&[&str], &str)],
) -> Vec<String> {
    let files: BTreeSet<&str> = edges.keys().flat_map(|(from, to)| [&**from, &**to]).collect();
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        files.iter().map(|file| (*file, reached_from(file, edges))).collect();
    let mut found: Vec<BTreeSet<&str>> = Vec::new();
    for file in &files {
        let mutual =
            |other: &&&str| reached[file].contains(**other) && reached[**other].contains(file);
        let circle: BTreeSet<&str> = files.iter().filter(mutual).copied().collect();
        if circle.len() > 1 && !found.contains(&circle) {
            found.push(circle);
        }
    }
    let listed = |circle: &BTreeSet<&str>| {
        benign.iter().any(|(files, _)| files.iter().copied().collect::<BTreeSet<_>>() == *circle)
    };
    let mut wrong: Vec<String> =
        found.iter().filter(|circle| !listed(circle)).map(|circle| shown(circle, edges)).collect();
    for (files, _) in benign {
        if !found.contains(&files.iter().copied().collect()) {
            wrong.push(format!("{}: no circle any more, strike it off the list", files.join(", ")));
        }
    }
    wrong
}

fn reached_from<'a>(
    file: &str,
    edges: &'a BTreeMap<(String, String), String>,
) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![file];
    while let Some(next) = open.pop() {
        for (_, to) in edges.keys().filter(|(from, _)| from == next) {
            if reached.insert(&**to) {
                open.push(to);
            }
        }
    }
    reached
}

fn shown(circle: &BTreeSet<&str>, edges: &BTreeMap<(String, String), String>) -> String {
    let inside = |ends: &&(String, String)| circle.contains(&*ends.0) && circle.contains(&*ends.1);
    let mut lines = vec![format!("circle of {} files:", circle.len())];
    for ends in edges.keys().filter(inside) {
        lines.push(format!("    {} -> {} ({})", ends.0, ends.1, edges[ends]));
    }
    lines.join("\n")
}
