//! Reads `record.npy` by its own header, as `NumPy` does.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::collections::HashMap;
use std::path::Path;

/// A record in memory.
pub(crate) struct Record {
    bytes: Vec<u8>,
    start: usize,
    row_bytes: usize,
    /// Offset and item size of every field.
    fields: HashMap<String, (usize, usize)>,
    rows: usize,
}

impl Record {
    /// Reads the file of a run that has ended.
    pub(crate) fn read(path: &Path) -> Self {
        let record = Self::read_killed(path);
        let length = record.start + record.rows * record.row_bytes;
        assert_eq!(record.bytes.len(), length, "rows are missing or cut");
        record
    }

    /// Reads the file of a run that was killed: behind the rows that the header counts there may be
    /// more.
    pub(crate) fn read_killed(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let header = String::from_utf8(bytes[10..start].to_vec()).unwrap();
        let descr = &header[header.find('[').unwrap() + 1..header.find(']').unwrap()];
        let (mut fields, mut offset) = (HashMap::new(), 0);
        for field in descr.split("('").skip(1) {
            let name = &field[..field.find('\'').unwrap()];
            let kind = field.split('\'').nth(2).unwrap();
            let size: usize = kind[2..].parse().unwrap();
            let items: usize = match field.find("', (") {
                Some(at) => {
                    let shape = &field[at + 4..];
                    let numbers = shape[..shape.find(')').unwrap()].split(',');
                    numbers.filter_map(|n| n.trim().parse::<usize>().ok()).product()
                }
                None => 1,
            };
            fields.insert(name.to_owned(), (offset, size));
            offset += size * items;
        }
        let shape = &header[header.find("'shape': (").unwrap() + 10..];
        let rows = shape[..shape.find(',').unwrap()].trim().parse().unwrap();
        let record = Self { start, row_bytes: offset, fields, rows, bytes };
        assert!(record.bytes.len() >= start + rows * offset, "rows are missing");
        record
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    fn at(&self, row: usize, field: &str, item: usize) -> &[u8] {
        let (offset, size) = self.fields[field];
        let start = self.start + row * self.row_bytes + offset + item * size;
        &self.bytes[start..start + size]
    }

    /// An `f64` field.
    pub(crate) fn number(&self, row: usize, field: &str, item: usize) -> f64 {
        f64::from_le_bytes(self.at(row, field, item).try_into().unwrap())
    }

    /// An unsigned field of any size.
    pub(crate) fn integer(&self, row: usize, field: &str, item: usize) -> u64 {
        self.at(row, field, item).iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte))
    }
}
