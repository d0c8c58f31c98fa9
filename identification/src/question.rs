//! The question of an identification: records, a datasheet and what is wanted.

use super::error::IdentificationError;
use super::split::split;
use firmware_core::damper::Nominal;
use measurement::{Measurement, RecordReader, interpolant, read_tests_with};
use scenario::datasheet::Datasheet;
use std::path::{Path, PathBuf};

/// What an identification starts from.
#[derive(Debug, Clone)]
pub struct Question {
    /// Records to fit.
    pub train: Vec<Measurement>,
    /// Records that no fit sees.
    pub holdout: Vec<Measurement>,
    /// The maker's numbers, if there are any.
    pub datasheet: Option<Nominal>,
    /// Fit an empirical map, which is no physics, to the residual.
    pub empirical: bool,
    /// Continue the search past its usual limit of work.
    pub thorough: bool,
    /// What the reader should know about all this.
    pub notes: Vec<String>,
}

/// The files of a question.
#[derive(Debug, Clone, Copy)]
pub struct QuestionFiles<'a> {
    /// Records to fit.
    pub train: &'a [PathBuf],
    /// Records that no fit sees; without them some of the training tests are held out.
    pub holdout: &'a [PathBuf],
    /// The maker's numbers.
    pub datasheet: Option<&'a Path>,
    /// Columns and units of the records.
    pub mapping: Option<&'a Path>,
    /// Reads records that are no tables of text.
    pub reader: Option<&'a dyn RecordReader>,
}

/// Records that a note names.
const NAMED_RECORDS: usize = 3;

impl Question {
    /// Reads all files of a question. The second value holds the warnings about the datasheet.
    ///
    /// # Errors
    /// A file that cannot be used, or a record that is there twice.
    pub fn read(files: QuestionFiles<'_>) -> Result<(Self, Vec<String>), IdentificationError> {
        let datasheet = files.datasheet.map(Datasheet::load).transpose()?;
        refuse_files_given_twice(&files)?;
        let (train, holdout) = read_records(&files)?;
        // Both parts of a test that is cut have what was repaired in it.
        let of_one = (train.len() == 1 && holdout.is_empty()).then(|| repairs(&train, &[]));
        let (train, holdout, how) = held_out(train, holdout);
        let mut notes = Vec::new();
        let mut warnings = Vec::new();
        if let Some(sheet) = &datasheet {
            warnings.extend(sheet.warnings.iter().map(|line| format!("datasheet: {line}")));
            notes.extend(sheet.conversion.iter().map(|line| format!("datasheet: {line}")));
            notes.extend(warnings.iter().cloned());
        }
        notes.extend(how);
        notes.extend(of_one.unwrap_or_else(|| repairs(&train, &holdout)));
        notes.extend(bandwidths(train.iter().chain(&holdout)));
        let datasheet = datasheet.map(|sheet| sheet.nominal);
        let question = Self { train, holdout, datasheet, empirical: false, thorough: false, notes };
        Ok((question, warnings))
    }
}

/// What was repaired, once for all records that it was repaired in.
fn repairs(train: &[Measurement], holdout: &[Measurement]) -> Vec<String> {
    let mut found: Vec<(&str, Vec<&str>)> = Vec::new();
    for record in train.iter().chain(holdout) {
        for repair in &record.repairs {
            match found.iter_mut().find(|(known, _)| known == repair) {
                Some((_, names)) => names.push(&record.name),
                None => found.push((repair, vec![&record.name])),
            }
        }
    }
    let records = train.len() + holdout.len();
    let line = |(repair, names): &(&str, Vec<&str>)| match names.len() {
        count if count > 1 && count == records => format!("all {count} records: {repair}"),
        count if count > NAMED_RECORDS => {
            let first = names[..NAMED_RECORDS].join(", ");
            format!("{first} and {} more: {repair}", count - NAMED_RECORDS)
        }
        _ => format!("{}: {repair}", names.join(", ")),
    };
    found.iter().map(line).collect()
}

fn refuse_files_given_twice(files: &QuestionFiles<'_>) -> Result<(), IdentificationError> {
    if let Some(twice) = files.holdout.iter().find(|held| files.train.contains(held)) {
        return Err(IdentificationError::TrainAndHoldout(twice.clone()));
    }
    for files in [files.train, files.holdout] {
        let again = |(index, file): (usize, &PathBuf)| files[..index].contains(file);
        if let Some(place) = files.iter().enumerate().position(again) {
            return Err(IdentificationError::GivenTwice(files[place].clone()));
        }
    }
    Ok(())
}

/// The records to fit and those held out, read together so that no two tests share a name.
fn read_records(
    files: &QuestionFiles<'_>,
) -> Result<(Vec<Measurement>, Vec<Measurement>), IdentificationError> {
    let paths: Vec<PathBuf> = files.train.iter().chain(files.holdout).cloned().collect();
    let mut train = read_tests_with(&paths, files.mapping, files.reader)?;
    refuse_repeated(&train)?;
    let fitted = train.iter().take_while(|record| files.train.contains(&record.file)).count();
    let holdout = train.split_off(fitted);
    Ok((train, holdout))
}

/// Refuses a record that is there twice, under whatever name: held out and fitted at once, it would
/// show an error that no hold-out has.
fn refuse_repeated(records: &[Measurement]) -> Result<(), IdentificationError> {
    for (index, later) in records.iter().enumerate() {
        let same = |first: &&Measurement| {
            first.force_n == later.force_n && first.displacement_m == later.displacement_m
        };
        if let Some(first) = records[..index].iter().find(same) {
            let (file, of) = (later.file.clone(), first.file.clone());
            return Err(IdentificationError::SameNumbers { file, of });
        }
    }
    Ok(())
}

/// The records as given; where none is held out, some are chosen, and a note says which.
fn held_out(
    train: Vec<Measurement>,
    holdout: Vec<Measurement>,
) -> (Vec<Measurement>, Vec<Measurement>, Option<String>) {
    if !holdout.is_empty() {
        return (train, holdout, None);
    }
    let chosen = split(train);
    (chosen.train, chosen.holdout, Some(chosen.how))
}

/// The bandwidth of each sampling rate, once per rate.
fn bandwidths<'a>(records: impl Iterator<Item = &'a Measurement>) -> Vec<String> {
    let mut rates: Vec<f64> = records.map(|record| libm::round(record.rate_hz())).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let lines = rates.iter().map(|rate_hz| {
        format!(
            "{rate_hz} samples per second: velocity and acceleration lose 3 dB at {:.0} Hz",
            interpolant::bandwidth_hz(*rate_hz, 3.0)
        )
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    #[test]
    fn one_file_was_counted_as_all_2_records() {
        let mut csv = "time_s,displacement_m,force_n,velocity_m_per_s\n".to_owned();
        for n in 0..2000 {
            let angle = 0.05 * f64::from(n);
            let (x, f) = (5e-3 * libm::sin(angle), 1e4 * libm::cos(angle));
            // A velocity of the wrong sign is noted.
            writeln!(csv, "{},{x},{f},{}", 2e-3 * f64::from(n), -0.125 * libm::cos(angle)).unwrap();
        }
        let file = std::env::temp_dir().join(format!("one-file-{}.csv", std::process::id()));
        std::fs::write(&file, csv).unwrap();
        let train = std::slice::from_ref(&file);
        let files =
            QuestionFiles { train, holdout: &[], datasheet: None, mapping: None, reader: None };
        let (question, _) = Question::read(files).unwrap();
        std::fs::remove_file(&file).unwrap();
        let notes = question.notes.join("\n");
        assert!(!notes.contains("all 2 records"), "{notes}");
        assert!(
            notes.contains(": velocity column not used") && notes.contains("one-file-"),
            "{notes}"
        );
        assert_eq!(question.holdout.len(), 1);
    }
}
