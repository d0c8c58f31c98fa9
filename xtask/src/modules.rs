//! Kernel modules in the order in which they can be inserted.
//!
//! An unpacked kernel package has no dependency list yet (its installation would write one), but
//! every module names what it needs in its own `depends=` field.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::stream::quiet;

/// The files of the wanted modules and of all they need; one that others need comes before them.
///
/// # Errors
///
/// One line: the tree cannot be read, or has no such module and does not have it built in.
pub(crate) fn insertion_order(tree: &Path, wanted: &[&str]) -> Result<Vec<PathBuf>, String> {
    let mut files = BTreeMap::new();
    let mut built_in = String::new();
    collect(tree, &mut files, &mut built_in).map_err(|e| format!("{}: {e}", tree.display()))?;
    let mut order = Vec::new();
    for name in wanted {
        insert(&key(name), &files, &built_in, &mut order)?;
    }
    Ok(order)
}

fn insert(
    name: &str,
    files: &BTreeMap<String, PathBuf>,
    built_in: &str,
    order: &mut Vec<PathBuf>,
) -> Result<(), String> {
    let Some(file) = files.get(name) else {
        let is_built_in = built_in.lines().any(|line| key(stem(Path::new(line))) == name);
        return if is_built_in { Ok(()) } else { Err(format!("the kernel has no module {name}")) };
    };
    let file = uncompressed(file)?;
    if order.contains(&file) {
        return Ok(());
    }
    let bytes = fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    for needed in needed(&bytes) {
        insert(&needed, files, built_in, order)?;
    }
    order.push(file);
    Ok(())
}

/// What a module needs, from the field that the build writes into it.
fn needed(module: &[u8]) -> Vec<String> {
    let field = b"\0depends=";
    let Some(start) = module.windows(field.len()).position(|window| window == field) else {
        return Vec::new();
    };
    let value = module.iter().skip(start + field.len()).take_while(|byte| **byte != 0);
    let value: Vec<u8> = value.copied().collect();
    let names = String::from_utf8_lossy(&value);
    names.split(',').filter(|name| !name.is_empty()).map(key).collect()
}

fn uncompressed(file: &Path) -> Result<PathBuf, String> {
    if file.extension().is_some_and(|extension| extension == "xz") {
        let plain = file.with_extension("");
        if !plain.exists() {
            quiet(Command::new("xz").arg("-dk").arg(file))?;
        }
        return Ok(plain);
    }
    Ok(file.to_path_buf())
}

fn collect(
    folder: &Path,
    files: &mut BTreeMap<String, PathBuf>,
    built_in: &mut String,
) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_dir() {
            collect(&path, files, built_in)?;
        } else if entry.file_name() == "modules.builtin" {
            built_in.push_str(&fs::read_to_string(&path)?);
        } else if entry.file_name().to_string_lossy().contains(".ko") {
            files.insert(key(stem(&path)), path);
        }
    }
    Ok(())
}

/// `can-raw.ko.xz` is `can-raw`.
fn stem(path: &Path) -> &str {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or("");
    name.split_once(".ko").map_or(name, |(stem, _)| stem)
}

/// The kernel takes `-` and `_` in names for the same.
fn key(name: &str) -> String {
    name.replace('-', "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_module_needs_comes_first_and_once() {
        let tree = std::env::temp_dir().join(format!("modules-{}", std::process::id()));
        fs::create_dir_all(tree.join("net")).unwrap();
        fs::write(tree.join("net/can.ko"), b"\x7fELF\0license=GPL\0depends=\0").unwrap();
        fs::write(tree.join("can-dev.ko"), b"\0depends=crc32\0").unwrap();
        fs::write(tree.join("net/vcan.ko"), b"\0depends=can-dev,can\0name=vcan\0").unwrap();
        fs::write(tree.join("modules.builtin"), "kernel/lib/crc32.ko\n").unwrap();
        let order = insertion_order(&tree, &["can", "vcan"]);
        let lacking = insertion_order(&tree, &["can-raw"]);
        fs::remove_dir_all(&tree).unwrap();
        let names: Vec<_> = order.unwrap().iter().map(|path| stem(path).to_owned()).collect();
        assert_eq!(names, ["can", "can-dev", "vcan"]);
        assert_eq!(lacking.unwrap_err(), "the kernel has no module can_raw");
    }
}
