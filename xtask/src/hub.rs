//! A bus between emulated boards and programs of this machine: what one end sends, all others get.
//!
//! Every end is a connection to one Unix socket, with frames between bytes 0xC0 as on the serial
//! line of the project (`nodes/src/serial_line.rs`). Whole frames are passed on, so that two ends
//! that send at once do not mix their bytes.

use std::io::{self, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// The byte at either end of a frame.
const END: u8 = 0xC0;

/// A bus that waits for its ends.
pub(crate) struct Hub {
    listener: UnixListener,
    path: PathBuf,
}

impl Hub {
    /// A socket for a number of ends; its file goes with the hub.
    ///
    /// # Errors
    /// The socket cannot be made.
    pub(crate) fn listen(path: &Path) -> io::Result<Self> {
        Ok(Self { listener: UnixListener::bind(path)?, path: path.to_owned() })
    }

    /// Waits for all its ends, passes frames on, and closes the bus once there is nobody left to
    /// pass them on to: one of them waits for that.
    ///
    /// # Errors
    /// A connection that cannot be made.
    pub(crate) fn run(&self, ends: usize) -> io::Result<()> {
        let mut connections = Vec::new();
        for _ in 0..ends {
            connections.push(self.listener.accept()?.0);
        }
        let out = connections.iter().map(|end| end.try_clone().map(Mutex::new));
        let out: Vec<Mutex<UnixStream>> = out.collect::<io::Result<_>>()?;
        let left = AtomicUsize::new(ends);
        thread::scope(|scope| {
            for (place, end) in connections.into_iter().enumerate() {
                let (out, left) = (&out, &left);
                scope.spawn(move || {
                    pass_on(end, place, out);
                    if left.fetch_sub(1, Ordering::SeqCst) > 2 {
                        return;
                    }
                    for end in out.iter().filter_map(|end| end.lock().ok()) {
                        let _gone = end.shutdown(std::net::Shutdown::Both);
                    }
                });
            }
        });
        Ok(())
    }
}

impl Drop for Hub {
    fn drop(&mut self) {
        let _gone = std::fs::remove_file(&self.path);
    }
}

/// Passes on what comes from one end, until it is gone.
fn pass_on(mut from: UnixStream, place: usize, out: &[Mutex<UnixStream>]) {
    let (mut bytes, mut frames) = ([0; 4096], Frames::default());
    while let Ok(read @ 1..) = from.read(&mut bytes) {
        for frame in bytes[..read].iter().filter_map(|byte| frames.take(*byte)) {
            let others = out.iter().enumerate().filter(|(other, _)| *other != place);
            for mut end in others.filter_map(|(_, end)| end.lock().ok()) {
                // One that is gone ends the bus by its own thread.
                let _gone = end.write_all(&frame);
            }
        }
    }
}

/// Puts bytes together into frames.
#[derive(Default)]
struct Frames(Vec<u8>);

impl Frames {
    /// Takes the next byte; a frame with its two ends, where it is whole.
    fn take(&mut self, byte: u8) -> Option<Vec<u8>> {
        if byte != END {
            self.0.push(byte);
            return None;
        }
        let content = std::mem::take(&mut self.0);
        (!content.is_empty()).then(|| [&[END], content.as_slice(), &[END]].concat())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_all_ends_reach_the_others_whole() {
        let path = std::env::temp_dir().join(format!("yawbench-hub-{}", std::process::id()));
        let hub = Hub::listen(&path).unwrap();
        let ends = [0; 3].map(|_| UnixStream::connect(&path).unwrap());
        thread::scope(|scope| {
            scope.spawn(|| hub.run(3));
            let [mut one, mut two, mut three] = ends;
            for round in 0..100_u8 {
                one.write_all(&[END, 1, round]).unwrap();
                two.write_all(&[END, 2, round, END]).unwrap();
                one.write_all(&[END]).unwrap();
            }
            let mut got = [0; 800];
            three.read_exact(&mut got).unwrap();
            for (sender, expected) in [(1, 100), (2, 100)] {
                let frames = got.chunks(4).filter(|frame| frame[1] == sender && frame[3] == END);
                assert_eq!(frames.count(), expected);
            }
            drop((one, three));
            let mut rest = Vec::new();
            assert!(two.read_to_end(&mut rest).is_ok(), "the bus ends with the last but one");
        });
        drop(hub);
        assert!(!path.exists());
    }
}
