//! `yawbench reproduce`: what others have published, computed anew.
//!
//! With `--validation`, numbers of this program beside numbers that are known
//! ([`studies::validation`]): a table, `validation.json` and a page.

use crate::progress;
use crate::record::RunFolder;
use anyhow::bail;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use studies::validation::{self, Reference, page, text};

/// A comparison missed, or a reference could not be computed.
const FAILED: u8 = 1;

/// What `reproduce` is told.
#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Compare with benchmarks, published values, closed forms and second solutions; exit code 1 if one
    /// misses.
    #[arg(long)]
    validation: bool,
    /// Folder for the files [default: runs/validation].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print validation.json instead of a table.
    #[arg(long)]
    json: bool,
}

/// `validation.json`.
#[derive(Debug, Serialize)]
struct ValidationFile<'a> {
    format: u32,
    program: &'static str,
    passes: bool,
    references: &'a [Reference],
}

/// Runs the command.
///
/// # Errors
/// Nothing asked for; a folder or disk that fails.
pub fn command(args: &ReproduceArgs) -> anyhow::Result<ExitCode> {
    if !args.validation {
        bail!("reproduce: the figures of the study are to come; --validation is there");
    }
    let folder =
        RunFolder::at(args.out.clone().unwrap_or_else(|| PathBuf::from("runs/validation")));
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
    leave(args, &folder, &references)
}

/// Writes the files and prints the table.
fn leave(
    args: &ReproduceArgs,
    folder: &RunFolder,
    references: &[Reference],
) -> anyhow::Result<ExitCode> {
    let passes = references.iter().all(Reference::passes);
    let program = env!("CARGO_PKG_VERSION");
    let file = ValidationFile { format: 1, program, passes, references };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    folder.write("validation.json", &json)?;
    folder.write("validation.html", &page::page(references).to_html()?)?;
    if args.json {
        print!("{json}");
        for miss in text::misses(references) {
            eprintln!("MISS {miss}");
        }
    } else {
        print!("{}", text::text(references));
        println!("\nfiles in {}: validation.html, validation.json", folder.path().display());
    }
    Ok(if passes { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}
