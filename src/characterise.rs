//! `yawbench characterise`: a virtual bench visit, or the figures of a real one.
//!
//! Three sources: a model with its effects, the hydraulic damper (`--physical`), or measured records
//! (`--from`). The first two leave one CSV per test, made by the sensors of a usual laboratory; all
//! leave `laboratory.json` with the figures that are printed. Nothing is written before everything
//! has been worked out.

use crate::output::print;
use anyhow::{Context, bail};
use clap::Args;
use hil_host::record::RunFolder;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use scenario::damper::DamperFile;
use scenario::source::Source;
use serde::Serialize;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use virtual_bench::bench_visit::protocol::{self, Test};
use virtual_bench::bench_visit::random::Random;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::bench_visit::test_list::TestList;
use virtual_bench::bench_visit::{
    self, LABORATORY_DEGC, Modelled, RawRecord, Specimen, measurements,
};
use virtual_bench::hydraulic::HydraulicDamper;
use virtual_bench::laboratory::{Laboratory, Limit};

/// What `characterise` is told.
#[derive(Debug, Args)]
pub(crate) struct CharacteriseArgs {
    /// The damper: a model file with a [damper] table.
    #[arg(required_unless_present_any = ["physical", "from"], conflicts_with_all = ["physical", "from"])]
    model: Option<PathBuf>,
    /// The damper: a hydraulic damper from chambers, valves and oil.
    #[arg(long, value_name = "FILE", conflicts_with = "from")]
    physical: Option<PathBuf>,
    /// Tests: full (24 tests in five minutes of bench time), short (ten in one), or a list in a file.
    #[arg(long, value_name = "full|short|FILE", default_value = "full")]
    tests: String,
    /// No visit: the figures of these measured records.
    #[arg(long, value_name = "CSV", num_args = 1.., conflicts_with = "tests")]
    from: Vec<PathBuf>,
    /// Columns and units of the measured records.
    #[arg(long, value_name = "FILE", requires = "from")]
    mapping: Option<PathBuf>,
    /// Datasheet whose force table and tolerance the figures are held against.
    #[arg(long, value_name = "FILE")]
    datasheet: Option<PathBuf>,
    /// Seed of noise and of whatever is random in the damper.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the files [default: runs/NAME-N].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print laboratory.json instead of tables.
    #[arg(long)]
    json: bool,
}

/// `laboratory.json`.
#[derive(Debug, Serialize)]
struct LaboratoryFile {
    format: u32,
    source: &'static str,
    files: Vec<String>,
    seed: Option<u64>,
    sensors: Option<SensorFigures>,
    #[serde(flatten)]
    laboratory: Laboratory,
}

/// The sensors of a virtual visit, for the record.
#[derive(Debug, Serialize)]
struct SensorFigures {
    rate_hz: f64,
    force_range_n: f64,
    force_noise_n: f64,
    force_bits: u32,
    displacement_range_m: f64,
    displacement_noise_m: f64,
    displacement_bits: u32,
    coloured_noise_n: f64,
    coloured_rho_per_ms: Option<f64>,
    anti_alias_hz: Option<f64>,
    temperature_noise_k: Option<f64>,
}

impl SensorFigures {
    fn of(sensors: &Sensors) -> Self {
        Self {
            rate_hz: sensors.rate_hz,
            force_range_n: sensors.force.range,
            force_noise_n: sensors.force.noise,
            force_bits: sensors.force.bits,
            displacement_range_m: sensors.displacement.range,
            displacement_noise_m: sensors.displacement.noise,
            displacement_bits: sensors.displacement.bits,
            coloured_noise_n: sensors.coloured.map_or(0.0, |noise| noise.level_n),
            coloured_rho_per_ms: sensors.coloured.map(|noise| noise.rho_per_ms),
            anti_alias_hz: sensors.anti_alias_hz,
            temperature_noise_k: sensors.temperature_noise_k,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &CharacteriseArgs) -> anyhow::Result<()> {
    let limits = match &args.datasheet {
        Some(path) => Limit::load(path)?,
        None => Vec::new(),
    };
    if !args.from.is_empty() {
        let tests = measurement::read_tests(&args.from, args.mapping.as_deref())?;
        let files = args.from.iter().map(|path| path.display().to_string()).collect();
        let file = LaboratoryFile {
            format: 1,
            source: "measured",
            files,
            seed: None,
            sensors: None,
            laboratory: Laboratory::of(&tests, &limits),
        };
        return leave(args, &args.from[0], &file, &[]);
    }
    let list = match TestList::built_in(&args.tests) {
        Some(list) => list,
        None => TestList::load(Path::new(&args.tests))?,
    };
    let (source, path, specimen) = specimen(args, &list.tests)?;
    let sensors = sensors(specimen.as_ref(), &list);
    let records = records(specimen.as_ref(), &list.tests, &sensors, args.seed);
    for record in records.iter().filter(|record| record.doubtful_steps > 0) {
        let (name, count) = (&record.name, record.doubtful_steps);
        eprintln!(
            "warning: {name}: {count} steps of the simulation were not solved as they should"
        );
    }
    let tests = measurements(&records)?;
    let file = LaboratoryFile {
        format: 1,
        source,
        files: vec![path.display().to_string()],
        seed: Some(args.seed),
        sensors: Some(SensorFigures::of(&sensors)),
        laboratory: Laboratory::of(&tests, &limits),
    };
    leave(args, path, &file, &records)
}

/// The damper of a virtual visit: what it is, its file, itself.
fn specimen<'a>(
    args: &'a CharacteriseArgs,
    tests: &[Test],
) -> anyhow::Result<(&'static str, &'a Path, Box<dyn Specimen>)> {
    if let Some(path) = &args.physical {
        let damper = HydraulicDamper::load(path)?;
        for test in tests {
            let reach_m = test.mean_m.abs() + test.excitation.reach().1;
            if reach_m > damper.half_stroke_m {
                bail!(
                    "{}: test \"{}\" goes to {reach_m} m, expected within half_stroke_m = {}",
                    path.display(),
                    test.name,
                    damper.half_stroke_m
                );
            }
        }
        return Ok(("physical", path, Box::new(damper)));
    }
    let Some(path) = &args.model else { bail!("no damper: expected MODEL, --physical or --from") };
    let damper = DamperFile::load_model(path)?.build(&Source::read(path)?)?;
    Ok(("model", path, Box::new(Modelled { damper })))
}

/// Sensors whose ranges fit: found by running every test once without noise.
fn sensors(specimen: &dyn Specimen, list: &TestList) -> Sensors {
    let exact = Sensors { temperature_noise_k: Some(0.0), ..Sensors::exact(1000.0) };
    let visited = records(specimen, &list.tests, &exact, 0);
    let forces = visited.iter().flat_map(|record| &record.force_n);
    let peak_force_n = forces.fold(0.0, |most: f64, force| most.max(force.abs()));
    list.sensors.sensors(peak_force_n, protocol::reach(&list.tests).1)
}

/// Records every test, with a progress bar over two seconds.
fn records(
    specimen: &dyn Specimen,
    tests: &[Test],
    sensors: &Sensors,
    seed: u64,
) -> Vec<RawRecord> {
    let total_s: f64 = tests.iter().map(|test| test.duration_s).sum();
    let target = ProgressDrawTarget::stderr_with_hz(10);
    let bar = ProgressBar::with_draw_target(Some(total_s as u64), target);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    let begin = Instant::now();
    let (mut degc, mut done_s) = (LABORATORY_DEGC, 0.0);
    let mut records = Vec::with_capacity(tests.len());
    for (index, test) in tests.iter().enumerate() {
        if begin.elapsed() > Duration::from_secs(2) {
            bar.set_message(test.name.clone());
            bar.set_position(done_s as u64);
        }
        let own_seed = Random::seed_of(seed, index as u64);
        let record = bench_visit::record_from(specimen, test, sensors, own_seed, degc);
        degc = record.end_degc;
        done_s += test.duration_s;
        records.push(record);
    }
    bar.finish_and_clear();
    records
}

/// Writes the files and prints the figures.
fn leave(
    args: &CharacteriseArgs,
    named_after: &Path,
    file: &LaboratoryFile,
    records: &[RawRecord],
) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(file)?;
    let folder = RunFolder::choose(args.out.as_deref(), &crate::output::stem(named_after));
    let place = |name: &str| folder.file(name).display().to_string();
    folder.create()?;
    for record in records {
        let name = format!("{}.csv", record.name);
        let write = || -> std::io::Result<()> {
            let mut to = BufWriter::new(std::fs::File::create(folder.file(&name))?);
            record.write_csv(&mut to)?;
            to.flush()
        };
        write().with_context(|| place(&name))?;
    }
    folder.write("laboratory.json", &format!("{json}\n"))?;
    if args.json {
        return Ok(print(&json)?);
    }
    let visit = file.sensors.as_ref().map_or(String::new(), |sensors| {
        format!(
            "\nvirtual visit, seed {}: {} Hz, force +-{} N with {} N rms of noise, displacement +-{} m with {} um\n",
            args.seed,
            sensors.rate_hz,
            sensors.force_range_n,
            sensors.force_noise_n,
            sensors.displacement_range_m,
            sensors.displacement_noise_m * 1e6
        )
    });
    let csv = if records.is_empty() { String::new() } else { format!(", {} CSV", records.len()) };
    let place = folder.path().display();
    Ok(print(&format!("{}{visit}files in {place}: laboratory.json{csv}", file.laboratory))?)
}
