//! The lossless record as a `NumPy` file: `numpy.load("record.npy")` gives a structured array.
//!
//! Format 1.0: magic, version, header length, a Python dictionary padded with spaces, then the
//! rows. The number of rows is written last, over spaces kept free for it.

use super::row::Row;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};

/// Writes rows to a file.
#[derive(Debug)]
pub struct NpyWriter {
    file: BufWriter<File>,
    rows: u64,
    bytes: Vec<u8>,
}

/// Width kept free for the number of rows.
const COUNT_WIDTH: usize = 20;

impl NpyWriter {
    /// Begins a new file with a header for zero rows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(file: File) -> io::Result<Self> {
        let mut file = BufWriter::with_capacity(1 << 20, file);
        file.write_all(&header(0))?;
        // A run that is killed leaves a file that can be read.
        file.flush()?;
        Ok(Self { file, rows: 0, bytes: Vec::with_capacity(1024) })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn write(&mut self, rows: &[Row]) -> io::Result<()> {
        for row in rows {
            self.bytes.clear();
            row.put(&mut self.bytes);
            self.file.write_all(&self.bytes)?;
            self.rows += 1;
        }
        Ok(())
    }

    /// Writes the number of rows and closes the file.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn finish(mut self) -> io::Result<u64> {
        self.file.flush()?;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&header(self.rows))?;
        file.sync_data()?;
        Ok(self.rows)
    }
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

    /// The next row; a row that was cut off is no row.
    pub(super) fn next_row(&mut self) -> io::Result<Option<&[u8]>> {
        let size = Row::size();
        self.row.clear();
        self.file.by_ref().take(size as u64).read_to_end(&mut self.row)?;
        Ok((self.row.len() == size).then_some(self.row.as_slice()))
    }

    /// Goes back to the first row.
    pub(super) fn rewind(&mut self) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.start)).map(|_| ())
    }
}

/// Whether a header is that of this layout, whatever its number of rows: a run that was killed has
/// not written it.
fn is_ours(found: &[u8], ours: &[u8]) -> bool {
    let Some(open) = ours.iter().rposition(|byte| *byte == b'(') else { return false };
    let (before, after) = (0..=open, open + 1 + COUNT_WIDTH..ours.len());
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
}
