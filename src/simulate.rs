//! `yawbench simulate`: a model's force on a record, free-running from its displacement.

use crate::error::CommandError;
use crate::run_records::RunRecordArgs;
use crate::{output, stop};
use clap::Args;
use firmware_core::damper::Damper;
use identification::result::Models;
use identification::{Prediction, TestSet, simulate, start_deflection_m};
use measurement::{RecordReader as _, read_motions, read_tests_with};
use scenario::damper::DamperFile;
use scenario::source::Source;
use std::fs::File;
use std::io::Write as _;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// Options of `simulate`.
#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The damper: a model file, which has a damper table, such as `identify` writes.
    model: PathBuf,
    /// The record: its displacement drives the model, its force shows where the dashpot starts. A
    /// record without a force column is driven too, from rest in the middle of the clearance. The
    /// record.npy or bus.log of a run is a record too.
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
    #[command(flatten)]
    of_run: RunRecordArgs,
}

/// Runs `simulate`.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &SimulateArgs) -> Result<(), CommandError> {
    let damper = DamperFile::load_model(&args.model)?.build(&Source::read(&args.model)?)?;
    let mapping = args.mapping.as_deref();
    let reader = args.of_run.reader();
    let motions =
        if reader.reads(&args.record) { None } else { read_motions(&args.record, mapping)? };
    let measured = motions.is_none();
    let records = match motions {
        Some(records) => records,
        None => read_tests_with(std::slice::from_ref(&args.record), mapping, Some(&reader))?,
    };
    let tests = TestSet::new(records);
    let [test] = tests.tests.as_slice() else {
        return Err(CommandError::Input {
            file: args.record.clone(),
            found: format!("{} tests in one file", tests.tests.len()),
            expected: "one; a mapping can choose with `where`".to_owned(),
        });
    };
    let place = Place::checked(args)?;
    for repair in &test.record.repairs {
        files::say!("note: {}: {repair}", args.record.display());
    }
    if !measured {
        let file = args.record.display();
        files::say!("{file}: no column force_n, started at rest in the middle of the clearance");
    }
    let run = |damper: &Damper| {
        let start_m = if measured { start_deflection_m(damper, test) } else { 0.0 };
        simulate(damper, test, start_m)
    };
    // A model with a map is two: its physics, and the same with the map.
    let mapped_n = damper.empirical().map(|_| run(&damper));
    let force_n = run(&damper.without_empirical());
    let prediction = Prediction {
        test,
        measured_n: measured.then_some(test.record.force_n.as_slice()),
        models_n: Models { datasheet: None, refitted: None, with_effects: Some(&force_n) },
        with_empirical_n: mapped_n.as_deref(),
    };
    // Both files are written.
    let _ = stop::flag();
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
    fn checked(args: &SimulateArgs) -> Result<Self, CommandError> {
        let refused = |found: String, expected: &str| {
            let file = format!("--out {}", args.out.display()).into();
            Err(CommandError::Input { file, found, expected: expected.to_owned() })
        };
        let (csv, mapping) = (args.out.clone(), args.out.with_extension("toml"));
        let folder = csv.parent().filter(|folder| !folder.as_os_str().is_empty());
        if csv.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
            return refused("no place for a file".to_owned(), "one in a folder that exists");
        }
        if mapping == csv {
            let found = "the ending .toml, which the mapping has".to_owned();
            return refused(found, "another one, such as .csv");
        }
        // The mapping next to the record is read without being named.
        let companion = args.record.with_extension("toml");
        let inputs =
            [Some(&args.record), Some(&companion), Some(&args.model), args.mapping.as_ref()];
        for output in [&csv, &mapping] {
            let shown = output.display().to_string();
            let shown = files::quoted(&shown);
            if is_same(output, &args.record) {
                return refused("the record itself".to_owned(), "another file");
            }
            if inputs.into_iter().flatten().any(|input| is_same(output, input)) {
                let found = format!("{shown}, which is an input of this command");
                return refused(found, "another file");
            }
            if output.symlink_metadata().is_ok_and(|about| !about.is_file()) {
                let found = format!("{shown}, which is no regular file");
                return refused(found, "a new file or one to replace");
            }
            if !args.overwrite && output.symlink_metadata().is_ok() {
                let found = format!("{shown}, which exists");
                return refused(found, "a new file; --overwrite replaces it");
            }
        }
        Ok(Self { csv, mapping, overwrite: args.overwrite })
    }

    fn write(&self, prediction: &Prediction<'_>) -> Result<(), CommandError> {
        self.write_file(&self.csv, &prediction.to_csv())?;
        self.write_file(&self.mapping, &prediction.to_mapping(&output::file_name(&self.csv)))
    }

    /// Writes a new file. An earlier one is replaced by renaming, so that no other name of it is
    /// changed; a disk that fails leaves no part of a file.
    fn write_file(&self, path: &Path, text: &str) -> Result<(), CommandError> {
        let failed = |why| CommandError::File(path.to_owned(), why);
        let new = if self.overwrite {
            path.with_extension(format!("{}.new", std::process::id()))
        } else {
            path.to_owned()
        };
        let mut file = File::create_new(&new).map_err(failed)?;
        let written = file.write_all(text.as_bytes());
        let named =
            written.and_then(|()| if new == path { Ok(()) } else { std::fs::rename(&new, path) });
        named.map_err(|why| {
            let _ = std::fs::remove_file(&new);
            failed(why)
        })
    }
}

/// True for two paths to the same existing file.
fn is_same(one: &Path, other: &Path) -> bool {
    let node = |path: &Path| path.metadata().ok().map(|about| (about.dev(), about.ino()));
    node(one).is_some_and(|one| Some(one) == node(other))
}
