//! Where the bytes of a record go: a file, or in a test something that fails like one.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt as _;

/// A file that is written at chosen places. A shared reference is enough, so that one thread
/// writes while another waits for the disk.
pub trait Storage: Sync {
    /// Writes all bytes from the place `at` on.
    ///
    /// # Errors
    /// The disk is full, or gone; a part of the bytes may be written.
    fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()>;

    /// Cuts off what is behind `length`.
    ///
    /// # Errors
    /// The disk is gone.
    fn cut(&self, length: u64) -> io::Result<()>;

    /// Waits until the disk holds what was written.
    ///
    /// # Errors
    /// The disk is full, or gone.
    fn sync(&self) -> io::Result<()>;
}

impl Storage for File {
    fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()> {
        self.write_all_at(bytes, at)
    }

    fn cut(&self, length: u64) -> io::Result<()> {
        self.set_len(length)
    }

    fn sync(&self) -> io::Result<()> {
        self.sync_data()
    }
}

impl<S: Storage> Storage for &S {
    fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()> {
        (**self).write_at(bytes, at)
    }

    fn cut(&self, length: u64) -> io::Result<()> {
        (**self).cut(length)
    }

    fn sync(&self) -> io::Result<()> {
        (**self).sync()
    }
}

/// A storage that is only ever appended to: what a failed write leaves behind is cut off again.
#[derive(Debug)]
pub(super) struct Appender<S> {
    storage: S,
    length: u64,
}

impl<S: Storage> Appender<S> {
    pub(super) const fn new(storage: S) -> Self {
        Self { storage, length: 0 }
    }

    /// Appends all bytes or none of them.
    pub(super) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err(why) = self.storage.write_at(bytes, self.length) {
            // Where this fails too, the next bytes overwrite what is there.
            let _ = self.storage.cut(self.length);
            return Err(why);
        }
        self.length += bytes.len() as u64;
        Ok(())
    }

    /// Replaces bytes that are there.
    pub(super) fn replace(&self, bytes: &[u8], at: u64) -> io::Result<()> {
        debug_assert!(at + bytes.len() as u64 <= self.length, "replaces what is not there");
        self.storage.write_at(bytes, at)
    }

    pub(super) fn sync(&self) -> io::Result<()> {
        self.storage.sync()
    }
}
