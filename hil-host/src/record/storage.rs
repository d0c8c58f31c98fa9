//! Where the bytes of a record go: a file, or in a test something that fails like one.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt as _;

/// A file that is written at chosen places. A shared reference is enough, so that one thread
/// writes while another waits for the disk.
pub trait Storage: Send + Sync {
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
        match self.sync_data() {
            // A device that keeps nothing.
            Err(why) if why.kind() == io::ErrorKind::InvalidInput => Ok(()),
            synchronised => synchronised,
        }
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
