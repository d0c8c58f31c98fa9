//! The lossless record as a `NumPy` file: `numpy.load("record.npy")` gives a structured array.
//!
//! Format 1.0: magic, version, header length, a Python dictionary padded with spaces, then the
//! rows. The number of rows stands in a field of fixed width and is replaced after every batch of
//! rows. After a power cut it may be ahead of the rows: [`RowReader`] ignores it and goes by the
//! size of the file.

use super::row::Row;
use super::storage::{Appender, Storage};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::RangeInclusive;

/// Writes rows to a file.
///
/// Rows are written first, then their number. A program that is killed therefore leaves a file that
/// `NumPy` reads up to the last batch.
#[derive(Debug)]
pub struct NpyWriter<S = File> {
    file: Appender<S>,
    /// Where their number begins in the header.
    count_at: u64,
    rows: u64,
    bytes: Vec<u8>,
}

/// Width kept free for the number of rows.
const COUNT_WIDTH: usize = 20;

impl<S: Storage> NpyWriter<S> {
    /// Begins a new file with a header for zero rows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(file: S) -> io::Result<Self> {
        let (mut file, header) = (Appender::new(file), header(0));
        file.append(&header)?;
        let count_at = count_place(&header).unwrap_or(0) as u64;
        Ok(Self { file, count_at, rows: 0, bytes: Vec::new() })
    }

    /// Appends rows: all of them or none.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn write(&mut self, rows: &[Row]) -> io::Result<()> {
        self.bytes.clear();
        for row in rows {
            row.put(&mut self.bytes);
        }
        self.file.append(&self.bytes)?;
        self.rows += rows.len() as u64;
        self.count()
    }

    /// Puts the number of rows into the header.
    fn count(&self) -> io::Result<()> {
        self.file.replace(format!("{:<COUNT_WIDTH$}", self.rows).as_bytes(), self.count_at)
    }

    /// Waits until the disk holds the rows; gives their number.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn finish(self) -> io::Result<u64> {
        self.count()?;
        self.file.sync()?;
        Ok(self.rows)
    }
}

/// Where the number of rows begins in a header.
fn count_place(header: &[u8]) -> Option<usize> {
    header.iter().rposition(|byte| *byte == b'(').map(|open| open + 1)
}

/// Reads the rows of a record one by one.
#[derive(Debug)]
pub(super) struct RowReader {
    file: BufReader<File>,
    start: u64,
    row: Vec<u8>,
}

impl RowReader {
    /// Reads the header; `None` for a file of another layout.
    pub(super) fn begin(file: File) -> io::Result<Option<Self>> {
        let mut file = BufReader::with_capacity(1 << 20, file);
        let ours = header(0);
        let mut found = Vec::with_capacity(ours.len());
        file.by_ref().take(ours.len() as u64).read_to_end(&mut found)?;
        let start = ours.len() as u64;
        Ok(is_ours(&found, &ours).then(|| Self { file, start, row: Vec::new() }))
    }

    /// The next row. A row that was cut off is no row; nor is one of zeros, which some file systems
    /// leave at the end after a power cut: every cycle has a number.
    pub(super) fn next_row(&mut self) -> io::Result<Option<&[u8]>> {
        let size = Row::size();
        self.row.clear();
        self.file.by_ref().take(size as u64).read_to_end(&mut self.row)?;
        let is_row = self.row.len() == size && self.row.iter().take(8).any(|byte| *byte != 0);
        Ok(is_row.then_some(self.row.as_slice()))
    }

    /// Goes back to the first row.
    pub(super) fn rewind(&mut self) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.start)).map(|_| ())
    }
}

/// Hands the rows of a record to `take`, until it returns false; gives the number of whole rows by
/// the size of the file, or none for another layout.
pub(crate) fn each_row(file: File, mut take: impl FnMut(&Row) -> bool) -> io::Result<Option<u64>> {
    let length = file.metadata()?.len();
    let Some(mut rows) = RowReader::begin(file)? else { return Ok(None) };
    let all = length.saturating_sub(rows.start) / Row::size() as u64;
    while let Some(bytes) = rows.next_row()? {
        if !take(&Row::get(bytes)) {
            break;
        }
    }
    Ok(Some(all))
}

/// The rows of some cycles, found without reading those before them; none for another layout.
pub(crate) fn rows_of(file: File, cycles: RangeInclusive<u64>) -> io::Result<Option<Vec<Row>>> {
    let length = file.metadata()?.len();
    let Some(mut rows) = RowReader::begin(file)? else { return Ok(None) };
    let (start, size) = (rows.start, Row::size() as u64);
    // Rows are in the order of their cycles, and some may be lost.
    let (mut low, mut high) = (0, length.saturating_sub(start) / size);
    while low < high {
        let middle = low.midpoint(high);
        rows.file.seek(SeekFrom::Start(start + middle * size))?;
        let cycle = rows.next_row()?.map(|bytes| Row::get(bytes).cycle);
        if cycle.is_some_and(|cycle| cycle < *cycles.start()) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    rows.file.seek(SeekFrom::Start(start + low * size))?;
    let mut found = Vec::new();
    while let Some(bytes) = rows.next_row()? {
        let row = Row::get(bytes);
        if row.cycle > *cycles.end() {
            break;
        }
        found.push(row);
    }
    Ok(Some(found))
}

/// Whether a header is that of this layout, whatever its number of rows.
fn is_ours(found: &[u8], ours: &[u8]) -> bool {
    let Some(place) = count_place(ours) else { return false };
    let (before, after) = (0..place, place + COUNT_WIDTH..ours.len());
    found.len() == ours.len()
        && found.get(before.clone()) == ours.get(before)
        && found.get(after.clone()) == ours.get(after)
}

/// The whole header, always of the same length.
fn header(rows: u64) -> Vec<u8> {
    let fields: Vec<String> = Row::fields()
        .into_iter()
        .map(|(name, kind, shape)| {
            if shape.is_empty() {
                format!("('{name}', '{kind}')")
            } else {
                let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
                format!("('{name}', '{kind}', ({},))", shape.join(", "))
            }
        })
        .collect();
    let mut text = format!(
        "{{'descr': [{}], 'fortran_order': False, 'shape': ({rows:<COUNT_WIDTH$},), }}",
        fields.join(", ")
    );
    let unpadded = 10 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn the_header_keeps_its_length_and_alignment() {
        let (empty, full) = (header(0), header(u64::MAX));
        assert_eq!(empty.len(), full.len());
        assert_eq!(empty.len() % 64, 0);
        let text = String::from_utf8_lossy(&full[10..]);
        assert!(text.contains("('extension_m', '<f8', (4,))"), "{text}");
        assert!(text.contains("('frame', '|u1', (4, 16,))"), "{text}");
        assert!(text.contains("'shape': (18446744073709551615,)"), "{text}");
    }

    /// A disk that takes so many bytes and then is full, in the middle of a write.
    struct Small {
        bytes: Mutex<Vec<u8>>,
        room: usize,
    }

    impl Storage for Small {
        fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()> {
            let mut disk = self.bytes.lock().unwrap();
            for (index, byte) in (at as usize..).zip(bytes) {
                if index >= self.room {
                    return Err(io::ErrorKind::StorageFull.into());
                }
                if index >= disk.len() {
                    disk.resize(index + 1, 0);
                }
                disk[index] = *byte;
            }
            Ok(())
        }
        fn cut(&self, length: u64) -> io::Result<()> {
            self.bytes.lock().unwrap().truncate(length as usize);
            Ok(())
        }
        fn sync(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn the_rows_of_some_cycles_are_found_where_rows_are_lost() {
        let path = std::env::temp_dir().join(format!("hil-host-rows-{}.npy", std::process::id()));
        let mut writer = NpyWriter::begin(File::create(&path).unwrap()).unwrap();
        let written = (1..=500).filter(|cycle| !(100..150).contains(cycle) && *cycle != 301);
        let written: Vec<Row> = written.map(|cycle| Row { cycle, ..Row::default() }).collect();
        writer.write(&written).unwrap();
        writer.finish().unwrap();
        let found = |cycles| {
            let rows = rows_of(File::open(&path).unwrap(), cycles).unwrap().unwrap();
            (rows.len(), rows.first().map(|row| row.cycle), rows.last().map(|row| row.cycle))
        };
        assert_eq!(found(1..=10), (10, Some(1), Some(10)));
        assert_eq!(found(120..=160), (11, Some(150), Some(160)));
        assert_eq!(found(300..=302), (2, Some(300), Some(302)));
        assert_eq!(found(490..=2000), (11, Some(490), Some(500)));
        assert_eq!(found(501..=2000), (0, None, None));
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_full_disk_takes_a_batch_whole_or_not_at_all() {
        let start = header(0).len();
        let room = start + 10 * Row::size() + 5;
        let disk = Small { bytes: Mutex::default(), room };
        let mut writer = NpyWriter::begin(&disk).unwrap();
        writer.write(&[Row::default(); 7]).unwrap();
        assert!(writer.write(&[Row::default(); 4]).is_err());
        // Another file was deleted: the next rows find room.
        writer.write(&[Row::default(); 3]).unwrap();
        assert!(writer.write(&[Row::default()]).is_err());
        assert_eq!(writer.finish().unwrap(), 10);
        let bytes = disk.bytes.into_inner().unwrap();
        assert_eq!(bytes.len(), start + 10 * Row::size());
        assert_eq!(bytes[..start], header(10));
    }
}
