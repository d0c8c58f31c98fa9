//! The console of an emulated board: words in, lines out, and the end, through the debugger.

use core::fmt::{self, Write};
use cortex_m_semihosting::{debug, nr, syscall};

/// Longest command line.
const LINE_MAX: usize = 128;

/// The command line of the emulator, or nothing.
pub struct CommandLine([u8; LINE_MAX]);

impl CommandLine {
    /// Asks for it.
    pub fn read() -> Self {
        let mut line = [0_u8; LINE_MAX];
        // Address and size of the buffer, as semihosting takes them.
        let block = [line.as_mut_ptr() as usize, LINE_MAX];
        #[expect(unsafe_code, reason = "the debugger fills the buffer, up to its size")]
        let refused = unsafe { syscall(nr::GET_CMDLINE, &block) };
        if refused != 0 {
            line = [0; LINE_MAX];
        }
        Self(line)
    }

    /// Its words.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap_or(0);
        let words = self.0.get(..end).unwrap_or_default().split(|byte| *byte == b' ');
        let text = |word| core::str::from_utf8(word).unwrap_or_default();
        words.map(text).filter(|word| !word.is_empty())
    }
}

/// Writes to the console of the emulator.
pub struct Console;

impl Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.as_bytes().chunks(LINE_MAX - 1) {
            let mut line = [0_u8; LINE_MAX];
            line.iter_mut().zip(part).for_each(|(to, from)| *to = *from);
            #[expect(unsafe_code, reason = "the debugger reads up to the zero at the end")]
            unsafe {
                syscall(nr::WRITE0, &line);
            }
        }
        Ok(())
    }
}

/// Ends the emulator.
pub fn exit(is_good: bool) -> ! {
    loop {
        debug::exit(if is_good { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    }
}
