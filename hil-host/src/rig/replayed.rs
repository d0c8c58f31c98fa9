//! A log that is played back to an emulated rig.
//!
//! A rig arms only on a frame that returns its fresh number, so that no old log can move it. An
//! emulated rig on a virtual interface has nothing to lose: it draws the number of the log, and the
//! host's frames in it arm and command it once more. The exchange is the usual one; a rig that
//! differs from that of the log in its limits or its readiness refuses.

use crate::BenchError;
use crate::bus::BusError;
use crate::record::{LogFault, LogReader};
use can_protocol::{ArmItem, ArmMessage, ArmSide, Node};
use std::path::Path;

/// The number that a rig drew in a log, for the first session in which it was armed.
///
/// # Errors
/// The interface is not virtual; the log cannot be read or arms no such rig.
pub(super) fn rig_number(log: &Path, interface: &str, node: Node) -> Result<u32, BenchError> {
    if !is_virtual(interface) {
        return Err(BusError::NotVirtual { interface: interface.to_owned() }.into());
    }
    let mut reader = LogReader::open(log).map_err(LogFault::into_bench_error)?;
    let mut number = None;
    while let Some(line) = reader.next_line().map_err(LogFault::into_bench_error)? {
        let Ok(message) = ArmMessage::decode(line.frame.id(), line.frame.data()) else { continue };
        match (message.side, message.item) {
            _ if message.node != node => {}
            (ArmSide::Rig, ArmItem::RigNumber) => number = Some(message.value),
            (ArmSide::Rig, ArmItem::Armed) => {
                if let Some(number) = number {
                    return Ok(number);
                }
            }
            _ => {}
        }
    }
    Err(BenchError::Kept {
        file: log.to_owned(),
        found: format!("no session in which node {node} is armed"),
        expected: "the bus.log of a run with that rig",
    })
}

/// Whether an interface has no hardware. One that is not there is found out when it is opened.
fn is_virtual(interface: &str) -> bool {
    let name = Path::new(interface).file_name().filter(|name| *name == interface);
    let Some(name) = name else { return true };
    !Path::new("/sys/class/net").join(name).join("device").exists()
}
