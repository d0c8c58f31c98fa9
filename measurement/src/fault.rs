//! What a cell without a number is, and what to do about it.

/// Marks that programs write in the place of a reading, in small letters.
const MISSING: [&str; 20] = [
    "",
    "nan",
    "n/a",
    "na",
    "#n/a",
    "#nv",
    "#value!",
    "#wert!",
    "null",
    "none",
    "-",
    "?",
    "*",
    "inf",
    "-inf",
    "overflow",
    "ovl",
    "overrange",
    "invalid",
    "error",
];

/// What a cell without a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// A mark for a reading that is missing.
    Missing,
    /// A negative number as accountants write it.
    Accounting,
    /// Text below the last row of numbers.
    Footer,
    /// Anything else.
    Other,
}

impl Fault {
    /// What a cell is; `is_footer` where no number follows in its column.
    pub(crate) fn of(cell: &str, is_finite: impl Fn(&str) -> bool, is_footer: bool) -> Self {
        let inside = cell.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
        if inside.is_some_and(|inside| is_finite(inside.trim())) {
            return Self::Accounting;
        }
        let small = cell.trim().to_lowercase();
        // The library of Microsoft writes 1.#QNAN, -1.#IND and 1.#INF.
        let is_microsoft = small.trim_start_matches(['+', '-']).starts_with("1.#");
        if is_footer && !is_microsoft && small.contains(char::is_alphabetic) && small != "nan" {
            return Self::Footer;
        }
        let consists_of = |mark: u8| small.len() > 1 && small.bytes().all(|byte| byte == mark);
        if is_footer && (consists_of(b'-') || consists_of(b'=')) {
            return Self::Footer;
        }
        if is_microsoft
            || consists_of(b'*')
            || consists_of(b'-')
            || MISSING.contains(&small.as_str())
        {
            return Self::Missing;
        }
        Self::Other
    }

    /// What to do about it, as the end of a message; `has_clock` where time stamps show a gap.
    pub(crate) fn way_out(self, line: usize, has_clock: bool) -> String {
        match self {
            Self::Missing if has_clock => format!(
                "; the reading is missing: delete line {line} (up to three missing samples in a \
                 row are filled in), or cut the file there"
            ),
            Self::Missing => "; the reading is missing: cut the file there".to_owned(),
            Self::Accounting => {
                "; a number in brackets is a negative one of a spreadsheet: format \
                                 the cells as plain numbers with a minus sign and export again"
                    .to_owned()
            }
            Self::Footer => format!(
                "; text below the last row of numbers: delete it from line \
                                     {line} on"
            ),
            Self::Other => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_missing_readings_are_known() {
        let is_finite = |cell: &str| cell.parse::<f64>().is_ok_and(f64::is_finite);
        for cell in ["", "NaN", "1.#QNAN", "-1.#IND", "1.#INF", "-", "#N/A", "OVERFLOW", "****"] {
            assert_eq!(Fault::of(cell, is_finite, false), Fault::Missing, "{cell}");
        }
        assert_eq!(Fault::of("(751.6)", is_finite, false), Fault::Accounting);
        assert_eq!(Fault::of("Mean", is_finite, true), Fault::Footer);
        assert_eq!(Fault::of("Mean", is_finite, false), Fault::Other);
    }
}
