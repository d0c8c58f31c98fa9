//! The order of writes: what a power cut leaves can be read.
//!
//! One thread appends entries to a file and states how far it has come. Another one takes that
//! state, waits until the disk holds the file, and only then writes the number of entries into its
//! header ([`Durable::hold`]). The number is therefore never ahead of the entries, whatever the
//! disk does with writes that it has not been asked to hold. The thread that appends never waits
//! for the disk.

use super::storage::Storage;
use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Digits kept free for a number of entries.
pub(super) const COUNT_WIDTH: usize = 20;

/// Where a file keeps the number of its entries.
#[derive(Debug, Clone, Copy)]
pub(super) struct Count {
    /// Where the digits begin.
    pub(super) at: u64,
    /// Where the entries begin.
    pub(super) start: u64,
    /// Bytes of an entry.
    pub(super) size: u64,
}

/// A file with what is known of it by the threads that write and hold it.
#[derive(Debug)]
pub(crate) struct Durable<S> {
    storage: S,
    count: Option<Count>,
    /// Bytes that have been written.
    written: AtomicU64,
    /// Bytes that the disk holds. Locked while the disk is waited for.
    held: Mutex<u64>,
}

impl<S: Storage> Durable<S> {
    /// Waits until the disk holds what has been written, then puts its number into the header.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub(crate) fn hold(&self) -> io::Result<()> {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let written = self.written.load(Ordering::Acquire);
        if written == *held {
            return Ok(());
        }
        self.storage.sync()?;
        if let Some(Count { at, start, size }) = self.count {
            let entries = written.saturating_sub(start) / size.max(1);
            self.storage.write_at(format!("{entries:<COUNT_WIDTH$}").as_bytes(), at)?;
        }
        *held = written;
        Ok(())
    }

    fn is_held(&self) -> bool {
        let held = *self.held.lock().unwrap_or_else(PoisonError::into_inner);
        held == self.written.load(Ordering::Acquire)
    }
}

/// The end of a file at which one thread appends: what a failed write leaves behind is cut off.
#[derive(Debug)]
pub(super) struct Appender<S> {
    file: Arc<Durable<S>>,
    length: u64,
}

impl<S: Storage> Appender<S> {
    /// A file without a number of entries.
    pub(super) fn new(storage: S) -> Self {
        Self::with_count(storage, None)
    }

    pub(super) fn with_count(storage: S, count: Option<Count>) -> Self {
        let (written, held) = (AtomicU64::new(0), Mutex::new(0));
        Self { file: Arc::new(Durable { storage, count, written, held }), length: 0 }
    }

    /// The file, for the thread that has the disk hold it.
    pub(super) fn file(&self) -> Arc<Durable<S>> {
        Arc::clone(&self.file)
    }

    pub(super) const fn length(&self) -> u64 {
        self.length
    }

    /// Appends all bytes or none of them.
    pub(super) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err(why) = self.file.storage.write_at(bytes, self.length) {
            // Where this fails too, the next bytes overwrite what is there.
            let _ = self.file.storage.cut(self.length);
            return Err(why);
        }
        self.length += bytes.len() as u64;
        self.file.written.store(self.length, Ordering::Release);
        Ok(())
    }

    /// Waits until the disk holds everything, the number of entries included.
    pub(super) fn finish(&self) -> io::Result<()> {
        self.file.hold()?;
        if self.file.count.is_some() { self.file.storage.sync() } else { Ok(()) }
    }
}

/// The files of one kind that a run writes: the one that is appended to, and earlier parts until
/// the disk holds them.
#[derive(Debug)]
pub(crate) struct OpenFiles<S>(Mutex<Vec<Arc<Durable<S>>>>);

impl<S> Default for OpenFiles<S> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<S: Storage> OpenFiles<S> {
    /// Adds a file that begins.
    pub(crate) fn add(&self, file: Arc<Durable<S>>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(file);
    }

    /// Has the disk hold all of them; those that nobody appends to any more are then released.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub(crate) fn hold(&self) -> io::Result<()> {
        // The lock is not held while the disk is waited for: a writer may add a file.
        let files = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let held = files.iter().map(|file| file.hold()).fold(Ok(()), Result::and);
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // One reference is in the list, one in the copy of it.
        open.retain(|file| Arc::strong_count(file) > 2 || !file.is_held());
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{NpyWriter, Row};
    use std::sync::atomic::AtomicBool;

    /// A write, and what the disk was asked to hold.
    #[derive(Debug, Clone)]
    enum Asked {
        Write {
            bytes: Vec<u8>,
            at: u64,
        },
        /// The disk was asked when so many requests had been made, and answered here.
        Held {
            since: usize,
        },
    }

    /// A disk that remembers what it was asked for.
    #[derive(Debug, Default)]
    struct Remembering(Mutex<Vec<Asked>>);

    impl Storage for Remembering {
        fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()> {
            self.0.lock().unwrap().push(Asked::Write { bytes: bytes.to_vec(), at });
            Ok(())
        }
        fn cut(&self, _: u64) -> io::Result<()> {
            unreachable!("no write fails")
        }
        fn sync(&self) -> io::Result<()> {
            let since = self.0.lock().unwrap().len();
            // Others write while the disk is busy.
            for _ in 0..20 {
                std::thread::yield_now();
            }
            self.0.lock().unwrap().push(Asked::Held { since });
            Ok(())
        }
    }

    /// What a power cut behind `requests` leaves at worst: rows only as far as the disk was asked
    /// to hold them, the header as it was written last. Number in the header, rows, rows written.
    fn left_by_a_cut(requests: &[Asked], start: u64) -> (u64, u64, u64) {
        let (mut count, mut rows, mut written, mut ends) = (0, 0, 0, Vec::new());
        for request in requests {
            match request {
                Asked::Write { bytes, at } if *at >= start => {
                    written = (at + bytes.len() as u64 - start) / Row::size() as u64;
                }
                Asked::Write { bytes, .. } if bytes.len() == COUNT_WIDTH => {
                    count = std::str::from_utf8(bytes).unwrap().trim().parse().unwrap();
                }
                Asked::Write { .. } => {}
                Asked::Held { since } => {
                    rows = since.checked_sub(1).map_or(0, |last| ends[last]);
                }
            }
            ends.push(written);
        }
        (count, rows, written)
    }

    #[test]
    fn at_every_cut_the_number_is_at_most_the_rows_that_the_disk_holds() {
        let disk = Remembering::default();
        let mut writer = NpyWriter::begin(&disk).unwrap();
        let (file, done) = (writer.file(), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Acquire) {
                    file.hold().unwrap();
                    std::thread::yield_now();
                }
            });
            for cycle in 1..=1000 {
                writer.write(&[Row { cycle, ..Row::default() }]).unwrap();
                std::thread::yield_now();
            }
            done.store(true, Ordering::Release);
        });
        assert_eq!(writer.finish().unwrap(), 1000);
        let requests = disk.0.into_inner().unwrap();
        let Asked::Write { bytes: header, at: 0 } = &requests[0] else { panic!("no header") };
        let start = header.len() as u64;
        for cut in 1..=requests.len() {
            let (count, rows, _) = left_by_a_cut(&requests[..cut], start);
            assert!(count <= rows, "cut {cut}: {count} of {rows}");
        }
        assert_eq!(left_by_a_cut(&requests, start), (1000, 1000, 1000));
    }

    #[test]
    fn a_cut_loses_what_was_written_since_the_disk_was_asked_last() {
        // Batches of 10 ms, the disk asked every 50 ms.
        let disk = Remembering::default();
        let mut writer = NpyWriter::begin(&disk).unwrap();
        let file = writer.file();
        for batch in 0..400_u64 {
            let row = |n| Row { cycle: 10 * batch + n, ..Row::default() };
            writer.write(&(1..=10).map(row).collect::<Vec<_>>()).unwrap();
            if batch % 5 == 4 {
                file.hold().unwrap();
            }
        }
        let requests = disk.0.lock().unwrap().clone();
        let Asked::Write { bytes: header, at: 0 } = &requests[0] else { panic!("no header") };
        for cut in 1..=requests.len() {
            let (count, rows, written) = left_by_a_cut(&requests[..cut], header.len() as u64);
            assert!(count <= rows && written - rows <= 50, "cut {cut}: {count} {rows} {written}");
        }
    }

    #[test]
    fn a_part_that_is_complete_is_released_when_the_disk_holds_it() {
        let (disk, open) = (Remembering::default(), OpenFiles::default());
        let first = NpyWriter::begin(&disk).unwrap();
        open.add(first.file());
        open.hold().unwrap();
        assert_eq!(open.0.lock().unwrap().len(), 1);
        let second = NpyWriter::begin(&disk).unwrap();
        open.add(second.file());
        drop(first);
        open.hold().unwrap();
        assert_eq!(open.0.lock().unwrap().len(), 1);
        drop(second);
        open.hold().unwrap();
        assert!(open.0.lock().unwrap().is_empty());
    }
}
