//! `yawbench simulate`: a model's force on a record, free-running from its displacement.

use crate::predictions::{self, Forces};
use anyhow::{Context, bail};
use clap::Args;
use firmware_core::damper::Damper;
use identification::result::Models;
use identification::simulation::{simulate, start_deflection_m};
use identification::tests_at_hand::TestsAtHand;
use measurement::{read_motions, read_tests};
use scenario::damper::DamperFile;
use scenario::source::Source;
use std::path::{Path, PathBuf};

/// What `simulate` is told.
#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The damper: a model file with a [damper] table, such as `identify` leaves.
    model: PathBuf,
    /// The record: its displacement drives the model, its force shows where the dashpot starts. A
    /// record without a force column is driven too, from rest in the middle of the clearance.
    record: PathBuf,
    /// The file to write.
    #[arg(long, value_name = "CSV")]
    out: PathBuf,
    /// Columns and units of the record.
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
}

/// Runs `simulate`.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &SimulateArgs) -> anyhow::Result<()> {
    let damper = DamperFile::load_model(&args.model)?.build(&Source::read(&args.model)?)?;
    let mapping = args.mapping.as_deref();
    let motions = read_motions(&args.record, mapping)?;
    let measured = motions.is_none();
    let records = match motions {
        Some(records) => records,
        None => read_tests(std::slice::from_ref(&args.record), mapping)?,
    };
    if records.len() != 1 {
        let (file, count) = (args.record.display(), records.len());
        bail!("{file}: {count} tests in one file, expected one; a mapping can choose with `where`");
    }
    refuse_place(&args.out, &args.record)?;
    let tests = TestsAtHand::new(records);
    let Some(test) = tests.tests.first() else { bail!("no test") };
    for repair in &test.record.repairs {
        eprintln!("note: {}: {repair}", args.record.display());
    }
    if !measured {
        let file = args.record.display();
        eprintln!("{file}: no column force_n, started at rest in the middle of the clearance");
    }
    let run = |damper: &Damper| {
        let start_m = if measured { start_deflection_m(damper, test) } else { 0.0 };
        simulate(damper, test, start_m)
    };
    // A model with a map is two: its physics, and what the map makes of it.
    let mapped_n = damper.empirical().map(|_| run(&damper));
    let force_n = run(&damper.without_empirical());
    let forces = Forces {
        measured: measured.then_some(test.record.force_n.as_slice()),
        models: Models { datasheet: None, refitted: None, with_effects: Some(&force_n) },
        with_empirical: mapped_n.as_deref(),
    };
    predictions::write(&args.out, test, &forces).with_context(|| args.out.display().to_string())?;
    Ok(())
}

/// Refuses to write where nothing can be written, or over the record.
fn refuse_place(out: &Path, record: &Path) -> anyhow::Result<()> {
    let file = out.display();
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    if out.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
        bail!("--out {file}: found no place for a file, expected one in a folder that exists");
    }
    let same = |path: &Path| std::fs::canonicalize(path).ok();
    if same(out).is_some_and(|out| Some(out) == same(record)) {
        bail!("--out {file}: found the record itself, expected another file");
    }
    Ok(())
}
