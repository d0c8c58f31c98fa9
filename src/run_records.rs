//! Options of the commands that read the record or the bus log of a run as a damper test.

use can_protocol::Node;
use clap::Args;
use hil_host::record::measured::RunRecords;

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

fn node(text: &str) -> Result<Node, String> {
    let number = text.parse().ok().and_then(|number| Node::new(number).ok());
    number.ok_or_else(|| "expected a node from 1 to 4".to_owned())
}
