//! `yawbench characterise`: a virtual bench visit, or the figures of measured records.
//!
//! With `--propose-mapping` it prints a mapping for a file, or writes it to `--out`.
//!
//! Four sources: a model with its effects, the hydraulic damper (`--physical`), measured records
//! (`--from`), or a rig (`--bus`). All but the third write a CSV file and its mapping per test; all
//! write `laboratory.json` with the figures that are printed. A virtual visit writes nothing before
//! its last test is recorded.

use crate::error::CommandError;
use crate::on_rig::{self, Common, LABORATORY, OnRigArgs};
use crate::output::print;
use crate::run_records::RunRecordArgs;
use crate::{exit, output, stop};
use clap::Args;
use files::{ResultFolder, did_you_mean};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use measurement::mapping::Companion;
use measurement::read_tests_with;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use virtual_bench::bench_visit::RawRecord;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::test_list::TestList;
use virtual_bench::characterisation::{LaboratoryFile, Visit};
use virtual_bench::laboratory::Limit;

/// Options of `characterise`.
#[derive(Debug, Args)]
pub(crate) struct CharacteriseArgs {
    /// The damper: a model file, which has a damper table.
    #[arg(required_unless_present_any = ["physical", "from", "propose_mapping", "bus"], conflicts_with_all = ["physical", "from"])]
    model: Option<PathBuf>,
    /// The damper: a hydraulic damper from chambers, valves and oil.
    #[arg(long, value_name = "FILE", conflicts_with = "from")]
    physical: Option<PathBuf>,
    /// Tests: full (24 tests in five minutes of bench time), short (ten in one), or a list in a
    /// file.
    #[arg(long, value_name = "full|short|FILE", default_value = "full")]
    tests: String,
    /// No visit: the figures of these measured records: CSV files, or record.npy and bus.log of a
    /// run.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "tests")]
    from: Vec<PathBuf>,
    /// Columns and units of the measured records [default: FILE.toml next to FILE.csv, if it is
    /// one].
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// No visit: print a mapping for this file, with what it says about its columns and questions
    /// about the rest; --out FILE writes it.
    #[arg(long, value_name = "CSV", conflicts_with_all = ["model", "physical", "from", "tests", "datasheet", "json"])]
    propose_mapping: Option<PathBuf>,
    /// Datasheet with whose force table and tolerance the figures are compared.
    #[arg(long, value_name = "FILE")]
    datasheet: Option<PathBuf>,
    /// Seed of the noise and of everything random in the damper.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the files [default: runs/NAME-N]; with --propose-mapping the mapping's file.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a result that --out holds.
    #[arg(long)]
    overwrite: bool,
    /// Print laboratory.json instead of tables.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    of_run: RunRecordArgs,
    #[command(flatten)]
    on_rig: OnRigArgs,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &CharacteriseArgs) -> Result<ExitCode, CommandError> {
    if let Some(path) = &args.propose_mapping {
        return propose_mapping(args, path);
    }
    let datasheet = args.datasheet.as_deref().map(Limit::load).transpose()?.unwrap_or_default();
    if let Some(first) = args.from.first() {
        return of_records(args, first, &datasheet);
    }
    refuse_record(args)?;
    if args.mapping.is_some() && !args.on_rig.plays() {
        return Err(CommandError::option("--mapping", "--from or --play, whose columns it names"));
    }
    let list = test_list(&args.tests)?;
    if let Some(bus) = &args.on_rig.bus {
        let common = Common {
            model: args.model.as_deref(),
            mapping: args.mapping.as_deref(),
            reader: &args.of_run.reader(),
            tests: &list.tests,
            node: args.of_run.node(),
            out: args.out.as_deref(),
            overwrite: args.overwrite,
            json: args.json,
            datasheet: &datasheet,
        };
        return on_rig::command(&args.on_rig, bus, common);
    }
    let (path, visit) = match (&args.physical, &args.model) {
        (Some(path), _) => (path, Visit::of_hydraulic(path, list, args.seed)?),
        (None, Some(path)) => (path, Visit::of_model(path, list, args.seed)?),
        (None, None) => {
            return Err(CommandError::option("no damper", "MODEL, --physical or --from"));
        }
    };
    of_visit(args, path, &visit, &datasheet)
}

/// Refuses a measured record in the place of a damper.
fn refuse_record(args: &CharacteriseArgs) -> Result<(), CommandError> {
    let is_table =
        |path: &&PathBuf| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    let Some(path) =
        args.model.iter().chain(&args.physical).find(|path| is_table(path) && path.is_file())
    else {
        return Ok(());
    };
    let shown = path.display().to_string();
    Err(CommandError::Input {
        file: path.clone(),
        found: "a CSV file".to_owned(),
        expected: format!(
            "the TOML file of a damper; characterise --from {} gives the figures of a measured \
             record",
            files::quoted(&shown)
        ),
    })
}

/// The tests by their name or file.
fn test_list(name: &str) -> Result<TestList, CommandError> {
    let built_in = TestList::built_in(name);
    let is_word = Path::new(name).extension().is_none() && !name.contains('/');
    if built_in.is_none() && is_word && !Path::new(name).exists() {
        let similar = did_you_mean(name, ["full", "short"]);
        let expected = format!("full, short or the file of a list{similar}");
        return Err(CommandError::option(
            format!("--tests {name} (cannot be read as a file)"),
            expected,
        ));
    }
    Ok(built_in.map_or_else(|| TestList::named(name), Ok)?)
}

/// A mapping for a file.
fn propose_mapping(args: &CharacteriseArgs, path: &Path) -> Result<ExitCode, CommandError> {
    let mapping = measurement::propose_mapping(path)?;
    match &args.out {
        Some(out) => write_mapping(out, path, &mapping, args.overwrite)?,
        None => print(&mapping)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes a mapping to a file that is not there yet, or that is a mapping to be replaced.
fn write_mapping(
    out: &Path,
    record: &Path,
    mapping: &str,
    overwrite: bool,
) -> Result<(), CommandError> {
    let refused = |found: &str, expected: &str| {
        let file = format!("--out {}", out.display()).into();
        Err(CommandError::Input { file, found: found.to_owned(), expected: expected.to_owned() })
    };
    if out.is_dir() {
        return refused("a folder", "the name of a TOML file");
    }
    let same = |one: &Path| one.canonicalize().ok();
    if same(out).is_some() && same(out) == same(record) {
        return refused("the record itself", "another file");
    }
    if !overwrite && out.symlink_metadata().is_ok() {
        return refused("a file that exists", "a new one, or --overwrite");
    }
    std::fs::write(out, mapping).map_err(|why| CommandError::File(out.to_owned(), why))?;
    print(&format!("mapping in {}", files::quoted(&out.display().to_string())))?;
    Ok(())
}

/// The figures of measured records.
fn of_records(
    args: &CharacteriseArgs,
    first: &Path,
    datasheet: &[Limit],
) -> Result<ExitCode, CommandError> {
    let mut folder = folder(args, first)?;
    folder.check(&[LABORATORY])?;
    let tests = read_tests_with(&args.from, args.mapping.as_deref(), Some(&args.of_run.reader()))?;
    let file = LaboratoryFile::of_records(&args.from, &tests, datasheet);
    // The figures are written whole.
    let _ = stop::flag();
    folder.create()?;
    finish(args, &folder, &file, "")
}

/// The records and figures of a virtual visit.
fn of_visit(
    args: &CharacteriseArgs,
    path: &Path,
    visit: &Visit,
    datasheet: &[Limit],
) -> Result<ExitCode, CommandError> {
    let mut folder = folder(args, path)?;
    let csv: Vec<String> = visit.tests().iter().map(Test::csv_name).collect();
    let mappings: Vec<String> = csv.iter().map(|name| Companion::name_for(name)).collect();
    let names = csv.iter().chain(&mappings).map(String::as_str);
    folder.check(&names.chain([LABORATORY]).collect::<Vec<_>>())?;
    let mut progress = Progress::new(visit.tests());
    let outcome = visit.run(datasheet, stop::flag(), &mut |test| progress.show(test))?;
    progress.bar.finish_and_clear();
    if outcome.records.is_empty() {
        files::say!("interrupted before the first test was recorded: nothing is written");
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    for record in outcome.records.iter().filter(|record| record.doubtful_steps > 0) {
        let (name, count) = (&record.name, record.doubtful_steps);
        files::say!("warning: {name}: {count} steps of the simulation did not converge");
    }
    folder.create()?;
    for record in &outcome.records {
        write(&folder, record, &outcome.specimen)?;
    }
    let written = format!(", {} CSV with their mappings", outcome.records.len());
    finish(args, &folder, &outcome.file, &written)
}

fn folder(args: &CharacteriseArgs, named_after: &Path) -> Result<ResultFolder, CommandError> {
    let (out, name) = (args.out.as_deref(), output::stem(named_after));
    let folder = ResultFolder::fresh(out, &name, "characterise", args.overwrite)?;
    let options = [&args.model, &args.physical, &args.mapping, &args.datasheet];
    let inputs = args.from.iter().chain(options.into_iter().flatten());
    folder.refuse_inputs(inputs.map(PathBuf::as_path))?;
    Ok(folder)
}

/// Writes a record and its mapping.
fn write(folder: &ResultFolder, record: &RawRecord, specimen: &str) -> Result<(), CommandError> {
    let name = record.csv_name();
    let mut to = BufWriter::new(folder.create_file(&name)?);
    let written = record.write_csv(&mut to).and_then(|()| to.flush());
    written.map_err(|why| CommandError::File(folder.file(&name), why))?;
    folder.write(&Companion::name_for(&name), &record.companion(specimen).to_toml(&name))?;
    Ok(())
}

/// Writes the figures last and prints them.
fn finish(
    args: &CharacteriseArgs,
    folder: &ResultFolder,
    file: &LaboratoryFile,
    written: &str,
) -> Result<ExitCode, CommandError> {
    let json = serde_json::to_string_pretty(file)?;
    folder.write(LABORATORY, &format!("{json}\n"))?;
    if args.json {
        print(&json)?;
    } else {
        let place = folder.path().display().to_string();
        let place = files::quoted(&place);
        print(&format!("{file}files in {place}: {LABORATORY}{written}"))?;
    }
    let code = if file.is_interrupted() { exit::INTERRUPTED } else { 0 };
    Ok(ExitCode::from(code))
}

/// A bar over the tests; it appears after two seconds.
struct Progress<'a> {
    tests: &'a [Test],
    bar: ProgressBar,
    begin: Instant,
}

impl<'a> Progress<'a> {
    fn new(tests: &'a [Test]) -> Self {
        let total_s: f64 = tests.iter().map(|test| test.duration_s).sum();
        let target = ProgressDrawTarget::stderr_with_hz(10);
        let bar = ProgressBar::with_draw_target(Some(total_s as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Self { tests, bar, begin: Instant::now() }
    }

    /// A test begins.
    fn show(&mut self, test: usize) {
        if self.begin.elapsed() > Duration::from_secs(2) {
            let done_s: f64 = self.tests[..test].iter().map(|test| test.duration_s).sum();
            self.bar.set_message(self.tests[test].name.clone());
            self.bar.set_position(done_s as u64);
        }
    }
}
