//! What the preamble of a measurement file of `LabVIEW` says: the units of its channels, and the
//! step of time where the file has no column of it.

use crate::layout::Separator;
use crate::lines;

/// What a preamble says.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Preamble {
    /// Units of the columns, as they are written; empty where none is.
    units: Vec<String>,
    /// Seconds between two samples of every channel.
    pub(crate) step_s: Option<f64>,
}

impl Preamble {
    /// The preamble above the numbers, if the file is one of `LabVIEW`.
    pub(crate) fn of(above: &[&str], separator: Separator) -> Option<Self> {
        let first = above.iter().find(|line| !line.trim().is_empty())?;
        if !first.trim_start().starts_with("LabVIEW Measurement") {
            return None;
        }
        // The values of a tag that comes again belong to the block below it.
        let tag = |name: &str| -> Option<Vec<String>> {
            above.iter().rev().map(|line| lines::cells(line, separator)).find_map(|cells| {
                let is_tag = cells.get(0).is_some_and(|cell| cell.eq_ignore_ascii_case(name));
                is_tag.then(|| cells.iter().skip(1).map(str::to_owned).collect())
            })
        };
        let is_multi = tag("X_Columns")
            .and_then(|values| values.first().cloned())
            .is_some_and(|value| value.eq_ignore_ascii_case("multi"));
        let mut units = Vec::new();
        for (channel, unit) in tag("Y_Unit_Label").unwrap_or_default().into_iter().enumerate() {
            if channel == 0 || is_multi {
                units.push(String::new());
            }
            units.push(unit);
        }
        let steps = tag("Delta_X").unwrap_or_default();
        let mut steps = steps.iter().filter(|cell| !cell.is_empty());
        let step = steps.next().filter(|first| steps.all(|other| other == *first));
        let step_s = step.and_then(|text| text.replace(',', ".").parse::<f64>().ok());
        Some(Self { units, step_s: step_s.filter(|step| step.is_finite() && *step > 0.0) })
    }

    /// The unit of a column.
    pub(crate) fn unit(&self, column: usize) -> Option<&str> {
        self.units.get(column).map(String::as_str).filter(|unit| !unit.is_empty())
    }
}
