//! Who uses whom: paths resolved to the file that defines the item.

use super::modules::{ModulePath, Reference, Tree, identifier};
use std::collections::BTreeMap;

/// What uses what.
#[derive(Debug, Default)]
pub(super) struct Edges {
    /// Paths that name another crate of the workspace.
    pub(super) between_crates: Vec<CrateEdge>,
    /// File and file of one crate, with the first path that makes the edge.
    pub(super) between_files: BTreeMap<(String, String), String>,
    /// Imports that hide what they use.
    pub(super) unresolved: Vec<String>,
}

/// A path that names another crate.
#[derive(Debug)]
pub(super) struct CrateEdge {
    pub(super) from: String,
    pub(super) to: String,
    pub(super) place: String,
    pub(super) path: String,
}

/// What a path leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Target {
    Module(ModulePath),
    /// An item, by the module that defines it.
    Item(ModulePath),
}

/// Re-exports of re-exports of one item, at most.
const DEEPEST: usize = 20;

/// All edges of a tree, without test code.
pub(super) fn edges(tree: &Tree) -> Edges {
    let mut edges = Edges::default();
    for (path, module) in tree.modules.iter().filter(|(path, _)| !tree.is_test(path)) {
        for glob in &module.globs {
            let target = resolve(tree, path, &glob.path, DEEPEST);
            if let Some(Target::Module(target)) = target
                && target[0] == path[0]
                && !target.starts_with(path)
            {
                let (file, line, what) = (&module.file, glob.line, glob.path.join("::"));
                let said = format!("{file}:{line}: {what}::*, expected the names that are used");
                edges.unresolved.push(said);
            }
        }
        for reference in module.references.iter().chain(&module.globs) {
            add_crate_edge(tree, path, &module.file, reference, &mut edges);
            let Some(Target::Item(target)) = resolve(tree, path, &reference.path, DEEPEST) else {
                continue;
            };
            let related = target.starts_with(path) || path.starts_with(&target);
            let Some(defining) = tree.modules.get(&target) else { continue };
            if target[0] == path[0] && !related && defining.file != module.file {
                let between = (module.file.clone(), defining.file.clone());
                let place = format!("line {}: {}", reference.line, reference.path.join("::"));
                edges.between_files.entry(between).or_insert(place);
            }
        }
    }
    edges
}

fn add_crate_edge(
    tree: &Tree,
    path: &[String],
    file: &str,
    reference: &Reference,
    edges: &mut Edges,
) {
    let first = &reference.path[0];
    let module = &tree.modules[path];
    let is_own = is_module(tree, path, first) || module.items.contains(first);
    let used = tree.crates.keys().find(|name| identifier(name) == *first);
    let user = tree.crates.keys().find(|name| identifier(name) == path[0]);
    if let (Some(to), Some(from)) = (used, user)
        && to != from
        && !is_own
    {
        edges.between_crates.push(CrateEdge {
            from: from.clone(),
            to: to.clone(),
            place: format!("{file}:{}", reference.line),
            path: reference.path.join("::"),
        });
    }
}

/// Follows a path that is written in a module.
fn resolve(tree: &Tree, from: &[String], path: &[String], depth: usize) -> Option<Target> {
    let depth = depth.checked_sub(1)?;
    let mut at = from.to_vec();
    let mut rest = path;
    let mut target = loop {
        let (first, later) = rest.split_first()?;
        rest = later;
        match first.as_str() {
            "crate" => break Target::Module(vec![from[0].clone()]),
            "self" => break Target::Module(at),
            "super" => {
                at.pop();
                if rest.first().is_none_or(|next| next != "super") {
                    break Target::Module(at);
                }
            }
            name => break name_in_scope(tree, &at, name, path, depth)?,
        }
    };
    for name in rest {
        match target {
            Target::Module(module) => target = member(tree, &module, name, depth)?,
            // A variant or an associated item.
            Target::Item(_) => break,
        }
    }
    Some(target)
}

/// The first name of a path: one of the module's own, or a crate.
fn name_in_scope(
    tree: &Tree,
    from: &[String],
    name: &str,
    path: &[String],
    depth: usize,
) -> Option<Target> {
    let module = tree.modules.get(from)?;
    if is_module(tree, from, name) || module.items.contains(name) {
        return member(tree, from, name, depth);
    }
    match module.imports.get(name) {
        // `use name::item as name` names a crate, not itself.
        Some(import) if import[0] != name && import != path => resolve(tree, from, import, depth),
        _ => {
            let root = vec![name.to_owned()];
            tree.modules.contains_key(&root).then_some(Target::Module(root))
        }
    }
}

/// A name in a module, followed through re-exports.
fn member(tree: &Tree, of: &[String], name: &str, depth: usize) -> Option<Target> {
    let depth = depth.checked_sub(1)?;
    let below = [of, &[name.to_owned()]].concat();
    let module = tree.modules.get(of)?;
    // A type or function may have the name of a module; items come first in what is imported.
    if module.items.contains(name) {
        return Some(Target::Item(of.to_vec()));
    }
    if tree.modules.contains_key(&below) {
        return Some(Target::Module(below));
    }
    if let Some(import) = module.imports.get(name) {
        return resolve(tree, of, import, depth);
    }
    let through_glob = module.globs.iter().find_map(|glob| {
        let Some(Target::Module(target)) = resolve(tree, of, &glob.path, depth) else {
            return None;
        };
        let known = tree.modules.get(&target)?;
        let has = known.items.contains(name) || known.imports.contains_key(name);
        has.then(|| member(tree, &target, name, depth)).flatten()
    });
    // What nothing here defines is made by a macro of this module.
    Some(through_glob.unwrap_or_else(|| Target::Item(of.to_vec())))
}

fn is_module(tree: &Tree, of: &[String], name: &str) -> bool {
    tree.modules.contains_key(&[of, &[name.to_owned()]].concat())
}
