//! Measured irregularity: a CSV file with a column of distance and up to four channels.

use super::random::CHANNELS;
use super::samples::Samples;
use crate::error::{Place, ScenarioError};
use crate::inputs::Inputs;
use crate::source;
use files::quote::message;
use files::{Limit, did_you_mean, number, quoted};
use firmware_core::track::IrregularitySample;
use std::path::Path;

/// Reads measured irregularity at even distances.
pub(super) fn read_csv(path: &Path, inputs: &mut Inputs) -> Result<Samples, ScenarioError> {
    let fail = |line: Option<usize>, message: String| {
        let at = Place { line, ..Place::whole(path) };
        ScenarioError::Mismatch { at, message }
    };
    let (text, hash) = source::read_hashed(path, Limit::Table)?;
    inputs.note("measured track", hash);
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let headers =
        reader.headers().map_err(|error| fail(Some(1), message(&error.to_string())))?.clone();
    let known = ["distance_m", "vertical_m", "alignment_m", "cross_level_m", "gauge_m"];
    if let Some(unknown) = headers.iter().find(|name| !known.contains(name)) {
        return Err(fail(
            Some(1),
            format!(
                "unknown column `{}`, expected {}{}",
                quoted(unknown),
                known.join(", "),
                did_you_mean(unknown, known)
            ),
        ));
    }
    let column = |name: &str| headers.iter().position(|header| header == name);
    let Some(distance) = column("distance_m") else {
        return Err(fail(Some(1), "column `distance_m` is missing".to_owned()));
    };
    let columns =
        [column("vertical_m"), column("alignment_m"), column("cross_level_m"), column("gauge_m")];
    let (mut places, mut samples) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| {
            fail(error.position().map(|p| p.line() as usize), message(&error.to_string()))
        })?;
        let line = record.position().map(|p| p.line() as usize);
        let number = |index: usize| -> Result<f64, ScenarioError> {
            let text = record.get(index).unwrap_or("");
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(fail(
                    line,
                    format!(
                        "column `{}`: found \"{}\", expected a number",
                        headers.get(index).unwrap_or(""),
                        quoted(text)
                    ),
                )),
            }
        };
        places.push((number(distance)?, line));
        let mut sample = IrregularitySample::default();
        for (index, (_, set)) in columns.iter().zip(CHANNELS) {
            if let Some(index) = index {
                set(&mut sample, number(*index)?);
            }
        }
        samples.push(sample);
    }
    let [(first_m, _), (second_m, _), ..] = places.as_slice() else {
        return Err(fail(None, format!("{} rows, expected at least 4", places.len())));
    };
    let (first_m, step_m) = (*first_m, second_m - first_m);
    if places.len() < 4 || step_m <= 0.0 {
        return Err(fail(None, "expected at least 4 rows at rising distance".to_owned()));
    }
    for (index, (place, line)) in places.iter().enumerate() {
        let expected = first_m + step_m * index as f64;
        if (place - expected).abs() > 0.01 * step_m {
            return Err(fail(
                *line,
                format!(
                    "column `distance_m`: found {}, expected {} (even steps of {} m)",
                    number(*place),
                    number(expected),
                    number(step_m)
                ),
            ));
        }
    }
    let mut samples = Samples { samples, first_m, step_m, ..Samples::default() };
    samples.fade_in();
    Ok(samples)
}

/// Measured samples must reach over the whole run, finely enough, with believable sizes.
pub(super) fn covers(
    path: &Path,
    samples: &Samples,
    from_m: f64,
    to_m: f64,
) -> Result<(), ScenarioError> {
    let last_m = samples.first_m + samples.step_m * samples.samples.len().saturating_sub(1) as f64;
    let fail = |message: String| Err(ScenarioError::mismatch(path, message));
    if samples.first_m > from_m || last_m < to_m {
        return fail(format!(
            "covers {} to {} m, but the run needs {} to {to_m:.0} m",
            number(samples.first_m),
            number(last_m),
            number(from_m)
        ));
    }
    if samples.step_m > 1.0 {
        return fail(format!("steps of {} m, expected at most 1 m", number(samples.step_m)));
    }
    let largest = samples.samples.iter().fold(0.0, |most: f64, sample| {
        let sizes = [sample.vertical_m, sample.alignment_m, sample.cross_level_m, sample.gauge_m];
        sizes.iter().fold(most, |most, size| most.max(size.abs()))
    });
    if largest > 0.2 {
        let largest = number(largest);
        return fail(format!("a value of {largest} m, expected at most 0.2 m: are these metres?"));
    }
    Ok(())
}
