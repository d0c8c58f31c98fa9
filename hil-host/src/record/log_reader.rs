//! The frames of a candump log, part after part.
//!
//! A log is read as a stream. The last line of a program that was killed may be cut off; it is left
//! out. Frames with long ids and error frames are no frames of this bench and are skipped.

use super::bus_log::Direction;
use super::parts::open_parts;
use crate::BenchError;
use crate::bus::WireFrame;
use files::{InputError, quoted};
use socketcan::dump::{Direction as Way, ParseError, Reader};
use socketcan::{CanAnyFrame, EmbeddedFrame, Frame as _};
use std::fs::File;
use std::io::{self, BufReader, Read as _, Take};
use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};

/// A frame of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LogLine {
    /// Its line, from one, counted over all parts.
    pub(crate) line: usize,
    /// Its time stamp (us).
    pub(crate) stamp_us: u64,
    /// The name of its bus.
    pub(crate) bus: String,
    /// Which way it went, where the log says so.
    pub(crate) direction: Option<Direction>,
    /// The frame.
    pub(crate) frame: WireFrame,
}

/// Why a log cannot be read on.
#[derive(Debug)]
pub(crate) enum LogFault {
    /// A part cannot be opened.
    Input(InputError),
    /// The disk fails.
    Disk(PathBuf, io::Error),
    /// A line that holds no frame: file, line in it, what was found.
    NoFrame(PathBuf, usize, String),
}

impl LogFault {
    /// The same as an error of the bench.
    pub(crate) fn into_bench_error(self) -> BenchError {
        match self {
            Self::Input(why) => why.into(),
            Self::Disk(file, why) => BenchError::File { file, why },
            Self::NoFrame(file, line, found) => BenchError::Kept {
                file,
                found: format!("line {line}: {}", quoted(&found)),
                expected: "(time) bus id#data, as candump -L writes it",
            },
        }
    }
}

/// Reads the frames of a log.
#[derive(Debug)]
pub(crate) struct LogReader {
    /// Parts that are read after this one, the next one last.
    next: Vec<(PathBuf, File)>,
    now: Option<Part>,
    lines_before: usize,
    is_cut_off: bool,
}

/// A part that is read.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    reader: Reader<BufReader<Take<File>>>,
    line: usize,
}

impl LogReader {
    /// Opens a log with its parts.
    ///
    /// # Errors
    /// One of them cannot be opened.
    pub(crate) fn open(log: &Path) -> Result<Self, LogFault> {
        let mut next = open_parts(log).map_err(LogFault::Input)?;
        next.reverse();
        Ok(Self { next, now: None, lines_before: 0, is_cut_off: false })
    }

    /// The same without the parts behind the first.
    pub(crate) fn of_first_part(mut self) -> Self {
        self.next.drain(..self.next.len().saturating_sub(1));
        self
    }

    /// The next frame with a short id.
    ///
    /// # Errors
    /// The disk fails, or a line holds no frame.
    pub(crate) fn next_line(&mut self) -> Result<Option<LogLine>, LogFault> {
        loop {
            let Some(part) = &mut self.now else {
                let Some((path, file)) = self.next.pop() else { return Ok(None) };
                self.begin(path, file)?;
                continue;
            };
            part.line += 1;
            let line = part.line;
            let record = part.reader.next_record().map_err(|why| match why {
                ParseError::Io(why) => LogFault::Disk(part.path.clone(), why),
                why => LogFault::NoFrame(part.path.clone(), line, why.to_string()),
            })?;
            let Some(record) = record else {
                self.lines_before += line - 1;
                self.now = None;
                continue;
            };
            if let Some(frame) = standard(&record.frame) {
                let direction = record.direction.map(|way| match way {
                    Way::Received => Direction::Received,
                    Way::Transmitted => Direction::Sent,
                });
                let (line, stamp_us) = (self.lines_before + line, record.t_us);
                return Ok(Some(LogLine { line, stamp_us, bus: record.device, direction, frame }));
            }
        }
    }

    /// Whether a line was cut off and left out.
    pub(crate) const fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    fn begin(&mut self, path: PathBuf, file: File) -> Result<(), LogFault> {
        let failed = |why| LogFault::Disk(path.clone(), why);
        let whole = whole_lines(&file).map_err(failed)?;
        self.is_cut_off |= file.metadata().map_err(failed)?.len() > whole;
        let reader = Reader::from_reader(file.take(whole));
        self.now = Some(Part { path, reader, line: 0 });
        Ok(())
    }
}

/// A frame that has a short id.
fn standard(frame: &CanAnyFrame) -> Option<WireFrame> {
    let (id, fd, data) = match frame {
        CanAnyFrame::Normal(frame) if !frame.is_extended() => (frame.raw_id(), false, frame.data()),
        CanAnyFrame::Fd(frame) if !frame.is_extended() => (frame.raw_id(), true, frame.data()),
        _ => return None,
    };
    WireFrame::new(u16::try_from(id).ok()?, fd, data)
}

/// Bytes of a log up to its last line end.
fn whole_lines(file: &File) -> io::Result<u64> {
    let mut end = file.metadata()?.len();
    let mut bytes = [0; 4096];
    while end > 0 {
        let start = end.saturating_sub(bytes.len() as u64);
        let part = &mut bytes[..(end - start) as usize];
        file.read_exact_at(part, start)?;
        if let Some(at) = part.iter().rposition(|byte| *byte == b'\n') {
            return Ok(start + at as u64 + 1);
        }
        end = start;
    }
    Ok(0)
}
