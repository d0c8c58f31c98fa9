//! `yawbench reproduce --validation`: numbers of this program beside numbers that are known
//! ([`evidence::validation`]): a table, `validation.json` and a page.

use crate::output::print;
use crate::progress;
use evidence::validation::{self, Reference, page, text};
use hil_host::record::RunFolder;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// A comparison missed, or a reference could not be computed.
const FAILED: u8 = 1;

/// `validation.json`.
#[derive(Debug, Serialize)]
struct ValidationFile<'a> {
    format: u32,
    program: &'static str,
    passes: bool,
    references: &'a [Reference],
}

/// Compares everything; the files go into `out` or `runs/validation`.
///
/// # Errors
/// A folder or disk that fails.
pub(crate) fn command(out: Option<&Path>, json: bool) -> anyhow::Result<ExitCode> {
    let folder = RunFolder::at(out.unwrap_or(Path::new("runs/validation")).to_owned());
    // A folder that cannot be made is told before the work and not after it.
    folder.create()?;
    let bar = progress::bar("the first references");
    let found = validation::all(&|title, done, of| {
        progress::show(&bar, [done, of], title.to_owned());
    });
    bar.finish_and_clear();
    let references = match found {
        Ok(references) => references,
        Err(why) => {
            eprintln!("error: a reference could not be computed: {why}");
            return Ok(ExitCode::from(FAILED));
        }
    };
    leave(json, &folder, &references)
}

/// Writes the files and prints the table.
fn leave(as_json: bool, folder: &RunFolder, references: &[Reference]) -> anyhow::Result<ExitCode> {
    let passes = references.iter().all(Reference::passes);
    let program = env!("CARGO_PKG_VERSION");
    let file = ValidationFile { format: 1, program, passes, references };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    folder.write("validation.json", &json)?;
    folder.write("validation.html", &page::page(references).to_html()?)?;
    if as_json {
        print(&json)?;
        for miss in text::misses(references) {
            eprintln!("MISS {miss}");
        }
    } else {
        let place = folder.path().display();
        let text = text::text(references);
        print(&format!("{text}\nfiles in {place}: validation.html, validation.json"))?;
    }
    Ok(if passes { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}
