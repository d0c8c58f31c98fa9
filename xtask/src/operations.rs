//! `cargo xtask firmware --table`: what kinds of instructions a step has, and an estimate of its
//! cycles.
//!
//! QEMU writes down each block of instructions when it translates it, and the number of the block
//! whenever it runs it. The difference of two runs is that of the steps between them, with what
//! `measure` does around a step (its hash and a line of output, 2 %).
//!
//! **The estimate.** ARM publishes no instruction timings of the Cortex-M7. The weights are from
//! LLVM's scheduling model of it (`ARMScheduleM7.td`): the lower bound has every result ready when
//! it is needed and pairs of integer instructions and 32-bit loads issued together, the upper bound
//! waits for each result. Both have code and data in memories without wait states.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Kinds of instructions: name, first letters of the mnemonics, cycles at least and at most. The
/// first that fits counts.
const KINDS: [(&str, &[&str], f64, f64); 9] = [
    ("divide, root", &["vdiv", "vsqrt"], 30.0, 30.0),
    ("multiply-add", &["vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms"], 1.0, 11.0),
    ("multiply", &["vmul", "vnmul"], 1.0, 7.0),
    ("add", &["vadd", "vsub"], 1.0, 4.0),
    (
        "load, store of doubles",
        &["vldr", "vldm", "vpop", "vstr", "vstm", "vpush", "ldrd", "strd"],
        1.0,
        2.0,
    ),
    ("other floating point", &["v"], 1.0, 3.0),
    ("load, store of words", &["ldr", "ldm", "pop", "str", "stm", "push"], 0.5, 2.0),
    ("branch", &["b", "cb", "tb"], 0.5, 2.0),
    ("integer", &[""], 0.5, 1.0),
];

/// Mnemonics that begin as a branch does and are none.
const NO_BRANCHES: [&str; 4] = ["bic", "bfi", "bfc", "bkpt"];

/// Clocks that the estimate is stated for (MHz).
const CLOCKS_MHZ: [f64; 2] = [480.0, 1000.0];

/// How often each kind was executed.
pub(crate) type Counts = [u64; KINDS.len()];

fn kind(mnemonic: &str) -> usize {
    let begins = |starts: &[&str]| starts.iter().any(|start| mnemonic.starts_with(start));
    let fits = |(name, starts, ..): &(&str, &[&str], f64, f64)| {
        begins(starts)
            && !(*name == "branch" && NO_BRANCHES.iter().any(|no| mnemonic.starts_with(no)))
    };
    KINDS.iter().position(fits).unwrap_or(KINDS.len() - 1)
}

/// Reads what QEMU has written with `-d in_asm,exec,nochain`.
///
/// # Errors
/// One line: the file cannot be read.
pub(crate) fn count(log: &Path) -> Result<Counts, String> {
    let file = File::open(log).map_err(|error| format!("{}: {error}", log.display()))?;
    Ok(counted(BufReader::new(file).lines().map_while(Result::ok)))
}

fn counted(lines: impl Iterator<Item = String>) -> Counts {
    let mut blocks: HashMap<String, Counts> = HashMap::new();
    let mut translated: Option<Counts> = None;
    let mut sum = Counts::default();
    for line in lines {
        if line.starts_with("IN:") {
            translated = Some(Counts::default());
        } else if line.starts_with("0x") {
            if let (Some(block), Some(mnemonic)) = (&mut translated, mnemonic(&line)) {
                block[kind(mnemonic)] += 1;
            }
        } else if let Some(number) = line.strip_prefix("Trace 0: ") {
            let number = number.split(' ').next().unwrap_or_default();
            // What was translated last is what runs now.
            if let Some(block) = translated.take() {
                blocks.insert(number.to_owned(), block);
            }
            if let Some(block) = blocks.get(number) {
                sum.iter_mut().zip(block).for_each(|(sum, count)| *sum += count);
            }
        }
    }
    sum
}

/// The mnemonic of a line such as `0x00000400:  f008 fd0e  bl       #0x8e20`.
fn mnemonic(line: &str) -> Option<&str> {
    let is_code = |word: &&str| word.len() == 4 && word.bytes().all(|b| b.is_ascii_hexdigit());
    line.split_whitespace().skip(1).find(|word| !is_code(word))
}

/// The rows of a table: kind, count and share of it in a step, then the estimates.
pub(crate) fn rows(law: &str, steps: u64, few: &Counts, many: &Counts) -> Vec<String> {
    let per_step = |kind: usize| many[kind].saturating_sub(few[kind]) as f64 / steps as f64;
    let mut rows = Vec::new();
    let (mut least, mut most) = (0.0, 0.0);
    for (at, (name, _, low, high)) in KINDS.iter().enumerate() {
        let count = per_step(at);
        least += count * low;
        most += count * high;
        rows.push(format!("| {law} | {name} | {count:.0} | {low} to {high} |"));
    }
    for mhz in CLOCKS_MHZ {
        let [low, high] = [least, most].map(|cycles| cycles / (mhz * 1e3) * 100.0);
        rows.push(format!(
            "| {law} | estimate at {mhz} MHz | {:.0} k to {:.0} k cycles | {low:.0} to {high:.0} % of 1 ms |",
            least / 1e3,
            most / 1e3
        ));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_count_as_often_as_they_run() {
        let log = "IN: main\n0x00000400:  f008 fd0e  bl       #0x8e20\n\
                   0x00000404:  ee81 0b02  vdiv.f64 d0, d1, d2\n\nTrace 0: 0x7f01 [0/400] main\n\
                   IN: main\n0x00000408:  bf00       nop      \nTrace 0: 0x7f02 [0/408] main\n\
                   Trace 0: 0x7f01 [0/400] main\n";
        let counts = counted(log.lines().map(str::to_owned));
        let by_name = |name: &str| counts[KINDS.iter().position(|row| row.0 == name).unwrap()];
        assert_eq!((by_name("divide, root"), by_name("branch"), by_name("integer")), (2, 2, 1));
    }

    #[test]
    fn kinds_are_told_by_the_first_letters() {
        for (mnemonic, name) in [
            ("vmla.f64", "multiply-add"),
            ("vcmp.f64", "other floating point"),
            ("ldrd", "load, store of doubles"),
            ("ldrb", "load, store of words"),
            ("bic.w", "integer"),
            ("bne.w", "branch"),
        ] {
            assert_eq!(KINDS[kind(mnemonic)].0, name, "{mnemonic}");
        }
    }
}
