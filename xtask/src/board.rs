//! The Cortex-M7 image, run in QEMU: the host's hashes, and what a step costs.
//!
//! `qemu-system-arm` emulates an MPS2 board with a Cortex-M7 (`mps2-an500`). With
//! `-icount shift=0` its time is the number of instructions, so that what is measured does not
//! depend on this machine. The image `measure` judges its own hash against the one that the host
//! found when it built the image; here the lines that it prints are read.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::debian;
use crate::operations;
use crate::run::{Outcome, Run};
use crate::stream::{Ended, lines};

/// How long the locomotive runs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Length {
    /// 1,000 steps.
    Short,
    /// 10,000 steps.
    Full,
}

/// Instructions in a tick of the board's timer: 25 MHz, and an instruction is 1 ns.
const INSTRUCTIONS_PER_TICK: u32 = 40;

/// Longest run of one image.
const LIMIT: Duration = Duration::from_secs(300);

/// Rise over a committed count that fails, %.
const RISE_PERCENT: f64 = 3.0;

/// RAM of an image at most: statics and the deepest stack, the set-up's or a step's, bytes.
pub(crate) const RAM_MAX: u32 = 256_000;

/// Runs everything that the image can run.
pub(crate) fn test(run: &mut Run, target: &str, length: Length) -> Outcome {
    let qemu = match debian::ensure("qemu-system-arm", &["qemu-system-arm"]) {
        Ok(qemu) => qemu,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_QEMU_ARM", reason),
    };
    let image = run.target.join("firmware").join(target).join("release/measure");
    let board = Board { qemu, image };
    let runs = match board.said(&["list"]) {
        Ok(lines) => lines,
        Err(reason) => return Outcome::Failed(reason),
    };
    let committed = run.root.join("firmware/counts.toml");
    let mut all = Outcome::Passed;
    let mut same = 0;
    for words in runs.iter().map(|line| line.split_whitespace().collect::<Vec<_>>()) {
        let [group, name, steps] = words.as_slice() else { continue };
        if *group == "creep" && (*steps == "1000") == (length == Length::Full) {
            continue;
        }
        match board.said(&words) {
            Ok(lines) if *group == "creep" => {
                all = all.and(judged(run, &board.image, &committed, name, &lines));
                same += 1;
            }
            Ok(_) => same += 1,
            Err(reason) => all = all.and(Outcome::Failed(reason)),
        }
    }
    run.note(format!("Cortex-M7 in QEMU: {same} runs have the host's bits"));
    all
}

/// Steps of the two runs whose difference is counted.
const FEW_AND_MANY: [u64; 2] = [100, 110];

/// Prints the kinds of instructions of a step with each law.
pub(crate) fn table(run: &mut Run, target: &str) -> Outcome {
    let qemu = match debian::ensure("qemu-system-arm", &["qemu-system-arm"]) {
        Ok(qemu) => qemu,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_QEMU_ARM", reason),
    };
    let image = run.target.join("firmware").join(target).join("release/measure");
    let board = Board { qemu, image };
    let log = run.target.join("firmware/blocks.log");
    println!("| law | kind | in a step | cycles |\n| --- | --- | --- | --- |");
    for law in ["linear_saturated", "polach", "fastsim"] {
        let [few, many] = FEW_AND_MANY.map(|steps| {
            let steps = steps.to_string();
            // The host has no hash of so few steps, so the image says that they differ.
            let _ended = board.ended(&["creep", law, &steps], Some(&log), |_| {});
            operations::count(&log)
        });
        let (few, many) = match (few, many) {
            (Ok(few), Ok(many)) => (few, many),
            (Err(reason), _) | (_, Err(reason)) => return Outcome::Failed(reason),
        };
        let steps = FEW_AND_MANY[1] - FEW_AND_MANY[0];
        for row in operations::rows(law, steps, &few, &many) {
            println!("{row}");
        }
    }
    let removed = std::fs::remove_file(&log);
    removed.map_or_else(|why| Outcome::Failed(why.to_string()), |()| Outcome::Passed)
}

/// An emulated board with an image.
pub(crate) struct Board {
    /// The emulator.
    pub(crate) qemu: PathBuf,
    /// What it runs.
    pub(crate) image: PathBuf,
}

impl Board {
    /// The lines that the image prints for some words; it fails where its hash differs.
    fn said(&self, words: &[&str]) -> Result<Vec<String>, String> {
        let mut said = Vec::new();
        match self.ended(words, None, |line| said.push(line.to_owned())) {
            Ok(Ended::Status(0)) => Ok(said),
            Ok(ended) => {
                let last = said.last().map_or("it said nothing", String::as_str);
                Err(format!("{} on the board: {ended}: {last}", words.join(" ")))
            }
            Err(error) => Err(format!("{}: {error}", self.qemu.display())),
        }
    }

    /// The emulator with the image and some words on its command line; its time and what is on its
    /// UART are still to be given.
    pub(crate) fn command(&self, words: &[&str]) -> Command {
        let mut qemu = Command::new(&self.qemu);
        let arguments = words.iter().fold(String::new(), |all, word| all + ",arg=" + word);
        qemu.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"])
            .args(["-chardev", "stdio,id=console", "-semihosting-config"])
            .arg(format!("enable=on,target=native,chardev=console{arguments}"))
            .arg("-kernel")
            .arg(&self.image);
        qemu
    }

    /// Runs the image with some words on its command line; every block that runs goes into `log`.
    fn ended(
        &self,
        words: &[&str],
        log: Option<&Path>,
        mut see: impl FnMut(&str),
    ) -> std::io::Result<Ended> {
        let mut qemu = self.command(words);
        qemu.args(["-icount", "shift=0", "-serial", "none"]);
        if let Some(log) = log {
            qemu.args(["-d", "in_asm,exec,nochain", "-D"]).arg(log);
        }
        lines(&mut qemu, Some(LIMIT), |line, is_stderr| {
            if is_stderr {
                eprintln!("{line}");
            }
            see(line);
        })
    }
}

/// What the locomotive costs with a law, against the committed counts.
fn judged(run: &mut Run, image: &Path, committed: &Path, law: &str, lines: &[String]) -> Outcome {
    let number = |start: &str| -> Vec<u32> {
        let values = lines.iter().filter_map(|line| line.strip_prefix(start)?.trim().parse().ok());
        values.collect()
    };
    let mut counts = number("ticks ");
    for ticks in &mut counts {
        *ticks *= INSTRUCTIONS_PER_TICK;
    }
    counts.sort_unstable();
    let share = |percent: usize| counts.get((counts.len() * percent / 100).min(counts.len() - 1));
    let (Some(&median), Some(&p99), Some(&worst)) = (share(50), share(99), counts.last()) else {
        return Outcome::Failed(format!("{law}: the board counted no step"));
    };
    let (Some(setup), Some(stack)) =
        (number("stack setup ").first().copied(), number("stack steps ").first().copied())
    else {
        return Outcome::Failed(format!("{law}: the board measured no stack"));
    };
    let Some((flash, statics)) = memory(image) else {
        return Outcome::Failed(format!("{}: no 32-bit ELF file", image.display()));
    };
    run.note(format!(
        "{law}: {median} instructions a step (p99 {p99}, worst {worst}), stack {stack} B \
         (set-up {setup} B), flash {flash} B, statics {statics} B"
    ));
    let ram = statics + stack.max(setup);
    if ram > RAM_MAX {
        return Outcome::Failed(format!("{ram} B of RAM, expected at most {RAM_MAX}"));
    }
    let Some(before) = crate::instructions::kept(committed, law) else {
        return Outcome::Failed(format!("{}: no count of {law}", committed.display()));
    };
    let rise = 100.0 * (f64::from(median) / before - 1.0);
    if rise > RISE_PERCENT {
        return Outcome::Failed(format!("{law} is dearer on the board by {rise:.1} %"));
    }
    Outcome::Passed
}

/// Bytes of an image that lie in flash, and that it holds in RAM.
pub(crate) fn memory(image: &Path) -> Option<(u32, u32)> {
    let elf = std::fs::read(image).ok()?;
    let segments = segments(&elf)?;
    let flash = segments.iter().map(|segment| segment.in_file).sum();
    let ram = segments.iter().filter(|s| s.address >= RAM_ADDRESS).map(|s| s.in_memory).sum();
    Some((flash, ram))
}

/// Where the RAM of the board begins.
const RAM_ADDRESS: u32 = 0x2000_0000;

/// What is loaded from a program header.
#[derive(Debug, PartialEq, Eq)]
struct Segment {
    address: u32,
    in_file: u32,
    in_memory: u32,
}

/// The loaded segments of a little-endian 32-bit ELF file.
fn segments(elf: &[u8]) -> Option<Vec<Segment>> {
    const LOADED: u32 = 1;
    let short = |at: usize| Some(u16::from_le_bytes(elf.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(elf.get(at..at + 4)?.try_into().ok()?));
    if !elf.starts_with(b"\x7fELF\x01\x01") {
        return None;
    }
    let (table, size, count) = (word(28)? as usize, short(42)?, short(44)?);
    let mut segments = Vec::new();
    for number in 0..count {
        let header = table + usize::from(number) * usize::from(size);
        if word(header)? == LOADED {
            let (address, in_file, in_memory) =
                (word(header + 8)?, word(header + 16)?, word(header + 20)?);
            segments.push(Segment { address, in_file, in_memory });
        }
    }
    Some(segments)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loaded_segments_are_read() {
        let mut elf = vec![0; 52 + 2 * 32];
        elf[..6].copy_from_slice(b"\x7fELF\x01\x01");
        elf[28] = 52;
        elf[42] = 32;
        elf[44] = 2;
        // One is loaded, one is a note.
        for (number, kind, in_file, in_memory) in [(0, 1, 3, 9), (1, 4, 5, 5)] {
            let header = 52 + 32 * number;
            elf[header] = kind;
            elf[header + 11] = 0x20;
            elf[header + 16] = in_file;
            elf[header + 20] = in_memory;
        }
        let ram = Segment { address: RAM_ADDRESS, in_file: 3, in_memory: 9 };
        assert_eq!(segments(&elf), Some(vec![ram]));
        assert_eq!(segments(b"#!/bin/sh"), None);
        assert_eq!(segments(&elf[..60]), None);
    }
}
