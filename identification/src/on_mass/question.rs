//! What is asked: records of a body, and a datasheet of the damper on it where there is one.

use super::record::Record;
use crate::error::IdentificationError;
use crate::question::QuestionFiles;
use firmware_core::damper::Nominal;
use measurement::body_record::{BodyRecord, read_body_records};
use scenario::datasheet::Datasheet;
use std::path::PathBuf;

/// What the identification of a body starts from.
#[derive(Debug, Clone)]
pub struct OnMassQuestion {
    /// Records to fit.
    pub train: Vec<BodyRecord>,
    /// Records that no fit sees.
    pub holdout: Vec<BodyRecord>,
    /// Numbers of the damper on the body, if there is one: the series damper is then part of the
    /// model from the beginning.
    pub datasheet: Option<Nominal>,
    /// What the reader should know about all this.
    pub notes: Vec<String>,
}

impl OnMassQuestion {
    /// Reads all files of a question. The second value holds the warnings about the datasheet.
    ///
    /// # Errors
    /// A file that cannot be used or that is given twice, or records of different outputs.
    pub fn read(files: QuestionFiles<'_>) -> Result<(Self, Vec<String>), IdentificationError> {
        let datasheet = files.datasheet.map(Datasheet::load).transpose()?;
        if let Some(twice) = files.holdout.iter().find(|held| files.train.contains(held)) {
            return Err(IdentificationError::TrainAndHoldout(twice.clone()));
        }
        for files in [files.train, files.holdout] {
            let again = |(index, file): &(usize, &PathBuf)| files[..*index].contains(file);
            if let Some((_, file)) = files.iter().enumerate().find(again) {
                return Err(IdentificationError::GivenTwice(file.clone()));
            }
        }
        let paths: Vec<PathBuf> = files.train.iter().chain(files.holdout).cloned().collect();
        let mut train = read_body_records(&paths, files.mapping)?;
        refuse_other_outputs(&train)?;
        refuse_repeated(&train)?;
        let fitted = train.iter().take_while(|record| files.train.contains(&record.file)).count();
        let holdout = train.split_off(fitted);
        let mut notes = Vec::new();
        let mut warnings = Vec::new();
        if let Some(sheet) = &datasheet {
            warnings.extend(sheet.warnings.iter().map(|line| format!("datasheet: {line}")));
            notes.extend(sheet.conversion.iter().map(|line| format!("datasheet: {line}")));
            notes.extend(warnings.iter().cloned());
        }
        let datasheet = datasheet.map(|sheet| sheet.nominal);
        Ok((Self { train, holdout, datasheet, notes }, warnings))
    }

    /// The records, ready for a simulation.
    pub(super) fn records(&self) -> [Vec<Record>; 2] {
        [&self.train, &self.holdout].map(|all| all.iter().cloned().map(Record::new).collect())
    }
}

/// All errors are in one unit.
fn refuse_other_outputs(records: &[BodyRecord]) -> Result<(), IdentificationError> {
    let Some(first) = records.first() else { return Ok(()) };
    match records.iter().find(|record| record.output != first.output) {
        Some(other) => Err(IdentificationError::OtherOutput {
            file: other.file.clone(),
            found: other.output.name(),
            expected: first.output.name(),
        }),
        None => Ok(()),
    }
}

fn refuse_repeated(records: &[BodyRecord]) -> Result<(), IdentificationError> {
    for (index, later) in records.iter().enumerate() {
        let same =
            |first: &&BodyRecord| first.force_n == later.force_n && first.motion == later.motion;
        if let Some(first) = records[..index].iter().find(same) {
            let (file, of) = (later.file.clone(), first.file.clone());
            return Err(IdentificationError::SameNumbers { file, of });
        }
    }
    Ok(())
}
