//! The Cortex-M7 images of `firmware/`: linked, so that a way to panic or a heap would show.
//!
//! The panic handler of the image calls a function that does not exist, so the image links only
//! where the optimiser has proved every panic away. Two more checks keep that honest: the names in
//! the image are searched, and the same image with a deliberate panic must not link.

use std::path::Path;
use std::process::Command;

use crate::run::{Outcome, Run};
use crate::stream::shown;

/// The images; the first one calls everything.
const IMAGES: [&str; 4] = ["proof", "measure", "locomotive", "rig"];
/// The function that the panic handler calls; it is defined nowhere.
const MISSING: &str = "there_is_a_way_to_panic";
/// Parts of mangled names that only panics and heaps bring; the first is `core::panicking`.
const FORBIDDEN: [&str; 4] = ["9panicking", "panic_fmt", "panic_bounds_check", "__rust_alloc"];
/// A part of a name that the image must have: proof that names are there to be searched.
const EXPECTED: &str = "firmware_core";

/// Links the image and checks it; `prepare` adds target and compiler to a cargo command.
pub(crate) fn check(run: &mut Run, target: &str, prepare: impl Fn(&mut Command)) -> Outcome {
    let folder = run.target.join("firmware");
    let build = |run: &Run| {
        let mut cargo = run.cargo();
        cargo.current_dir(run.root.join("firmware")).args(["build", "--release", "--locked"]);
        prepare(cargo.arg("--target-dir").arg(&folder));
        cargo
    };
    match run.checked(&mut build(run)) {
        Outcome::Passed => {}
        Outcome::Failed(reason) => {
            let hint = format!("{reason}; for {MISSING}, firmware/README.md says how to find it");
            return Outcome::Failed(hint);
        }
        skipped @ Outcome::Skipped(_) => return skipped,
    }
    for image in IMAGES {
        if let Err(reason) = inspect(&folder.join(target).join("release").join(image)) {
            return Outcome::Failed(reason);
        }
    }
    let mut trapped = build(run);
    trapped.args(["--bin", "proof", "--features", "panic-path"]);
    match trapped.output() {
        Ok(output) if output.status.success() => {
            Outcome::Failed(format!("{} links in spite of its panic", shown(&trapped)))
        }
        Ok(output) if String::from_utf8_lossy(&output.stderr).contains(MISSING) => {
            println!("with a deliberate panic it does not link, as it must");
            Outcome::Passed
        }
        Ok(output) => {
            eprintln!("{}", String::from_utf8_lossy(&output.stderr));
            Outcome::Failed(format!("{}: fails, but not for its panic", shown(&trapped)))
        }
        Err(error) => Outcome::Failed(format!("{}: {error}", shown(&trapped))),
    }
}

fn inspect(image: &Path) -> Result<(), String> {
    let shown = image.display();
    let bytes = std::fs::read(image).map_err(|error| format!("{shown}: {error}"))?;
    if !contains(&bytes, EXPECTED) {
        return Err(format!("{shown}: has no names to search"));
    }
    if let Some(name) = FORBIDDEN.into_iter().find(|name| contains(&bytes, name)) {
        return Err(format!("{shown}: has a symbol with {name} in its name"));
    }
    let code = code_bytes(&bytes).ok_or_else(|| format!("{shown}: no 32-bit ELF file"))?;
    println!("{shown}: {:.1} kB of code, no panic, no heap", f64::from(code) / 1e3);
    Ok(())
}

fn contains(bytes: &[u8], name: &str) -> bool {
    bytes.windows(name.len()).any(|window| window == name.as_bytes())
}

/// The flag of a section that holds code.
const EXECUTABLE: u32 = 4;

/// Bytes in the executable sections of a little-endian 32-bit ELF file.
fn code_bytes(elf: &[u8]) -> Option<u32> {
    let short = |at: usize| Some(u16::from_le_bytes(elf.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(elf.get(at..at + 4)?.try_into().ok()?));
    if !elf.starts_with(b"\x7fELF\x01\x01") {
        return None;
    }
    let (table, size, count) = (word(32)? as usize, short(46)?, short(48)?);
    let mut code = 0;
    for number in 0..count {
        let section = table + usize::from(number) * usize::from(size);
        if word(section + 8)? & EXECUTABLE != 0 {
            code += word(section + 20)?;
        }
    }
    Some(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_found_by_its_mangled_name() {
        let image = b"\x00_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE\x00";
        assert!(contains(image, FORBIDDEN[0]) && contains(image, FORBIDDEN[2]));
        assert!(!contains(b"\x00_ZN13firmware_core4line4Line4stepE\x00", FORBIDDEN[0]));
    }

    #[test]
    fn executable_sections_are_added_up() {
        let mut elf = vec![0; 52 + 3 * 40];
        elf[..6].copy_from_slice(b"\x7fELF\x01\x01");
        elf[32] = 52;
        elf[46] = 40;
        elf[48] = 3;
        for (section, flags, size) in [(0, 6, 100), (1, 2, 50), (2, 6, 11)] {
            elf[52 + 40 * section + 8] = flags;
            elf[52 + 40 * section + 20] = size;
        }
        assert_eq!(code_bytes(&elf), Some(111));
        assert_eq!(code_bytes(&elf[..80]), None);
        assert_eq!(code_bytes(b"#!/bin/sh"), None);
    }
}
