//! Frames on a line of bytes: a bus of two nodes without a CAN controller.
//!
//! ```text
//! END  id, high byte (bit 7: FD)  id, low byte  payload  END
//! ```
//! with the escapes of SLIP (RFC 1055). The payload has its own CRC and its seal, so the line adds
//! none: what was damaged is a damaged frame, or none.

use crate::{MAX_BYTES, WireFrame};
use heapless::Vec;

const END: u8 = 0xC0;
const ESCAPE: u8 = 0xDB;
const ESCAPED_END: u8 = 0xDC;
const ESCAPED_ESCAPE: u8 = 0xDD;

/// Marks a frame of CAN FD in the high byte of the id.
const FD: u8 = 0x80;

/// Writes a frame, byte by byte.
pub fn write(frame: &WireFrame, mut put: impl FnMut(u8)) {
    let [high, low] = frame.id().to_be_bytes();
    let high = if frame.is_fd() { high | FD } else { high };
    put(END);
    for byte in [high, low].iter().chain(frame.data()) {
        match *byte {
            END => [ESCAPE, ESCAPED_END].into_iter().for_each(&mut put),
            ESCAPE => [ESCAPE, ESCAPED_ESCAPE].into_iter().for_each(&mut put),
            byte => put(byte),
        }
    }
    put(END);
}

/// Reads frames, byte by byte.
#[derive(Debug, Clone, Default)]
pub struct Reader {
    bytes: Vec<u8, { MAX_BYTES + 2 }>,
    is_escaped: bool,
    is_broken: bool,
}

impl Reader {
    /// Takes the next byte; a frame, where it ends one.
    pub fn take(&mut self, byte: u8) -> Option<WireFrame> {
        let is_escaped = core::mem::take(&mut self.is_escaped);
        let byte = match byte {
            END => return self.end(),
            ESCAPE => {
                self.is_escaped = true;
                return None;
            }
            ESCAPED_END if is_escaped => END,
            ESCAPED_ESCAPE if is_escaped => ESCAPE,
            byte => {
                self.is_broken |= is_escaped;
                byte
            }
        };
        self.is_broken |= self.bytes.push(byte).is_err();
        None
    }

    fn end(&mut self) -> Option<WireFrame> {
        let bytes = core::mem::take(&mut self.bytes);
        if core::mem::take(&mut self.is_broken) {
            return None;
        }
        let (&[high, low], data) = bytes.split_first_chunk()?;
        WireFrame::new(u16::from_be_bytes([high & !FD, low]), high & FD != 0, data)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec as Bytes;

    fn written(frames: &[WireFrame]) -> Bytes<u8> {
        let mut bytes = Bytes::new();
        for frame in frames {
            write(frame, |byte| bytes.push(byte));
        }
        bytes
    }

    fn read(bytes: &[u8]) -> Bytes<WireFrame> {
        let mut reader = Reader::default();
        bytes.iter().filter_map(|byte| reader.take(*byte)).collect()
    }

    #[test]
    fn frames_come_out_as_they_went_in() {
        let frames = [
            WireFrame::new(0x101, false, &[END, ESCAPE, 0, ESCAPED_END, 1, END, END, 2]).unwrap(),
            WireFrame::new(0x0C0, false, &[]).unwrap(),
            WireFrame::new(0x7DB, true, &[ESCAPE; 64]).unwrap(),
        ];
        assert_eq!(read(&written(&frames)), frames);
    }

    #[test]
    fn a_reader_that_comes_late_or_misses_bytes_finds_the_next_frame() {
        let frames = [[1; 8], [2; 8], [3; 8]].map(|data| WireFrame::new(7, false, &data).unwrap());
        let bytes = written(&frames);
        assert_eq!(read(&bytes[5..]).last(), Some(&frames[2]));
        // Without an END two frames are one that is too long.
        let joined: Bytes<u8> = [&bytes[..11], &bytes[13..]].concat();
        assert_eq!(read(&joined).last(), Some(&frames[2]));
        assert_eq!(read(&[END, 0, 7, ESCAPE, 9, END]), []);
        assert_eq!(read(&[END, 0xFF, 0xFF, 1, END, 0, END]), []);
    }
}
