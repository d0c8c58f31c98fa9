//! Which damper of a run is read, where its files are given as records.
//!
//! A record or a log may hold several dampers. Where it has one on a rig, that one is meant;
//! otherwise the user names it. Places of dampers stand in `run.json` next to a record.

use super::{read_bus_log, read_record, rigs_in_log};
use crate::record::npy::is_record;
use crate::record::places::Places;
use can_protocol::Node;
use files::{Limit, input, quoted};
use firmware_core::vehicle::DAMPER_SLOTS;
use measurement::{MeasurementError, RecordReader, Series};
use socketcan::dump::Reader;
use std::io::Read as _;
use std::path::Path;

/// Bytes of a file that show its kind: more than the header of a record.
const KIND_BYTES: u64 = 16_384;

/// Reads `record.npy` and `bus.log` of a run, or another candump log of a rig.
///
/// ```
/// use hil_host::record::measured::RunRecords;
/// use measurement::RecordReader as _;
/// assert!(!RunRecords::default().reads(std::path::Path::new("not there.log")));
/// ```
#[derive(Debug, Clone, Default)]
pub struct RunRecords {
    /// The rig in a log.
    pub node: Option<Node>,
    /// Its bus, where the log holds several.
    pub bus: Option<String>,
    /// The damper slot in a record: its place on the vehicle, or its number from one.
    pub slot: Option<String>,
}

/// What a file is by its beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Record,
    Log,
}

impl RecordReader for RunRecords {
    fn reads(&self, path: &Path) -> bool {
        kind_of(path).is_some()
    }

    fn read(&self, path: &Path) -> Result<Vec<Series>, MeasurementError> {
        Ok(vec![match kind_of(path) {
            Some(Kind::Log) => {
                let (node, bus) = self.rig_in(path)?;
                read_bus_log(path, node, bus.as_deref())?
            }
            _ => read_record(path, self.slot_in(path)?)?,
        }])
    }
}

impl RunRecords {
    /// The rig that is meant in a log, and its bus.
    fn rig_in(&self, log: &Path) -> Result<(Node, Option<String>), MeasurementError> {
        if let Some(node) = self.node {
            return Ok((node, self.bus.clone()));
        }
        let rigs = rigs_in_log(log)?;
        let refused = |found, expected: &str| {
            Err(MeasurementError::File { file: log.into(), found, expected: expected.to_owned() })
        };
        match rigs.as_slice() {
            [] => refused(
                "a log without a measurement of a rig".to_owned(),
                "a log of a run, or of a rig that speaks can-protocol/yawbench.dbc",
            ),
            [(node, bus)] => Ok((*node, Some(bus.clone()))),
            several => {
                let names = several.iter().map(|(node, bus)| format!("{node} on {}", quoted(bus)));
                let names = names.collect::<Vec<_>>().join(", ");
                refused(format!("rigs {names}"), "one of them: --node N, with --interface NAME")
            }
        }
    }

    /// The number of the slot that is meant in a record, from zero.
    fn slot_in(&self, record: &Path) -> Result<usize, MeasurementError> {
        let Places { places, rig_slots } = Places::next_to(record);
        let refused = |found| {
            let known = places.iter().map(|place| format!("\"{}\"", quoted(place)));
            let numbers = format!("1 to {DAMPER_SLOTS}");
            let names = known.chain([numbers]).collect::<Vec<_>>().join(", ");
            let expected = format!("--slot with one of {names}");
            Err(MeasurementError::File { file: record.to_owned(), found, expected })
        };
        let Some(wanted) = &self.slot else {
            return match rig_slots.as_slice() {
                [number] if (1..=DAMPER_SLOTS).contains(number) => Ok(number - 1),
                [] => refused("no run.json next to it that names one damper on a rig".to_owned()),
                several => refused(format!("{} dampers on rigs", several.len())),
            };
        };
        let by_place = places.iter().position(|place| place == wanted);
        let by_number = wanted.parse().ok().and_then(|number: usize| number.checked_sub(1));
        match by_place.or(by_number.filter(|slot| *slot < DAMPER_SLOTS)) {
            Some(slot) => Ok(slot),
            None => refused(format!("--slot {}", quoted(wanted))),
        }
    }
}

/// What a file is, if it is one that a run writes.
fn kind_of(path: &Path) -> Option<Kind> {
    let file = input::open(path, Limit::Stream).ok()?;
    let mut begin = Vec::new();
    file.take(KIND_BYTES).read_to_end(&mut begin).ok()?;
    if is_record(&begin) {
        return Some(Kind::Record);
    }
    // The parser allocates for a line: one without an end is no log.
    let line = begin.split_inclusive(|byte| *byte == b'\n').next()?;
    let is_frame = line.starts_with(b"(") && line.ends_with(b"\n");
    let first = is_frame.then(|| Reader::from_reader(line).next_record())?;
    matches!(first, Ok(Some(_))).then_some(Kind::Log)
}
