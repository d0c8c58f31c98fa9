//! The lossless record as a `NumPy` file: `numpy.load("record.npy")` gives a structured array.
//!
//! Format 1.0: magic, version, header length, a Python dictionary padded with spaces, then the
//! rows. The number of rows stands in a field of fixed width; it is replaced when the disk holds
//! the rows, and is never ahead of them. [`RowReader`] ignores it and goes by the size of the
//! file, which may hold more.

use super::durable::{Appender, COUNT_WIDTH, Count, Durable};
use super::parts::open_parts;
use super::row::Row;
use super::storage::Storage;
use crate::BenchError;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How every file of this format begins.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Writes rows to a file.
///
/// Rows are appended; their number follows when the disk holds them
/// ([`finish`](NpyWriter::finish)).
#[derive(Debug)]
pub struct NpyWriter<S = File> {
    file: Appender<S>,
    start: u64,
    bytes: Vec<u8>,
}

impl<S: Storage> NpyWriter<S> {
    /// Begins a new file with a header for zero rows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(file: S) -> io::Result<Self> {
        let header = header(0);
        let (at, start) = (count_place(&header).unwrap_or(0) as u64, header.len() as u64);
        let count = Count { at, start, size: Row::size() as u64 };
        let mut file = Appender::with_count(file, Some(count));
        file.append(&header)?;
        Ok(Self { file, start, bytes: Vec::new() })
    }

    /// The file, for the thread that has the disk hold it.
    pub(crate) fn file(&self) -> Arc<Durable<S>> {
        self.file.file()
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
        self.file.append(&self.bytes)
    }

    /// Waits until the disk holds the rows and their number; gives it.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn finish(self) -> io::Result<u64> {
        self.file.finish()?;
        Ok((self.file.length() - self.start) / Row::size() as u64)
    }
}

/// Where the number of rows begins in a header.
fn count_place(header: &[u8]) -> Option<usize> {
    header.iter().rposition(|byte| *byte == b'(').map(|open| open + 1)
}

/// Reads the rows of a record one by one, part after part.
#[derive(Debug)]
pub(crate) struct RowReader {
    /// Parts that are read after this one, the next one last.
    next: Vec<(PathBuf, File)>,
    now: Part,
    /// Parts that have been read.
    done: Vec<(PathBuf, File)>,
    row: Vec<u8>,
    /// Cycle of the last row that was decoded.
    cycle: u64,
}

/// A part that is read.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    file: BufReader<File>,
    start: u64,
    /// Whole rows by the size of the file.
    rows: u64,
}

impl Part {
    /// Reads the header; none for a file of another layout. A part that its program had just made
    /// when it was killed has none, and no rows.
    fn begin(path: PathBuf, file: File, may_be_empty: bool) -> io::Result<Option<Self>> {
        let length = file.metadata()?.len();
        let mut file = BufReader::with_capacity(1 << 20, file);
        file.rewind()?;
        let ours = header(0);
        let mut found = Vec::with_capacity(ours.len());
        file.by_ref().take(ours.len() as u64).read_to_end(&mut found)?;
        let start = ours.len() as u64;
        let is_empty = may_be_empty && found.len() < ours.len();
        let rows = length.saturating_sub(start) / Row::size() as u64;
        let is_known = is_empty || is_ours(&found, &ours);
        Ok(is_known.then_some(Self { path, file, start, rows }))
    }

    fn go_to(&mut self, row: u64) -> io::Result<()> {
        let at = self.start + row * Row::size() as u64;
        self.file.seek(SeekFrom::Start(at)).map(|_| ())
    }

    /// Reads the next row into `row`; false where there is none. A row that was cut off is no row;
    /// nor is one of zeros, which some file systems leave at the end after a power cut: every cycle
    /// has a number.
    fn read(&mut self, row: &mut Vec<u8>) -> io::Result<bool> {
        let size = Row::size();
        row.clear();
        self.file.by_ref().take(size as u64).read_to_end(row)?;
        Ok(row.len() == size && row.iter().take(8).any(|byte| *byte != 0))
    }
}

impl RowReader {
    /// Opens a record of this version, with all its parts.
    ///
    /// # Errors
    /// It cannot be read, or has another layout.
    pub(crate) fn open(record: &Path) -> Result<Self, BenchError> {
        let reader = Self::begin(open_parts(record)?);
        let reader = reader.map_err(|why| BenchError::File { file: record.to_owned(), why })?;
        reader.ok_or_else(|| BenchError::Kept {
            file: record.to_owned(),
            found: "another layout".to_owned(),
            expected: "a record of this version",
        })
    }

    /// Reads the header; `None` for files of another layout.
    pub(super) fn begin(mut parts: Vec<(PathBuf, File)>) -> io::Result<Option<Self>> {
        parts.reverse();
        let Some((path, first)) = parts.pop() else { return Ok(None) };
        let now = Part::begin(path, first, false)?;
        Ok(now.map(|now| Self { next: parts, now, done: Vec::new(), row: Vec::new(), cycle: 0 }))
    }

    /// How many rows there are, by the sizes of all files.
    pub(crate) fn rows(&self) -> io::Result<u64> {
        let parts = self.next.iter().chain(&self.done);
        let rows = parts.map(|(_, file)| Ok(file.metadata()?.len() / Row::size() as u64));
        Ok(self.now.rows + rows.sum::<io::Result<u64>>()?)
    }

    /// The next row.
    pub(super) fn next_row(&mut self) -> io::Result<Option<&[u8]>> {
        while !self.now.read(&mut self.row)? {
            let Some((path, file)) = self.next.pop() else { return Ok(None) };
            let other = || invalid(format!("{}: another layout", path.display()));
            let part = Part::begin(path.clone(), file, true)?.ok_or_else(other)?;
            let Part { path, file, .. } = std::mem::replace(&mut self.now, part);
            self.done.push((path, file.into_inner()));
        }
        Ok(Some(&self.row))
    }

    /// The next row, decoded.
    ///
    /// # Errors
    /// It cannot be read, or its cycle does not follow that of the row before: part of another
    /// record.
    pub(crate) fn next(&mut self) -> io::Result<Option<Row>> {
        let Some(row) = self.next_row()?.map(Row::get) else { return Ok(None) };
        let before = std::mem::replace(&mut self.cycle, row.cycle);
        if row.cycle <= before {
            let found = row.cycle;
            return Err(invalid(format!(
                "found cycle {found} behind cycle {before}, expected a later one"
            )));
        }
        Ok(Some(row))
    }

    /// Goes back to the first row.
    pub(super) fn rewind(self) -> io::Result<Option<Self>> {
        let mut parts = self.done;
        parts.push((self.now.path, self.now.file.into_inner()));
        parts.extend(self.next.into_iter().rev());
        Self::begin(parts)
    }
}

/// A file that is not what it should be.
fn invalid(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// The rows of some cycles, found without reading those before them; none for another layout.
pub(crate) fn rows_of(
    parts: Vec<(PathBuf, File)>,
    cycles: RangeInclusive<u64>,
) -> io::Result<Option<Vec<Row>>> {
    let (mut found, mut bytes) = (Vec::new(), Vec::new());
    for (number, (path, file)) in parts.into_iter().enumerate() {
        let Some(mut part) = Part::begin(path, file, number > 0)? else { return Ok(None) };
        // Rows are in the order of their cycles, and some may be lost.
        let (mut low, mut high) = (0, part.rows);
        while low < high {
            let middle = low.midpoint(high);
            part.go_to(middle)?;
            let is_before = part.read(&mut bytes)? && Row::get(&bytes).cycle < *cycles.start();
            if is_before {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        part.go_to(low)?;
        while part.read(&mut bytes)? {
            let row = Row::get(&bytes);
            if row.cycle > *cycles.end() {
                return Ok(Some(found));
            }
            found.push(row);
        }
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

/// Whether a file that begins like this is the record of a run, of this or another version.
pub(super) fn is_record(begin: &[u8]) -> bool {
    let holds = |name: &[u8]| begin.windows(name.len()).any(|window| window == name);
    begin.starts_with(MAGIC) && holds(b"('cycle', '<u8')") && holds(b"('measured_n', ")
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
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(b"\x01\x00");
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::open_parts;
    use std::sync::Mutex;

    #[test]
    fn the_number_of_rows_lies_within_one_sector() {
        // A disk writes a sector whole or not at all: the number is never half an old one.
        let place = count_place(&header(0)).unwrap();
        assert_eq!(place / 512, (place + COUNT_WIDTH - 1) / 512, "{place}");
    }

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
            let rows = rows_of(open_parts(&path).unwrap(), cycles).unwrap().unwrap();
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
