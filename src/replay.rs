//! `yawbench replay`: a recorded run, computed again from what came over the bus.

use crate::error::CommandError;
use crate::exit;
use crate::output::print;
use clap::Args;
use hil_host::replay::{Replay, replay};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Options of `replay`.
#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The result folder of the run, or its record.npy.
    run: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs `replay`: exit code 0 where every cycle of the record is the same, else 1.
///
/// # Errors
/// A folder that holds no run, or a file of it that cannot be read.
pub(crate) fn command(args: &ReplayArgs) -> Result<ExitCode, CommandError> {
    let folder = if args.run.is_file() {
        args.run.parent().unwrap_or(Path::new("")).to_owned()
    } else {
        args.run.clone()
    };
    let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    let begin = Instant::now();
    let found = replay(&folder, &mut |done, of| {
        if begin.elapsed() > Duration::from_secs(2) {
            bar.set_length(of);
            bar.set_position(done.min(of));
        }
    });
    bar.finish_and_clear();
    let found = found?;
    if args.json {
        print(&serde_json::to_string_pretty(&found)?)?;
    } else {
        print(&text(&found, &folder))?;
    }
    Ok(if found.is_whole() { ExitCode::SUCCESS } else { ExitCode::from(exit::FAILED) })
}

fn text(found: &Replay, folder: &Path) -> String {
    let folder = folder.display().to_string();
    let mut lines = Vec::new();
    lines.extend(found.recorded_by.as_ref().map(|program| {
        format!("note: recorded by {}, replayed by another version", files::quoted(program))
    }));
    let (cycles, frames) = (found.cycles, found.frames);
    lines.push(match &found.difference {
        None => format!(
            "{}: {cycles} cycles and {frames} frames sent are the same, bit for bit; trajectory {}",
            files::quoted(&folder),
            found.trajectory_hash
        ),
        Some(place) => format!(
            "{}: differs in {place}; {cycles} cycles before are the same",
            files::quoted(&folder)
        ),
    });
    if found.not_replayed > 0 {
        lines.push(format!(
            "the bus log ends there: {} cycles of the record were not replayed",
            found.not_replayed
        ));
    }
    if found.not_recorded > 0 {
        lines.push(format!(
            "the record ends there: {} cycles that summary.json counts are not in it",
            found.not_recorded
        ));
    }
    if found.without_row > 0 {
        lines.push(format!(
            "note: the record lacks the rows of {} cycles: only their frames were compared",
            found.without_row
        ));
    }
    lines.join("\n")
}
