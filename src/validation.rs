//! `yawbench reproduce --validation`: numbers of this program compared with known numbers
//! ([`evidence::validation`]): a table, `validation.json` and a page.

use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::print;
use crate::{progress, stop};
use evidence::validation::{self, REFERENCES, Reference};
use files::ResultFolder;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// `validation.json`.
#[derive(Debug, Serialize)]
struct ValidationFile<'a> {
    format: u32,
    program: &'static str,
    passes: bool,
    references: &'a [Reference],
}

/// Compares everything; the files go to `out` or `runs/validation`.
///
/// # Errors
/// A folder or disk that fails; a reference that cannot be computed.
pub(crate) fn command(out: Option<&Path>, json: bool) -> Result<ExitCode, CommandError> {
    let identity = validation::identity()?;
    let (mut folder, changed) =
        ResultFolder::for_identity(out, "validation", "reproduce --validation", &identity)?;
    folder.check(&["validation.json", "validation.html"])?;
    if let Some(changed) = changed {
        files::say!("note: {changed}");
    }
    folder.create()?;
    let bar = progress::bar("the first references");
    let computed = validation::all(stop::flag(), &|title, done, of| {
        progress::show(&bar, [done, of], title.to_owned());
    });
    bar.finish_and_clear();
    let references = match computed {
        Ok(references) => references,
        Err(why) => {
            files::say!("error: a reference could not be computed: {why}");
            return Ok(ExitCode::from(FAILED));
        }
    };
    finish(json, &folder, &references)
}

/// Writes the files and prints the table.
fn finish(
    as_json: bool,
    folder: &ResultFolder,
    references: &[Reference],
) -> Result<ExitCode, CommandError> {
    let (done, of) = (references.len(), REFERENCES.len());
    let passes = done == of && references.iter().all(Reference::passes);
    let program = env!("CARGO_PKG_VERSION");
    let file = ValidationFile { format: 1, program, passes, references };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    folder.write("validation.json", &json)?;
    folder.write("validation.html", &validation::page(references).to_html()?)?;
    if as_json {
        print(&json)?;
        for miss in validation::misses(references) {
            files::say!("MISS {miss}");
        }
    } else {
        let place = folder.path().display();
        let text = validation::text(references);
        print(&format!("{text}\nfiles in {place}: validation.html, validation.json"))?;
    }
    if done < of {
        files::say!("interrupted: {done} of {of} references are computed");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::from(if passes { 0 } else { FAILED }))
}
