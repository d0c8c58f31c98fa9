//! What callgrind writes: the instructions of a run, and how often memory was copied.

use std::collections::HashMap;

/// Functions that copy or fill memory, as the C library names them: `__memcpy_avx_unaligned`.
const COPIES: [&str; 3] = ["memcpy", "memmove", "memset"];

/// What a run came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Counts {
    /// Instructions.
    pub(crate) instructions: f64,
    /// Calls of what copies or fills memory.
    pub(crate) copies: f64,
}

impl Counts {
    /// Reads a file of callgrind.
    ///
    /// A function is named once, with a number, and by its number from then on: `cfn=(12) memcpy`,
    /// `cfn=(12)`. The line `calls=3 0x40` behind it says how often it was called from there.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let mut names: HashMap<&str, &str> = HashMap::new();
        let (mut called, mut copies, mut instructions) = ("", 0.0, None);
        for line in text.lines() {
            let named = line.strip_prefix("cfn=").or_else(|| line.strip_prefix("fn="));
            if let Some((number, name)) = named.and_then(|named| named.split_once(')')) {
                if !name.is_empty() {
                    names.insert(number, name);
                }
                called = number;
            } else if let Some(count) = line.strip_prefix("calls=") {
                let name = names.get(called).copied().unwrap_or_default();
                if COPIES.iter().any(|copy| name.contains(copy)) {
                    copies += count.split(' ').next()?.parse::<f64>().ok()?;
                }
            } else if let Some(total) = line.strip_prefix("totals: ") {
                instructions = total.trim().parse().ok();
            }
        }
        Some(Self { instructions: instructions?, copies })
    }

    /// What lies between a short run and a longer one, for each of so many cycles.
    pub(crate) fn per_cycle(few: Self, many: Self, cycles: u32) -> Self {
        let each = |few: f64, many: f64| (many - few) / f64::from(cycles);
        Self {
            instructions: each(few.instructions, many.instructions),
            copies: each(few.copies, many.copies),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_counted_by_the_name_that_was_given_first() {
        let text = "events: Ir\nfn=(1) step\n16 5\ncfn=(2) __memcpy_avx_unaligned\ncalls=3 0x40 \n\
                    16 60\ncfn=(3) sqrt\ncalls=7 0x80 \n17 7\nfn=(4) other\ncfn=(2)\ncalls=2 0x40 \n\
                    1 40\n\ntotals: 1234\n";
        let counts = Counts::read(text).unwrap();
        assert_eq!(counts, Counts { instructions: 1234.0, copies: 5.0 });
        assert_eq!(Counts::read("events: Ir\n"), None);
    }
}
