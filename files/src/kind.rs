//! What a file is by its first bytes, where it is no text of ours.

/// What stands at the start, what such a file is, and what to do about it.
const KINDS: [(&[u8], &str, &str); 25] = [
    (b"PK\x03\x04", "a ZIP archive, perhaps an Excel workbook", SAVE_SHEET),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Excel workbook", SAVE_SHEET),
    (b"%PDF-", "a PDF document", "export the numbers as CSV"),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file", WRITE_TABLE),
    (b"MATLAB 7.3 MAT-file", "a MATLAB 7.3 file (HDF5)", WRITE_TABLE),
    (b"MATLAB", "a MATLAB file", WRITE_TABLE),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file, perhaps of MATLAB", WRITE_TABLE),
    (b"\x93NUMPY", "a NumPy array", "write it with numpy.savetxt as CSV"),
    (b"TDSm", "a TDMS file of LabVIEW", "export it as CSV"),
    (b"TDSh", "an index of a TDMS file of LabVIEW", "export the TDMS file as CSV"),
    (b"MDF     ", "an MDF measurement", "export it as CSV"),
    (b"UnFinMF ", "an MDF measurement that was not finalised", "finalise it and export it as CSV"),
    (b"{\\rtf", "a rich text document", "save it as plain text"),
    (b"<?xml", "an XML file", SAVE_SHEET),
    (b"<!DOCTYPE", "a web page", SAVE_SHEET),
    (b"<html", "a web page", SAVE_SHEET),
    (b"\x1f\x9d", "a compressed archive", "unpack it"),
    (b"Rar!", "an archive", "unpack it"),
    (b"7z\xbc\xaf\x27\x1c", "an archive", "unpack it"),
    (b"LOGG", "a BLF bus log", "export it as a candump log"),
    (b"PAR1", "a Parquet table", "write it as CSV"),
    (b"SQLite format 3\0", "an SQLite database", "export the table as CSV"),
    (b"\x1f\x8b", "a gzip archive", "unpack it"),
    (b"\x89PNG", "a PNG picture", "give the numbers as text"),
    (b"\x7fELF", "a program", "give a text file"),
];

const SAVE_SHEET: &str = "save the sheet as CSV";
const WRITE_TABLE: &str = "write the table with writetable as CSV";

/// Longest start that is looked at, bytes.
pub(crate) const START_BYTES: usize = 4096;

/// What a file is and what to do about it, if its first bytes say so.
pub(crate) fn of(start: &[u8]) -> Option<(&'static str, &'static str)> {
    let (found, (_, what, advice)) =
        KINDS.iter().map(|kind| (start.starts_with(kind.0), kind)).find(|(found, _)| *found)?;
    debug_assert!(found);
    let holds = |name: &[u8]| start.windows(name.len()).any(|window| window == name);
    if *advice == SAVE_SHEET && (holds(b"[Content_Types].xml") || holds(b"xl/")) {
        return Some(("an Excel workbook", SAVE_SHEET));
    }
    if start.starts_with(b"PK") && holds(b"opendocument.spreadsheet") {
        return Some(("an OpenDocument spreadsheet", SAVE_SHEET));
    }
    if start.starts_with(b"PK") && holds(b".npy") {
        return Some(("a NumPy archive", "write its arrays with numpy.savetxt as CSV"));
    }
    Some((what, advice))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_by_their_first_bytes() {
        assert_eq!(
            of(b"PK\x03\x04....[Content_Types].xml"),
            Some(("an Excel workbook", SAVE_SHEET))
        );
        assert_eq!(of(b"MATLAB 7.3 MAT-file, Platform").map(|kind| kind.1), Some(WRITE_TABLE));
        assert_eq!(of(b"PK\x03\x04 arr_0.npy").map(|kind| kind.0), Some("a NumPy archive"));
        assert_eq!(of(b"\x93NUMPY\x01\x00").map(|kind| kind.0), Some("a NumPy array"));
        assert_eq!(of(b"time_s,force_n\n0,1\n"), None);
        assert_eq!(of(b""), None);
    }
}
