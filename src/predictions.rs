//! `predictions/<test>.csv` and what `simulate` writes: a record's motion with measured and simulated
//! forces beside it.
//!
//! Columns: `time_s,displacement_m,force_n,datasheet_n,refitted_n,with_effects_n`, and
//! `with_empirical_n` where there is an empirical map. A force that is not there has empty cells.

use identification::result::Models;
use identification::tests_at_hand::Test;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Forces beside the motion of a test, N.
pub(crate) struct Forces<'a> {
    /// Measured.
    pub(crate) measured: Option<&'a [f64]>,
    /// Of the models.
    pub(crate) models: Models<Option<&'a [f64]>>,
    /// Of the last of them with an empirical map; without one there is no column.
    pub(crate) with_empirical: Option<&'a [f64]>,
}

/// Writes the file.
pub(crate) fn write(path: &Path, test: &Test, forces: &Forces<'_>) -> std::io::Result<()> {
    let Forces { measured, models, with_empirical } = forces;
    let mut columns = vec![
        ("force_n", *measured),
        ("datasheet_n", models.datasheet),
        ("refitted_n", models.refitted),
        ("with_effects_n", models.with_effects),
    ];
    if with_empirical.is_some() {
        columns.push(("with_empirical_n", *with_empirical));
    }
    let mut to = BufWriter::new(std::fs::File::create(path)?);
    let record = &test.record;
    let extension = if record.direction_declared { "positive" } else { "unknown" };
    writeln!(to, "# extension: {extension}")?;
    write!(to, "time_s,displacement_m")?;
    for (name, _) in &columns {
        write!(to, ",{name}")?;
    }
    writeln!(to)?;
    for sample in 0..record.len() {
        write!(to, "{},{}", record.time_s(sample), record.displacement_m[sample])?;
        for (_, force_n) in &columns {
            match force_n.and_then(|force_n| force_n.get(sample)) {
                Some(force_n) => write!(to, ",{force_n}")?,
                None => write!(to, ",")?,
            }
        }
        writeln!(to)?;
    }
    to.flush()
}
