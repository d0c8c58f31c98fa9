//! Options of the commands that read the record or the bus log of a run as a damper test.

use crate::error::CommandError;
use can_protocol::Node;
use clap::Args;
use hil_host::record::measured::RunRecords;
use measurement::RecordReader as _;
use std::path::{Path, PathBuf};

/// Which damper of a run is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Where a record is the record.npy or bus.log of a run")]
pub(crate) struct RunRecordArgs {
    /// The rig: its node on the bus, or in a bus.log where several answer in it.
    #[arg(long, value_name = "1..4", value_parser = node)]
    node: Option<Node>,
    /// The interface of that rig in a bus.log, where it answers on several.
    #[arg(long, value_name = "NAME", requires = "node")]
    interface: Option<String>,
    /// The damper slot in a record.npy, where several are on rigs or none is: its place on the
    /// vehicle, or its number from one.
    #[arg(long, value_name = "PLACE")]
    slot: Option<String>,
}

impl RunRecordArgs {
    /// The rig that is named.
    pub(crate) const fn node(&self) -> Option<Node> {
        self.node
    }

    /// The reader of these files.
    pub(crate) fn reader(&self) -> RunRecords {
        RunRecords { node: self.node, bus: self.interface.clone(), slot: self.slot.clone() }
    }
}

/// Refuses the record and the log of one run among other files: they hold the same measurement.
///
/// # Errors
/// Two files of one run.
pub(crate) fn refuse_one_run_twice<'a>(
    reader: &RunRecords,
    files: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), CommandError> {
    let mut runs: Vec<(PathBuf, &Path)> = Vec::new();
    for file in files.filter(|file| reader.reads(file)) {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let Ok(folder) = folder.unwrap_or(Path::new(".")).canonicalize() else { continue };
        let is_other = |earlier: &Path| earlier.file_name() != file.file_name();
        let mut of_run = runs.iter().filter(|(run, _)| *run == folder);
        if let Some((_, earlier)) = of_run.find(|(_, earlier)| is_other(earlier)) {
            let earlier = earlier.display().to_string();
            return Err(CommandError::Input {
                file: file.clone(),
                found: format!("the same run as in {}", files::quoted(&earlier)),
                expected: "each run once".to_owned(),
            });
        }
        runs.push((folder, file));
    }
    Ok(())
}

fn node(text: &str) -> Result<Node, String> {
    let number = text.parse().ok().and_then(|number| Node::new(number).ok());
    number.ok_or_else(|| "expected a node from 1 to 4".to_owned())
}
