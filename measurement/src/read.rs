//! From files to tests.

use crate::columns;
use crate::commas;
use crate::companion;
use crate::error::MeasurementError;
use crate::layout::Layout;
use crate::mapping::Mapping;
use crate::measurement::Measurement;
use crate::prepare;
use crate::question;
use crate::reader::RecordReader;
use crate::recognition;
use crate::table::Table;
use crate::text::Text;
use files::quoted;
use scenario::source::Source;
use std::path::{Path, PathBuf};

/// Reads all tests of files, in the order given, with names that no two of them share.
///
/// Without a mapping the columns are `time_s,displacement_m,force_n` and optionally
/// `velocity_m_per_s,temperature_degc`, and a mapping of the same stem next to a file is found by
/// itself ([`mapping`](crate::mapping)). Lines that begin with `#` are comments, and one of them
/// may say `# extension: positive`, `negative` or `unknown`.
///
/// # Errors
/// The first thing that does not fit, in one line.
pub fn read_tests(
    paths: &[PathBuf],
    mapping: Option<&Path>,
) -> Result<Vec<Measurement>, MeasurementError> {
    read_tests_with(paths, mapping, None)
}

/// The same where some of the files may be of a kind that `reader` reads. No mapping applies to
/// these: what their columns mean is known.
///
/// # Errors
/// The first thing that does not fit, in one line.
pub fn read_tests_with(
    paths: &[PathBuf],
    mapping: Option<&Path>,
    reader: Option<&dyn RecordReader>,
) -> Result<Vec<Measurement>, MeasurementError> {
    let choice = MappingChoice::load(mapping)?;
    let mut visits = Visits::default();
    for path in paths {
        if let Some(reader) = reader.filter(|reader| reader.reads(path)) {
            for series in reader.read(path)? {
                let force_column = series.columns[2].clone();
                visits.add(prepare::as_recorded(series)?, (Layout::own(), force_column));
            }
            continue;
        }
        let text = Text::read(path)?;
        let (layout, wiring) = choice.layout(path, &text, true)?;
        let advised = |error| choice.advised(error, &text);
        for table in Table::parse(path, &text, &layout).map_err(advised)? {
            for series in columns::tests_of(&table, &layout).map_err(advised)? {
                let force_column = series.columns[2].clone();
                let mut test = prepare::as_recorded(series)?;
                // What the laboratory states comes before what this program concludes.
                test.destroyed.extend(layout.destroyed.clone());
                test.specimen.clone_from(&layout.specimen);
                visits.add(test, (wiring.clone(), force_column));
            }
        }
    }
    let mut tests = visits.with_signs_settled();
    name_apart(&mut tests);
    report_missing_temperatures(&mut tests);
    Ok(tests)
}

/// The tests of a file without a force column: their motion, with the displacement in the place of
/// the force, so that every check of the motion is made. `None` where the file has a force column
/// or the mapping names one.
///
/// # Errors
/// The first thing that does not fit, in one line.
pub fn read_motions(
    path: &Path,
    mapping: Option<&Path>,
) -> Result<Option<Vec<Measurement>>, MeasurementError> {
    let text = Text::read(path)?;
    let (mut layout, _) = MappingChoice::load(mapping)?.layout(path, &text, false)?;
    let tables = Table::parse(path, &text, &layout)?;
    let has_force = |name: &String| name != "force_n" || tables.iter().any(|table| table.has(name));
    if layout.force.iter().any(|force| has_force(&force.column)) {
        return Ok(None);
    }
    let has_displacement =
        tables.iter().any(|table| table.has(&layout.displacement.reading.column));
    let motion = if has_displacement || layout.displacement.required {
        &layout.displacement.reading
    } else {
        &layout.velocity.reading
    };
    layout.force = vec![motion.clone()];
    let mut series = Vec::new();
    for table in tables {
        series.extend(columns::tests_of(&table, &layout)?);
    }
    Measurement::from_visit(series).map(Some)
}

/// The mapping that applies to the files.
pub(crate) enum MappingChoice {
    /// One that was named.
    Named(Box<Mapping>, Source),
    /// For each file that next to it, if there is one.
    Companions,
}

impl MappingChoice {
    pub(crate) fn load(path: Option<&Path>) -> Result<Self, MeasurementError> {
        let Some(path) = path else { return Ok(Self::Companions) };
        let (mapping, source) = Mapping::load(path)?;
        Ok(Self::Named(Box::new(mapping), source))
    }

    /// The layout of a file, and the layout by which its wiring is compared with that of others:
    /// what a companion says about one file does not separate it from the others of its visit.
    /// Without a mapping a file that states no force is understood only where none is needed.
    pub(crate) fn layout(
        &self,
        file: &Path,
        text: &Text,
        needs_force: bool,
    ) -> Result<(Layout, Layout), MeasurementError> {
        if let Self::Named(mapping, source) = self {
            let layout = mapping.layout(source, file)?;
            return Ok((layout.clone(), layout));
        }
        let Some(source) = companion::find(file)? else {
            commas::check(file, &text.content)?;
            let layout = question::layout(&text.content, needs_force).map_err(|open| {
                // Names in another encoding say nothing.
                let encoding = match text.repairs.as_slice() {
                    [] => String::new(),
                    said => format!("; {}, save it as UTF-8", said.join("; ")),
                };
                MeasurementError::File {
                    file: file.to_owned(),
                    found: open.found,
                    expected: open.expected + &encoding,
                }
            })?;
            // What is said about one file does not separate it from others of its visit.
            let wiring = Layout { skip_lines: 0, understood: None, ..layout.clone() };
            return Ok((layout, wiring));
        };
        let layout = source.parse::<Mapping>()?.layout(&source, file)?;
        let Layout { extension, velocity, temperature, destroyed, specimen, .. } = Layout::own();
        let wiring =
            Layout { extension, velocity, temperature, destroyed, specimen, ..layout.clone() };
        Ok((layout, wiring))
    }
}

impl MappingChoice {
    /// An error about the columns of a file, with the way out where nobody has written a mapping.
    fn advised(&self, error: MeasurementError, text: &Text) -> MeasurementError {
        match (self, error) {
            (Self::Companions, MeasurementError::File { file, found, expected })
                if expected.starts_with("one called ") && !found.starts_with("several") =>
            {
                let way_out = if recognition::recognised(&text.content).is_some() {
                    "yawbench characterise --propose-mapping FILE writes a mapping to begin with"
                        .to_owned()
                } else {
                    let mut rows = text.content.lines().filter(|line| !line.trim().is_empty());
                    let second = rows.nth(1).unwrap_or("").trim();
                    format!("no rows of numbers follow, but \"{}\"", quoted(second))
                };
                MeasurementError::File { file, found, expected: format!("{expected}; {way_out}") }
            }
            (_, error) => error,
        }
    }
}

/// How the force was read: tests that share it were wired alike.
type Wiring = (Layout, String);

/// Tests with the visits that they belong to.
#[derive(Default)]
struct Visits {
    tests: Vec<Measurement>,
    /// The visit of every test.
    of_tests: Vec<usize>,
    /// The wiring of every visit.
    wirings: Vec<Wiring>,
}

impl Visits {
    fn add(&mut self, test: Measurement, wiring: Wiring) {
        let known = self.wirings.iter().position(|other| *other == wiring);
        self.of_tests.push(known.unwrap_or(self.wirings.len()));
        if known.is_none() {
            self.wirings.push(wiring);
        }
        self.tests.push(test);
    }

    fn with_signs_settled(mut self) -> Vec<Measurement> {
        for visit in 0..self.wirings.len() {
            let of_visit =
                self.tests.iter_mut().zip(&self.of_tests).filter(|(_, own)| **own == visit);
            prepare::settle_signs(&mut of_visit.map(|(test, _)| test).collect::<Vec<_>>());
        }
        self.tests
    }
}

/// Adds a number to names that came before.
fn name_apart(tests: &mut [Measurement]) {
    let mut taken = std::collections::BTreeSet::new();
    for test in tests {
        let (plain, mut number) = (test.name.clone(), 1);
        while !taken.insert(test.name.clone()) {
            number += 1;
            test.name = format!("{plain}-{number}");
        }
    }
}

fn report_missing_temperatures(tests: &mut [Measurement]) {
    if tests.iter().all(|test| test.temperature_degc.is_none()) {
        return;
    }
    for test in tests.iter_mut().filter(|test| test.temperature_degc.is_none()) {
        test.repairs
            .push("left as it is: no temperature here, though other tests have it".to_owned());
    }
}
