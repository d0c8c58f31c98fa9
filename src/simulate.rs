//! `yawbench simulate`: a model's force on a record, free-running from its displacement.

use anyhow::{Context, bail};
use clap::Args;
use firmware_core::damper::Damper;
use identification::result::Models;
use identification::{Prediction, TestSet, simulate, start_deflection_m};
use measurement::mapping::{Mapping, Reading};
use measurement::table::Table;
use measurement::{Measurement, MeasurementError, read_tests, series};
use scenario::damper::DamperFile;
use scenario::source::Source;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Options of `simulate`.
#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The damper: a model file with a [damper] table, such as `identify` writes.
    model: PathBuf,
    /// The record: its displacement drives the model, its force shows where the dashpot starts. A
    /// record without a force column is driven too, from rest in the middle of the clearance.
    record: PathBuf,
    /// The file to write. A mapping with the same name and the ending .toml is written with it; it
    /// states which sign means extension.
    #[arg(long, value_name = "CSV")]
    out: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    overwrite: bool,
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
    let motions = motions(&args.record, mapping)?;
    let measured = motions.is_none();
    let records = match motions {
        Some(records) => records,
        None => read_tests(std::slice::from_ref(&args.record), mapping)?,
    };
    if records.len() != 1 {
        let (file, count) = (args.record.display(), records.len());
        bail!("{file}: {count} tests in one file, expected one; a mapping can choose with `where`");
    }
    let place = Place::checked(args)?;
    let tests = TestSet::new(records);
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
    let prediction = Prediction {
        test,
        measured_n: measured.then_some(test.record.force_n.as_slice()),
        models_n: Models { datasheet: None, refitted: None, with_effects: Some(&force_n) },
        with_empirical_n: mapped_n.as_deref(),
    };
    place.write(&prediction)
}

/// The CSV file to write and its mapping.
struct Place {
    csv: PathBuf,
    mapping: PathBuf,
    overwrite: bool,
}

impl Place {
    /// Refuses a place where no file can be made, or where one is in the way.
    fn checked(args: &SimulateArgs) -> anyhow::Result<Self> {
        let (csv, mapping) = (args.out.clone(), args.out.with_extension("toml"));
        let file = csv.display();
        let folder = csv.parent().filter(|folder| !folder.as_os_str().is_empty());
        if csv.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
            bail!("--out {file}: found no place for a file, expected one in a folder that exists");
        }
        if mapping == csv {
            bail!("--out {file}: found the ending .toml, which is for the mapping, expected .csv");
        }
        let same = |path: &Path| std::fs::canonicalize(path).ok();
        let inputs = [Some(&args.record), Some(&args.model), args.mapping.as_ref()];
        for output in [&csv, &mapping] {
            let shown = output.display();
            let is_output = |input: &&PathBuf| same(input).is_some() && same(input) == same(output);
            if same(output) == same(&args.record) && same(output).is_some() {
                bail!("--out {file}: found the record itself, expected another file");
            }
            if inputs.into_iter().flatten().any(|input| is_output(&input)) {
                bail!("--out {file}: {shown} is an input of this command, expected another file");
            }
            if !args.overwrite && output.symlink_metadata().is_ok() {
                bail!("--out {file}: {shown} exists, expected a new file; --overwrite replaces it");
            }
        }
        Ok(Self { csv, mapping, overwrite: args.overwrite })
    }

    fn write(&self, prediction: &Prediction<'_>) -> anyhow::Result<()> {
        self.write_file(&self.csv, &prediction.to_csv())?;
        self.write_file(&self.mapping, &prediction.to_mapping())
    }

    fn write_file(&self, path: &Path, text: &str) -> anyhow::Result<()> {
        let mut options = OpenOptions::new();
        options.write(true);
        if self.overwrite {
            options.create(true).truncate(true);
        } else {
            options.create_new(true);
        }
        let written = options.open(path).and_then(|mut file| file.write_all(text.as_bytes()));
        written.with_context(|| path.display().to_string())
    }
}

/// The tests of a file without a force column; `None` where it has one or the mapping names one.
/// The displacement stands in the place of the force, so that every check of the motion is made.
fn motions(
    path: &Path,
    mapping: Option<&Path>,
) -> Result<Option<Vec<Measurement>>, MeasurementError> {
    let mut layout = match mapping {
        Some(file) => {
            let (mapping, source) = Mapping::load(file)?;
            mapping.layout(&source, path)?
        }
        None => Mapping::own()?,
    };
    let table = Table::read(path, &layout)?;
    let has_force =
        |force: &Reading| force.column != "force_n" || table.names.contains(&force.column);
    if layout.force.iter().any(has_force) {
        return Ok(None);
    }
    layout.force = vec![layout.displacement.clone()];
    let tests = series::tests_of(&table, &layout)?;
    Measurement::from_visit(tests).map(Some)
}
