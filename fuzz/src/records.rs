//! What a run has recorded, as a crash, a full disk or a hand left it: the first byte chooses.

use crate::temporary::Temporary;
use crate::toml_files::check;
use can_protocol::Node;
use hil_host::record::measured::{read_bus_log, read_record};
use hil_host::record::{NpyWriter, Row};
use std::fs::File;
use std::sync::LazyLock;

/// The start of every record, which random bytes do not hit.
static HEADER: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let file = Temporary::new("header.npy", b"").expect("room for a header");
    let writable = File::options().write(true).open(file.path()).expect("it was just made");
    let begun = NpyWriter::begin(writable).expect("room for a header");
    begun.finish().expect("room for a header");
    std::fs::read(file.path()).expect("it was just written")
});

pub(crate) fn records(bytes: &[u8]) {
    let Some((kind, content)) = bytes.split_first() else { return };
    match kind % 3 {
        0 => {
            let Some(log) = Temporary::new("bus.log", content) else { return };
            check(read_bus_log(log.path(), Node::ALL[usize::from(kind / 3 % 4)], None));
        }
        1 => record(usize::from(kind / 3), content),
        _ => {
            // Rows are long: few bytes are repeated until there are some.
            let long = content.iter().copied().cycle().take(3 * Row::size() + content.len());
            let whole: Vec<u8> = HEADER.iter().copied().chain(long).collect();
            record(usize::from(kind / 3), &whole);
        }
    }
}

fn record(slot: usize, bytes: &[u8]) {
    let Some(record) = Temporary::new("record.npy", bytes) else { return };
    check(read_record(record.path(), slot));
}
