//! Where a step's output goes: shown as it comes, or kept until its step is due.

/// The output of steps.
pub(crate) enum Console {
    Shown,
    Kept(Vec<String>),
}

impl Console {
    /// Takes a line, which may be an error's.
    pub(crate) fn line(&mut self, line: &str, is_stderr: bool) {
        match self {
            Console::Shown if is_stderr => eprintln!("{line}"),
            Console::Shown => println!("{line}"),
            Console::Kept(lines) => lines.push(line.to_owned()),
        }
    }

    /// Shows what another one has kept.
    pub(crate) fn take(&mut self, other: Console) {
        if let Console::Kept(lines) = other {
            for line in &lines {
                self.line(line, false);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kept_lines_come_in_their_order_and_once() {
        let mut kept = Console::Kept(Vec::new());
        kept.line("one", false);
        let mut later = Console::Kept(Vec::new());
        later.line("two", true);
        kept.take(later);
        let Console::Kept(lines) = kept else { panic!("it keeps") };
        assert_eq!(lines, ["one", "two"]);
    }
}
